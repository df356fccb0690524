// SPDX-License-Identifier: MIT
// Predicates on points with whole-number coordinates, |x| <= 2^53, held in doubles. Always right: a
// floating-point filter first, exact integers where it cannot tell.
#ifndef ENF_BASE_EXACT_H
#define ENF_BASE_EXACT_H

#include <stdbool.h>

enum { ENF_UNSURE = 2 };

/// The two tiers of the predicate below: what doubles can tell, or ENF_UNSURE; and whole numbers.
int enf_points_orient_quickly(const double a[3], const double b[3], const double c[3], const double d[3]);
int enf_points_orient_exactly(const double a[3], const double b[3], const double c[3], const double d[3]);

/// Both.
int enf_points_orient_closely(const double a[3], const double b[3], const double c[3], const double d[3]);

/// Whatever the points, a determinant in doubles is not off by more: its magnitude is at most 6 * 2^162.
#define ENF_ORIENT_SURE 0x1p115

/// Sign of det(b - a, c - a, d - a): +1 if d is in front of the plane through a, b, c (they turn
/// counter-clockwise seen from d), -1 behind it, 0 if the four lie in one plane. Most are far from it.
static inline int enf_points_orient(const double a[3], const double b[3], const double c[3],
                                    const double d[3]) {
    double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
    double wx = d[0] - a[0], wy = d[1] - a[1], wz = d[2] - a[2];
    double determinant = wx * (uy * vz - uz * vy) + wy * (uz * vx - ux * vz) + wz * (ux * vy - uy * vx);
    bool above = determinant > ENF_ORIENT_SURE, below = determinant < -ENF_ORIENT_SURE;
    if (above | below) return above - below; // one branch, which processors guess
    return enf_points_orient_closely(a, b, c, d);
}

/// Do the three points lie on a line?
bool enf_points_collinear(const double a[3], const double b[3], const double c[3]);

/// Is the point inside the sphere through a, b, c, d (+1), outside (-1) or on it (0)? They must be positively
/// oriented (enf_points_orient > 0); the sign is the opposite if they are negatively oriented.
int enf_points_side_of_sphere(const double a[3], const double b[3], const double c[3], const double d[3],
                              const double point[3]);

/// The largest power of two that divides all three coordinates of all `count` points; 2^53 if they are all 0.
/// Sums and products of multiples of a unit are exact in a double while they stay below 2^53 units.
double enf_points_unit(const double *const *points, int count);

#endif
