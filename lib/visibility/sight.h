// SPDX-License-Identifier: GPL-3.0-or-later
// Walks along lines through the cells: every two portals passed on the way see each other.
#ifndef ENF_VISIBILITY_SIGHT_H
#define ENF_VISIBILITY_SIGHT_H

#include "visibility/line.h"
#include "visibility/shapes.h"

typedef struct enf_sight {
    const enf_shapes *shapes; ///< not owned
    int32_t *first;           ///< opening_count + 1 offsets into edges
    double (*edges)[6];       ///< Pluecker coordinates, (a x b, b - a) / |b - a| for an edge from a to b
    bool *cell_is_convex;     ///< per cell
    double clearance;         ///< what a product must have for its sign to be sure
    bool trusts_order; ///< set it if no cell bends by more than rounding does: lines come to the portals
                       ///< of such in order, though flat ones have no room to show it
} enf_sight;

/// False without memory; free it in any case.
bool enf_sight_make(enf_sight *sight, const enf_shapes *shapes);
void enf_sight_free(enf_sight *sight);

/// Follows the line from a directed portal on, through convex cells. Returns how many portals it passes after
/// this one, at most `most`, and which; -1 if it does not pass this one. All are passed for sure (with a
/// clearance of 2^-40 of the largest coordinate) and in order (line_order.h, or see above); where that is not
/// so, the walk ends.
int32_t enf_sight_walk(const enf_sight *sight, const enf_line *line, int32_t portal, int32_t *passed,
                       int32_t most);

#endif
