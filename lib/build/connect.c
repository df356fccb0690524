// SPDX-License-Identifier: GPL-3.0-or-later
// The subdivision, with what covers its facets, becomes the fine complex: numbers without gaps, loops without
// corners on straight lines, vertices that somebody uses. Overlaps of coplanar polygons are resolved here, in
// the plane: they cut pieces out of a facet, not cells.
#include "build/connect.h"

#include "base/array.h"
#include "build/cover.h"
#include "build/join.h"

#include <stdlib.h>
#include <string.h>

typedef struct connector {
    enf_complex *complex;
    const enf_arrangement *arrangement;
    enf_subdivision *space;
    enf_covers covers;
    enf_pool pool;                       ///< has the geometry while we are at work
    int32_t *cell_number, *facet_number; ///< new numbers; -1: gone
    int32_t *cover_order;                ///< covers by facet
    enf_loop *open, *rest;               ///< of the facet at hand: what no cover has taken yet
    size_t open_count, open_capacity, rest_count, rest_capacity;
    size_t piece_capacity, piece_facet_capacity;
} connector;

// ---------------------------------------------------------------------------------------------- numbers

/// Joins cells, and numbers what is left in the old order.
static bool number_cells(connector *c) {
    enf_subdivision *space = c->space;
    size_t cells = space->cell_count, facets = space->facet_count;
    int32_t *into = c->cell_number = enf_array_new(cells, sizeof *into);
    c->facet_number = enf_array_new(facets, sizeof *c->facet_number);
    if (!into || !c->facet_number) return false;
    uint8_t *part = enf_array_new(cells, sizeof *part); // of a tetrahedron that was cut
    if (!part) return false;
    for (size_t i = 0; i < cells; i++) part[i] = space->cell_parent[i] >= 0;
    for (size_t i = 0; i < cells; i++) into[i] = (int32_t)i;
    c->complex->cells_joined +=
        enf_subdivision_join(space, c->covers.covered, part, c->arrangement->reflex, into);
    free(part);
    int32_t count = 0;
    for (size_t i = 0; i < facets; i++) c->facet_number[i] = space->facets[i].first >= 0 ? count++ : -1;
    c->complex->facet_count = count;
    count = 0; // a cell that went into another may have the lower number: first those that stay
    for (size_t i = 0; i < cells; i++) {
        if (into[i] == (int32_t)i && space->cell_facet[i] >= 0) into[i] = -1 - count++;
    }
    for (size_t i = 0; i < cells; i++) {
        if (into[i] >= 0 && into[into[i]] < 0) into[i] = into[into[i]]; // roots hold -1 - number already
    }
    for (size_t i = 0; i < cells; i++) into[i] = -1 - into[i]; // cells gone before the cuts: nonsense, unused
    c->complex->cell_count = count;
    return true;
}

static void renumber_tree(connector *c) {
    enf_subdivision *space = c->space;
    enf_complex *complex = c->complex;
    for (int32_t t = 0; t < space->tetrahedron_count; t++) {
        int32_t *root = &space->tetrahedron_root[t];
        if (*root < 0) *root = -1 - c->cell_number[-1 - *root];
    }
    for (size_t n = 0; n < space->node_count; n++) {
        for (int k = 0; k < 2; k++) {
            int32_t *child = &space->node_child[n][k];
            if (*child < 0) *child = -1 - c->cell_number[-1 - *child];
        }
    }
    complex->tetrahedron_root = space->tetrahedron_root;
    complex->node_child = space->node_child;
    complex->node_count = (int32_t)space->node_count;
    space->tetrahedron_root = NULL;
    space->node_child = NULL;
}

// ---------------------------------------------------------------------------------------------- facets

static bool make_facets(connector *c) {
    enf_complex *complex = c->complex;
    const enf_subdivision *space = c->space;
    size_t count = (size_t)complex->facet_count, corners = 0;
    for (size_t i = 0; i < space->facet_count; i++) {
        int32_t first = space->facets[i].first, h = first;
        if (first < 0) continue;
        do {
            int32_t next = space->halves[h].next;
            corners += space->halves[h].edge_plane != space->halves[next].edge_plane;
            h = next;
        } while (h != first);
    }
    complex->facets.offset = enf_array_new(count + 1, sizeof *complex->facets.offset);
    complex->facets.corners = enf_array_new(corners, sizeof *complex->facets.corners);
    complex->facet_plane = enf_array_new(count, sizeof *complex->facet_plane);
    complex->facet_cell = enf_array_new(count, sizeof *complex->facet_cell);
    if (!complex->facets.offset || !complex->facets.corners || !complex->facet_plane || !complex->facet_cell)
        return false;
    for (size_t i = 0; i < space->facet_count; i++) {
        int32_t f = c->facet_number[i];
        if (f < 0) continue;
        c->pool.corner_count = 0;
        enf_loop loop = enf_facet_loop(space, (int32_t)i, &c->pool);
        if (c->pool.failed) return false;
        complex->facets.offset[f] = (int64_t)complex->facets.corner_count;
        memcpy(complex->facets.corners + complex->facets.corner_count, c->pool.corners,
               (size_t)loop.count * sizeof *c->pool.corners);
        complex->facets.corner_count += (size_t)loop.count;
        complex->facet_plane[f] = loop.plane;
        for (int side = 0; side < 2; side++) {
            int32_t cell = space->facets[i].cell[side];
            complex->facet_cell[f][side] = cell < 0 ? -1 : c->cell_number[cell];
        }
    }
    complex->facets.count = complex->facet_count;
    complex->facets.offset[count] = (int64_t)complex->facets.corner_count;
    return true;
}

static bool make_cells(enf_complex *complex) {
    size_t cells = (size_t)complex->cell_count;
    int32_t *next = complex->cell_facet = enf_array_zeroed(cells + 2, sizeof *next);
    complex->cell_facets = enf_array_new(2 * (size_t)complex->facet_count, sizeof *complex->cell_facets);
    if (!next || !complex->cell_facets) return false;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t f = 0; f < complex->facet_count; f++) {
            for (int side = 0; side < 2; side++) {
                int32_t cell = complex->facet_cell[f][side];
                if (cell < 0) continue;
                if (pass == 0) {
                    next[cell + 2]++;
                } else {
                    complex->cell_facets[next[cell + 1]++] = f;
                }
            }
        }
        for (size_t i = 0; pass == 0 && i < cells; i++) next[i + 2] += next[i + 1];
    }
    return true;
}

// ---------------------------------------------------------------------------------------------- covers

/// Covers by facet, on one facet in the order they were found.
static bool make_covers(connector *c) {
    enf_complex *complex = c->complex;
    const enf_covers *found = &c->covers;
    size_t count = found->count, facets = (size_t)complex->facet_count;
    int32_t *next = complex->facet_cover = enf_array_zeroed(facets + 2, sizeof *next);
    int32_t *order = c->cover_order = enf_array_new(count, sizeof *order);
    complex->covers.offset = enf_array_new(count + 1, sizeof *complex->covers.offset);
    complex->covers.corners = enf_array_new(found->loops.corner_count, sizeof *complex->covers.corners);
    complex->cover_polygon = enf_array_new(count, sizeof *complex->cover_polygon);
    complex->cover_side = enf_array_new(count, sizeof *complex->cover_side);
    if (!next || !order || !complex->covers.offset || !complex->covers.corners || !complex->cover_polygon ||
        !complex->cover_side) {
        return false;
    }
    for (size_t i = 0; i < count; i++) next[c->facet_number[found->covers[i].facet] + 2]++;
    for (size_t f = 0; f < facets; f++) next[f + 2] += next[f + 1];
    for (size_t i = 0; i < count; i++)
        order[next[c->facet_number[found->covers[i].facet] + 1]++] = (int32_t)i;
    for (size_t i = 0; i < count; i++) {
        const enf_cover *cover = &found->covers[order[i]];
        complex->covers.offset[i] = (int64_t)complex->covers.corner_count;
        complex->cover_polygon[i] = cover->polygon;
        complex->cover_side[i] = (uint8_t)cover->side;
        if (cover->loop < 0) continue;
        int64_t begin = found->loops.offset[cover->loop];
        size_t corners = (size_t)(found->loops.offset[cover->loop + 1] - begin);
        memcpy(complex->covers.corners + complex->covers.corner_count, found->loops.corners + begin,
               corners * sizeof *complex->covers.corners);
        complex->covers.corner_count += corners;
    }
    complex->covers.count = (int32_t)count;
    complex->covers.offset[count] = (int64_t)complex->covers.corner_count;
    return true;
}

// ---------------------------------------------------------------------------------------------- pieces

/// A piece with corners, or (count = 0) one that is the whole facet.
static bool add_piece(connector *c, int32_t facet, const enf_corner *corners, int32_t count, int32_t cover) {
    enf_complex *complex = c->complex;
    size_t pieces = (size_t)complex->pieces.count + 1;
    if (!enf_array_reserve(complex->piece_facet, c->piece_facet_capacity, pieces) ||
        !enf_array_reserve(complex->piece_cover, c->piece_capacity, pieces) ||
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
static bool take_cover(connector *c, int32_t facet, int32_t cover, enf_loop cover_loop) {
    enf_pool *pool = &c->pool;
    c->rest_count = 0;
    for (size_t i = 0; i < c->open_count; i++) {
        enf_loop inside = c->open[i];
        size_t rest_before = c->rest_count;
        bool some = true;
        for (int32_t e = 0; e < cover_loop.count && some; e++) {
            int32_t plane = pool->corners[cover_loop.first + e].edge_plane;
            int side = enf_pool_edge_side(pool, cover_loop, e);
            enf_position position = enf_pool_classify(pool, inside, plane);
            if (position == ENF_POSITION_ACROSS) {
                enf_loop behind, front;
                enf_pool_cut(pool, inside, plane, &behind, &front);
                if (!push_loop(&c->rest, &c->rest_count, &c->rest_capacity, side < 0 ? front : behind))
                    return false;
                inside = side < 0 ? behind : front;
            } else {
                some = position == (side < 0 ? ENF_POSITION_BEHIND : ENF_POSITION_FRONT);
            }
        }
        if (pool->failed) return false;
        if (!some) { // not under the cover at all: keep it in one piece
            c->rest_count = rest_before;
            if (!push_loop(&c->rest, &c->rest_count, &c->rest_capacity, c->open[i])) return false;
        } else if (!add_piece(c, facet, pool->corners + inside.first, inside.count, cover)) {
            return false;
        }
    }
    enf_loop *swap = c->open;
    c->open = c->rest;
    c->rest = swap;
    size_t capacity = c->open_capacity;
    c->open_capacity = c->rest_capacity;
    c->rest_capacity = capacity;
    c->open_count = c->rest_count;
    return true;
}

static enf_loop copy_loop(connector *c, const enf_loops *loops, int32_t index, int32_t plane) {
    const enf_corner *corners = loops->corners + loops->offset[index];
    return enf_pool_loop(&c->pool, plane, corners,
                         (int32_t)(loops->offset[index + 1] - loops->offset[index]));
}

/// A facet that covers share, and the rest of it.
static bool share_facet(connector *c, int32_t facet) {
    const enf_complex *complex = c->complex;
    int32_t plane = complex->facet_plane[facet];
    c->pool.corner_count = 0;
    c->open_count = 0;
    enf_loop whole = copy_loop(c, &complex->facets, facet, plane);
    if (c->pool.failed || !push_loop(&c->open, &c->open_count, &c->open_capacity, whole)) return false;
    for (int32_t i = complex->facet_cover[facet]; i < complex->facet_cover[facet + 1]; i++) {
        enf_loop cover = copy_loop(c, &complex->covers, i, plane);
        if (c->pool.failed || !take_cover(c, facet, i, cover)) return false;
    }
    for (size_t i = 0; i < c->open_count; i++) {
        const enf_corner *corners = c->pool.corners + c->open[i].first;
        if (!add_piece(c, facet, corners, c->open[i].count, ENF_PIECE_OPEN)) return false;
    }
    return !c->pool.failed;
}

static bool make_pieces(connector *c) {
    enf_complex *complex = c->complex;
    size_t facets = (size_t)complex->facet_count;
    complex->facet_piece = enf_array_new(facets + 1, sizeof *complex->facet_piece);
    size_t room = facets + facets / 16 + 1; // most facets are one piece
    if (!complex->facet_piece || !enf_array_reserve(complex->piece_facet, c->piece_facet_capacity, room) ||
        !enf_array_reserve(complex->piece_cover, c->piece_capacity, room) ||
        !enf_array_reserve(complex->pieces.offset, complex->pieces.offset_capacity, room + 1)) {
        return false;
    }
    complex->pieces.offset[0] = 0;
    for (int32_t f = 0; f < complex->facet_count; f++) {
        complex->facet_piece[f] = complex->pieces.count;
        int32_t begin = complex->facet_cover[f], end = complex->facet_cover[f + 1], over = begin;
        while (over < end && complex->covers.offset[over] != complex->covers.offset[over + 1]) over++;
        bool good = over < end     ? add_piece(c, f, NULL, 0, over)
                    : begin == end ? add_piece(c, f, NULL, 0, ENF_PIECE_OPEN)
                                   : share_facet(c, f);
        if (!good) return false;
    }
    complex->facet_piece[facets] = complex->pieces.count;
    return true;
}

// ---------------------------------------------------------------------------------------------- sights

static int compare_numbers(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/// Per cell the polygons whose front it sees, ascending, each once.
static bool make_sights(enf_complex *complex) {
    size_t cells = (size_t)complex->cell_count;
    int64_t *next = complex->seen_offset = enf_array_zeroed(cells + 2, sizeof *next);
    complex->seen = enf_array_new((size_t)complex->covers.count, sizeof *complex->seen);
    if (!next || !complex->seen) return false;
    for (int pass = 0; pass < 2; pass++) {
        for (int32_t f = 0; f < complex->facet_count; f++) {
            for (int32_t i = complex->facet_cover[f]; i < complex->facet_cover[f + 1]; i++) {
                int32_t cell = complex->facet_cell[f][complex->cover_side[i]];
                if (cell < 0) continue;
                if (pass == 0) {
                    next[cell + 2]++;
                } else {
                    complex->seen[next[cell + 1]++] = complex->cover_polygon[i];
                }
            }
        }
        for (size_t i = 0; pass == 0 && i < cells; i++) next[i + 2] += next[i + 1];
    }
    int64_t kept = 0, begin = 0;
    for (size_t cell = 0; cell < cells; cell++) {
        int64_t end = next[cell + 1];
        if (end - begin > 1)
            qsort(complex->seen + begin, (size_t)(end - begin), sizeof *complex->seen, compare_numbers);
        next[cell] = kept;
        for (int64_t i = begin; i < end; i++) {
            if (i == begin || complex->seen[i] != complex->seen[i - 1])
                complex->seen[kept++] = complex->seen[i];
        }
        begin = end;
    }
    next[cells] = kept;
    return true;
}

// ---------------------------------------------------------------------------------------------- vertices

static void mark_vertices(const enf_loops *loops, int32_t point_count, int32_t *number) {
    for (size_t i = 0; i < loops->corner_count; i++) {
        if (loops->corners[i].vertex >= point_count) number[loops->corners[i].vertex - point_count] = 1;
    }
}

static void renumber_vertices(enf_loops *loops, int32_t point_count, const int32_t *number) {
    for (size_t i = 0; i < loops->corner_count; i++) {
        int32_t *vertex = &loops->corners[i].vertex;
        if (*vertex >= point_count) *vertex = number[*vertex - point_count];
    }
}

/// Keeps the crossings that a loop uses, in order, and rounds them to coordinates.
static bool make_vertices(connector *c) {
    enf_complex *complex = c->complex;
    const enf_geometry *geometry = &c->pool.geometry;
    int32_t points = complex->point_count, made = geometry->crossing_count;
    int32_t *number = enf_array_zeroed((size_t)made, sizeof *number);
    if (!number) return false;
    mark_vertices(&complex->facets, points, number);
    mark_vertices(&complex->covers, points, number);
    mark_vertices(&complex->pieces, points, number);
    int32_t count = points;
    for (int32_t i = 0; i < made; i++) number[i] = number[i] ? count++ : -1;
    complex->vertex_count = count;
    complex->vertex_planes = enf_array_new((size_t)count, sizeof *complex->vertex_planes);
    complex->vertex_position = enf_array_new((size_t)count, sizeof *complex->vertex_position);
    if (complex->vertex_planes && complex->vertex_position) {
        memset(complex->vertex_planes, 0xff, (size_t)points * sizeof *complex->vertex_planes); // -1 -1 -1
        memcpy(complex->vertex_position, complex->points, (size_t)points * sizeof *complex->vertex_position);
        for (int32_t i = 0; i < made; i++) {
            if (number[i] < 0) continue;
            memcpy(complex->vertex_planes[number[i]], geometry->crossings[i].plane,
                   sizeof *complex->vertex_planes);
            enf_geometry_position(geometry, points + i, complex->vertex_position[number[i]]);
        }
        renumber_vertices(&complex->facets, points, number);
        renumber_vertices(&complex->covers, points, number);
        renumber_vertices(&complex->pieces, points, number);
    }
    free(number);
    return complex->vertex_planes && complex->vertex_position;
}

// ---------------------------------------------------------------------------------------------- all together

/// What the complex has in common with the arrangement.
static bool take_arrangement(enf_complex *complex, enf_arrangement *arrangement) {
    const enf_tet_mesh *tets = &arrangement->tets;
    complex->points = arrangement->geometry.points;
    complex->point_count = arrangement->geometry.point_count;
    complex->tetrahedra = enf_array_new((size_t)tets->count, sizeof *complex->tetrahedra);
    if (!complex->tetrahedra) return false;
    memcpy(complex->tetrahedra, tets->corners, (size_t)tets->count * sizeof *complex->tetrahedra);
    complex->planes = arrangement->geometry.planes;
    complex->plane_count = arrangement->geometry.plane_count;
    arrangement->geometry.planes = NULL;
    return true;
}

static bool connect(connector *c, enf_arrangement *arrangement, const enf_crew *crew, bool *stopped) {
    if (!enf_covers_find(&c->covers, arrangement, crew, &c->pool, stopped)) return false;
    c->space->geometry = c->pool.geometry;
    bool good = number_cells(c);
    c->pool.geometry = c->space->geometry;
    if (!good) return false;
    renumber_tree(c);
    c->complex->node_plane = c->space->node_plane;
    good = make_facets(c);
    c->space->node_plane = NULL;
    return good && make_cells(c->complex) && make_covers(c) && make_pieces(c) && make_sights(c->complex) &&
           take_arrangement(c->complex, arrangement) && make_vertices(c);
}

enf_status enf_complex_connect(enf_complex *complex, enf_arrangement *arrangement, const enf_crew *crew,
                               enf_error *error) {
    connector c = {.complex = complex, .arrangement = arrangement, .space = &arrangement->subdivision};
    bool stopped = false;
    c.pool.geometry = c.space->geometry;
    c.space->geometry.crossings = NULL;
    bool good = connect(&c, arrangement, crew, &stopped);
    c.space->geometry.crossings = NULL;
    complex->predicates_filter = arrangement->geometry.decided_by_filter + c.pool.geometry.decided_by_filter;
    complex->predicates_exact = arrangement->geometry.decided_exactly + c.pool.geometry.decided_exactly;
    enf_pool_free(&c.pool);
    enf_covers_free(&c.covers);
    free(c.cell_number);
    free(c.facet_number);
    free(c.cover_order);
    free(c.open);
    free(c.rest);
    enf_subdivision_free(c.space);
    if (stopped) return enf_fail(error, ENF_NO_RESOURCES, "cancelled");
    return good ? ENF_OK : enf_fail_memory(error, "the facets' pieces");
}
