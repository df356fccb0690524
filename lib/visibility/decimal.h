// SPDX-License-Identifier: GPL-3.0-or-later
// Decimal numbers as what they are, not rounded to doubles.
#ifndef ENF_VISIBILITY_DECIMAL_H
#define ENF_VISIBILITY_DECIMAL_H

#include <gmp.h>
#include <stdbool.h>

/// Numbers with more digits, or exponents of ten beyond these limits, are refused.
enum { ENF_DECIMAL_DIGITS = 20000, ENF_DECIMAL_EXPONENT = 20000 };

/// out = the number that *text begins with, after blanks: a sign or none, digits with or without a point, an
/// exponent or none. Moves *text behind it and sets *digits to how many digits it has, leading zeros not
/// counted. False if there is no such number.
bool enf_decimal_read(mpq_t out, const char **text, int *digits);

#endif
