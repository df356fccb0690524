// SPDX-License-Identifier: MIT
// Sums of products of whole numbers, in parts of 128 bits, for the exact tier of the predicates.
#ifndef ENF_BASE_PARTS_H
#define ENF_BASE_PARTS_H

#include "base/limbs.h"

/// A whole number of up to 191 bits, 2^64 * high + low: products can be added up before anything is carried.
typedef struct enf_parts {
    enf_int128 high, low;
} enf_parts;

/// sum += a * b, |a| <= 2^54
static inline void enf_parts_add(enf_parts *sum, int64_t a, enf_int128 b) {
    sum->high += (enf_int128)a * (int64_t)(b >> 64);
    sum->low += (enf_int128)a * (uint64_t)b;
}

static inline int enf_parts_sign(const enf_parts *value) {
    enf_int128 high = value->high + (value->low >> 64);
    return high < 0 ? -1 : high > 0 || (uint64_t)value->low;
}

/// a * d - b * c
static inline enf_int128 enf_minor(int64_t a, int64_t b, int64_t c, int64_t d) {
    return (enf_int128)a * d - (enf_int128)b * c;
}

#endif
