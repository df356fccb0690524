// SPDX-License-Identifier: GPL-3.0-or-later
// Axis-parallel planes that rounding has torn apart become planes again, and coordinates that were round
// numbers become round again.
#ifndef ENF_BUILD_FLATTEN_H
#define ENF_BUILD_FLATTEN_H

#include "build/frame.h"

typedef struct enf_flattening {
    bool moved;     ///< any point
    int64_t planes; ///< different coordinates at which a polygon lies square to an axis, over the three axes
    double noise;   ///< how much the corners of such polygons differ, with few exceptions
    double lattice[3]; ///< per axis: the step of the lattice that most coordinates lie on; 0: not looked for,
                       ///< none
} enf_flattening;

/// Moves coordinates of `points` (xyz), each by at most `reach`, in place. `rings`: the polygons; their
/// place_of gives the points' numbers. Does not depend on the order of points and polygons. `turned`: the
/// coordinates come out of a rotation, so nothing can be taken for exact.
enf_status enf_flatten(double *points, size_t count, const enf_frame_rings *rings, double reach, bool turned,
                       enf_flattening *result, enf_error *error);

#endif
