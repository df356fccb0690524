// SPDX-License-Identifier: GPL-3.0-or-later
// Join: where two fine cells make one convex cell, one is enough.
#ifndef ENF_BUILD_JOIN_H
#define ENF_BUILD_JOIN_H

#include "build/subdivision.h"

typedef struct enf_joiner {
    const enf_tet_mesh *tets;
    uint8_t *reflex; ///< per facet of the tetrahedra: edges at which nothing can be joined; borrowed
    int32_t *into;   ///< per cell: the cell that it went into, or itself
    size_t known, capacity;
    int32_t count; ///< cells that went into another
} enf_joiner;

/// Begins with the tetrahedra of a part, every cell by itself; a joiner that has been used (or is all zero)
/// is used again. `reflex` has a zero for each facet of the tetrahedra, and may be shared by parts: each
/// fills in its own. False without memory; free it in any case.
bool enf_joiner_start(enf_joiner *joiner, const enf_subdivision *subdivision, const enf_tet_mesh *tets,
                      uint8_t *reflex);
void enf_joiner_free(enf_joiner *joiner);

/// Makes room for cells below this number. False without memory.
bool enf_joiner_reserve(enf_joiner *joiner, size_t cell_count);

/// Joins the cells of a facet if nothing covers the facets between them (cover < 0) and their union is
/// convex, exactly. The one behind stays; the facets between them and the other cell (cell_facet = -1) are
/// gone.
bool enf_joiner_try(enf_joiner *joiner, enf_subdivision *subdivision, int32_t facet);

/// The cell that has taken this one, or itself.
int32_t enf_joiner_find(enf_joiner *joiner, int32_t cell);

#endif
