// SPDX-License-Identifier: GPL-3.0-or-later
// Finite doubles as whole multiples of a power of two that divides them all.
#ifndef ENF_VISIBILITY_EXACT_DOUBLE_H
#define ENF_VISIBILITY_EXACT_DOUBLE_H

#include <gmp.h>
#include <limits.h>
#include <math.h>
#include <stdint.h>

enum { ENF_NO_UNIT = INT_MAX };

/// The double is *mantissa * 2^(what is returned), the mantissa a whole number; 0 has no unit.
static inline int enf_double_split(double value, int64_t *mantissa) {
    int exponent;
    *mantissa = (int64_t)ldexp(frexp(value, &exponent), 53);
    if (*mantissa == 0) return ENF_NO_UNIT;
    const int zeros = __builtin_ctzll((uint64_t)*mantissa);
    *mantissa /= INT64_C(1) << zeros;
    return exponent - 53 + zeros;
}

/// The smaller of `unit` and the largest u for which all three coordinates are multiples of 2^u.
static inline int enf_point_unit(const double point[3], int unit) {
    for (int i = 0; i < 3; i++) {
        int64_t mantissa;
        int own = enf_double_split(point[i], &mantissa);
        if (own < unit) unit = own;
    }
    return unit;
}

/// out = value / 2^unit, which must be whole.
static inline void enf_double_to_whole(mpz_t out, double value, int unit) {
    int64_t mantissa;
    int own = enf_double_split(value, &mantissa);
    mpz_set_si(out, mantissa);
    if (mantissa) mpz_mul_2exp(out, out, (mp_bitcnt_t)(own - unit));
}

#endif
