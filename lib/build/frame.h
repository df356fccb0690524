// SPDX-License-Identifier: GPL-3.0-or-later
// The choice of the canonical frame (enf_frame in clean.h): which axis comes first, which way it points, how
// fine the grid is. All of it follows from the set of points alone, so a permuted or mirrored world gets the
// same grid.
#ifndef ENF_BUILD_FRAME_H
#define ENF_BUILD_FRAME_H

#include "build/clean.h"

/// `points`: xyz of `count` different points, |x| <= 1e150, in any order; count may be 0.
void enf_frame_choose(enf_frame *frame, const double *points, size_t count);

#endif
