// SPDX-License-Identifier: GPL-3.0-or-later
// What the checker's files share: the world with its exact numbers and a few lists, and the row being filled.
// Each stage's function adds its rows; a row ends at the first thing that is wrong.
#ifndef ENF_BUILD_CHECK_ROWS_H
#define ENF_BUILD_CHECK_ROWS_H

#include "build/check.h"
#include "build/check_chain.h"

typedef struct enf_checker {
    const enf_file_view *view;
    enf_check_report *report;
    enf_check_row *row; ///< the row being filled
    enf_check_exact exact;
    enf_check_chain chain;
    bool failed; ///< no memory

} enf_checker;

/// Starts a row. `truth` is the detail of a row that holds.
void enf_check_begin(enf_checker *checker, const char *name, const char *truth);

/// Breaks the row (once; later words are dropped). Returns false.
bool enf_check_break(enf_checker *checker, const char *format, ...) ENF_PRINTF(2, 3);

/// Notes that memory ran out. Returns false.
bool enf_check_no_memory(enf_checker *checker);

/// Is the row that was begun last whole so far?
static inline bool enf_check_holds(const enf_checker *checker) {
    return checker->row->held && !checker->failed;
}

static inline enf_check_loop enf_check_facet(const enf_checker *checker, int32_t facet) {
    const enf_file_view *view = checker->view;
    int64_t first = view->facet_offset[facet];
    return (enf_check_loop){view->facet_corners + first, (int32_t)(view->facet_offset[facet + 1] - first),
                            view->facet_plane[facet]};
}

/// The side of a facet on which a fine cell that lists it lies: 0 behind, 1 in front.
static inline int enf_check_facet_side(const enf_checker *checker, int32_t facet, int32_t fine) {
    return checker->view->facet_fine[facet][0] == fine ? 0 : 1;
}

/// A cover or piece, on a facet: the facet itself if it has no corners of its own.
static inline enf_check_loop enf_check_cover(const enf_checker *checker, int32_t cover, int32_t facet) {
    const enf_file_view *view = checker->view;
    int64_t first = view->cover_offset[cover];
    if (view->cover_offset[cover + 1] == first) return enf_check_facet(checker, facet);
    return (enf_check_loop){view->cover_corners + first, (int32_t)(view->cover_offset[cover + 1] - first),
                            view->facet_plane[facet]};
}

static inline enf_check_loop enf_check_piece(const enf_checker *checker, int32_t piece, int32_t facet) {
    const enf_file_view *view = checker->view;
    int64_t first = view->piece_offset[piece];
    if (view->piece_offset[piece + 1] == first) return enf_check_facet(checker, facet);
    return (enf_check_loop){view->piece_corners + first, (int32_t)(view->piece_offset[piece + 1] - first),
                            view->facet_plane[facet]};
}

static inline enf_check_loop enf_check_portal_loop(const enf_checker *checker, int32_t loop) {
    const enf_file_view *view = checker->view;
    int64_t first = view->portal_loop_offset[loop];
    return (enf_check_loop){view->portal_loop_corners + first,
                            (int32_t)(view->portal_loop_offset[loop + 1] - first),
                            view->portal_loop_plane[loop]};
}

/// Can one pass the piece? (Not occluded, and not a sealed crack.)
static inline bool enf_check_is_open(const enf_file_view *view, int32_t piece) {
    return view->piece_cover[piece] == -1;
}

// The stages, in order.
void enf_check_numbers(enf_checker *checker); ///< check_file.c; sets up checker->exact
void enf_check_clean(enf_checker *checker);
void enf_check_tetrahedra(enf_checker *checker);
void enf_check_split(enf_checker *checker);
void enf_check_trees(enf_checker *checker); ///< a row of split
void enf_check_covers(enf_checker *checker);
void enf_check_connect(enf_checker *checker);
void enf_check_seen(enf_checker *checker); ///< a row of connect
void enf_check_colour(enf_checker *checker);
void enf_check_decimate(enf_checker *checker);
void enf_check_drawn(enf_checker *checker); ///< a row of decimate
void enf_check_portals(enf_checker *checker);
void enf_check_file(enf_checker *checker);
void enf_check_sight(enf_checker *checker); ///< a row of file

#endif
