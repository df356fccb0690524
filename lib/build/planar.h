// SPDX-License-Identifier: GPL-3.0-or-later
// Exact decisions on three grid points (whole numbers, |x| <= 2^53): a floating-point filter, then 128 bits.
// Differences have 54 bits, their products 108, so nothing can overflow.
#ifndef ENF_BUILD_PLANAR_H
#define ENF_BUILD_PLANAR_H

#include "base/limbs.h"

#include <math.h>
#include <stdbool.h>

/// Sign of (b - a) x (c - a) in the plane of the axes u and v: +1 if a, b, c turn left, 0 if they are on a
/// line.
static inline int enf_planar_turn(const double a[3], const double b[3], const double c[3], int u, int v) {
    // Each difference is off by 2^-53 relative at most, each product by three times that; 2^-50 covers it
    // all.
    double left = (b[u] - a[u]) * (c[v] - a[v]), right = (b[v] - a[v]) * (c[u] - a[u]);
    double bound = (fabs(left) + fabs(right)) * 0x1p-50, difference = left - right;
    if (difference > bound) return 1;
    if (difference < -bound) return -1;
    if (left == 0 && right == 0) return 0;
    enf_int128 exact_left = (enf_int128)((int64_t)b[u] - (int64_t)a[u]) * ((int64_t)c[v] - (int64_t)a[v]);
    enf_int128 exact_right = (enf_int128)((int64_t)b[v] - (int64_t)a[v]) * ((int64_t)c[u] - (int64_t)a[u]);
    return (exact_left > exact_right) - (exact_left < exact_right);
}

/// True if the three points lie on one line.
static inline bool enf_planar_collinear(const double a[3], const double b[3], const double c[3]) {
    return enf_planar_turn(a, b, c, 0, 1) == 0 && enf_planar_turn(a, b, c, 1, 2) == 0 &&
           enf_planar_turn(a, b, c, 2, 0) == 0;
}

#endif
