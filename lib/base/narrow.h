// SPDX-License-Identifier: MIT
// The exact tier of the orientation where compilers have no whole numbers of 128 bits: limbs of 32 bits.
#ifndef ENF_BASE_NARROW_H
#define ENF_BASE_NARROW_H

#include <stdint.h>

enum { ENF_NARROW_LIMBS = 6 };

/// to - from
static inline void enf_points_subtract(const double to[3], const double from[3], int64_t difference[3]) {
    for (int i = 0; i < 3; i++) difference[i] = (int64_t)to[i] - (int64_t)from[i];
}

/// out = a * b; out has two limbs more than a, of which there are `size`.
static inline void enf_narrow_multiply(uint32_t *out, const uint32_t *a, int size, uint64_t b) {
    const uint32_t part[2] = {(uint32_t)b, (uint32_t)(b >> 32)};
    for (int i = 0; i < size + 2; i++) out[i] = 0;
    for (int j = 0; j < 2; j++) {
        uint64_t carry = 0;
        for (int i = 0; i < size; i++) {
            carry += (uint64_t)a[i] * part[j] + out[i + j];
            out[i + j] = (uint32_t)carry;
            carry >>= 32;
        }
        out[size + j] = (uint32_t)carry;
    }
}

/// sum += a * b * c, or -=, in two's complement; their magnitudes are at most 2^54.
static inline void enf_narrow_add(uint32_t sum[ENF_NARROW_LIMBS], int64_t a, int64_t b, int64_t c,
                                  int subtract) {
    const int64_t factor[3] = {a, b, c};
    uint64_t size[3];
    uint32_t pair[4], product[ENF_NARROW_LIMBS];
    for (int i = 0; i < 3; i++) {
        size[i] = factor[i] < 0 ? -(uint64_t)factor[i] : (uint64_t)factor[i];
        subtract ^= factor[i] < 0;
    }
    const uint32_t first[2] = {(uint32_t)size[0], (uint32_t)(size[0] >> 32)};
    enf_narrow_multiply(pair, first, 2, size[1]);
    enf_narrow_multiply(product, pair, 4, size[2]);
    uint64_t carry = subtract != 0; // -x is ~x + 1
    for (int i = 0; i < ENF_NARROW_LIMBS; i++) {
        carry += (uint64_t)sum[i] + (subtract ? ~product[i] : product[i]);
        sum[i] = (uint32_t)carry;
        carry >>= 32;
    }
}

/// The sign of det(u, v, w); magnitudes are at most 2^54, so the sum is below 2^165.
static inline int enf_narrow_determinant(const int64_t u[3], const int64_t v[3], const int64_t w[3]) {
    uint32_t sum[ENF_NARROW_LIMBS] = {0}, any = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        enf_narrow_add(sum, w[i], u[j], v[k], 0);
        enf_narrow_add(sum, w[i], u[k], v[j], 1);
    }
    for (int i = 0; i < ENF_NARROW_LIMBS; i++) any |= sum[i];
    return sum[ENF_NARROW_LIMBS - 1] >> 31 ? -1 : any != 0;
}

#endif
