// SPDX-License-Identifier: GPL-3.0-or-later
// The exact side of hidden_pieces.c: what doubles suggest about a piece of line space is proved or decided
// here, with whole numbers.
#ifndef ENF_VISIBILITY_CHECK_HIDDEN_EXACT_H
#define ENF_VISIBILITY_CHECK_HIDDEN_EXACT_H

#include "visibility/portal_graph.h"

#include <gmp.h>

enum { ENF_PIECE_BITS = 20, ENF_PIECE_ONE = 1 << ENF_PIECE_BITS };

/// A triangle within one of the first portal, corner[0], and one within one of the last, corner[1]: its
/// corners' barycentric coordinates there, each adding up to ENF_PIECE_ONE.
typedef struct enf_piece {
    int32_t corner[2][3][3];
    int8_t halved[2]; ///< how often
} enf_piece;

/// What a line has to do besides passing the portals' edges, with corners of the graph. Two of them: pass the
/// way from the first to the second like an edge. Six, of two triangles whose planes it rises through: come
/// to the first one before the second.
typedef struct enf_piece_side {
    int32_t corner[6];
    int count;
    int32_t place; ///< the caller's
} enf_piece_side;

/// Two triangles, as corners of the graph, and the edges to be passed, as in hidden_proof.h; then the sides.
typedef struct enf_piece_task {
    const enf_portal_graph *graph;
    int32_t triangle[2][3];
    const int32_t *edges, *corner_next;
    const enf_piece_side *sides;
    int32_t edge_count, side_count;
} enf_piece_task;

static inline int32_t enf_piece_forms(const enf_piece_task *task) {
    return task->edge_count + task->side_count;
}

typedef struct enf_hidden_exact enf_hidden_exact;

/// Null without memory.
enf_hidden_exact *enf_hidden_exact_make(const enf_portal_graph *graph);
void enf_hidden_exact_free(enf_hidden_exact *exact);

/// Everything is about this task from now on, which must stay. False without memory.
bool enf_hidden_exact_begin(enf_hidden_exact *exact, const enf_piece_task *task);

/// The values of a side's form for the nine pairs of corners, as [3 p + q], brought to 1 or so.
void enf_hidden_exact_values(enf_hidden_exact *exact, int32_t side, double values[9]);

/// Do these weights prove that no line of the piece passes all edges and sides? An edge's weight is that of
/// its form in world units, times `scales`; a side's that of enf_hidden_exact_values.
bool enf_hidden_exact_proves(enf_hidden_exact *exact, const enf_piece *piece, const double *weights,
                             const double *scales);

/// Decides whether there are such weights: 1 if so. If not, a line of the piece is tried: -1, it passes all
/// edges; share[0] and [1] are, rounded, its points' barycentric coordinates in the two triangles. 0: it does
/// not.
int enf_hidden_exact_decide(enf_hidden_exact *exact, const enf_piece *piece, double share[2][3]);

/// The line of the last such -1 as it is.
void enf_hidden_exact_line(const enf_hidden_exact *exact, mpq_t from[3], mpq_t to[3]);

#endif
