// SPDX-License-Identifier: GPL-3.0-or-later
// Split, the other half: the area of every clean polygon lies on facets between fine cells, as
// covers.
#include "build/check_rows.h"

#include "base/array.h"

#include <stdlib.h>

/// A facet is convex: it holds a cover that has all its corners in it.
static bool cover_on_facet(enf_checker *checker, const enf_check_loop *cover, int32_t facet) {
    enf_check_loop whole = enf_check_facet(checker, facet);
    for (int32_t i = 0; i < cover->count; i++) {
        if (!enf_check_loop_holds(&checker->exact, &whole, cover->corners[i].vertex)) return false;
    }
    return true;
}

static bool check_cover(enf_checker *checker, int32_t cover, int32_t facet) {
    const enf_file_view *view = checker->view;
    enf_check_exact *exact = &checker->exact;
    enf_check_loop loop = enf_check_cover(checker, cover, facet);
    bool whole = view->cover_offset[cover] == view->cover_offset[cover + 1];
    const char *fault = whole ? NULL : enf_check_loop_fault(exact, &loop);
    if (fault) return enf_check_break(checker, "cover %d of facet %d %s", (int)cover, (int)facet, fault);
    int32_t polygon = view->cover_polygon[cover];
    const int32_t *span = view->mesh_polygon_plane[polygon];
    for (int i = 0; i < 3; i++) {
        if (enf_check_side(exact, span[i], loop.plane) != 0)
            return enf_check_break(checker, "cover %d of facet %d is not in the plane of its polygon %d",
                                   (int)cover, (int)facet, (int)polygon);
    }
    int sign, axis = enf_check_axis(exact, loop.plane, &sign);
    bool same_way = enf_check_normal_sign(exact, span, axis) == sign;
    if (view->cover_side[cover] != same_way)
        return enf_check_break(checker, "cover %d names the wrong side as the front of polygon %d",
                               (int)cover, (int)polygon);
    if (!whole && !cover_on_facet(checker, &loop, facet))
        return enf_check_break(checker, "cover %d reaches out of its facet %d", (int)cover, (int)facet);
    return true;
}

/// The covers of a polygon tile it: their outlines make up its outline.
static bool polygon_is_covered(enf_checker *checker, int32_t polygon, const int32_t *covers,
                               const int32_t *facet_of, int32_t count) {
    const enf_file_view *view = checker->view;
    enf_check_exact *exact = &checker->exact;
    enf_check_chain_empty(&checker->chain);
    for (int32_t i = 0; i < count; i++) {
        enf_check_loop loop = enf_check_cover(checker, covers[i], facet_of[covers[i]]);
        enf_check_chain_add_loop(&checker->chain, exact, &loop, view->cover_side[covers[i]] ? 1 : -1);
    }
    int64_t first = view->mesh_polygon_corner[polygon], end = view->mesh_polygon_corner[polygon + 1];
    for (int64_t c = first; c < end; c++) {
        int32_t next = view->mesh_corners[c + 1 < end ? c + 1 : first];
        enf_check_chain_add(&checker->chain, exact, view->mesh_corners[c], next, -1);
    }
    if (checker->chain.failed) return enf_check_no_memory(checker);
    int axis = 0;
    while (axis < 2 && enf_check_normal_sign(exact, view->mesh_polygon_plane[polygon], axis) == 0) axis++;
    return enf_check_chain_vanishes(&checker->chain, exact, axis, NULL) ||
           enf_check_break(checker, "the covers of clean polygon %d do not tile it", (int)polygon);
}

static void check_polygons(enf_checker *checker, int32_t *first, int32_t *list, const int32_t *facet_of) {
    const enf_file_view *view = checker->view;
    for (int32_t c = 0; c < view->cover_count; c++) first[view->cover_polygon[c] + 2]++;
    for (int32_t p = 0; p < view->mesh_polygon_count; p++) first[p + 2] += first[p + 1];
    for (int32_t c = 0; c < view->cover_count; c++) list[first[view->cover_polygon[c] + 1]++] = c;
    for (int32_t p = 0; p < view->mesh_polygon_count; p++, checker->row->tested++) {
        if (!polygon_is_covered(checker, p, list + first[p], facet_of, first[p + 1] - first[p])) return;
    }
}

void enf_check_covers(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "split: covers",
                    "every cover lies on its facet, in its polygon's plane, the right way round");
    int32_t *facet_of = enf_array_new((size_t)view->cover_count, sizeof *facet_of);
    int32_t *first = enf_array_zeroed((size_t)view->mesh_polygon_count + 2, sizeof *first);
    int32_t *list = enf_array_new((size_t)view->cover_count, sizeof *list);
    if (!facet_of || !first || !list) enf_check_no_memory(checker);
    for (int32_t f = 0; f < view->facet_count && enf_check_holds(checker); f++) {
        for (int32_t c = view->facet_cover[f]; c < view->facet_cover[f + 1]; c++, checker->row->tested++) {
            facet_of[c] = f;
            if (!check_cover(checker, c, f)) break;
        }
    }
    if (enf_check_holds(checker)) {
        enf_check_begin(checker, "split: polygons",
                        "the area of every clean polygon lies on facets of fine cells, exactly");
        check_polygons(checker, first, list, facet_of);
    }
    free(facet_of);
    free(first);
    free(list);
}
