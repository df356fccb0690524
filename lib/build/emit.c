// SPDX-License-Identifier: GPL-3.0-or-later
// Overlaps of coplanar polygons are resolved here, in the plane: they cut pieces out of a facet, not cells.
#include "build/emit.h"

#include "base/array.h"

/// A piece with corners, or (count = 0) one that is the whole facet.
static bool add_piece(enf_settler *s, int32_t facet, const enf_corner *corners, int32_t count,
                      int32_t cover) {
    enf_complex *complex = &s->yield->complex;
    size_t pieces = (size_t)complex->pieces.count + 1;
    if (!enf_array_reserve(complex->piece_facet, s->yield->piece_facet_capacity, pieces) ||
        !enf_array_reserve(complex->piece_cover, s->yield->piece_cover_capacity, pieces) ||
        !enf_loops_append(&complex->pieces, corners, count)) {
        return false;
    }
    complex->piece_facet[pieces - 1] = facet;
    complex->piece_cover[pieces - 1] = cover;
    return true;
}

static bool push_loop(enf_loop **list, size_t *count, size_t *capacity, enf_loop loop) {
    if (!enf_array_reserve(*list, *capacity, *count + 1)) return false;
    (*list)[(*count)++] = loop;
    return true;
}

/// Splits every open loop by a cover: what lies inside becomes an occluded piece, what lies outside stays
/// open.
static bool take_cover(enf_settler *s, int32_t facet, int32_t cover, enf_loop cover_loop) {
    enf_pool *pool = &s->pool;
    s->rest_count = 0;
    for (size_t i = 0; i < s->open_count; i++) {
        enf_loop inside = s->open[i];
        size_t rest_before = s->rest_count;
        bool some = true;
        for (int32_t e = 0; e < cover_loop.count && some; e++) {
            int32_t plane = pool->corners[cover_loop.first + e].edge_plane;
            int side = enf_pool_edge_side(pool, cover_loop, e);
            enf_position position = enf_pool_classify(pool, inside, plane);
            if (position == ENF_POSITION_ACROSS) {
                enf_loop behind, front;
                enf_pool_cut(pool, inside, plane, &behind, &front);
                if (!push_loop(&s->rest, &s->rest_count, &s->rest_capacity, side < 0 ? front : behind))
                    return false;
                inside = side < 0 ? behind : front;
            } else {
                some = position == (side < 0 ? ENF_POSITION_BEHIND : ENF_POSITION_FRONT);
            }
        }
        if (pool->failed) return false;
        if (!some) { // not under the cover at all: keep it in one piece
            s->rest_count = rest_before;
            if (!push_loop(&s->rest, &s->rest_count, &s->rest_capacity, s->open[i])) return false;
        } else if (!add_piece(s, facet, pool->corners + inside.first, inside.count, cover)) {
            return false;
        }
    }
    enf_loop *swap = s->open;
    s->open = s->rest;
    s->rest = swap;
    size_t capacity = s->open_capacity;
    s->open_capacity = s->rest_capacity;
    s->rest_capacity = capacity;
    s->open_count = s->rest_count;
    return true;
}

static enf_loop copy_loop(enf_settler *s, const enf_loops *loops, int32_t index, int32_t plane) {
    const enf_corner *corners = loops->corners + loops->offset[index];
    return enf_pool_loop(&s->pool, plane, corners, loops->offset[index + 1] - loops->offset[index]);
}

/// A facet that covers share, and the rest of it.
static bool share_facet(enf_settler *s, int32_t facet) {
    const enf_complex *complex = &s->yield->complex;
    int32_t plane = complex->facet_plane[facet];
    s->pool.corner_count = 0;
    s->open_count = 0;
    enf_loop whole = copy_loop(s, &complex->facets, facet, plane);
    if (s->pool.failed || !push_loop(&s->open, &s->open_count, &s->open_capacity, whole)) return false;
    for (int32_t i = complex->facet_cover[facet]; i < complex->covers.count; i++) {
        enf_loop cover = copy_loop(s, &complex->covers, i, plane);
        if (s->pool.failed || !take_cover(s, facet, i, cover)) return false;
    }
    for (size_t i = 0; i < s->open_count; i++) {
        const enf_corner *corners = s->pool.corners + s->open[i].first;
        if (!add_piece(s, facet, corners, s->open[i].count, ENF_PIECE_OPEN)) return false;
    }
    return !s->pool.failed;
}

static bool add_pieces(enf_settler *s, int32_t facet) {
    const enf_complex *complex = &s->yield->complex;
    int32_t begin = complex->facet_cover[facet], end = complex->covers.count, over = begin;
    while (over < end && complex->covers.offset[over] != complex->covers.offset[over + 1]) over++;
    if (over < end) return add_piece(s, facet, NULL, 0, over);
    if (begin == end) return add_piece(s, facet, NULL, 0, ENF_PIECE_OPEN);
    s->pool.geometry = s->space->geometry;
    bool good = share_facet(s, facet);
    s->space->geometry = s->pool.geometry;
    return good;
}

/// Moves the facet's covers to the complex.
static bool add_covers(enf_settler *s, int32_t first) {
    enf_complex *complex = &s->yield->complex;
    for (int32_t i = first, next; i >= 0; i = next) {
        enf_cover *cover = &s->covers[i];
        size_t count = (size_t)complex->covers.count + 1;
        int32_t begin = cover->loop < 0 ? 0 : s->loops.offset[cover->loop];
        int32_t corners = cover->loop < 0 ? 0 : s->loops.offset[cover->loop + 1] - begin;
        if (!enf_array_reserve(complex->cover_polygon, s->yield->cover_polygon_capacity, count) ||
            !enf_array_reserve(complex->cover_side, s->yield->cover_side_capacity, count) ||
            !enf_loops_append(&complex->covers, corners ? s->loops.corners + begin : NULL, corners)) {
            return false;
        }
        complex->cover_polygon[count - 1] = cover->polygon;
        complex->cover_side[count - 1] = (uint8_t)cover->side;
        next = cover->next;
        cover->next = s->free_cover;
        s->free_cover = i;
    }
    return true;
}

/// The facet's outline, without corners on straight lines (as enf_facet_loop), straight into the complex.
static bool add_loop(enf_settler *s, int32_t facet) {
    const enf_half *halves = s->space->halves;
    enf_loops *loops = &s->yield->complex.facets;
    int32_t first = s->space->facets[facet].first, h = first;
    if (!enf_array_reserve(loops->offset, loops->offset_capacity, (size_t)loops->count + 2)) return false;
    loops->offset[0] = 0;
    do {
        const enf_half *half = &halves[h], *next = &halves[half->next];
        if (next->edge_plane != half->edge_plane) {
            if (!enf_array_reserve(loops->corners, loops->corner_capacity, loops->corner_count + 1))
                return false;
            loops->corners[loops->corner_count++] = (enf_corner){next->vertex, next->edge_plane};
        }
        h = half->next;
    } while (h != first);
    loops->offset[++loops->count] = (int32_t)loops->corner_count;
    return loops->corner_count <= INT32_MAX;
}

bool enf_emit_facet(enf_settler *s, int32_t facet) {
    enf_complex *complex = &s->yield->complex;
    const enf_share share = s->space->facets[facet];
    int32_t added = complex->facets.count;
    size_t count = (size_t)added + 1;
    if (!enf_array_reserve(complex->facet_plane, s->yield->plane_capacity, count) ||
        !enf_array_reserve(complex->facet_cell, s->yield->cell_capacity, count) ||
        !enf_array_reserve(complex->facet_cover, s->yield->facet_cover_capacity, count + 1) ||
        !enf_array_reserve(complex->facet_piece, s->yield->facet_piece_capacity, count + 1) ||
        !add_loop(s, facet)) {
        return false;
    }
    complex->facet_plane[added] = enf_subdivision_plane(s->space, facet);
    complex->facet_cell[added][0] = share.cell[0];
    complex->facet_cell[added][1] = share.cell[1];
    complex->facet_cover[added] = complex->covers.count;
    complex->facet_piece[added] = complex->pieces.count;
    complex->facet_count = complex->facets.count;
    if (!add_covers(s, share.cover) || !add_pieces(s, added)) return false;
    complex->facet_cover[count] = complex->covers.count;
    complex->facet_piece[count] = complex->pieces.count;
    enf_subdivision_remove(s->space, facet);
    return true;
}
