// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility_check/whole_number.h"

#include <float.h>
#include <math.h>

int enf_last_bit(double value) {
    int exponent, bit = 0;
    if (value == 0) return DBL_MAX_EXP;
    int64_t mantissa = (int64_t)ldexp(frexp(value, &exponent), DBL_MANT_DIG);
    while (!(mantissa & 1)) {
        mantissa /= 2;
        bit++;
    }
    return exponent - DBL_MANT_DIG + bit;
}

int enf_last_bit_of_graph(const enf_portal_graph *graph) {
    int unit = 0;
    int32_t corners = graph->opening_count ? graph->opening_corner[graph->opening_count] : 0;
    for (int32_t c = 0; c < corners; c++)
        for (int i = 0; i < 3; i++) {
            int bit = enf_last_bit(graph->corners[c][i]);
            if (bit < unit) unit = bit;
        }
    return unit;
}

void enf_set_whole(mpz_t out, double value, int unit) {
    int exponent;
    mpz_set_d(out, ldexp(frexp(value, &exponent), DBL_MANT_DIG));
    int shift = exponent - DBL_MANT_DIG - unit;
    if (shift >= 0)
        mpz_mul_2exp(out, out, (mp_bitcnt_t)shift);
    else
        mpz_tdiv_q_2exp(out, out, (mp_bitcnt_t)-shift); // drops zeros only
}
