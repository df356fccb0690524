// SPDX-License-Identifier: GPL-3.0-or-later
// Join: where two fine cells make one convex cell, one is enough.
#ifndef ENF_BUILD_JOIN_H
#define ENF_BUILD_JOIN_H

#include "build/subdivision.h"

/// For each facet of the tetrahedra between two of those that `may` be joined: a bit for each of its three
/// edges at which the two together are not convex. Joining more to them does not mend that: no part of the
/// facet at that edge need be tried. Null without memory (free() it).
uint8_t *enf_tetrahedra_reflex(const enf_tet_mesh *tets, const double *points, const uint8_t *may);

/// Joins cells across open facets as long as the union is convex, exactly: where `covered` (a byte per facet)
/// is 0 and `may` (a byte per cell) is set for both cells. Facets between joined cells are gone afterwards
/// (first = -1), and so are cells that went into another (cell_facet = -1): into[c] becomes the cell that
/// took cell c, or c itself. Returns how many went.
int32_t enf_subdivision_join(enf_subdivision *subdivision, const uint8_t *covered, const uint8_t *may,
                             const uint8_t *reflex, int32_t *into);

#endif
