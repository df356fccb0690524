// SPDX-License-Identifier: GPL-3.0-or-later
// A facet is flat, so this is work in two dimensions: its back faces and its front faces tile it in two ways,
// the overlaps of the two tilings are its pieces, and from each piece the covers are taken away one after the
// other (the thesis 4.2.2), so that covers that overlap each other count once. All cuts are by planes, hence
// exact.
#include "build/connect.h"

#include "base/array.h"
#include "base/parallel.h"
#include "build/loop.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK = 1024 }; ///< facets a job

typedef struct sight {
    int32_t cell, polygon;
} sight;

typedef struct connect_block {
    enf_loops pieces;
    int32_t (*piece_face)[2];
    int32_t *piece_cover;
    size_t face_capacity, cover_capacity;
    int32_t piece_count[BLOCK]; ///< per facet of the block
    enf_crossing *crossings;    ///< new ones
    size_t crossing_count, crossing_capacity;
    sight *sights;
    size_t sight_count, sight_capacity;
} connect_block;

typedef struct connector {
    enf_pool pool;
    enf_loop *open, *rest; ///< what is left of a piece, before and after the next cover
    size_t open_count, open_capacity, rest_count, rest_capacity;
} connector;

typedef struct connect_all {
    const enf_complex *complex;
    const int32_t *facet_face; ///< facet_count + 1 offsets into faces_by_facet; faces behind come first
    const int32_t *faces_by_facet;
    const int32_t *face_cell;
    connect_block *blocks;
    connector *connectors;
    bool *failed; ///< per block
} connect_all;

// ---------------------------------------------------------------------------------------------- results

static bool add_piece(connector *connector, connect_block *block, const enf_corner *corners, int32_t count,
                      const int32_t face[2], int32_t cover) {
    const enf_geometry *geometry = &connector->pool.geometry;
    size_t pieces = (size_t)block->pieces.count + 1;
    if (!enf_array_reserve(block->piece_face, block->face_capacity, pieces) ||
        !enf_array_reserve(block->piece_cover, block->cover_capacity, pieces) ||
        !enf_loops_append(&block->pieces, corners, count)) {
        return false;
    }
    // Own crossings are numbered anew in the block; the pool's are dropped with the facet.
    enf_corner *added = block->pieces.corners + block->pieces.offset[block->pieces.count - 1];
    int32_t own = geometry->point_count + geometry->shared_count;
    for (int32_t i = 0; i < count; i++) {
        if (added[i].vertex < own) continue;
        if (!enf_array_reserve(block->crossings, block->crossing_capacity, block->crossing_count + 1))
            return false;
        block->crossings[block->crossing_count] = geometry->crossings[added[i].vertex - own];
        added[i].vertex = own + (int32_t)block->crossing_count++;
    }
    block->piece_face[pieces - 1][0] = face[0];
    block->piece_face[pieces - 1][1] = face[1];
    block->piece_cover[pieces - 1] = cover;
    return true;
}

static bool add_sight(const connect_all *all, connect_block *block, const int32_t face[2], int32_t cover) {
    int32_t seeing = face[all->complex->cover_side[cover]];
    if (seeing < 0) return true;
    if (!enf_array_reserve(block->sights, block->sight_capacity, block->sight_count + 1)) return false;
    block->sights[block->sight_count++] = (sight){all->face_cell[seeing], all->complex->cover_polygon[cover]};
    return true;
}

// ---------------------------------------------------------------------------------------------- one facet

static enf_loop copy_loop(connector *connector, const enf_loops *loops, int32_t index, int32_t plane) {
    const enf_corner *corners = loops->corners + loops->offset[index];
    return enf_pool_loop(&connector->pool, plane, corners,
                         (int32_t)(loops->offset[index + 1] - loops->offset[index]));
}

static bool push_loop(enf_loop **list, size_t *count, size_t *capacity, enf_loop loop) {
    if (!enf_array_reserve(*list, *capacity, *count + 1)) return false;
    (*list)[(*count)++] = loop;
    return true;
}

/// Splits every open loop by a cover: what lies inside becomes an occluded piece, what lies outside stays
/// open.
static bool take_cover(connector *connector, connect_block *block, const int32_t face[2], int32_t cover,
                       enf_loop cover_loop) {
    enf_pool *pool = &connector->pool;
    connector->rest_count = 0;
    for (size_t i = 0; i < connector->open_count; i++) {
        enf_loop inside = connector->open[i];
        size_t rest_before = connector->rest_count;
        bool some = true;
        for (int32_t e = 0; e < cover_loop.count && some; e++) {
            int32_t plane = pool->corners[cover_loop.first + e].edge_plane;
            int side = enf_pool_edge_side(pool, cover_loop, e);
            enf_position position = enf_pool_classify(pool, inside, plane);
            if (position == ENF_POSITION_ACROSS) {
                enf_loop behind, front;
                enf_pool_cut(pool, inside, plane, &behind, &front);
                if (!push_loop(&connector->rest, &connector->rest_count, &connector->rest_capacity,
                               side < 0 ? front : behind)) {
                    return false;
                }
                inside = side < 0 ? behind : front;
            } else {
                some = position == (side < 0 ? ENF_POSITION_BEHIND : ENF_POSITION_FRONT);
            }
        }
        if (pool->failed) return false;
        if (!some) { // not under the cover at all: keep it in one piece
            connector->rest_count = rest_before;
            if (!push_loop(&connector->rest, &connector->rest_count, &connector->rest_capacity,
                           connector->open[i])) {
                return false;
            }
        } else if (!add_piece(connector, block, pool->corners + inside.first, inside.count, face, cover)) {
            return false;
        }
    }
    enf_loop *swap = connector->open;
    connector->open = connector->rest;
    connector->rest = swap;
    size_t capacity = connector->open_capacity;
    connector->open_capacity = connector->rest_capacity;
    connector->rest_capacity = capacity;
    connector->open_count = connector->rest_count;
    return true;
}

/// One overlap of a back and a front face, with the facet's covers taken away.
static bool add_overlap(const connect_all *all, connector *connector, connect_block *block, int32_t facet,
                        enf_loop overlap, const int32_t face[2]) {
    const enf_complex *complex = all->complex;
    int32_t plane = complex->facet_plane[facet];
    int32_t first = complex->facet_cover[facet], end = complex->facet_cover[facet + 1];
    connector->open_count = 0;
    if (!push_loop(&connector->open, &connector->open_count, &connector->open_capacity, overlap))
        return false;
    for (int32_t c = first; c < end; c++) {
        enf_loop cover = copy_loop(connector, &complex->covers, c, plane);
        enf_loop seen = overlap;
        if (end - first >
            1) { // a cover that lies under another one takes nothing away, but is seen all the same
            if (enf_pool_intersect(&connector->pool, &seen, cover) && !add_sight(all, block, face, c))
                return false;
        }
        int32_t before = block->pieces.count;
        if (connector->pool.failed || !take_cover(connector, block, face, c, cover)) return false;
        if (end - first == 1 && block->pieces.count > before && !add_sight(all, block, face, c)) return false;
    }
    for (size_t i = 0; i < connector->open_count; i++) {
        enf_loop loop = connector->open[i];
        if (!add_piece(connector, block, connector->pool.corners + loop.first, loop.count, face,
                       ENF_PIECE_OPEN))
            return false;
    }
    return !connector->pool.failed;
}

static bool add_pair(const connect_all *all, connector *connector, connect_block *block, int32_t facet,
                     const int32_t face[2], bool whole_behind, bool whole_front) {
    const enf_complex *complex = all->complex;
    int32_t plane = complex->facet_plane[facet];
    // Where one side is a single face, it is the whole facet and the other side's face is the overlap.
    int32_t base = face[0] < 0 || (face[1] >= 0 && whole_behind) ? face[1] : face[0];
    if (complex->facet_cover[facet] == complex->facet_cover[facet + 1] && (whole_behind || whole_front)) {
        const enf_corner *corners = complex->faces.corners + complex->faces.offset[base];
        int32_t count = (int32_t)(complex->faces.offset[base + 1] - complex->faces.offset[base]);
        return add_piece(connector, block, corners, count, face, ENF_PIECE_OPEN);
    }
    enf_loop overlap = copy_loop(connector, &complex->faces, base, plane);
    if (!whole_behind && !whole_front) {
        enf_loop other = copy_loop(connector, &complex->faces, face[1], plane);
        if (connector->pool.failed || !enf_pool_intersect(&connector->pool, &overlap, other)) {
            return !connector->pool.failed;
        }
    }
    return !connector->pool.failed && add_overlap(all, connector, block, facet, overlap, face);
}

static bool connect_facet(const connect_all *all, connector *connector, connect_block *block, int32_t facet) {
    const enf_complex *complex = all->complex;
    int32_t first = all->facet_face[facet], end = all->facet_face[facet + 1], middle = first;
    while (middle < end && complex->face_side[all->faces_by_facet[middle]] == 0) middle++;
    enf_pool_empty(&connector->pool);
    bool whole_behind = middle - first <= 1, whole_front = end - middle <= 1;
    for (int32_t b = first; b < middle || (b == first && middle == first); b++) {
        for (int32_t f = middle; f < end || (f == middle && middle == end); f++) {
            int32_t face[2] = {b < middle ? all->faces_by_facet[b] : -1,
                               f < end ? all->faces_by_facet[f] : -1};
            if (!add_pair(all, connector, block, facet, face, whole_behind, whole_front)) return false;
        }
    }
    return true;
}

static void connect_job(void *user, int32_t index, int thread) {
    connect_all *all = user;
    connect_block *block = &all->blocks[index];
    for (int32_t i = 0; i < BLOCK && index * BLOCK + i < all->complex->facet_count; i++) {
        int32_t before = block->pieces.count;
        if (!connect_facet(all, &all->connectors[thread], block, index * BLOCK + i)) {
            all->failed[index] = true;
            return;
        }
        block->piece_count[i] = block->pieces.count - before;
    }
}

// ---------------------------------------------------------------------------------------------- all together

/// Faces sorted by facet, those behind first; and the cell of every face.
static bool sort_faces(const enf_complex *complex, int32_t **facet_face, int32_t **faces_by_facet,
                       int32_t **face_cell) {
    size_t facets = (size_t)complex->facet_count;
    int32_t *next = *facet_face = enf_array_zeroed(facets + 2, sizeof *next);
    *faces_by_facet = enf_array_new((size_t)complex->faces.count, sizeof **faces_by_facet);
    *face_cell = enf_array_new((size_t)complex->faces.count, sizeof **face_cell);
    if (!next || !*faces_by_facet || !*face_cell) return false;
    for (int32_t f = 0; f < complex->faces.count; f++) next[complex->face_facet[f] + 2]++;
    for (size_t f = 0; f < facets; f++) next[f + 2] += next[f + 1];
    for (int side = 0; side < 2; side++) {
        for (int32_t f = 0; f < complex->faces.count; f++) {
            if (complex->face_side[f] == side) (*faces_by_facet)[next[complex->face_facet[f] + 1]++] = f;
        }
    }
    for (int32_t c = 0; c < complex->cell_count; c++) {
        for (int32_t f = complex->cell_face[c]; f < complex->cell_face[c + 1]; f++) (*face_cell)[f] = c;
    }
    return true;
}

static bool join_pieces(enf_complex *complex, const connect_block *blocks, int32_t block_count,
                        int32_t shared_end) {
    size_t pieces = 0, corners = 0;
    for (int32_t b = 0; b < block_count; b++) {
        pieces += (size_t)blocks[b].pieces.count;
        corners += blocks[b].pieces.corner_count;
    }
    if (pieces > INT32_MAX) return false;
    complex->pieces.offset = enf_array_new(pieces + 1, sizeof *complex->pieces.offset);
    complex->pieces.corners = enf_array_new(corners, sizeof *complex->pieces.corners);
    complex->piece_face = enf_array_new(pieces, sizeof *complex->piece_face);
    complex->piece_cover = enf_array_new(pieces, sizeof *complex->piece_cover);
    complex->facet_piece = enf_array_new((size_t)complex->facet_count + 1, sizeof *complex->facet_piece);
    if (!complex->pieces.offset || !complex->pieces.corners || !complex->piece_face ||
        !complex->piece_cover || !complex->facet_piece) {
        return false;
    }
    int32_t vertex_base = 0;
    for (int32_t b = 0; b < block_count; b++) {
        const connect_block *block = &blocks[b];
        int32_t piece = complex->pieces.count;
        for (int32_t i = 0; i < BLOCK && b * BLOCK + i < complex->facet_count; i++) {
            complex->facet_piece[b * BLOCK + i] = piece;
            piece += block->piece_count[i];
        }
        for (int32_t i = 0; i < block->pieces.count; i++) {
            complex->pieces.offset[complex->pieces.count + i] =
                (int64_t)complex->pieces.corner_count + block->pieces.offset[i];
        }
        for (size_t i = 0; i < block->pieces.corner_count; i++) {
            enf_corner corner = block->pieces.corners[i];
            if (corner.vertex >= shared_end) corner.vertex += vertex_base;
            complex->pieces.corners[complex->pieces.corner_count + i] = corner;
        }
        size_t count = (size_t)block->pieces.count;
        if (count) {
            memcpy(complex->piece_face + complex->pieces.count, block->piece_face,
                   count * sizeof *block->piece_face);
            memcpy(complex->piece_cover + complex->pieces.count, block->piece_cover,
                   count * sizeof *block->piece_cover);
        }
        complex->pieces.count += block->pieces.count;
        complex->pieces.corner_count += block->pieces.corner_count;
        vertex_base += (int32_t)block->crossing_count;
    }
    complex->facet_piece[complex->facet_count] = complex->pieces.count;
    complex->pieces.offset[complex->pieces.count] = (int64_t)complex->pieces.corner_count;
    return true;
}

static int compare_numbers(const void *a, const void *b) {
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}

/// Per cell the polygons it sees, ascending, each once.
static bool join_sights(enf_complex *complex, const connect_block *blocks, int32_t block_count) {
    size_t cells = (size_t)complex->cell_count, total = 0;
    for (int32_t b = 0; b < block_count; b++) total += blocks[b].sight_count;
    int64_t *next = complex->seen_offset = enf_array_zeroed(cells + 2, sizeof *next);
    complex->seen = enf_array_new(total, sizeof *complex->seen);
    if (!next || !complex->seen) return false;
    for (int32_t b = 0; b < block_count; b++) {
        for (size_t i = 0; i < blocks[b].sight_count; i++) next[blocks[b].sights[i].cell + 2]++;
    }
    for (size_t c = 0; c < cells; c++) next[c + 2] += next[c + 1];
    for (int32_t b = 0; b < block_count; b++) {
        for (size_t i = 0; i < blocks[b].sight_count; i++) {
            complex->seen[next[blocks[b].sights[i].cell + 1]++] = blocks[b].sights[i].polygon;
        }
    }
    int64_t kept = 0, begin = 0;
    for (size_t c = 0; c < cells; c++) {
        int64_t end = next[c + 1];
        qsort(complex->seen + begin, (size_t)(end - begin), sizeof *complex->seen, compare_numbers);
        next[c] = kept;
        for (int64_t i = begin; i < end; i++) {
            if (i == begin || complex->seen[i] != complex->seen[i - 1])
                complex->seen[kept++] = complex->seen[i];
        }
        begin = end;
    }
    next[cells] = kept;
    return true;
}

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
static bool make_vertices(enf_complex *complex, const enf_arrangement *arrangement,
                          const enf_crossing *crossings, const connect_block *blocks, int32_t block_count) {
    int32_t points = complex->point_count, made = complex->vertex_count - points, total = made;
    for (int32_t b = 0; b < block_count; b++) total += (int32_t)blocks[b].crossing_count;
    int32_t *number = enf_array_zeroed((size_t)total, sizeof *number);
    if (!number) return false;
    mark_vertices(&complex->faces, points, number);
    mark_vertices(&complex->covers, points, number);
    mark_vertices(&complex->pieces, points, number);
    int32_t count = points;
    for (int32_t i = 0; i < total; i++) number[i] = number[i] ? count++ : -1;
    complex->vertex_count = count;
    complex->vertex_planes = enf_array_new((size_t)count, sizeof *complex->vertex_planes);
    complex->vertex_position = enf_array_new((size_t)count, sizeof *complex->vertex_position);
    if (!complex->vertex_planes || !complex->vertex_position) {
        free(number);
        return false;
    }
    memset(complex->vertex_planes, 0xff, (size_t)points * sizeof *complex->vertex_planes); // -1 -1 -1
    memcpy(complex->vertex_position, complex->points, (size_t)points * sizeof *complex->vertex_position);
    enf_geometry geometry = arrangement->geometry;
    const enf_crossing *source = crossings;
    for (int32_t b = -1, i = 0; b < block_count; b++) {
        int32_t end = b < 0 ? made : i + (int32_t)blocks[b].crossing_count, begin = i;
        geometry.shared = source = b < 0 ? crossings : blocks[b].crossings;
        geometry.shared_count = end - begin;
        for (; i < end; i++) {
            if (number[i] < 0) continue;
            memcpy(complex->vertex_planes[number[i]], source[i - begin].plane,
                   sizeof *complex->vertex_planes);
            enf_geometry_position(&geometry, points + (i - begin), complex->vertex_position[number[i]]);
        }
    }
    renumber_vertices(&complex->faces, points, number);
    renumber_vertices(&complex->covers, points, number);
    renumber_vertices(&complex->pieces, points, number);
    free(number);
    return true;
}

static bool run_blocks(connect_all *all, enf_arrangement *arrangement, const enf_crossing *crossings,
                       int32_t block_count, const enf_crew *crew, bool *stopped) {
    int threads = crew->threads;
    for (int i = 0; i < threads; i++) {
        enf_geometry *geometry = &all->connectors[i].pool.geometry;
        *geometry = arrangement->geometry;
        geometry->decided_by_filter = geometry->decided_exactly = 0;
        geometry->shared = crossings;
        geometry->shared_count = all->complex->vertex_count - all->complex->point_count;
    }
    *stopped = !enf_parallel_for(crew, block_count, connect_job, all);
    bool good = !*stopped;
    for (int32_t b = 0; b < block_count; b++) good = good && !all->failed[b];
    for (int i = 0; i < threads; i++) {
        arrangement->geometry.decided_by_filter += all->connectors[i].pool.geometry.decided_by_filter;
        arrangement->geometry.decided_exactly += all->connectors[i].pool.geometry.decided_exactly;
    }
    return good;
}

static void free_blocks(connect_all *all, int32_t block_count, int threads) {
    for (int32_t b = 0; all->blocks && b < block_count; b++) {
        enf_loops_free(&all->blocks[b].pieces);
        free(all->blocks[b].piece_face);
        free(all->blocks[b].piece_cover);
        free(all->blocks[b].crossings);
        free(all->blocks[b].sights);
    }
    for (int i = 0; all->connectors && i < threads; i++) {
        enf_pool_free(&all->connectors[i].pool);
        free(all->connectors[i].open);
        free(all->connectors[i].rest);
    }
    free(all->blocks);
    free(all->connectors);
    free(all->failed);
}

enf_status enf_complex_connect(enf_complex *complex, enf_arrangement *arrangement,
                               const enf_crossing *crossings, const enf_crew *crew, enf_error *error) {
    int threads = crew->threads;
    bool stopped = false;
    int32_t block_count = (complex->facet_count + BLOCK - 1) / BLOCK;
    int32_t *facet_face = NULL, *faces_by_facet = NULL, *face_cell = NULL;
    connect_all all = {.complex = complex,
                       .blocks = enf_array_zeroed((size_t)block_count, sizeof *all.blocks),
                       .connectors = enf_array_zeroed((size_t)threads, sizeof *all.connectors),
                       .failed = enf_array_zeroed((size_t)block_count, sizeof *all.failed)};
    bool good = all.blocks && all.connectors && all.failed &&
                sort_faces(complex, &facet_face, &faces_by_facet, &face_cell);
    all.facet_face = facet_face;
    all.faces_by_facet = faces_by_facet;
    all.face_cell = face_cell;
    good = good && run_blocks(&all, arrangement, crossings, block_count, crew, &stopped) &&
           join_pieces(complex, all.blocks, block_count, complex->vertex_count) &&
           join_sights(complex, all.blocks, block_count) &&
           make_vertices(complex, arrangement, crossings, all.blocks, block_count);
    free_blocks(&all, block_count, threads);
    free(facet_face);
    free(faces_by_facet);
    free(face_cell);
    if (stopped) return enf_fail(error, ENF_NO_RESOURCES, "cancelled");
    if (!good) return enf_fail_memory(error, "the facets' pieces");
    complex->planes = arrangement->geometry.planes;
    complex->plane_count = arrangement->geometry.plane_count;
    arrangement->geometry.planes = NULL;
    complex->predicates_filter = arrangement->geometry.decided_by_filter;
    complex->predicates_exact = arrangement->geometry.decided_exactly;
    return ENF_OK;
}
