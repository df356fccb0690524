// SPDX-License-Identifier: GPL-3.0-or-later
// The choice of the canonical frame (enf_frame in clean.h): which axis comes first, which way it points, how
// fine the grid is. All of it follows from the set of points alone, so a permuted or mirrored world gets the
// same grid.
#ifndef ENF_BUILD_FRAME_H
#define ENF_BUILD_FRAME_H

#include "build/clean.h"

/// The polygons of a soup, as far as the choice of the frame needs them.
typedef struct enf_frame_rings {
    const enf_soup *soup;
    const int32_t *polygons; ///< numbers of those that count
    size_t polygon_count;
    const int32_t
        *place_of; ///< per soup point that they use: index into the points given to enf_frame_choose
} enf_frame_rings;

/// `points`: xyz of `count` different points, |x| <= 1e100, in any order; count may be 0. The polygons are
/// only looked at where the set of points is symmetric. The frame's turn is left as it is: the points have
/// been turned by it.
void enf_frame_choose(enf_frame *frame, const double *points, size_t count, const enf_frame_rings *rings);

#endif
