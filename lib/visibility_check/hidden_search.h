// SPDX-License-Identifier: GPL-3.0-or-later
// The state of the search of check_hidden.c, and the question it asks at every portal.
#ifndef ENF_VISIBILITY_CHECK_HIDDEN_SEARCH_H
#define ENF_VISIBILITY_CHECK_HIDDEN_SEARCH_H

#include "visibility_check/check_hidden.h"
#include "visibility_check/check_witness.h"
#include "visibility_check/facing_cells.h"
#include "visibility_check/hidden_pieces.h"
#include "visibility_check/hidden_proof.h"
#include "visibility_check/line_simplex.h"

/// A portal on the way from the source.
typedef struct hidden_frame {
    int32_t portal;
    int32_t next;         ///< the portal to try next, as an index into cell_portals
    int32_t column_count; ///< edges of all portals up to this one
    enf_line_basis basis; ///< of the linear program over them
} hidden_frame;

typedef struct hidden_search {
    const enf_portal_graph *graph;
    const enf_hidden_options *options;
    enf_hidden_report *report;
    size_t words;      ///< of a row of cells
    uint64_t *visible; ///< rows, made symmetric
    int32_t *seen_count;
    size_t only_words;       ///< of a row of options->only
    int32_t *corner_opening; ///< of each corner
    enf_facing_cells facing;
    enf_hidden_proof proof;
    enf_hidden_pieces pieces;
    enf_witness_checker witness;

    // One source's.
    double (*edge)[ENF_LINE_ROWS]; ///< of each corner: the edge to the next one, near the source, length 1
    uint64_t *targets;             ///< what is still to be confirmed
    hidden_frame *stack;
    uint64_t *masks; ///< of each frame: cells in front of its portals, all visible from its cells
    size_t stack_capacity, mask_capacity;
    double (*columns)[ENF_LINE_ROWS]; ///< of the edges on the way
    int32_t *column_edge;             ///< which edges they are, as in hidden_proof.h
    size_t column_capacity, column_edge_capacity;
    enf_piece_side *sides; ///< that the order asks for, in hidden_order.c
    int32_t side_count;
    size_t side_capacity;
    bool failed; ///< no memory
} hidden_search;

/// Edges as seen from the middle of a cell's portals: small numbers there, where lines come together.
void hidden_search_edges(hidden_search *search, int32_t source);

/// Adds the portal's edges to the frame, which is a copy of its parent's. False: it is certain that no line
/// passes the whole sequence.
bool hidden_search_program(hidden_search *search, hidden_frame *frame, int32_t portal);

/// For a whole sequence, of which `frame` is the last one on the stack, that no certificate rules out: is it
/// hidden nevertheless? If not, *pair has what was found.
bool hidden_search_pieces(hidden_search *search, const hidden_frame *frame, enf_hidden_pair *pair);

// ---- hidden_order.c
/// Is there a line that comes to all portals of the sequence up to `frame`, in order? The line of SEEN is the
/// pieces' one.
enf_pieces_answer hidden_search_in_order(hidden_search *search, const hidden_frame *frame);

#endif
