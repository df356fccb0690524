// SPDX-License-Identifier: GPL-3.0-or-later
// The air of a compiled world, made ready for visibility in two ways, of which each may tell less than there
// is to tell, and neither too little to see: the cells with their portals, and a partition by walls.
//
// Cells are concave and hold walls, so that their portals alone tell little of what hides what. A partition
// of the air by its own walls has convex leafs; in buildings, where walls share planes, fewer of them than
// there are cells. Elsewhere the fine cells are taken for leafs. What leafs see tells what the parts of cells
// in them see.
#ifndef ENF_VISIBILITY_WORLD_AIR_H
#define ENF_VISIBILITY_WORLD_AIR_H

#include "visibility/air_order.h"
#include "visibility/air_parts.h"
#include "visibility/portal_graph.h"

typedef struct enf_world_air {
    bool uses_portals, uses_leafs; ///< at least one; what is left out costs more than it could tell, or is
                                   ///< not in the file
    bool has_partition;            ///< the leafs are those of a partition, not the fine cells
    enf_portal_graph portals;      ///< between the world's cells; empty if it is not used
    enf_portal_graph leafs;        ///< likewise
    enf_air_parts parts;           ///< of the world's cells, in the leafs
    enf_air_order order;           ///< of the leafs of a partition
} enf_world_air;

/// Needs the exact part of the file for leafs. `only_partition`: fine cells are not taken for leafs. The air
/// is the same for any number of threads. *air is overwritten; free it in any case.
enf_status enf_world_air_make(enf_world_air *air, const enf_file_view *view, bool only_partition, int threads,
                              enf_error *error);
void enf_world_air_free(enf_world_air *air);

#endif
