// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/settle.h"

#include "base/array.h"
#include "build/cover.h"
#include "build/emit.h"

#include <stdlib.h>
#include <string.h>

// ---------------------------------------------------------------------------------------------- start and
// end

bool enf_settler_start(enf_settler *s, const enf_arrangement *arrangement, enf_subdivision *space,
                       enf_yield *yield, enf_polygon_lines *lines, uint8_t *reflex) {
    s->arrangement = arrangement;
    s->lines = lines;
    s->space = space;
    s->yield = yield;
    s->join = !arrangement->plain;
    s->cover_count = 0;
    s->free_cover = -1;
    s->loops.count = 0;
    s->loops.corner_count = 0;
    return enf_joiner_start(&s->joiner, space, &arrangement->tets, reflex);
}

void enf_settler_free(enf_settler *s) {
    s->pool.geometry.crossings = NULL; // the space's
    void *arrays[] = {s->covers,  s->inner,     s->next_inner, s->inner_of, s->outer,
                      s->touched, s->waits_for, s->open,       s->rest};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) free(arrays[i]);
    enf_loops_free(&s->loops);
    enf_joiner_free(&s->joiner);
    enf_pool_free(&s->pool);
    memset(s, 0, sizeof *s);
}

// ---------------------------------------------------------------------------------------------- facets

static bool is_new(const enf_cut_cell *cut, int32_t cell) {
    return cell == cut->cell || cell >= cut->first_cell;
}

static bool push(int32_t **list, size_t *count, size_t *capacity, int32_t value) {
    if (!enf_array_reserve(*list, *capacity, *count + 1)) return false;
    (*list)[(*count)++] = value;
    return true;
}

/// Lists a new cell's facets with both sides cut.
static bool list_facets(enf_settler *s, const enf_cut_cell *cut, int32_t cell) {
    const enf_subdivision *space = s->space;
    int32_t last = -1;
    for (int32_t f = space->cell_facet[cell], next; f >= 0; f = next) {
        const enf_share *facet = &space->facets[f];
        int side = facet->cell[1] == cell;
        int32_t other = facet->cell[1 - side];
        next = facet->next[side];
        if (other >= 0 && is_new(cut, other)) {
            if (side == 0 && !push(&s->inner, &s->inner_count, &s->inner_capacity, f)) return false;
        } else if (other < 0 || space->cell_state[other] != ENF_CELL_WAITS) {
            if (!push(&s->outer, &s->outer_count, &s->outer_capacity, f)) return false;
        } else if (other > last) {
            last = other;
        }
    }
    s->waits_for[cell] = last;
    return push(&s->touched, &s->touched_count, &s->touched_capacity, cell);
}

static bool list_all(enf_settler *s, const enf_cut_cell *cut) {
    enf_subdivision *space = s->space;
    int32_t end = (int32_t)space->cell_count;
    s->inner_count = s->outer_count = s->touched_count = 0;
    space->cell_state[cut->cell] = ENF_CELL_CUT;
    for (int32_t c = cut->first_cell; c < end; c++) space->cell_state[c] = ENF_CELL_CUT;
    bool good = list_facets(s, cut, cut->cell);
    for (int32_t c = cut->first_cell; c < end && good; c++) good = list_facets(s, cut, c);
    return good;
}

// ---------------------------------------------------------------------------------------------- covers

/// Lays polygons on the facets of the new cuts.
static bool cover_inner(enf_settler *s, const enf_cut_cell *cut) {
    size_t nodes = s->space->node_count - (size_t)cut->first_node;
    if (nodes == 0) return true;
    if (!enf_array_reserve(s->inner_of, s->inner_of_capacity, nodes) ||
        !enf_array_reserve(s->next_inner, s->next_inner_capacity, s->inner_count + 1)) {
        return false;
    }
    for (size_t n = 0; n < nodes; n++) s->inner_of[n] = -1;
    for (size_t i = s->inner_count; i-- > 0;) {
        int32_t node = -1 - s->space->facets[s->inner[i]].source - cut->first_node;
        s->next_inner[i] = s->inner_of[node];
        s->inner_of[node] = (int32_t)i;
    }
    for (size_t i = 0; i < cut->hit_count; i++) {
        const enf_hit *hit = &cut->hits[i];
        enf_polygon_lines_take(s->lines, s->arrangement, hit->polygon, hit->lines);
        for (int32_t k = s->inner_of[-1 - hit->source - cut->first_node]; k >= 0; k = s->next_inner[k]) {
            if (!enf_cover_facet(s, s->inner[k])) return false;
        }
    }
    return true;
}

/// Lays polygons on a facet that lies on one of the tetrahedra's.
static bool cover_from_hits(enf_settler *s, int32_t facet) {
    const enf_arrangement *arrangement = s->arrangement;
    int32_t source = s->space->facets[facet].source;
    for (int32_t k = arrangement->hit_first[source]; k < arrangement->hit_first[source + 1]; k++) {
        enf_polygon_lines_take(s->lines, arrangement, arrangement->hits[k].polygon,
                               arrangement->hits[k].lines);
        if (!enf_cover_facet(s, facet)) return false;
    }
    return true;
}

static bool cover_outer(enf_settler *s) {
    for (size_t i = 0; i < s->outer_count; i++) {
        if (!cover_from_hits(s, s->outer[i])) return false;
    }
    return true;
}

// ---------------------------------------------------------------------------------------------- cells

/// A cell that some polygon has cut off.
static bool is_part(const enf_settler *s, int32_t cell) {
    return cell >= 0 && s->space->cell_parent[cell] >= 0;
}

static void try_join(enf_settler *s, int32_t facet) {
    const enf_share *share = &s->space->facets[facet];
    if (share->first >= 0 && is_part(s, share->cell[0]) && is_part(s, share->cell[1]))
        enf_joiner_try(&s->joiner, s->space, facet);
}

/// The last cuts first: they divide the smallest cells.
static void join_all(enf_settler *s) {
    for (size_t i = s->inner_count; i-- > 0;) try_join(s, s->inner[i]);
    for (size_t i = s->outer_count; i-- > 0;) try_join(s, s->outer[i]);
}

/// Does the cell have a neighbour that is still to be cut? They are cut in order, so the last one is
/// remembered and asked first.
static bool waits(enf_settler *s, int32_t cell) {
    const enf_subdivision *space = s->space;
    int32_t *last = &s->waits_for[cell];
    if (*last >= 0 && space->cell_state[*last] == ENF_CELL_WAITS) return true;
    *last = -1;
    for (int32_t f = space->cell_facet[cell], next; f >= 0; f = next) {
        const enf_share *facet = &space->facets[f];
        int side = facet->cell[1] == cell;
        int32_t other = facet->cell[1 - side];
        next = facet->next[side];
        if (other > *last && space->cell_state[other] == ENF_CELL_WAITS) *last = other;
    }
    return *last >= 0;
}

/// Closes a cell if all around it has been cut, and emits the facets that it shares with closed ones.
static bool close_cell(enf_settler *s, int32_t cell) {
    enf_subdivision *space = s->space;
    if (space->cell_state[cell] != ENF_CELL_CUT || space->cell_facet[cell] < 0 || waits(s, cell)) return true;
    space->cell_state[cell] = ENF_CELL_CLOSED;
    for (int32_t f = space->cell_facet[cell], next; f >= 0; f = next) {
        const enf_share *facet = &space->facets[f];
        int side = facet->cell[1] == cell;
        int32_t other = facet->cell[1 - side];
        next = facet->next[side];
        if ((other < 0 || space->cell_state[other] == ENF_CELL_CLOSED) && !enf_emit_facet(s, f)) return false;
    }
    return true;
}

static bool reserve_lines(enf_settler *s) {
    const enf_geometry *geometry = &s->space->geometry;
    return enf_polygon_lines_reserve(s->lines,
                                     (size_t)geometry->point_count + (size_t)geometry->crossing_count);
}

bool enf_settler_settle_still(enf_settler *s) {
    size_t count = s->space->facet_count; // of the tetrahedra's, before anything is cut
    for (size_t f = 0; f < count; f++) {
        const enf_share *facet = &s->space->facets[f];
        if (facet->cell[0] >= 0 || facet->cell[1] >= 0) continue;
        if (!reserve_lines(s) || !cover_from_hits(s, (int32_t)f) || !enf_emit_facet(s, (int32_t)f))
            return false;
    }
    return true;
}

bool enf_settler_settle(enf_settler *s, const enf_cut_cell *cut) {
    enf_subdivision *space = s->space;
    if (!reserve_lines(s) || !enf_array_reserve(s->waits_for, s->waits_capacity, space->cell_count) ||
        !list_all(s, cut) || !cover_inner(s, cut) || !cover_outer(s)) {
        return false;
    }
    for (size_t i = 0; i < s->outer_count; i++) { // before facets go
        const enf_share *facet = &space->facets[s->outer[i]];
        int32_t beyond = facet->cell[is_new(cut, facet->cell[0])];
        if (beyond < 0 || beyond == s->touched[s->touched_count - 1]) continue;
        if (!push(&s->touched, &s->touched_count, &s->touched_capacity, beyond)) return false;
    }
    if (!enf_joiner_reserve(&s->joiner, space->cell_count)) return false;
    if (s->join) join_all(s);
    for (size_t i = 0; i < s->touched_count; i++) {
        if (!close_cell(s, s->touched[i])) return false;
    }
    return true;
}
