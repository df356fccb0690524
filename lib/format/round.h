// SPDX-License-Identifier: MIT
// Rounding to whole numbers in two additions, where nearbyint may be a call into the library.
#ifndef ENF_FORMAT_ROUND_H
#define ENF_FORMAT_ROUND_H

#include <float.h>
#include <math.h>

/// nearbyint, for rounding to nearest (ties to even): from 2^52 on all doubles are whole numbers.
static inline double enf_round(double value) {
#if FLT_EVAL_METHOD == 0
    const double whole = copysign(0x1p52, value);
    return fabs(value) < 0x1p52 ? (value + whole) - whole : value;
#else // sums keep more digits than a double has
    return nearbyint(value);
#endif
}

#endif
