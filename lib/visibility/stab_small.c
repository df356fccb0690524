// SPDX-License-Identifier: GPL-3.0-or-later
// Is 0 a combination, with weights >= 0, of a few edge vectors in small whole numbers? In levels built on a
// grid most answers end here. Everything is exact in 64 bits or given up.
#include "visibility/exact_double.h"
#include "visibility/stab_parts.h"

#include <math.h>
#include <stdlib.h>

typedef struct small_system {
    int64_t entry[ENF_PLUECKER][ENF_HULL_MAX];
    int size, rank, pivot_of_row[ENF_PLUECKER];
} small_system;

/// (a - b) * per_unit, if the difference is exact and small; both are multiples of the unit.
static bool whole_difference(double a, double b, double per_unit, int64_t *out) {
    const double difference = a - b, part = a - difference;
    const double error = (a - (difference + part)) + (part - b); // Knuth's
    const double place = difference * per_unit;
    if (error != 0 || !(fabs(place) < 0x1p62)) return false;
    *out = (int64_t)place;
    return true;
}

/// a * b - c * d
static bool minor_of(int64_t a, int64_t b, int64_t c, int64_t d, int64_t *out) {
    int64_t one, two;
    return !__builtin_mul_overflow(a, b, &one) && !__builtin_mul_overflow(c, d, &two) &&
           !__builtin_sub_overflow(one, two, out) && *out != INT64_MIN;
}

static bool set_column(small_system *s, int column, const enf_pluecker_edge *edge, bool turned,
                       const double origin[3], double per_unit) {
    int64_t at[3], along[3];
    for (int i = 0; i < 3; i++) {
        if (!whole_difference(edge->from[i], origin[i], per_unit, &at[i])) return false;
        s->entry[3 + i][column] = along[i] = turned ? -edge->small[i] : edge->small[i];
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, l = (i + 2) % 3;
        if (!minor_of(at[j], along[l], at[l], along[j], &s->entry[i][column])) return false;
    }
    return true;
}

/// The members' vectors, seen from a corner of one of them in units that they share.
static bool set_columns(small_system *s, const enf_stabber *stabber, const int32_t *members) {
    const enf_pluecker_edge *edges = stabber->pluecker->edges;
    int unit = ENF_NO_UNIT;
    for (int n = 0; n < s->size; n++) {
        const enf_pluecker_edge *edge = &edges[stabber->sources[members[n]] >> 1];
        if (!edge->is_small) return false;
        unit = edge->unit < unit ? edge->unit : unit;
    }
    const double per_unit = unit == ENF_NO_UNIT ? 1 : ldexp(1, -unit);
    const double *origin = edges[stabber->sources[members[0]] >> 1].from;
    for (int n = 0; n < s->size; n++) {
        const int32_t source = stabber->sources[members[n]];
        if (!set_column(s, n, &edges[source >> 1], source & 1, origin, per_unit)) return false;
    }
    return true;
}

static int64_t common_divisor(int64_t a, int64_t b) {
    a = llabs(a);
    b = llabs(b);
    while (b) {
        const int64_t rest = a % b;
        a = b;
        b = rest;
    }
    return a;
}

static void shorten_row(int64_t *row, int size) {
    int64_t divisor = 0;
    for (int j = 0; j < size && divisor != 1; j++) divisor = common_divisor(row[j], divisor);
    for (int j = 0; divisor > 1 && j < size; j++) row[j] /= divisor;
}

/// row = pivot * row - entry * other, the two factors without their common divisor. False if too large.
static bool subtract_row(int64_t *row, const int64_t *other, int column, int size) {
    const int64_t divisor = common_divisor(row[column], other[column]);
    const int64_t by_row = other[column] / divisor, by_other = row[column] / divisor;
    int64_t large = 0;
    for (int j = 0; j < size; j++) {
        int64_t one, two;
        if (__builtin_mul_overflow(row[j], by_row, &one) ||
            __builtin_mul_overflow(other[j], by_other, &two) || __builtin_sub_overflow(one, two, &row[j]) ||
            row[j] == INT64_MIN)
            return false;
        large |= llabs(row[j]);
    }
    if (large >> 24) shorten_row(row, size);
    return true;
}

/// The row from `rank` on with the smallest entry that is not 0; -1 if there is none.
static int pivot_row(const small_system *s, int column) {
    int best = -1;
    for (int i = s->rank; i < ENF_PLUECKER; i++) {
        if (s->entry[i][column] == 0) continue;
        if (best < 0 || llabs(s->entry[i][column]) < llabs(s->entry[best][column])) best = i;
    }
    return best;
}

static void swap_rows(small_system *s, int a, int b) {
    for (int j = 0; j < s->size; j++) {
        const int64_t entry = s->entry[a][j];
        s->entry[a][j] = s->entry[b][j];
        s->entry[b][j] = entry;
    }
}

static bool eliminate(small_system *s) {
    for (int column = 0; column < s->size && s->rank < ENF_PLUECKER; column++) {
        const int row = pivot_row(s, column);
        if (row < 0) continue;
        swap_rows(s, row, s->rank);
        for (int i = 0; i < ENF_PLUECKER; i++) {
            if (i == s->rank || s->entry[i][column] == 0) continue;
            if (!subtract_row(s->entry[i], s->entry[s->rank], column, s->size)) return false;
        }
        s->pivot_of_row[s->rank++] = column;
    }
    return true;
}

/// With one free column: each pivot's weight times the pivot, plus the entry in that column, is 0.
static bool weights_have_one_sign(const small_system *s) {
    int free_column = 0;
    while (free_column < s->rank && s->pivot_of_row[free_column] == free_column) free_column++;
    for (int i = 0; i < s->rank; i++) {
        const int64_t pivot = s->entry[i][s->pivot_of_row[i]], entry = s->entry[i][free_column];
        if (entry != 0 && (entry > 0) == (pivot > 0)) return false;
    }
    return true;
}

bool enf_stabber_zero_by_small(const enf_stabber *stabber, const int32_t *members, int count) {
    small_system s = {.size = count};
    return count >= 2 && set_columns(&s, stabber, members) && eliminate(&s) && s.rank == count - 1 &&
           weights_have_one_sign(&s);
}
