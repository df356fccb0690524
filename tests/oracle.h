// SPDX-License-Identifier: GPL-3.0-or-later
// The oracle: decides with CGAL's exact numbers and kernels what the library decides with arithmetic of its
// own. It shares no code with the library. Coordinates are whole numbers held in doubles, at most 2^53 in
// magnitude.
#ifndef ENF_TESTS_ORACLE_H
#define ENF_TESTS_ORACLE_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/// A plane through three points, or (axis 0, 1, 2) through p and q and parallel to that axis.
typedef struct oracle_plane {
    double p[3], q[3], r[3];
    int axis; ///< -1: r counts
} oracle_plane;

/// A point, or where three planes cross.
typedef struct oracle_corner {
    bool is_point;
    double point[3];
    oracle_plane planes[3];
} oracle_corner;

/// Sign of the determinant (b - a, c - a, d - a).
int oracle_orient(const double a[3], const double b[3], const double c[3], const double d[3]);

/// +1 if the point is inside the sphere through a, b, c, d (positively oriented), -1 outside, 0 on it.
int oracle_side_of_sphere(const double a[3], const double b[3], const double c[3], const double d[3],
                          const double point[3]);

/// Do the three points of the plane span one?
bool oracle_spans(const oracle_plane *plane);

/// Do three planes cross in one point?
bool oracle_crosses(const oracle_plane planes[3]);

/// On which side of each of `count` planes is the corner: by integer determinants.
void oracle_sides(const oracle_corner *corner, const oracle_plane *planes, int count, int *sides);

/// The same for one plane, by CGAL's kernel objects over rationals.
int oracle_side_by_kernel(const oracle_corner *corner, const oracle_plane *plane);

/// The axis along which the plane's normal is longest (the first of equals), with the sign of the normal
/// there.
int oracle_dominant_axis(const oracle_plane *plane, int *sign);

/// Do the normals of two parallel planes point the same way?
bool oracle_same_way(const oracle_plane *a, const oracle_plane *b);

/// True if the corner is within +- reach in all coordinates; then *error is its largest distance, along an
/// axis and rounded up, from `position`.
bool oracle_position_error(const oracle_corner *corner, const double position[3], double reach,
                           double *error);

/// Sign of area(a) - area(b) - area(c), the polygons projected along `axis`; area(c) counts as 0 without
/// corners. *sign_of_a gets the sign of area(a).
int oracle_compare_areas(int axis, const oracle_corner *a, int a_count, const oracle_corner *b, int b_count,
                         const oracle_corner *c, int c_count, int *sign_of_a);

#ifdef __cplusplus
}
#endif
#endif
