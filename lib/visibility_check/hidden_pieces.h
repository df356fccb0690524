// SPDX-License-Identifier: GPL-3.0-or-later
// What a linear program over line space cannot rule out: lines from a triangle of the first portal to one of
// the last, as pairs of points, halved until every piece is proved empty or a line is found.
#ifndef ENF_VISIBILITY_CHECK_HIDDEN_PIECES_H
#define ENF_VISIBILITY_CHECK_HIDDEN_PIECES_H

#include "visibility_check/hidden_exact.h"
#include "visibility_check/matrix_game.h"

typedef enum enf_pieces_answer {
    ENF_PIECES_OPEN = 0, ///< the limit was reached (or there was no memory): nothing is known
    ENF_PIECES_HIDDEN,   ///< proved, exactly: no line passes all edges
    ENF_PIECES_SEEN, ///< there is a line, and it is near from -> to; enf_witness_check says if this is one
} enf_pieces_answer;

typedef struct enf_hidden_pieces {
    const enf_portal_graph *graph;
    int32_t limit;               ///< pieces to look at for one pair of triangles
    const enf_piece_side *sides; ///< to be passed as well
    int32_t side_count;
    enf_matrix_game game;
    enf_hidden_exact *exact;
    double (*product)[9],
        (*column)[9]; ///< of each edge: its sides of the nine corner lines; those of a piece
    double *scale;    ///< of each edge: what brings its sides to 1 or so
    size_t product_capacity, column_capacity, scale_capacity;
    double from[3], to[3]; ///< the line of ENF_PIECES_SEEN
    bool is_rounded;       ///< it is rounded: enf_hidden_exact_line is what it should be
    uint64_t pieces;       ///< looked at so far
} enf_hidden_pieces;

/// edges: 2 c, from corner c of the graph to the next one of its winding, or 2 c + 1, back. A line that
/// passes `first` and then `last` (openings) has all of them on the inner side?
enf_pieces_answer enf_hidden_pieces_ask(enf_hidden_pieces *work, int32_t first, int32_t last,
                                        const int32_t *edges, const int32_t *corner_next, int32_t edge_count);

/// The line of ENF_PIECES_SEEN as it is.
void enf_hidden_pieces_line(const enf_hidden_pieces *work, mpq_t from[3], mpq_t to[3]);

void enf_hidden_pieces_free(enf_hidden_pieces *work);

#endif
