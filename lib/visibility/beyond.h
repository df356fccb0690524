// SPDX-License-Identifier: GPL-3.0-or-later
// Does an opening reach beyond the plane of another? Exactly.
#ifndef ENF_VISIBILITY_BEYOND_H
#define ENF_VISIBILITY_BEYOND_H

#include "visibility/portal_graph.h"

/// Corners as whole numbers of a unit, if they fit.
typedef struct enf_whole_corners {
    const enf_portal_graph *graph; ///< not owned
    int64_t (*corners)[3];         ///< graph->corners; null: they take more than 61 bits
} enf_whole_corners;

/// False without memory; free it in any case.
bool enf_whole_corners_make(enf_whole_corners *whole, const enf_portal_graph *graph);
void enf_whole_corners_free(enf_whole_corners *whole);

/// Is a corner of `other` in front of (side 1; the right-hand side of the winding) or behind (side -1) a
/// plane through three corners of the opening, one of them the first? There is one such plane if the opening
/// is planar; if it is only nearly so, a yes counts from any of them.
bool enf_opening_is_beyond(const enf_whole_corners *whole, int32_t opening, int32_t other, int side);

#endif
