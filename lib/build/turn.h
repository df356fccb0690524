// SPDX-License-Identifier: GPL-3.0-or-later
// The dominant orthogonal frame of a world: the rotation that makes most of its area axis-parallel. A level
// that a tool has turned by an odd angle is turned back by it before anything exact is done.
#ifndef ENF_BUILD_TURN_H
#define ENF_BUILD_TURN_H

#include "build/frame.h"

typedef struct enf_turn {
    enf_turn_outcome outcome;
    double rows[3][3];     ///< a rotation (found, or the identity): turned[a] = rows[a] . world
    double aligned;        ///< share of the area that lies square to an axis, within the tolerance
    double aligned_before; ///< the same without the turn; both 0 where nobody looked
    bool is_framed;        ///< the frame has been chosen
    enf_frame frame;       ///< of the points as they were given
} enf_turn;

/// `points`, `rings`: as for enf_frame_choose; if a turn is found, the points are turned by it. `reach`: how
/// far (world units) a coordinate may be off. The result does not depend on the order of points and polygons;
/// a world that is turned by right angles, mirrored or scaled by a power of two gets the same turned points,
/// up to right angles and mirrors.
enf_status enf_turn_find(enf_turn *turn, double *points, size_t count, const enf_frame_rings *rings,
                         double reach, enf_error *error);

/// At least half of the coordinates are whole multiples of `step`, a power of two.
bool enf_points_are_round(const double *points, size_t count, double step);

/// The smallest power of two that is at least x (x > 0).
double enf_power_of_two_above(double x);

#endif
