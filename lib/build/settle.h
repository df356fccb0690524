// SPDX-License-Identifier: GPL-3.0-or-later
// Settle: what is cut on all sides will not change any more. As soon as the cells on both sides of a facet
// have been cut, polygons are laid on it and the cells may be joined; as soon as all facets around both have
// come so far, it goes into the fine complex, and its memory to the cells that are cut next. So the
// half-edges of only a part of the world are there at a time, and they are looked at while they are still at
// hand.
#ifndef ENF_BUILD_SETTLE_H
#define ENF_BUILD_SETTLE_H

#include "build/join.h"
#include "build/loop.h"
#include "build/polygon_lines.h"
#include "build/yield.h"

/// The share of a polygon on a facet that is not in the complex yet.
typedef struct enf_cover {
    int32_t polygon;
    int32_t loop; ///< in the settler's loops; -1: the whole facet
    int32_t side; ///< as complex.cover_side
    int32_t next; ///< the next cover of the facet; -1: the last
} enf_cover;

typedef struct enf_settler {
    const enf_arrangement *arrangement;
    enf_subdivision *space;
    enf_yield *yield; ///< where settled facets go
    enf_joiner joiner;
    bool join;                ///< cells may be joined
    enf_polygon_lines *lines; ///< borrowed: nobody counts on what they held before
    enf_pool pool;            ///< has the space's geometry while it clips

    enf_cover *covers;
    size_t cover_count, cover_capacity;
    int32_t free_cover; ///< list of those that can be used again; -1: none
    enf_loops loops;    ///< of covers that are a part of their facet

    int32_t *waits_for; ///< per cell that has been cut: a neighbour that had not been then, or -1
    size_t waits_capacity;

    // Scratch of one cell that was cut.
    int32_t *inner, *next_inner; ///< its facets on its own cuts; the next one on the same cut
    size_t inner_count, inner_capacity, next_inner_capacity;
    int32_t *inner_of; ///< per cut: the first of them
    size_t inner_of_capacity;
    int32_t *outer; ///< its facets towards cells that had been cut before
    size_t outer_count, outer_capacity;
    int32_t *touched; ///< cells that may be closed now
    size_t touched_count, touched_capacity;

    enf_loop *open, *rest; ///< of the facet at hand: what no cover has taken yet
    size_t open_count, open_capacity, rest_count, rest_capacity;
} enf_settler;

/// A cell that has just been cut, and what came of it.
typedef struct enf_cut_cell {
    int32_t cell, first_cell, first_node; ///< its number; new cells and nodes are from these on
    const enf_hit *hits;                  ///< polygons on the new nodes
    size_t hit_count;
} enf_cut_cell;

/// Begins with a part whose tetrahedra are in `space`; a settler that has been used (or is all zero) is used
/// again. Facets of the tetrahedra are covered by arrangement->hits; `lines` are borrowed and taken anew each
/// time; `reflex`: see enf_joiner_start. False without memory; free it in any case.
bool enf_settler_start(enf_settler *settler, const enf_arrangement *arrangement, enf_subdivision *space,
                       enf_yield *yield, enf_polygon_lines *lines, uint8_t *reflex);

/// Settles the facets between tetrahedra that stay as they are. False without memory.
bool enf_settler_settle_still(enf_settler *settler);
void enf_settler_free(enf_settler *settler);

/// False without memory.
bool enf_settler_settle(enf_settler *settler, const enf_cut_cell *cut);

#endif
