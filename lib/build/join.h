// SPDX-License-Identifier: GPL-3.0-or-later
// Join: where two fine cells make one convex cell, one is enough.
#ifndef ENF_BUILD_JOIN_H
#define ENF_BUILD_JOIN_H

#include "build/subdivision.h"

/// Joins cells across open facets (`covered` has a byte per facet) as long as the union is convex, exactly. Only
/// parts of cut tetrahedra are joined; whole ones stay as they are. Facets between joined cells are gone
/// afterwards (first = -1), and so are cells that went into another: into[c] is the cell that took cell c, or
/// c itself. Returns how many went, -1 without memory.
int32_t enf_subdivision_join(enf_subdivision *subdivision, const uint8_t *covered, int32_t *into);

#endif
