// SPDX-License-Identifier: GPL-3.0-or-later
// Join: where two fine cells make one convex cell, one is enough.
#ifndef ENF_BUILD_JOIN_H
#define ENF_BUILD_JOIN_H

#include "build/subdivision.h"

/// Joins cells across open facets as long as the union is convex, exactly: where `covered` (a byte per facet) is 0
/// and `may` (a byte per cell) is set for both cells. Facets between joined cells are gone afterwards
/// (first = -1), and so are cells that went into another (cell_facet = -1): into[c] becomes the cell that took
/// cell c, or c itself. Returns how many went.
int32_t enf_subdivision_join(enf_subdivision *subdivision, const uint8_t *covered, const uint8_t *may,
                             int32_t *into);

#endif
