// SPDX-License-Identifier: MIT
// Whole numbers of up to 512 bits, for the exact tier of the predicates. Sign and magnitude, only the limbs
// in use are touched, so small numbers cost little. No allocation. A result beyond 512 bits would be a bug in
// a predicate's degree analysis (build/geometry.c); it is caught by an assertion.
#ifndef ENF_BASE_WIDE_H
#define ENF_BASE_WIDE_H

#include "base/limbs.h"

#include <stdint.h>

#define ENF_WIDE_LIMBS 8

typedef struct enf_wide {
    int sign; ///< -1, 0, +1
    int size; ///< limbs in use; the highest is not 0
    uint64_t limb[ENF_WIDE_LIMBS];
} enf_wide;

void enf_wide_set(enf_wide *result, enf_int128 value);
void enf_wide_set_parts(enf_wide *result, enf_int128 high,
                        enf_int128 low); ///< 2^64 * high + low, sum < 2^191
void enf_wide_add(enf_wide *result, const enf_wide *a, const enf_wide *b);
void enf_wide_subtract(enf_wide *result, const enf_wide *a, const enf_wide *b);
void enf_wide_multiply(enf_wide *result, const enf_wide *a, const enf_wide *b); ///< result must not be a or b

/// result += a * b and result -= a * b
void enf_wide_add_product(enf_wide *result, const enf_wide *a, const enf_wide *b);
void enf_wide_subtract_product(enf_wide *result, const enf_wide *a, const enf_wide *b);

/// a / b rounded to double (within 5 units in the last place); b must not be 0.
double enf_wide_quotient(const enf_wide *a, const enf_wide *b);

#endif
