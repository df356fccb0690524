// SPDX-License-Identifier: GPL-3.0-or-later
// Which cells can be reached through portals that lie in front of a portal and have it behind them? More than
// can be seen, never less: for the checker of hidden pairs, which uses it to leave out what is pointless.
#ifndef ENF_VISIBILITY_CHECK_FACING_CELLS_H
#define ENF_VISIBILITY_CHECK_FACING_CELLS_H

#include "visibility/portal_graph.h"

typedef struct enf_facing_cells {
    int32_t portal_count;
    size_t row_words; ///< words of 64 cells
    uint64_t *rows;   ///< a row for each directed portal; the cell it leads into is in it
} enf_facing_cells;

/// False without memory; the struct is empty then.
bool enf_facing_cells_make(enf_facing_cells *facing, const enf_portal_graph *graph);
void enf_facing_cells_free(enf_facing_cells *facing);

#endif
