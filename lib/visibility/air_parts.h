// SPDX-License-Identifier: GPL-3.0-or-later
// Which cells of a world reach into which leafs of its air, and where: their parts.
#ifndef ENF_VISIBILITY_AIR_PARTS_H
#define ENF_VISIBILITY_AIR_PARTS_H

#include "visibility/air_tree.h"
#include "visibility/bodies.h"

/// What the leafs of a world's air hold.
typedef struct enf_air_parts {
    enf_bodies bodies;  ///< of cells, in the leafs that are air
    int32_t *leaf_of;   ///< per leaf of the tree its number among those, or -1: rock
    int32_t lost_count; ///< cells that reach into no leaf: thinner than the tree's tolerance everywhere
    int32_t *lost;
} enf_air_parts;

/// Cuts the fine cells of kept regions along the tree, on some threads: what comes out is the same for any
/// number. Needs the exact part of the file. *air is overwritten; free it in any case.
enf_status enf_air_parts_make(enf_air_parts *air, const enf_air_tree *tree, const enf_file_view *view,
                              int threads, enf_error *error);
void enf_air_parts_free(enf_air_parts *air);

#endif
