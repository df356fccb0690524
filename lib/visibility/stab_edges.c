// SPDX-License-Identifier: GPL-3.0-or-later
// The edge vectors of a sequence: in doubles, seen from a corner in its midst and scaled; and in whole
// numbers.
#include "base/array.h"
#include "visibility/exact_double.h"
#include "visibility/stab_parts.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int32_t count_edges(const enf_stabber *stabber) {
    const int32_t *first = stabber->pluecker->opening_edge;
    int32_t count = stabber->side_count;
    for (int32_t i = 0; i < stabber->count; i++) {
        const int32_t opening = stabber->sequence[i] >> 1;
        count += first[opening + 1] - first[opening];
    }
    return count;
}

static bool reserve(enf_stabber *stabber, int32_t wanted) {
    if (wanted <= stabber->capacity) return true;
    const int32_t capacity = wanted + wanted / 2 + 64;
    free(stabber->sources);
    free(stabber->vectors);
    free(stabber->products);
    stabber->sources = enf_array_new((size_t)capacity, sizeof *stabber->sources);
    stabber->vectors = enf_array_new((size_t)capacity, ENF_PLUECKER * sizeof *stabber->vectors);
    stabber->products = enf_array_new((size_t)capacity, sizeof *stabber->products);
    const bool done = stabber->sources && stabber->vectors && stabber->products;
    stabber->capacity = done ? capacity : 0;
    return done;
}

/// Origin, scale and unit.
static void choose_frame(enf_stabber *stabber) {
    const enf_pluecker *pluecker = stabber->pluecker;
    const int32_t midst = stabber->sequence[stabber->count / 2] >> 1;
    double size = 0;
    memcpy(stabber->origin, pluecker->edges[pluecker->opening_edge[midst]].from, sizeof stabber->origin);
    stabber->unit = ENF_NO_UNIT;
    stabber->rough = false;
    for (int32_t i = 0; i < stabber->count; i++) {
        const enf_pluecker_opening *opening = &pluecker->openings[stabber->sequence[i] >> 1];
        for (int k = 0; k < 3; k++) {
            size = fmax(size, stabber->origin[k] - opening->low[k]);
            size = fmax(size, opening->high[k] - stabber->origin[k]);
        }
        stabber->unit = opening->unit < stabber->unit ? opening->unit : stabber->unit;
        stabber->rough |= opening->rough;
    }
    if (stabber->unit == ENF_NO_UNIT) stabber->unit = 0;
    stabber->rough |= !(size > 0x1p-200 && size < 0x1p201) || stabber->side_count > 0;
    stabber->scale = stabber->rough ? 1 : ldexp(1, -1 - ilogb(size));
}

static void add_vector(enf_stabber *stabber, int32_t source) {
    const enf_pluecker_edge *edge = &stabber->pluecker->edges[source >> 1];
    const size_t stride = (size_t)stabber->capacity;
    const double sign = source & 1 ? -1 : 1;
    double at[3], *out = stabber->vectors + stabber->edge_count;
    for (int i = 0; i < 3; i++) at[i] = (edge->from[i] - stabber->origin[i]) * stabber->scale;
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        out[(size_t)i * stride] = sign * (at[j] * edge->along[k] - at[k] * edge->along[j]);
        out[(size_t)(i + 3) * stride] = sign * edge->along[i];
    }
    stabber->sources[stabber->edge_count++] = source;
}

/// Doubles are not asked about sides.
static void add_side(enf_stabber *stabber, int32_t side) {
    double *out = stabber->vectors + stabber->edge_count;
    for (int i = 0; i < ENF_PLUECKER; i++) out[(size_t)i * (size_t)stabber->capacity] = 0;
    stabber->sources[stabber->edge_count++] = -1 - side;
}

bool enf_stabber_take(enf_stabber *stabber, const int32_t *sequence, int32_t count) {
    const int32_t *first = stabber->pluecker->opening_edge;
    stabber->sequence = sequence;
    stabber->count = count;
    stabber->whole_ready = stabber->point_is_whole = false;
    stabber->edge_count = 0;
    if (!reserve(stabber, count_edges(stabber) + 1)) return false;
    choose_frame(stabber);
    for (int32_t i = 0; i < count; i++) {
        const int32_t opening = sequence[i] >> 1;
        for (int32_t k = first[opening]; k < first[opening + 1]; k++)
            add_vector(stabber, 2 * k + (sequence[i] & 1));
    }
    for (int32_t k = 0; k < stabber->side_count; k++) add_side(stabber, k);
    return true;
}

// ---------------------------------------------------------------------------------------------- whole
// numbers

/// out = (a - b) in units
static void whole_difference(mpz_t out, double a, double b, int unit) {
    mpz_t other;
    mpz_init(other);
    enf_double_to_whole(out, a, unit);
    enf_double_to_whole(other, b, unit);
    mpz_sub(out, out, other);
    mpz_clear(other);
}

void enf_stabber_whole_edge(const enf_stabber *stabber, int32_t k, mpz_t *vector) {
    const int32_t source = stabber->sources[k];
    if (source < 0) {
        enf_stabber_whole_side(stabber, &stabber->sides[-1 - source], vector);
        return;
    }
    const enf_pluecker_edge *edge = &stabber->pluecker->edges[source >> 1];
    const double *from = source & 1 ? edge->to : edge->from, *to = source & 1 ? edge->from : edge->to;
    mpz_t at[3];
    for (int i = 0; i < 3; i++) {
        mpz_init(at[i]);
        whole_difference(at[i], from[i], stabber->origin[i], stabber->unit);
        whole_difference(vector[3 + i], to[i], from[i], stabber->unit);
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        mpz_mul(vector[i], at[j], vector[3 + l]);
        mpz_submul(vector[i], at[l], vector[3 + j]);
    }
    for (int i = 0; i < 3; i++) mpz_clear(at[i]);
}

bool enf_stabber_whole_edges(enf_stabber *stabber) {
    if (stabber->whole_ready) return true;
    if (stabber->whole_count < stabber->edge_count) {
        enf_whole_vector *whole = realloc(stabber->whole, sizeof *whole * (size_t)stabber->edge_count);
        if (!whole) return false;
        stabber->whole = whole;
        while (stabber->whole_count < stabber->edge_count) {
            for (int i = 0; i < ENF_PLUECKER; i++) mpz_init(whole[stabber->whole_count][i]);
            stabber->whole_count++;
        }
    }
    for (int32_t k = 0; k < stabber->edge_count; k++) enf_stabber_whole_edge(stabber, k, stabber->whole[k]);
    stabber->whole_ready = true;
    return true;
}

bool enf_stabber_order(enf_stabber *stabber) {
    const int32_t count = stabber->edge_count;
    const double *x = stabber->hull.x;
    free(stabber->order);
    stabber->order = enf_array_new((size_t)count, sizeof *stabber->order);
    if (!stabber->order) return false;
    enf_min_norm_least(stabber->vectors, count, stabber->capacity, x, stabber->products);
    for (int i = 0; i < stabber->hull.size; i++) stabber->products[stabber->hull.member[i]] -= HUGE_VAL;
    for (int32_t k = 0; k < count; k++) {
        int32_t place = k;
        for (; place > 0 && stabber->products[k] < stabber->products[stabber->order[place - 1]]; place--)
            stabber->order[place] = stabber->order[place - 1];
        stabber->order[place] = k;
    }
    return true;
}
