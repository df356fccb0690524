// SPDX-License-Identifier: GPL-3.0-or-later
// Lines aimed by views: from random points of cells, what can be seen of the air is followed leaf by leaf,
// and lines go through what is left of the last window to cells that have not been seen. Of narrow sights a
// random point shows many, where a random line finds none. The views only say where to aim; that a cell is
// seen, the line has to show.
#ifndef ENF_VISIBILITY_WORLD_VIEWS_H
#define ENF_VISIBILITY_WORLD_VIEWS_H

#include "visibility/world_air.h"
#include "visibility/world_lines.h"

/// Looks around from `points` points of each cell for those that `claimed` has and no line has shown; stops
/// when there are `most` lines in all. Without leafs in the air, nothing is done. Returns how many pairs i <
/// j of `claimed` were not seen before. False in *good without memory.
int64_t enf_world_views_aim(enf_world_lines *lines, const enf_world_air *air, const enf_pvs *claimed,
                            int points, int64_t most, bool *good);

#endif
