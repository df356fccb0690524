// SPDX-License-Identifier: GPL-3.0-or-later
// Lines in decimals, and whether they pass: in whole numbers, for the decimals as they stand.
#include "visibility/stab_fine.h"

#include "base/array.h"
#include "visibility/decimal.h"

#include <stdlib.h>

/// What a number may take beside its digits: a sign, a point, an exponent, a blank.
enum { AROUND = 32 };

char *enf_fine_text(const enf_fine *fine, const enf_stabber *stabber, int digits) {
    const size_t most = (size_t)digits + AROUND;
    char *text = enf_array_new(2 * 3 * most, 1), *at = text;
    mpf_t value;
    mpf_init2(value, fine->bits);
    for (int i = 0; text && i < 6; i++) {
        enf_fine_coordinate(fine, stabber, i / 3, i % 3, value);
        at += gmp_snprintf(at, most, i < 5 ? "%.*Fe " : "%.*Fe", digits - 1, value);
    }
    mpf_clear(value);
    return text;
}

/// Two points of the world -> seen from the origin, in units.
static void set_frame(const enf_stabber *stabber, mpq_t number[6]) {
    mpq_t origin;
    mpq_init(origin);
    for (int i = 0; i < 6; i++) {
        mpq_set_d(origin, stabber->origin[i % 3]);
        mpq_sub(number[i], number[i], origin);
        if (stabber->unit > 0)
            mpq_div_2exp(number[i], number[i], (mp_bitcnt_t)stabber->unit);
        else
            mpq_mul_2exp(number[i], number[i], (mp_bitcnt_t)-stabber->unit);
    }
    mpq_clear(origin);
}

/// x of the line, in whole numbers: times a common denominator's square.
static void set_x(mpq_t number[6], mpz_t x[ENF_PLUECKER]) {
    mpz_t common, at[6];
    mpz_init_set_ui(common, 1);
    for (int i = 0; i < 6; i++) mpz_lcm(common, common, mpq_denref(number[i]));
    for (int i = 0; i < 6; i++) {
        mpz_init(at[i]);
        mpz_divexact(at[i], common, mpq_denref(number[i]));
        mpz_mul(at[i], at[i], mpq_numref(number[i]));
    }
    for (int i = 0; i < 3; i++) {
        const int j = (i + 1) % 3, k = (i + 2) % 3;
        mpz_sub(x[i], at[3 + i], at[i]);
        mpz_mul(x[i], x[i], common);
        mpz_mul(x[3 + i], at[j], at[3 + k]);
        mpz_submul(x[3 + i], at[k], at[3 + j]);
    }
    for (int i = 0; i < 6; i++) mpz_clear(at[i]);
    mpz_clear(common);
}

/// Does the line between two points of the world pass all edges?
static bool passes(const enf_stabber *stabber, mpq_t number[6]) {
    mpz_t x[ENF_PLUECKER], side;
    bool passes = true;
    mpz_init(side);
    for (int i = 0; i < ENF_PLUECKER; i++) mpz_init(x[i]);
    set_frame(stabber, number);
    set_x(number, x);
    for (int32_t k = 0; passes && k < stabber->edge_count; k++) {
        enf_whole_dot(side, x, stabber->whole[k]);
        passes = mpz_sgn(side) > 0;
    }
    for (int i = 0; i < ENF_PLUECKER; i++) mpz_clear(x[i]);
    mpz_clear(side);
    return passes;
}

bool enf_stabber_passes_text(const enf_stabber *stabber, const char *text) {
    mpq_t number[6];
    bool good = true;
    for (int i = 0; i < 6; i++) mpq_init(number[i]);
    for (int i = 0; good && i < 6; i++) {
        int digits;
        good = enf_decimal_read(number[i], &text, &digits);
    }
    good = good && *text == '\0' && passes(stabber, number);
    for (int i = 0; i < 6; i++) mpq_clear(number[i]);
    return good;
}

bool enf_stabber_passes_wholly(const enf_stabber *stabber, const enf_line *line) {
    mpq_t number[6];
    for (int i = 0; i < 6; i++) {
        mpq_init(number[i]);
        mpq_set_d(number[i], i < 3 ? line->from[i] : line->to[i - 3]);
    }
    bool good = passes(stabber, number);
    for (int i = 0; i < 6; i++) mpq_clear(number[i]);
    return good;
}
