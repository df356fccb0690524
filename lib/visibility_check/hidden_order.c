// SPDX-License-Identifier: GPL-3.0-or-later
// Order along the line, for the hidden pairs. Where portals lie in one plane but for rounding, a line may
// pass the edges of all and still come to one too early. Then what is asked for is a line that goes through
// one triangle of the earlier portal and afterwards through one of the later portal, for each pair of these.
#include "visibility_check/hidden_search.h"
#include "visibility_check/witness_order.h"

#include "base/array.h"

enum { SIDES = 5 }; ///< of a pair of triangles: two of each, and their order

/// Lines may be given by their points in any two portals on the way. From the first to the last is best as a
/// rule; where portals touch, others may decide what these can't.
static enf_pieces_answer ask_pieces(hidden_search *search, const hidden_frame *frame) {
    int32_t depth = (int32_t)(frame - search->stack);
    enf_pieces_answer answer = ENF_PIECES_OPEN;
    search->pieces.sides = search->sides;
    search->pieces.side_count = search->side_count;
    for (int32_t length = depth; length > 0 && answer == ENF_PIECES_OPEN; length--)
        for (int32_t at = 0; at + length <= depth && answer == ENF_PIECES_OPEN; at++)
            answer = enf_hidden_pieces_ask(&search->pieces, search->stack[at].portal >> 1,
                                           search->stack[at + length].portal >> 1, search->column_edge,
                                           search->proof.corner_next, frame->column_count);
    search->pieces.side_count = 0;
    return answer;
}

/// The first place in the sequence at which the line of the pieces is not after the one before; 0 if none is.
static int32_t find_disorder(const hidden_search *search, int32_t depth) {
    mpq_t from[3], to[3];
    int32_t place = 1;
    for (int i = 0; i < 3; i++) mpq_inits(from[i], to[i], NULL);
    enf_hidden_pieces_line(&search->pieces, from, to);
    while (place <= depth && enf_witness_in_order(search->graph, from, to, search->stack[place - 1].portal,
                                                  search->stack[place].portal))
        place++;
    for (int i = 0; i < 3; i++) mpq_clears(from[i], to[i], NULL);
    return place <= depth ? place : 0;
}

static bool is_ordered(const hidden_search *search, int32_t place) {
    for (int32_t k = 0; k < search->side_count; k++)
        if (search->sides[k].place == place) return true;
    return false;
}

/// The ways across the winding that bound its triangle of corners `first`, c and c + 1; *out: these, turned
/// as the portal is.
static void add_triangle(hidden_search *search, int32_t portal, int32_t c, int32_t place, int32_t out[3]) {
    const int32_t *offset = search->graph->opening_corner;
    int32_t first = offset[portal >> 1], end = offset[(portal >> 1) + 1];
    bool turned = portal & 1;
    enf_piece_side before = {.corner = {first, c}, .count = 2, .place = place};
    enf_piece_side after = {.corner = {c + 1, first}, .count = 2, .place = place};
    if (turned) {
        before = (enf_piece_side){.corner = {c, first}, .count = 2, .place = place};
        after = (enf_piece_side){.corner = {first, c + 1}, .count = 2, .place = place};
    }
    if (c > first + 1) search->sides[search->side_count++] = before;
    if (c + 2 < end) search->sides[search->side_count++] = after;
    out[0] = first;
    out[1] = turned ? c + 1 : c;
    out[2] = turned ? c : c + 1;
}

static void add_order(hidden_search *search, int32_t place, int32_t one, int32_t two) {
    enf_piece_side order = {.count = 6, .place = place};
    add_triangle(search, search->stack[place - 1].portal, one, place, order.corner);
    add_triangle(search, search->stack[place].portal, two, place, order.corner + 3);
    search->sides[search->side_count++] = order;
}

/// All pairs of triangles of the portal at this place and the one before.
static enf_pieces_answer ask_pairs(hidden_search *search, const hidden_frame *frame, int32_t place) {
    const int32_t *before = &search->graph->opening_corner[search->stack[place - 1].portal >> 1];
    const int32_t *here = &search->graph->opening_corner[search->stack[place].portal >> 1];
    enf_pieces_answer answer = ENF_PIECES_HIDDEN;
    int32_t count = search->side_count;
    if (!enf_array_reserve(search->sides, search->side_capacity, (size_t)count + SIDES)) {
        search->failed = true;
        return ENF_PIECES_OPEN;
    }
    for (int32_t a = before[0] + 1; a + 1 < before[1]; a++)
        for (int32_t b = here[0] + 1; b + 1 < here[1]; b++) {
            add_order(search, place, a, b);
            enf_pieces_answer part = hidden_search_in_order(search, frame);
            search->side_count = count;
            if (part == ENF_PIECES_SEEN) return part;
            if (part == ENF_PIECES_OPEN) answer = part;
        }
    return answer;
}

enf_pieces_answer hidden_search_in_order(hidden_search *search, const hidden_frame *frame) {
    enf_pieces_answer answer = ask_pieces(search, frame);
    if (answer != ENF_PIECES_SEEN) return answer;
    int32_t place = find_disorder(search, (int32_t)(frame - search->stack));
    if (place == 0) return ENF_PIECES_SEEN;
    return is_ordered(search, place) ? ENF_PIECES_OPEN : ask_pairs(search, frame, place);
}
