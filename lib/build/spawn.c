// SPDX-License-Identifier: GPL-3.0-or-later
// The walk goes through any face that has the point behind it (Devillers, Pion and Teillaud, "Walking in a
// triangulation", 2002); with exact predicates it always ends in a Delaunay triangulation. In one that has
// been flipped (flip.h) it could lead round in circles: then all tetrahedra are asked.
#include "build/spawn.h"

#include "base/array.h"
#include "base/exact.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void enf_cell_list_free(enf_cell_list *list) {
    free(list->cells);
    free(list->stack);
    memset(list, 0, sizeof *list);
}

/// +1 if the point lies on the tetrahedron's side of its facet k, 0 on the facet's plane, -1 beyond.
static int side_of_facet(const enf_complex *complex, const enf_tet_mesh *tets, int32_t t, int k,
                         const double point[3]) {
    int32_t facet = tets->facets[t][k];
    const int32_t *corner = tets->facet_corners[facet];
    int side =
        enf_points_orient(complex->points + 3 * (size_t)corner[0], complex->points + 3 * (size_t)corner[1],
                          complex->points + 3 * (size_t)corner[2], point);
    return tets->facet_sides[facet][1] == t ? side : -side;
}

static int32_t beyond(const enf_tet_mesh *tets, int32_t t, int k) {
    const int32_t *sides = tets->facet_sides[tets->facets[t][k]];
    return sides[0] == t ? sides[1] : sides[0];
}

/// The same without a walk.
static int32_t look_everywhere(const enf_complex *complex, const enf_tet_mesh *tets, const double point[3]) {
    for (int32_t t = 0; t < tets->count; t++) {
        int k = 0;
        while (k < 4 && side_of_facet(complex, tets, t, k, point) >= 0) k++;
        if (k == 4) return t;
    }
    return -1;
}

/// A tetrahedron that holds the point, or -1 outside the hull.
static int32_t walk(const enf_complex *complex, const enf_tet_mesh *tets, const double point[3],
                    int32_t start) {
    int32_t t = start;
    for (int64_t step = 0;; step++) {
        int exit = -1;
        for (int i = 0; i < 4 && exit < 0; i++) {
            int k = (int)((i + step) % 4);
            if (side_of_facet(complex, tets, t, k, point) < 0) exit = k;
        }
        if (exit < 0) return t;
        t = beyond(tets, t, exit);
        if (t < 0) return -1;
        if (step > 4 * (int64_t)tets->count) return look_everywhere(complex, tets, point);
    }
}

static bool push(enf_cell_list *list, size_t *depth, int32_t what) {
    if (!enf_array_reserve(list->stack, list->stack_capacity, *depth + 1)) return false;
    list->stack[(*depth)++] = what;
    return true;
}

/// All cells of one tetrahedron that hold the point: both children of a cut that passes through it.
static bool descend(const enf_complex *complex, int32_t t, const double point[3], enf_cell_list *list,
                    size_t base) {
    size_t depth = base;
    if (!push(list, &depth, complex->tetrahedron_root[t])) return false;
    while (depth > base) {
        int32_t at = list->stack[--depth];
        if (at < 0) {
            if (!enf_array_reserve(list->cells, list->capacity, list->count + 1)) return false;
            list->cells[list->count++] = -1 - at;
            continue;
        }
        const int32_t *plane = complex->planes[complex->node_plane[at]];
        int side =
            enf_points_orient(complex->points + 3 * (size_t)plane[0], complex->points + 3 * (size_t)plane[1],
                              complex->points + 3 * (size_t)plane[2], point);
        if (side <= 0 && !push(list, &depth, complex->node_child[at][0])) return false;
        if (side >= 0 && !push(list, &depth, complex->node_child[at][1])) return false;
    }
    return true;
}

static bool listed(const int32_t *numbers, size_t count, int32_t number) {
    for (size_t i = 0; i < count; i++) {
        if (numbers[i] == number) return true;
    }
    return false;
}

bool enf_complex_cells_at(const enf_complex *complex, const enf_tet_mesh *tets, const double point[3],
                          enf_cell_list *list) {
    double rounded[3];
    list->count = 0;
    for (int i = 0; i < 3; i++) {
        rounded[i] = rint(point[i]);
        if (!(fabs(rounded[i]) <= 0x1p53)) return true; // far outside the hull, or not a number
    }
    int32_t found = walk(complex, tets, rounded, list->start);
    if (found < 0) return true;
    list->start = found;
    // All tetrahedra around: through every facet that the point lies on. They stay on the stack's bottom.
    size_t around = 0;
    if (!push(list, &around, found)) return false;
    for (size_t i = 0; i < around; i++) {
        for (int k = 0; k < 4; k++) {
            int32_t t = list->stack[i], next = beyond(tets, t, k);
            if (next < 0 || side_of_facet(complex, tets, t, k, rounded) != 0) continue;
            if (!listed(list->stack, around, next) && !push(list, &around, next)) return false;
        }
    }
    for (size_t i = 0; i < around; i++) {
        if (!descend(complex, list->stack[i], rounded, list, around)) return false;
    }
    return true;
}
