// SPDX-License-Identifier: GPL-3.0-or-later
// Connect: the pieces of a facet tile its faces on both sides; open ones are free of polygons, the others lie
// under one.
#include "build/check_rows.h"

#include "base/array.h"

#include <stdlib.h>

static bool piece_faces_fit(enf_checker *checker, int32_t piece, int32_t facet) {
    const enf_file_view *view = checker->view;
    const int32_t *face = view->piece_face[piece];
    for (int side = 0; side < 2; side++) {
        if (face[side] < 0) continue;
        if (view->face_facet[face[side]] != facet || view->face_side[face[side]] != side)
            return enf_check_break(checker,
                                   "piece %d of facet %d names face %d, which is not on that side of it",
                                   (int)piece, (int)facet, (int)face[side]);
    }
    bool one_sided = face[0] < 0 || face[1] < 0;
    if ((face[0] < 0 && face[1] < 0) || one_sided != (view->facet_hull[facet] != 0))
        return enf_check_break(checker, "piece %d of facet %d lacks a face, or has one outside the hull",
                               (int)piece, (int)facet);
    return true;
}

static bool check_piece(enf_checker *checker, int32_t piece, int32_t facet) {
    enf_check_loop loop = enf_check_piece(checker, piece, facet);
    const char *fault = enf_check_loop_fault(&checker->exact, &loop);
    if (fault) return enf_check_break(checker, "piece %d of facet %d %s", (int)piece, (int)facet, fault);
    return piece_faces_fit(checker, piece, facet);
}

static void check_pieces(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "connect: pieces",
                    "every piece is convex, on its facet, between a face behind and a face in front of it, "
                    "or on the hull");
    for (int32_t f = 0; f < view->facet_count; f++) {
        for (int32_t p = view->facet_piece[f]; p < view->facet_piece[f + 1]; p++, checker->row->tested++) {
            if (!check_piece(checker, p, f)) return;
        }
    }
}

/// The pieces that name a face tile it.
static bool face_is_tiled(enf_checker *checker, int32_t face, const int32_t *pieces, int32_t count) {
    enf_check_exact *exact = &checker->exact;
    int32_t facet = checker->view->face_facet[face];
    enf_check_loop whole = enf_check_face(checker, face);
    if (count == 1) {
        enf_check_loop piece = enf_check_piece(checker, pieces[0], facet);
        if (enf_check_same_loop(exact, &whole, &piece)) return true;
    }
    enf_check_chain_empty(&checker->chain);
    enf_check_chain_add_loop(&checker->chain, exact, &whole, -1);
    for (int32_t i = 0; i < count; i++) {
        enf_check_loop piece = enf_check_piece(checker, pieces[i], facet);
        enf_check_chain_add_loop(&checker->chain, exact, &piece, 1);
    }
    if (checker->chain.failed) return enf_check_no_memory(checker);
    int sign, axis = enf_check_axis(exact, whole.plane, &sign);
    return enf_check_chain_vanishes(&checker->chain, exact, axis) ||
           enf_check_break(checker, "open and occluded pieces do not add up to face %d on facet %d",
                           (int)face, (int)facet);
}

static void check_faces(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "connect: areas",
                    "the open and occluded pieces of every face tile it, without gap or overlap");
    int32_t *first = enf_array_zeroed((size_t)view->face_count + 2, sizeof *first);
    int32_t *list = enf_array_new(2 * (size_t)view->piece_count, sizeof *list);
    bool good = (first && list) || enf_check_no_memory(checker);
    for (int pass = 0; good && pass < 2; pass++) {
        for (int32_t p = 0; p < view->piece_count; p++) {
            for (int side = 0; side < 2; side++) {
                int32_t face = view->piece_face[p][side];
                if (face < 0) continue;
                if (pass == 0) {
                    first[face + 2]++;
                } else {
                    list[first[face + 1]++] = p;
                }
            }
        }
        for (int32_t f = 0; pass == 0 && f < view->face_count; f++) first[f + 2] += first[f + 1];
    }
    for (int32_t f = 0; good && f < view->face_count; f++, checker->row->tested++)
        good = face_is_tiled(checker, f, list + first[f], first[f + 1] - first[f]);
    free(first);
    free(list);
}

static bool check_occlusion_of(enf_checker *checker, int32_t piece, int32_t facet) {
    const enf_file_view *view = checker->view;
    enf_check_exact *exact = &checker->exact;
    int32_t cover = view->piece_cover[piece];
    enf_check_loop loop = enf_check_piece(checker, piece, facet);
    if (cover >= 0) {
        if (cover < view->facet_cover[facet] || cover >= view->facet_cover[facet + 1])
            return enf_check_break(checker, "piece %d names cover %d, which is not on its facet %d",
                                   (int)piece, (int)cover, (int)facet);
        enf_check_loop over = enf_check_cover(checker, cover, facet);
        for (int32_t i = 0; i < loop.count; i++) {
            if (!enf_check_loop_holds(exact, &over, loop.corners[i].vertex))
                return enf_check_break(checker, "occluded piece %d reaches out of its cover %d", (int)piece,
                                       (int)cover);
        }
        return true;
    }
    for (int32_t c = view->facet_cover[facet]; c < view->facet_cover[facet + 1]; c++) {
        enf_check_loop over = enf_check_cover(checker, c, facet);
        if (!enf_check_loops_apart(exact, &loop, &over))
            return enf_check_break(checker, "open piece %d of facet %d is partly under cover %d", (int)piece,
                                   (int)facet, (int)c);
    }
    return true;
}

static void check_occlusion(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "connect: occlusion",
                    "occluded pieces lie under a polygon, open and sealed ones under none");
    for (int32_t f = 0; f < view->facet_count; f++) {
        for (int32_t p = view->facet_piece[f]; p < view->facet_piece[f + 1]; p++, checker->row->tested++) {
            if (!check_occlusion_of(checker, p, f)) return;
        }
    }
}

void enf_check_connect(enf_checker *checker) {
    check_pieces(checker);
    if (!enf_check_holds(checker)) return;
    check_faces(checker);
    check_occlusion(checker);
}
