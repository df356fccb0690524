// SPDX-License-Identifier: GPL-3.0-or-later
// The exact tier of geometry.h: planes with whole-number coefficients, and the determinants that decide where
// they meet.
//
// Points have coordinates of up to 54 bits with sign, differences of 55; a plane's normal has 110 bits, its
// offset 165; a determinant of two coefficients 220 or 275, one of four 497 (base/limbs.h holds each).
#ifndef ENF_BUILD_EXACT_PLANE_H
#define ENF_BUILD_EXACT_PLANE_H

#include <stdint.h>

/// normal . x + offset = 0
typedef struct enf_exact_plane {
    uint64_t normal[3][2], offset[3];
} enf_exact_plane;

/// The plane through p, p + u and p + v; |p| <= 2^53, |u|, |v| <= 2^54 in each coordinate.
void enf_exact_plane_set(enf_exact_plane *plane, const double p[3], const int64_t u[3], const int64_t v[3]);

/// Sign of the determinant of the normals: 0 if the planes do not meet in one point.
int enf_exact_planes_weight_sign(const enf_exact_plane plane[3]);

/// Sign of the determinant of all coefficients: 0 if the planes meet in one point, or are parallel to one
/// line.
int enf_exact_planes_sign(const enf_exact_plane plane[4]);

/// The point in which three planes meet (they must), each coordinate within 5 units in the last place.
void enf_exact_planes_meet(const enf_exact_plane plane[3], double point[3]);

#endif
