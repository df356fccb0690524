// SPDX-License-Identifier: GPL-3.0-or-later
// Two rays span an edge of the cone if no third one lies in all sides that hold both (K. Fukuda and A.
// Prodon, "Double description method revisited", 1996).
#include "visibility/cone.h"

#include <stdlib.h>
#include <string.h>

void enf_whole_dot(mpz_t out, mpz_t *a, mpz_t *b) {
    mpz_mul(out, a[0], b[0]);
    for (int i = 1; i < ENF_PLUECKER; i++) mpz_addmul(out, a[i], b[i]);
}

void enf_whole_shorten(mpz_t *vector) {
    mpz_t divisor;
    mpz_init(divisor);
    for (int i = 0; i < ENF_PLUECKER && mpz_cmp_ui(divisor, 1) != 0; i++)
        mpz_gcd(divisor, divisor, vector[i]);
    for (int i = 0; i < ENF_PLUECKER && mpz_cmp_ui(divisor, 1) > 0; i++)
        mpz_divexact(vector[i], vector[i], divisor);
    mpz_clear(divisor);
}

void enf_cone_init(enf_cone *cone) {
    memset(cone, 0, sizeof *cone);
    mpz_init(cone->term);
}

void enf_cone_free(enf_cone *cone) {
    for (int32_t i = 0; i < cone->made; i++) {
        for (int k = 0; k < ENF_PLUECKER; k++) mpz_clear(cone->rays[i].at[k]);
    }
    for (int32_t i = 0; i < cone->capacity; i++) mpz_clear(cone->values[i]);
    for (int32_t i = 0; i < cone->sides_made; i++) {
        for (int k = 0; k < ENF_PLUECKER; k++) mpz_clear(cone->sides[i][k]);
    }
    free(cone->rays);
    free(cone->values);
    mpz_clear(cone->term);
}

static bool grow(enf_cone *cone) {
    const int32_t capacity = cone->capacity + cone->capacity / 2 + 32;
    enf_cone_ray *rays = realloc(cone->rays, sizeof *rays * (size_t)capacity);
    if (!rays) return false;
    cone->rays = rays;
    mpz_t *values = realloc(cone->values, sizeof *values * (size_t)capacity);
    if (!values) return false;
    cone->values = values;
    while (cone->capacity < capacity) mpz_init(values[cone->capacity++]);
    return true;
}

/// A ray at the end, its position still to be set; null without memory.
static enf_cone_ray *new_ray(enf_cone *cone) {
    if (cone->ray_count == cone->capacity && !grow(cone)) return NULL;
    if (cone->ray_count == cone->made) {
        for (int k = 0; k < ENF_PLUECKER; k++) mpz_init(cone->rays[cone->made].at[k]);
        cone->made++;
    }
    enf_cone_ray *ray = &cone->rays[cone->ray_count++];
    memset(ray->tight, 0, sizeof ray->tight);
    return ray;
}

static void finish_ray(enf_cone_ray *ray) {
    enf_whole_shorten(ray->at);
    for (int k = 0; k < ENF_PLUECKER; k++) ray->about[k] = mpz_get_d(ray->at[k]);
}

static void keep_side(enf_cone *cone, mpz_t *side) {
    if (cone->side_count == cone->sides_made) {
        for (int k = 0; k < ENF_PLUECKER; k++) mpz_init(cone->sides[cone->sides_made][k]);
        cone->sides_made++;
    }
    for (int k = 0; k < ENF_PLUECKER; k++) mpz_set(cone->sides[cone->side_count][k], side[k]);
    cone->side_count++;
}

static void set_tight(enf_cone_ray *ray, int32_t side) {
    ray->tight[side / 64] |= UINT64_C(1) << side % 64;
}

// ---------------------------------------------------------------------------------------------- start

enum { WIDTH = 2 * ENF_PLUECKER };

/// Bareiss's elimination in Jordan's form of (matrix, 1); the right half becomes the inverse times the
/// determinant, whose sign is returned.
static int invert(mpz_t entry[ENF_PLUECKER][WIDTH]) {
    mpz_t divisor, factor;
    mpz_init_set_ui(divisor, 1);
    mpz_init(factor);
    for (int c = 0; c < ENF_PLUECKER; c++) {
        int row = c;
        while (mpz_sgn(entry[row][c]) == 0) row++;
        for (int j = 0; row != c && j < WIDTH; j++) {
            mpz_swap(entry[row][j], entry[c][j]);
            mpz_neg(entry[row][j], entry[row][j]); // so that the determinant keeps its sign
        }
        for (int i = 0; i < ENF_PLUECKER; i++) {
            mpz_set(factor, entry[i][c]);
            for (int j = 0; i != c && j < WIDTH; j++) {
                mpz_mul(entry[i][j], entry[i][j], entry[c][c]);
                mpz_submul(entry[i][j], factor, entry[c][j]);
                mpz_divexact(entry[i][j], entry[i][j], divisor);
            }
        }
        mpz_set(divisor, entry[c][c]);
    }
    const int sign = mpz_sgn(divisor);
    mpz_clears(divisor, factor, NULL);
    return sign;
}

bool enf_cone_start(enf_cone *cone, mpz_t *const sides[ENF_PLUECKER]) {
    mpz_t entry[ENF_PLUECKER][WIDTH];
    bool done = true;
    cone->ray_count = cone->side_count = 0;
    for (int i = 0; i < ENF_PLUECKER; i++) {
        keep_side(cone, sides[i]);
        for (int j = 0; j < ENF_PLUECKER; j++) {
            mpz_init_set(entry[i][j], sides[i][j]);
            mpz_init_set_ui(entry[i][ENF_PLUECKER + j], i == j);
        }
    }
    const int sign = invert(entry);
    for (int j = 0; done && j < ENF_PLUECKER; j++) {
        enf_cone_ray *ray = new_ray(cone);
        done = ray != NULL;
        for (int i = 0; done && i < ENF_PLUECKER; i++) {
            mpz_set(ray->at[i], entry[i][ENF_PLUECKER + j]);
            if (sign < 0) mpz_neg(ray->at[i], ray->at[i]);
            if (i != j) set_tight(ray, i);
        }
        if (done) finish_ray(ray);
    }
    for (int i = 0; i < ENF_PLUECKER; i++) {
        for (int j = 0; j < WIDTH; j++) mpz_clear(entry[i][j]);
    }
    return done;
}

// ---------------------------------------------------------------------------------------------- cut

static bool are_adjacent(const enf_cone *cone, int32_t a, int32_t b, int32_t count) {
    const int words = (cone->side_count + 63) / 64;
    uint64_t both[ENF_CONE_WORDS];
    int bits = 0;
    for (int w = 0; w < words; w++) {
        both[w] = cone->rays[a].tight[w] & cone->rays[b].tight[w];
        bits += __builtin_popcountll(both[w]);
    }
    if (bits < ENF_PLUECKER - 2) return false;
    for (int32_t i = 0; i < count; i++) {
        uint64_t missing = i == a || i == b;
        for (int w = 0; w < words; w++) missing |= both[w] & ~cone->rays[i].tight[w];
        if (!missing) return false;
    }
    return true;
}

/// Where the edge from ray a (inside) to ray b (outside) meets the new side.
static bool add_meeting(enf_cone *cone, int32_t a, int32_t b) {
    enf_cone_ray *ray = new_ray(cone);
    if (!ray) return false;
    for (int k = 0; k < ENF_PLUECKER; k++) {
        mpz_mul(ray->at[k], cone->rays[b].at[k], cone->values[a]);
        mpz_submul(ray->at[k], cone->rays[a].at[k], cone->values[b]);
    }
    for (int w = 0; w < ENF_CONE_WORDS; w++) ray->tight[w] = cone->rays[a].tight[w] & cone->rays[b].tight[w];
    set_tight(ray, cone->side_count);
    finish_ray(ray);
    return true;
}

/// Of the first `count`, only rays that are not outside stay.
static void drop_outside(enf_cone *cone, int32_t count) {
    int32_t kept = 0;
    for (int32_t i = 0; i < cone->ray_count; i++) {
        if (i < count && mpz_sgn(cone->values[i]) < 0) continue;
        if (i < count && mpz_sgn(cone->values[i]) == 0) set_tight(&cone->rays[i], cone->side_count);
        const enf_cone_ray ray = cone->rays[kept];
        cone->rays[kept++] = cone->rays[i];
        cone->rays[i] = ray;
    }
    cone->ray_count = kept;
}

bool enf_cone_cut(enf_cone *cone, mpz_t *side) {
    const int32_t count = cone->ray_count;
    for (int32_t i = 0; i < count; i++) enf_whole_dot(cone->values[i], cone->rays[i].at, side);
    for (int32_t a = 0; a < count; a++) {
        for (int32_t b = 0; mpz_sgn(cone->values[a]) > 0 && b < count; b++) {
            if (mpz_sgn(cone->values[b]) >= 0 || !are_adjacent(cone, a, b, count)) continue;
            if (!add_meeting(cone, a, b)) return false;
        }
    }
    drop_outside(cone, count);
    keep_side(cone, side);
    return true;
}
