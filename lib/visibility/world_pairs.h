// SPDX-License-Identifier: GPL-3.0-or-later
// The truth about pairs of cells of a compiled world, one by one: all ways through the leafs of the air from
// one to the other are tried, each by itself, and squeezed (squeeze.h) until a line is found or none is left:
// between the hulls of their parts, and, where these see each other, between what fine cells leave in leafs.
#ifndef ENF_VISIBILITY_WORLD_PAIRS_H
#define ENF_VISIBILITY_WORLD_PAIRS_H

#include "visibility/fine_vertices.h"
#include "visibility/squeeze.h"
#include "visibility/world_air.h"
#include "visibility/world_lines.h"

/// What of a fine cell lies in a leaf.
typedef struct enf_world_piece {
    int32_t leaf;
    enf_solid solid;
} enf_world_piece;

typedef struct enf_world_pieces {
    int32_t cell; ///< -1: none
    enf_world_piece *items;
    int32_t count;
    size_t capacity;
} enf_world_pieces;

typedef struct enf_world_pairs {
    const enf_world_air *air; ///< not owned
    enf_world_lines *lines;   ///< not owned: a pair is seen if these show it
    enf_shapes shapes;        ///< of the leafs' openings
    bool *is_guided;          ///< per portal: it may be seen, backwards, from the end of the way
    int32_t *marked;          ///< the twins of those
    int32_t marked_count;
    bool *is_on_way;            ///< per leaf
    int32_t *way;               ///< portals from the start
    enf_window *windows;        ///< what is left of each
    enf_world_pieces pieces[2]; ///< of the two cells; made when they are needed
    enf_fine_vertices vertices; ///< scratch
    double (*corners)[3];       ///< scratch
    size_t corner_capacity;
    enf_squeeze squeeze;
    int64_t ways; ///< that were squeezed so far
} enf_world_pairs;

/// Needs leafs in the air. *pairs is overwritten; free it in any case.
enf_status enf_world_pairs_make(enf_world_pairs *pairs, const enf_world_air *air, enf_world_lines *lines,
                                uint64_t seed, enf_error *error);
void enf_world_pairs_free(enf_world_pairs *pairs);

/// Does some line join the two cells? SEEN is proven by a line, HIDDEN by separating planes, within their
/// tolerances; OPEN: `steps` separators were too few, or what is left is too small.
enf_status enf_world_pairs_decide(enf_world_pairs *pairs, int32_t cell, int32_t other, int64_t steps,
                                  enf_squeeze_answer *answer, enf_error *error);

#endif
