// SPDX-License-Identifier: GPL-3.0-or-later
// The second tier of geometry.h, between the filter and exact numbers: planes with coefficients that are
// pairs of doubles, about a hundred bits. It tells all but the very smallest determinants from 0.
#ifndef ENF_BUILD_DOUBLED_PLANE_H
#define ENF_BUILD_DOUBLED_PLANE_H

#include <stdbool.h>

/// The number high + low, |low| no more than half a unit in the last place of high.
typedef struct enf_doubled {
    double high, low;
} enf_doubled;

/// normal . (x - origin) + offset = 0
typedef struct enf_doubled_plane {
    enf_doubled normal[3], offset;
    double size;  ///< no component of the normal is larger, nor what it is a difference of
    double reach; ///< offset <= size * reach
} enf_doubled_plane;

/// The plane through p, p + u and p + v; all whole numbers, u and v rounded to doubles. False if such a
/// difference, or that to the origin, may have been rounded.
bool enf_doubled_plane_set(enf_doubled_plane *plane, const double p[3], const double u[3], const double v[3],
                           const double origin[3]);

/// Where three planes meet: in origin - at / weight.
typedef struct enf_doubled_meeting {
    enf_doubled at[3], weight;
    double size;  ///< the product of the planes'
    double reach; ///< the sum of theirs
} enf_doubled_meeting;

/// The origin is a point of the first plane (whose offset is not looked at).
void enf_doubled_planes_meet(const enf_doubled_plane plane[3], enf_doubled_meeting *meeting);

/// Sign of the determinant of the coefficients of the planes that meet and of another, or 0 if that is not
/// certain.
int enf_doubled_meeting_sign(const enf_doubled_meeting *meeting, const enf_doubled_plane *plane);

/// Sign of the weight, or 0 if that is not certain.
int enf_doubled_meeting_weight_sign(const enf_doubled_meeting *meeting);

/// The point in which the planes meet, rounded, each coordinate off by less than one step (1) or one unit in
/// the last place, whichever is more. False if that is not certain.
bool enf_doubled_meeting_point(const enf_doubled_meeting *meeting, const double origin[3], double point[3]);

#endif
