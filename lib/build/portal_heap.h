// SPDX-License-Identifier: GPL-3.0-or-later
// The portals between the cells while they merge, and which of them is the lightest.
//
// All open pieces between two cells are one portal with one weight: the largest silhouette of the two cells,
// seen along the portal's normal, over the area of all its pieces (the thesis, 4.1.4 and 4.2.3). A silhouette
// only grows when its cell does, so a weight of before is a lower bound: it stays in the heap as it is, and
// is computed anew only when it comes to the top. That gives the same order of collapses as weighing every
// touched portal after every collapse.
#ifndef ENF_BUILD_PORTAL_HEAP_H
#define ENF_BUILD_PORTAL_HEAP_H

#include "build/block_heap.h"
#include "build/decimate.h"
#include "build/pair_table.h"
#include "build/surface.h"

/// A portal whose area vectors add up to less than this part of its area is closed like a bubble: it has no
/// plane, and its largest piece lends one.
#define ENF_CLOSED_PORTAL_RATIO 0x1p-10

/// Weights are rounded to so many binary digits, so that weights that differ by rounding only are a tie.
#define ENF_WEIGHT_BITS 32

typedef struct enf_portal {
    int32_t cell[2];              ///< the two cells
    int32_t next[2], previous[2]; ///< in the list of portals of each cell
    int32_t first_piece, last_piece, largest_piece;
    uint32_t weighed_at; ///< the ages of the cells, added up, when the weight was computed; 0: it is a
                         ///< lower bound
    uint32_t
        silhouette_at[2]; ///< the age of the cell when its silhouette was computed; 0: it is a lower bound
} enf_portal;

/// What its weight is made of.
typedef struct enf_portal_shape {
    double silhouette[2]; ///< of each cell, seen along the normal
    double area;          ///< of all pieces
    double sum[3];        ///< of the area vectors, from cell 0 to cell 1
} enf_portal_shape;

/// What the portals of a cell have in common.
typedef struct enf_portal_cell {
    int32_t first_portal; ///< the list of its portals, or -1
    int32_t degree;       ///< the length of that list
    int32_t smallest;     ///< the smallest fine cell in it
    uint32_t age;         ///< counts the times when its silhouettes may have grown; from 1
} enf_portal_cell;

typedef struct enf_portal_heap {
    enf_surface surface;
    enf_heuristic heuristic;
    int32_t portal_count;
    enf_portal *portals;
    enf_portal_shape *shapes; ///< apart: two arrays find room more easily than one, and are not always both
                              ///< looked at
    int32_t *piece_next;      ///< for each piece the next one of the same portal, or -1
    enf_pair_table table;     ///< two cells -> their portal
    enf_block_heap heap;      ///< which is the lightest
    enf_portal_cell *cells;
    size_t evaluations; ///< weights computed
} enf_portal_heap;

/// Takes the graph: it is empty afterwards, whatever the outcome. Portals are numbered as their cells
/// are, along a curve through space. They are in one block, but with `in_blocks` in several if they are
/// many: a block and its cells stay near the processor while it is worked on.
enf_status enf_portal_heap_create(enf_portal_heap *portals, enf_graph *graph, enf_heuristic heuristic,
                                  bool in_blocks, enf_error *error);
void enf_portal_heap_free(enf_portal_heap *portals);

/// The lightest portal of a block and its true weight, in graph units; *portal is -1 when none is left.
enf_status enf_portal_heap_top(enf_portal_heap *portals, int32_t block, int32_t *portal, double *weight,
                               enf_error *error);

/// Makes one cell of the two cells of a portal; tells the smallest fine cells that they had. Returns false
/// when there is no memory.
bool enf_portal_heap_collapse(enf_portal_heap *portals, int32_t portal, int32_t *kept, int32_t *gone);

#endif
