// SPDX-License-Identifier: GPL-3.0-or-later
// Connect: the pieces of a facet tile it; open ones are free of polygons, the others lie under one.
#include "build/check_rows.h"

static bool check_piece(enf_checker *checker, int32_t piece, int32_t facet) {
    const enf_file_view *view = checker->view;
    if (view->piece_facet[piece] != facet)
        return enf_check_break(checker, "piece %d is listed by facet %d, but names facet %d", (int)piece,
                               (int)facet, (int)view->piece_facet[piece]);
    if (view->piece_offset[piece] == view->piece_offset[piece + 1]) return true; // the facet
    enf_check_loop loop = enf_check_piece(checker, piece, facet);
    const char *fault = enf_check_loop_fault(&checker->exact, &loop);
    return !fault || enf_check_break(checker, "piece %d of facet %d %s", (int)piece, (int)facet, fault);
}

static void check_pieces(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "connect: pieces", "every piece is convex and on the facet that it names");
    for (int32_t f = 0; f < view->facet_count; f++) {
        for (int32_t p = view->facet_piece[f]; p < view->facet_piece[f + 1]; p++, checker->row->tested++) {
            if (!check_piece(checker, p, f)) return;
        }
    }
}

static bool facet_is_tiled(enf_checker *checker, int32_t facet) {
    enf_check_exact *exact = &checker->exact;
    int32_t first = checker->view->facet_piece[facet], end = checker->view->facet_piece[facet + 1];
    enf_check_loop whole = enf_check_facet(checker, facet);
    if (end - first == 1) {
        enf_check_loop piece = enf_check_piece(checker, first, facet);
        if (enf_check_same_loop(exact, &whole, &piece)) return true;
    }
    enf_check_chain_empty(&checker->chain);
    enf_check_chain_add_loop(&checker->chain, exact, &whole, -1);
    for (int32_t p = first; p < end; p++) {
        enf_check_loop piece = enf_check_piece(checker, p, facet);
        enf_check_chain_add_loop(&checker->chain, exact, &piece, 1);
    }
    if (checker->chain.failed) return enf_check_no_memory(checker);
    int sign, axis = enf_check_axis(exact, whole.plane, &sign);
    return enf_check_chain_vanishes(&checker->chain, exact, axis, NULL) ||
           enf_check_break(checker, "open and occluded pieces do not add up to facet %d", (int)facet);
}

static void check_areas(enf_checker *checker) {
    enf_check_begin(checker, "connect: areas",
                    "the open and occluded pieces of every facet tile it, without gap or overlap");
    for (int32_t f = 0; f < checker->view->facet_count && facet_is_tiled(checker, f); f++)
        checker->row->tested++;
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
    check_areas(checker);
    check_occlusion(checker);
}
