// SPDX-License-Identifier: GPL-3.0-or-later
// Flood: which polygon goes through which tetrahedron.
#ifndef ENF_BUILD_FLOOD_H
#define ENF_BUILD_FLOOD_H

#include "build/arrangement.h"

/// A polygon whose plane goes through the inside of a tetrahedron, near enough to be worth a closer look.
typedef struct enf_candidate {
    int32_t rank; ///< of the polygon, in the order of planes
    uint32_t
        lines; ///< a bit for each of the polygon's first edges that has not all of the tetrahedron inside
} enf_candidate;

typedef struct enf_candidates {
    int32_t *offset;           ///< per tetrahedron, count + 1
    enf_candidate *candidates; ///< by rank
    int32_t *order;            ///< polygons by plane: order[rank]
} enf_candidates;

/// Finds them, and adds polygons that lie on facets of the tetrahedra to the arrangement's hits. False when
/// the watch stopped it (*stopped) or without memory.
bool enf_candidates_find(enf_candidates *candidates, enf_arrangement *arrangement, const enf_crew *crew,
                         bool *stopped);
void enf_candidates_free(enf_candidates *candidates);

#endif
