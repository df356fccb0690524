// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/exact_plane.h"

#include "base/limbs.h"

/// Limbs of a coefficient of the normal, of the offset, of a minor of two normals, of one with offsets, and
/// of the determinants of three normals, of three planes' numerators and of four planes.
enum { NORMAL = 2, OFFSET = 3, MINOR = 4, OFFSET_MINOR = 5, WEIGHT = 6, NUMERATOR = 7, ALL = 8 };

void enf_exact_plane_set(enf_exact_plane *plane, const double p[3], const int64_t u[3], const int64_t v[3]) {
    enf_int128 high = 0, low = 0; // of the offset, in halves of the normal
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        enf_int128 normal = (enf_int128)u[j] * v[k] - (enf_int128)u[k] * v[j];
        enf_limbs_set(plane->normal[i], normal);
        high -= (normal >> 64) * (int64_t)p[i];
        low -= (enf_int128)(uint64_t)normal * (int64_t)p[i];
    }
    enf_limbs_set_parts(plane->offset, high, low);
}

/// a_i * b_j - a_j * b_i
static inline void minor(uint64_t out[MINOR], const enf_exact_plane *a, const enf_exact_plane *b, int i,
                         int j) {
    uint64_t product[MINOR];
    enf_limbs_multiply(out, a->normal[i], NORMAL, b->normal[j], NORMAL);
    enf_limbs_multiply(product, a->normal[j], NORMAL, b->normal[i], NORMAL);
    enf_limbs_subtract(out, product, MINOR);
}

/// a_i * b_offset - a_offset * b_i
static inline void offset_minor(uint64_t out[OFFSET_MINOR], const enf_exact_plane *a,
                                const enf_exact_plane *b, int i) {
    uint64_t product[OFFSET_MINOR];
    enf_limbs_multiply(out, a->normal[i], NORMAL, b->offset, OFFSET);
    enf_limbs_multiply(product, b->normal[i], NORMAL, a->offset, OFFSET);
    enf_limbs_subtract(out, product, OFFSET_MINOR);
}

static void weight_of(uint64_t weight[WEIGHT], const enf_exact_plane plane[3]) {
    uint64_t part[MINOR], term[WEIGHT];
    for (int i = 0; i < WEIGHT; i++) weight[i] = 0;
    for (int i = 0; i < 3; i++) {
        minor(part, &plane[1], &plane[2], (i + 1) % 3, (i + 2) % 3);
        enf_limbs_multiply(term, plane[0].normal[i], NORMAL, part, MINOR);
        enf_limbs_add(weight, term, WEIGHT);
    }
}

int enf_exact_planes_weight_sign(const enf_exact_plane plane[3]) {
    uint64_t weight[WEIGHT];
    weight_of(weight, plane);
    return enf_limbs_sign(weight, WEIGHT);
}

/// Minus component i of (offset_a * b x c + offset_b * c x a + offset_c * a x b).
static void numerator_of(uint64_t numerator[NUMERATOR], const enf_exact_plane plane[3], int i) {
    uint64_t part[MINOR], term[NUMERATOR];
    for (int k = 0; k < NUMERATOR; k++) numerator[k] = 0;
    for (int k = 0; k < 3; k++) {
        minor(part, &plane[(k + 1) % 3], &plane[(k + 2) % 3], (i + 1) % 3, (i + 2) % 3);
        enf_limbs_multiply(term, plane[k].offset, OFFSET, part, MINOR);
        enf_limbs_subtract(numerator, term, NUMERATOR);
    }
}

void enf_exact_planes_meet(const enf_exact_plane plane[3], double point[3]) {
    uint64_t weight[WEIGHT], numerator[NUMERATOR];
    weight_of(weight, plane);
    for (int i = 0; i < 3; i++) {
        numerator_of(numerator, plane, i);
        point[i] = enf_limbs_quotient(numerator, NUMERATOR, weight, WEIGHT);
    }
}

/// Adds a minor of two planes, times one with the offsets of two others, to a sum that fits (parts of it need
/// not: all is modulo 2^512).
static inline void add_term(uint64_t sum[ALL], const uint64_t part[MINOR],
                            const uint64_t with_offsets[OFFSET_MINOR]) {
    uint64_t term[MINOR + OFFSET_MINOR];
    enf_limbs_multiply(term, part, MINOR, with_offsets, OFFSET_MINOR);
    enf_limbs_add(sum, term, ALL);
}

int enf_exact_planes_sign(const enf_exact_plane plane[4]) {
    // Laplace's expansion by the first two rows: columns (j, k) of these go with (i, offset) of the others.
    uint64_t sum[ALL] = {0}, part[MINOR], with_offsets[OFFSET_MINOR];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        for (int pair = 0; pair < 4; pair += 2) {
            const enf_exact_plane *a = &plane[pair], *b = &plane[2 - pair];
            minor(part, &a[0], &a[1], j, k);
            if (enf_limbs_is_zero(part, MINOR)) continue;
            offset_minor(with_offsets, &b[0], &b[1], i);
            add_term(sum, part, with_offsets);
        }
    }
    return enf_limbs_sign(sum, ALL);
}
