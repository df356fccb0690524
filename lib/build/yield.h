// SPDX-License-Identifier: GPL-3.0-or-later
// Yield: what a part of the world comes to when it has been cut, and all of it put together.
#ifndef ENF_BUILD_YIELD_H
#define ENF_BUILD_YIELD_H

#include "build/arrangement.h"
#include "build/complex.h"
#include "build/parts.h"

/// What a part adds to the fine complex, as it grows. It has numbers of its own: cells as in its subdivision
/// (see enf_share), nodes and facets from 0, vertices that are no points from the number of points.
typedef struct enf_yield {
    enf_complex complex; ///< facets, covers, pieces; at the end also vertices that are no points, and trees
    size_t plane_capacity, cell_capacity, facet_cover_capacity, facet_piece_capacity;
    size_t cover_polygon_capacity, cover_side_capacity, piece_facet_capacity, piece_cover_capacity;

    int32_t
        still_count;    ///< facets from here on are the part's; those before have the world's numbers already
    int32_t cell_count; ///< of the subdivision, those that went into others included
    int32_t *cell_into; ///< per cell: the one that it went into, or itself
} enf_yield;

/// Makes room for so many facets, corners of facets, covers and pieces in all. False without memory.
bool enf_yield_reserve(enf_yield *yield, size_t facets, size_t corners, size_t covers, size_t pieces);

/// When the part has been cut: takes the trees of cuts, and the crossings that are corners of something,
/// rounded to coordinates. `into` (taken over) is the joiner's. False without memory.
bool enf_yield_finish(enf_yield *yield, enf_subdivision *subdivision, int32_t *into);

/// Puts all yields together in `complex`, which then has all but what connect adds, and sets
/// arrangement->cell_into. Cells that were tetrahedra have their numbers; new ones follow, part by part. The
/// yields are empty afterwards. False without memory.
bool enf_yields_gather(enf_yield *yields, const enf_parts *parts, const enf_crew *crew,
                       enf_arrangement *arrangement, enf_complex *complex);
void enf_yield_free(enf_yield *yield);

#endif
