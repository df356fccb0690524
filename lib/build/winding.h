// SPDX-License-Identifier: GPL-3.0-or-later
// Winding numbers of regions, by votes of the polygons between them.
#ifndef ENF_BUILD_WINDING_H
#define ENF_BUILD_WINDING_H

#include "build/complex.h"

/// "Winding of `low` minus winding of `high` is `difference`", with the area that says so; low < high.
typedef struct enf_vote {
    int32_t low, high, difference;
    double area;
} enf_vote;

/// Votes for the same claim are one vote with their areas added up. Zero it before use.
typedef struct enf_votes {
    enf_vote *votes;
    size_t count, capacity;
    int32_t *slots; ///< hash table over the claims; -1 = free
    size_t slot_count;
} enf_votes;

void enf_votes_free(enf_votes *votes);

/// Going from the region in front of a piece to the one behind it enters `entered` solids. False without
/// memory.
bool enf_votes_add(enf_votes *votes, int32_t behind, int32_t in_front, int32_t entered, double area);

/// Solids entered when going from the facet's front to its back through the middle of an occluded piece;
/// `area` is the piece's area vector.
int32_t enf_complex_solids_behind(const enf_complex *complex, const enf_mesh *mesh, int32_t facet,
                                  int32_t piece, const double area[3]);

/// The winding number of every region, and whether votes about it contradict each other. The outside is
/// region number region_count. Sorts the votes. False without memory.
bool enf_votes_settle(enf_votes *votes, int32_t region_count, int32_t *winding, bool *ambiguous);

#endif
