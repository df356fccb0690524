// SPDX-License-Identifier: GPL-3.0-or-later
// Split: convex fine cells that tile the hull, with facets between them.
//
// Why the rows prove the tiling. The outlines of a cell's facets, turned outwards, cancel along every line in
// space, so the facets are a closed surface; all corners are on the inner side of every facet's plane, so the
// surface lies on the boundary of the corners' convex hull, turned outwards everywhere, and covers it equally
// often, m > 0 times: the surface is m times the boundary of a convex body. Add up all cells: a facet between
// two cells is there once each way round and cancels; what remains are the facets on the hull of the world,
// which make up the outer faces of the tetrahedra. Closed surfaces that are equal hold every point equally
// often, and tetrahedra hold each point of the hull once ("tetrahedralize: hull"). So m is 1 and every point
// is in exactly one cell, up to the facets; volumes add up.
#include "build/check_rows.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

// ---------------------------------------------------------------------------------------------- facets

static bool check_facet(enf_checker *checker, int32_t facet) {
    const int32_t *fine = checker->view->facet_fine[facet];
    enf_check_loop loop = enf_check_facet(checker, facet);
    const char *fault = enf_check_loop_fault(&checker->exact, &loop);
    if (fault) return enf_check_break(checker, "facet %d %s", (int)facet, fault);
    return fine[0] != fine[1] || enf_check_break(checker, "facet %d has the same on both sides, fine cell %d",
                                                 (int)facet, (int)fine[0]);
}

/// What a cell lists are facets that name it; as many are listed as are named, so all are.
static void check_facets(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(
        checker, "split: facets",
        "every facet is convex, on its plane, and between two fine cells that list it, or on the hull");
    int64_t sides = 0;
    for (int32_t f = 0; f < view->facet_count; f++, checker->row->tested++) {
        if (!check_facet(checker, f)) return;
        sides += (view->facet_fine[f][0] >= 0) + (view->facet_fine[f][1] >= 0);
    }
    for (int32_t c = 0; c < view->fine_count; c++) {
        for (int32_t i = view->fine_facet[c]; i < view->fine_facet[c + 1]; i++) {
            const int32_t *at = &view->fine_facets[i], *fine = view->facet_fine[*at];
            if ((fine[0] == c || fine[1] == c) && (i == view->fine_facet[c] || at[-1] < at[0])) continue;
            enf_check_break(checker, "fine cell %d lists facet %d, which is not its own or out of order",
                            (int)c, (int)*at);
            return;
        }
    }
    if (sides != view->fine_facet_count)
        enf_check_break(checker, "facets have %lld sides, but fine cells list %d", (long long)sides,
                        (int)view->fine_facet_count);
}

// ---------------------------------------------------------------------------------------------- cells

/// A cell while it is looked at: its corners, each once.
typedef struct corner_list {
    int32_t *places;
    size_t count, capacity;
} corner_list;

static int compare_numbers(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

static bool gather_corners(enf_checker *checker, corner_list *list, int32_t cell) {
    const enf_file_view *view = checker->view;
    list->count = 0;
    for (int32_t i = view->fine_facet[cell]; i < view->fine_facet[cell + 1]; i++) {
        enf_check_loop loop = enf_check_facet(checker, view->fine_facets[i]);
        if (!enf_array_reserve(list->places, list->capacity, list->count + (size_t)loop.count))
            return enf_check_no_memory(checker);
        for (int32_t k = 0; k < loop.count; k++)
            list->places[list->count++] = checker->exact.place[loop.corners[k].vertex];
    }
    qsort(list->places, list->count, sizeof *list->places, compare_numbers);
    size_t kept = 0;
    for (size_t i = 0; i < list->count; i++) {
        if (i == 0 || list->places[i] != list->places[i - 1]) list->places[kept++] = list->places[i];
    }
    list->count = kept;
    return true;
}

/// All corners on the cell's side of the facet's plane, and one of them off it.
static bool facet_bounds_cell(enf_checker *checker, const corner_list *list, int32_t cell, int32_t facet) {
    int inner = enf_check_facet_side(checker, facet, cell) ? 1 : -1;
    bool volume = false;
    for (size_t i = 0; i < list->count; i++) {
        int side = enf_check_side(&checker->exact, list->places[i], checker->view->facet_plane[facet]);
        if (side == -inner)
            return enf_check_break(checker, "fine cell %d is not convex: vertex %d lies outside its facet %d",
                                   (int)cell, (int)list->places[i], (int)facet);
        volume = volume || side == inner;
    }
    return volume || enf_check_break(checker, "fine cell %d has no volume", (int)cell);
}

/// Has an earlier facet of the cell the same plane, and the cell on the same side of it?
static bool is_repeated(const enf_checker *checker, int32_t cell, int32_t index) {
    const enf_file_view *view = checker->view;
    const enf_check_exact *exact = &checker->exact;
    int32_t facet = view->fine_facets[index], plane = view->facet_plane[facet];
    for (int32_t i = view->fine_facet[cell]; i < index; i++) {
        int32_t other = view->fine_facets[i], its = view->facet_plane[other];
        if (exact->plane_class[plane] != exact->plane_class[its]) continue;
        bool same_way = exact->plane_sign[plane] == exact->plane_sign[its];
        bool same_side =
            enf_check_facet_side(checker, facet, cell) == enf_check_facet_side(checker, other, cell);
        if (same_way == same_side) return true;
    }
    return false;
}

static bool check_cell(enf_checker *checker, corner_list *list, int32_t cell) {
    const enf_file_view *view = checker->view;
    int32_t first = view->fine_facet[cell], end = view->fine_facet[cell + 1];
    if (end - first < 4)
        return enf_check_break(checker, "fine cell %d has fewer than four facets", (int)cell);
    if (!gather_corners(checker, list, cell)) return false;
    enf_check_chain_empty(&checker->chain);
    for (int32_t i = first; i < end; i++) {
        int32_t facet = view->fine_facets[i];
        enf_check_loop loop = enf_check_facet(checker, facet);
        if (!is_repeated(checker, cell, i) && !facet_bounds_cell(checker, list, cell, facet)) return false;
        enf_check_chain_add_loop(&checker->chain, &checker->exact, &loop,
                                 enf_check_facet_side(checker, facet, cell) ? -1 : 1);
    }
    enf_check_edge left = {0};
    bool closed = enf_check_chain_vanishes(&checker->chain, &checker->exact, ENF_CHECK_ANYWHERE, &left);
    if (checker->chain.failed) return enf_check_no_memory(checker);
    return closed || enf_check_break(checker, "fine cell %d is not closed at the edge of vertices %d and %d",
                                     (int)cell, (int)left.low, (int)left.high);
}

static void check_cells(enf_checker *checker) {
    enf_check_begin(checker, "split: cells", "every fine cell is closed and convex and has a volume");
    corner_list list = {0};
    for (int32_t c = 0; c < checker->view->fine_count && check_cell(checker, &list, c); c++)
        checker->row->tested++;
    free(list.places);
}

// ---------------------------------------------------------------------------------------------- the hull

/// A facet on the hull, or an outer face of a tetrahedron.
typedef struct outer {
    int32_t plane_class;
    int32_t facet;      ///< -1: a face
    int32_t corners[3]; ///< of a face, counter-clockwise seen from outside
} outer;

static int compare_outers(const void *a, const void *b) {
    const outer *x = a, *y = b;
    return (x->plane_class > y->plane_class) - (x->plane_class < y->plane_class);
}

static size_t list_outers(enf_checker *checker, outer *list) {
    static const int outside[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    const enf_file_view *view = checker->view;
    size_t count = 0;
    for (int32_t f = 0; f < view->facet_count; f++) {
        if (view->facet_fine[f][0] >= 0 && view->facet_fine[f][1] >= 0) continue;
        if (list) list[count] = (outer){checker->exact.plane_class[view->facet_plane[f]], f, {0}};
        count++;
    }
    for (int32_t t = 0; t < view->tetrahedron_count; t++) {
        for (int k = 0; k < 4; k++) {
            if (view->tetrahedron_next[t][k] >= 0) continue;
            outer made = {.facet = -1};
            int8_t sign = 1;
            for (int i = 0; i < 3; i++) made.corners[i] = view->tetrahedra[t][outside[k][i]];
            if (list) made.plane_class = enf_check_class_through(&checker->exact, made.corners, &sign);
            if (sign == 0) enf_check_no_memory(checker);
            if (list) list[count] = made;
            count++;
        }
    }
    return count;
}

/// The outlines of the facets and those of the faces in one plane are the same.
static bool plane_is_matched(enf_checker *checker, const outer *list, size_t count) {
    enf_check_exact *exact = &checker->exact;
    enf_check_chain_empty(&checker->chain);
    for (size_t i = 0; i < count; i++) {
        if (list[i].facet >= 0) {
            enf_check_loop loop = enf_check_facet(checker, list[i].facet);
            bool turned = checker->view->facet_fine[list[i].facet][0] < 0;
            enf_check_chain_add_loop(&checker->chain, exact, &loop, turned ? -1 : 1);
        }
        for (int k = 0; k < 3 && list[i].facet < 0; k++)
            enf_check_chain_add(&checker->chain, exact, list[i].corners[k], list[i].corners[(k + 1) % 3], -1);
    }
    bool same = enf_check_chain_vanishes(&checker->chain, exact, ENF_CHECK_ANYWHERE, NULL) &&
                list[0].plane_class >= 0; // faces that no plane of the world holds have no facets
    if (checker->chain.failed) return enf_check_no_memory(checker);
    if (list[0].facet >= 0)
        return same ||
               enf_check_break(checker, "facets on the hull in the plane of facet %d do not tile its faces",
                               (int)list[0].facet);
    return same || enf_check_break(checker, "no facets on the hull tile its face of points %d, %d and %d",
                                   (int)list[0].corners[0], (int)list[0].corners[1], (int)list[0].corners[2]);
}

static void check_hull(enf_checker *checker) {
    enf_check_begin(checker, "split: hull",
                    "facets on the hull tile the tetrahedra's outer faces; so the fine cells tile the hull, "
                    "and their volumes add up");
    size_t count = list_outers(checker, NULL);
    outer *list = enf_array_new(count, sizeof *list);
    if (!list) {
        enf_check_no_memory(checker);
        return;
    }
    list_outers(checker, list);
    qsort(list, count, sizeof *list, compare_outers);
    for (size_t i = 0, end; i < count && enf_check_holds(checker); i = end) {
        for (end = i + 1; end < count && list[end].plane_class == list[i].plane_class; end++) {
        }
        plane_is_matched(checker, list + i, end - i);
        checker->row->tested += end - i;
    }
    free(list);
}

void enf_check_split(enf_checker *checker) {
    check_facets(checker);
    if (!enf_check_holds(checker)) return;
    check_cells(checker);
    if (!enf_check_holds(checker)) return;
    check_hull(checker);
}
