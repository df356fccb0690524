// SPDX-License-Identifier: GPL-3.0-or-later
// Which fine cells hold a point: a walk through the triangulation, then down the tree of cuts.
#ifndef ENF_BUILD_SPAWN_H
#define ENF_BUILD_SPAWN_H

#include "build/complex.h"
#include "build/tetrahedra.h"

/// Fine cells whose closure holds a point: several when it lies on a face, none outside the hull.
typedef struct enf_cell_list {
    int32_t *cells;
    size_t count, capacity;
    int32_t *stack; ///< working memory
    size_t stack_capacity;
    int32_t start; ///< the tetrahedron where the next walk begins
} enf_cell_list;

void enf_cell_list_free(enf_cell_list *list);

/// Fills list->cells, in no particular order. The point (grid steps) is first rounded to the grid, then
/// everything is exact. False without memory.
bool enf_complex_cells_at(const enf_complex *complex, const enf_tet_mesh *tets, const double point[3],
                          enf_cell_list *list);

#endif
