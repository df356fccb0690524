// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/decimal.h"

#include <ctype.h>
#include <stdlib.h>

/// Digits and a point into a whole number. Returns how many digits there are, leading zeros not counted, or
/// -1 if there are none at all or too many; *exponent is lowered by one for each digit behind the point.
static int read_digits(mpz_t out, const char **text, long *exponent) {
    const char *at = *text;
    int digits = 0, all = 0;
    bool behind = false;
    mpz_set_ui(out, 0);
    for (; isdigit((unsigned char)*at) || (*at == '.' && !behind); at++) {
        if (*at == '.') {
            behind = true;
            continue;
        }
        if (++all > ENF_DECIMAL_DIGITS) return -1;
        *exponent -= behind;
        digits += digits > 0 || *at != '0';
        mpz_mul_ui(out, out, 10);
        mpz_add_ui(out, out, (unsigned long)(*at - '0'));
    }
    *text = at;
    return all ? digits : -1;
}

/// Moves behind an exponent, if there is one, and adds it; false if it is too large.
static bool read_exponent(const char **text, long *exponent) {
    const char *at = *text;
    if (*at != 'e' && *at != 'E') return true;
    at += 1 + (at[1] == '+' || at[1] == '-');
    if (!isdigit((unsigned char)*at)) return true;
    char *end;
    const long value = strtol(*text + 1, &end, 10);
    if (value > ENF_DECIMAL_EXPONENT || value < -ENF_DECIMAL_EXPONENT) return false;
    *exponent += value;
    *text = end;
    return true;
}

/// out *= 10^exponent
static void scale(mpq_t out, long exponent) {
    mpz_t power;
    mpz_init(power);
    mpz_ui_pow_ui(power, 10, (unsigned long)labs(exponent));
    if (exponent > 0)
        mpz_mul(mpq_numref(out), mpq_numref(out), power);
    else
        mpz_set(mpq_denref(out), power);
    mpq_canonicalize(out);
    mpz_clear(power);
}

bool enf_decimal_read(mpq_t out, const char **text, int *digits) {
    const char *at = *text;
    long exponent = 0;
    while (*at == ' ' || *at == '\t') at++;
    const bool negative = *at == '-';
    at += *at == '-' || *at == '+';
    mpq_set_ui(out, 0, 1);
    *digits = read_digits(mpq_numref(out), &at, &exponent);
    if (*digits < 0 || !read_exponent(&at, &exponent)) return false;
    scale(out, exponent);
    if (negative) mpq_neg(out, out);
    *text = at;
    return true;
}
