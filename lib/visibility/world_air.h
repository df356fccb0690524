// SPDX-License-Identifier: GPL-3.0-or-later
// The air of a compiled world, made ready for visibility. Cells are concave and hold walls, so that their
// portals alone tell little of what hides what. A partition of the air by its own walls has convex leafs,
// fewer than a third of the fine cells, and what the leafs see tells what the parts of cells in them see.
#ifndef ENF_VISIBILITY_WORLD_AIR_H
#define ENF_VISIBILITY_WORLD_AIR_H

#include "visibility/air_parts.h"
#include "visibility/portal_graph.h"

typedef struct enf_world_air {
    bool is_partitioned;    ///< false: the cells themselves and their portals, as no tree suits this world
    enf_portal_graph graph; ///< of the leafs
    enf_air_parts parts;    ///< of the world's cells
} enf_world_air;

/// Needs the exact part of the file for a partition. *air is overwritten; free it in any case.
enf_status enf_world_air_make(enf_world_air *air, const enf_file_view *view, enf_error *error);
void enf_world_air_free(enf_world_air *air);

#endif
