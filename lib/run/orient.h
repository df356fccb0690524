// SPDX-License-Identifier: MIT
// On which side of a plane a point lies, always right. The builder's base/exact.h answers the same with
// 128-bit integers; this one needs nothing wider than 64 bits, so that the runtime compiles anywhere.
#ifndef ENF_RUN_ORIENT_H
#define ENF_RUN_ORIENT_H

/// Sign of det(b - a, c - a, d - a): +1 if d is in front of the plane through a, b, c (they turn
/// counter-clockwise seen from d), -1 behind it, 0 on it. Coordinates are whole numbers, at most 2^53 in
/// magnitude.
int enf_orient(const double a[3], const double b[3], const double c[3], const double d[3]);

#endif
