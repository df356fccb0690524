// SPDX-License-Identifier: MIT
// Point location on a checked view; the builder asks it too, before the file is written.
#ifndef ENF_FORMAT_LOCATE_H
#define ENF_FORMAT_LOCATE_H

#include "enfilade/format.h"

/// enf_world_locate without a world around it. Uses the core arrays of the view only.
enf_place enf_view_locate(const enf_file_view *view, const double point[3], int32_t hint);

/// The same for a point in grid coordinates.
enf_place enf_view_locate_grid(const enf_file_view *view, const double grid[3], int32_t hint);

/// Where a walk towards a point of the grid ends that begins at a tetrahedron: at the one that holds the
/// point, or at one of the hull. `from` itself if it is none.
int32_t enf_view_locate_near(const enf_file_view *view, const double grid[3], int32_t from);

#endif
