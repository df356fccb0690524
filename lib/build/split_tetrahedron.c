// SPDX-License-Identifier: GPL-3.0-or-later
// The split of the thesis (4.2.1) done exactly: each polygon is first clipped to the tetrahedron and then
// only cuts the cells that its clipped piece really enters, as in a small BSP tree (Fuchs, Kedem and Naylor
// 1980) whose planes are the polygons' own. The next cut is the one that splits the fewest other pieces.
#include "build/split_tetrahedron.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

typedef struct face {
    enf_loop loop;
    int32_t facet; ///< as in enf_split_block
    uint8_t side;
} face;

typedef struct piece {
    enf_loop loop; ///< counter-clockwise seen from the front of its plane
    int32_t polygon;
} piece;

/// A cell still to be cut by its pieces, and where in the tree it hangs.
typedef struct job {
    size_t face_first, face_count;
    size_t piece_first, piece_count;
    int32_t parent; ///< node, or -1: the root
    int child;
} job;

typedef struct segment {
    int32_t from, to, plane;
} segment;

struct enf_splitter {
    const enf_arrangement *arrangement;
    enf_pool pool;
    face *faces;
    size_t face_count, face_capacity;
    piece *pieces;
    size_t piece_count, piece_capacity;
    job *jobs;
    size_t job_count, job_capacity;
    segment *segments;
    size_t segment_count, segment_capacity;
};

enf_splitter *enf_splitter_new(const enf_arrangement *arrangement) {
    enf_splitter *splitter = calloc(1, sizeof *splitter);
    if (!splitter) return NULL;
    splitter->arrangement = arrangement;
    splitter->pool.geometry = arrangement->geometry;
    splitter->pool.geometry.decided_by_filter = splitter->pool.geometry.decided_exactly = 0;
    return splitter;
}

void enf_splitter_free(enf_splitter *splitter) {
    if (!splitter) return;
    enf_pool_free(&splitter->pool);
    free(splitter->faces);
    free(splitter->pieces);
    free(splitter->jobs);
    free(splitter->segments);
    free(splitter);
}

void enf_splitter_counts(const enf_splitter *splitter, uint64_t *filter, uint64_t *exact) {
    *filter += splitter->pool.geometry.decided_by_filter;
    *exact += splitter->pool.geometry.decided_exactly;
}

void enf_split_block_free(enf_split_block *block) {
    free(block->crossings);
    free(block->root);
    free(block->node_child);
    free(block->node_plane);
    free(block->cell_tetrahedron);
    free(block->cell_face);
    enf_loops_free(&block->faces);
    free(block->face_facet);
    free(block->face_side);
    enf_loops_free(&block->covers);
    free(block->cover_facet);
    free(block->cover_polygon);
    free(block->cover_side);
    memset(block, 0, sizeof *block);
}

static void add_face(enf_splitter *splitter, face added) {
    if (!enf_array_reserve(splitter->faces, splitter->face_capacity, splitter->face_count + 1)) {
        splitter->pool.failed = true;
        return;
    }
    splitter->faces[splitter->face_count++] = added;
}

static void add_piece(enf_splitter *splitter, piece added) {
    if (!enf_array_reserve(splitter->pieces, splitter->piece_capacity, splitter->piece_count + 1)) {
        splitter->pool.failed = true;
        return;
    }
    splitter->pieces[splitter->piece_count++] = added;
}

static void add_segment(enf_splitter *splitter, segment added) {
    if (!enf_array_reserve(splitter->segments, splitter->segment_capacity, splitter->segment_count + 1)) {
        splitter->pool.failed = true;
        return;
    }
    splitter->segments[splitter->segment_count++] = added;
}

static void add_job(enf_splitter *splitter, job added) {
    if (!enf_array_reserve(splitter->jobs, splitter->job_capacity, splitter->job_count + 1)) {
        splitter->pool.failed = true;
        return;
    }
    splitter->jobs[splitter->job_count++] = added;
}

// ---------------------------------------------------------------------------------------------- setting out

/// The face opposite corner k as a loop: facet corners ascending turn counter-clockwise seen from the front.
static face tetrahedron_face(enf_splitter *splitter, int32_t t, int k) {
    const enf_tet_mesh *tets = &splitter->arrangement->tets;
    int32_t facet = tets->facets[t][k];
    enf_corner corners[3];
    for (int i = 0; i < 3; i++) {
        corners[i].vertex = tets->facet_corners[facet][i];
        // The edge to the next corner lies on the face opposite the third one.
        int32_t third = tets->facet_corners[facet][(i + 2) % 3];
        int opposite = 0;
        while (tets->corners[t][opposite] != third) opposite++;
        corners[i].edge_plane = tets->facets[t][opposite];
    }
    enf_loop loop = enf_pool_loop(&splitter->pool, facet, corners, 3);
    return (face){loop, facet, tets->facet_sides[facet][1] == t};
}

/// The whole polygon on its plane, counter-clockwise seen from the plane's front.
static enf_loop polygon_loop(enf_splitter *splitter, int32_t polygon) {
    const enf_arrangement *arrangement = splitter->arrangement;
    const enf_mesh *mesh = arrangement->mesh;
    enf_pool *pool = &splitter->pool;
    int64_t begin = mesh->polygon_corner[polygon], end = mesh->polygon_corner[polygon + 1];
    enf_loop loop = {arrangement->polygon_plane[polygon], (int32_t)pool->corner_count,
                     (int32_t)(end - begin)};
    if (!enf_array_reserve(pool->corners, pool->corner_capacity, pool->corner_count + (size_t)loop.count)) {
        pool->failed = true;
        return (enf_loop){0};
    }
    for (int64_t c = begin; c < end; c++) {
        pool->corners[pool->corner_count++] =
            (enf_corner){mesh->corners[c], arrangement->edge_plane_first + (int32_t)c};
    }
    return arrangement->polygon_flipped[polygon] ? enf_pool_reversed(pool, loop) : loop;
}

/// Clips the loop to the tetrahedron by all its faces but `skip` (-1: none).
static bool clip_to_tetrahedron(enf_splitter *splitter, int32_t t, int skip, enf_loop *loop) {
    const enf_tet_mesh *tets = &splitter->arrangement->tets;
    for (int k = 0; k < 4; k++) {
        if (k == skip) continue;
        int32_t facet = tets->facets[t][k];
        int side = tets->facet_sides[facet][1] == t ? 1 : -1;
        if (!enf_pool_keep(&splitter->pool, loop, facet, side)) return false;
    }
    return true;
}

static int32_t take_vertex(const enf_splitter *splitter, const enf_split_block *block, int32_t vertex) {
    return vertex < splitter->pool.geometry.point_count ? vertex : vertex + (int32_t)block->crossing_count;
}

/// Appends a loop to the block's loops, with vertices renumbered to the block's.
static bool append_loop(enf_splitter *splitter, const enf_split_block *block, enf_loops *loops,
                        enf_loop loop) {
    if (!enf_loops_append(loops, splitter->pool.corners + loop.first, loop.count)) return false;
    enf_corner *corners = loops->corners + loops->offset[loops->count - 1];
    for (int32_t i = 0; i < loop.count; i++) {
        corners[i].vertex = take_vertex(splitter, block, corners[i].vertex);
    }
    return true;
}

static bool add_cover(enf_splitter *splitter, enf_split_block *block, enf_loop loop, int32_t facet,
                      int32_t facet_plane, int32_t polygon) {
    const enf_arrangement *arrangement = splitter->arrangement;
    bool opposite =
        loop.plane != facet_plane && !enf_geometry_same_way(&arrangement->geometry, loop.plane, facet_plane);
    if (opposite) loop = enf_pool_reversed(&splitter->pool, loop);
    size_t count = (size_t)block->covers.count + 1;
    if (!enf_array_reserve(block->cover_facet, block->cover_facet_capacity, count) ||
        !enf_array_reserve(block->cover_polygon, block->cover_polygon_capacity, count) ||
        !enf_array_reserve(block->cover_side, block->cover_side_capacity, count) ||
        !append_loop(splitter, block, &block->covers, loop)) {
        return false;
    }
    block->cover_facet[count - 1] = facet;
    block->cover_polygon[count - 1] = polygon;
    block->cover_side[count - 1] = opposite == arrangement->polygon_flipped[polygon];
    return true;
}

/// Polygons in the plane of a face cover part of it; polygons across leave a piece inside.
static bool take_candidates(enf_splitter *splitter, enf_split_block *block, int32_t t) {
    const enf_arrangement *arrangement = splitter->arrangement;
    for (int64_t i = arrangement->candidate_offset[t]; i < arrangement->candidate_offset[t + 1]; i++) {
        enf_candidate candidate = arrangement->candidates[i];
        enf_loop loop = polygon_loop(splitter, candidate.polygon);
        int skip = candidate.how == ENF_MEETS_ACROSS ? -1 : candidate.how;
        if (splitter->pool.failed || !clip_to_tetrahedron(splitter, t, skip, &loop)) continue;
        if (skip < 0) {
            add_piece(splitter, (piece){loop, candidate.polygon});
        } else {
            int32_t facet = arrangement->tets.facets[t][skip];
            if (!add_cover(splitter, block, loop, facet, facet, candidate.polygon)) return false;
        }
    }
    return !splitter->pool.failed;
}

// ---------------------------------------------------------------------------------------------- choosing

enum { CHOICES_MAX = 16 }; ///< pieces that are tried as the next cut

static bool coplanar(enf_splitter *splitter, piece one, int32_t plane) {
    return one.loop.plane == plane || enf_pool_classify(&splitter->pool, one.loop, plane) == ENF_POSITION_ON;
}

/// The piece whose plane splits the fewest others; among equals the one whose plane holds the most, then the
/// first.
static size_t choose(enf_splitter *splitter, const job *job) {
    const piece *pieces = splitter->pieces + job->piece_first;
    size_t best = 0, best_split = SIZE_MAX, best_held = 0;
    for (size_t i = 0; i < job->piece_count && i < CHOICES_MAX; i++) {
        size_t split = 0, held = 0;
        for (size_t k = 0; k < job->piece_count && split <= best_split; k++) {
            if (pieces[k].loop.plane == pieces[i].loop.plane) {
                held++;
                continue;
            }
            switch (enf_pool_classify(&splitter->pool, pieces[k].loop, pieces[i].loop.plane)) {
            case ENF_POSITION_ACROSS:
                split++;
                break;
            case ENF_POSITION_ON:
                held++;
                break;
            default:
                break;
            }
        }
        if (split < best_split || (split == best_split && held > best_held)) {
            best = i;
            best_split = split;
            best_held = held;
        }
    }
    return best;
}

// ---------------------------------------------------------------------------------------------- cutting

/// The new face's edge where the cut leaves face `f`: counter-clockwise seen from the front of the cut.
static void add_cut_segment(enf_splitter *splitter, face f, int32_t entry, int32_t exit) {
    segment added = {f.side == 0 ? entry : exit, f.side == 0 ? exit : entry, f.loop.plane};
    add_segment(splitter, added);
}

/// A face wholly behind the cut may have an edge on it: that edge bounds the new face.
static void add_touching_edge(enf_splitter *splitter, face f) {
    const enf_corner *corners = splitter->pool.corners + f.loop.first;
    const int8_t *signs = splitter->pool.signs;
    for (int32_t i = 0; i < f.loop.count; i++) {
        int32_t next = i + 1 < f.loop.count ? i + 1 : 0;
        if (signs[i] == 0 && signs[next] == 0) {
            add_cut_segment(splitter, f, corners[next].vertex, corners[i].vertex);
            return;
        }
    }
}

/// A face across the cut: its behind part has an edge along the cut, from where the face's outline goes to
/// the front (exit) to where it comes back (entry), in the part's own order.
static void add_crossing_segment(enf_splitter *splitter, face f, enf_loop behind, int32_t plane) {
    const enf_corner *corners = splitter->pool.corners + behind.first;
    for (int32_t i = 0; i < behind.count; i++) {
        if (corners[i].edge_plane != plane) continue;
        int32_t next = i + 1 < behind.count ? i + 1 : 0;
        add_cut_segment(splitter, f, corners[next].vertex, corners[i].vertex);
        return;
    }
}

enum { FRONT_MARK = 2 }; ///< in face.side, until order_faces has sorted the faces of the two new cells apart

/// Cuts every face of the cell, once each so that both parts share their new vertices, and appends the parts
/// behind and (marked) in front. Leaves the new face's edges in `segments`.
static void cut_faces(enf_splitter *splitter, const job *cell, int32_t plane, size_t *behind_count,
                      size_t *front_count) {
    enf_pool *pool = &splitter->pool;
    size_t base = splitter->face_count;
    pool->cut_count = 0;
    pool->share_cut = true;
    splitter->segment_count = 0;
    for (size_t i = 0; i < cell->face_count && !pool->failed; i++) {
        face f = splitter->faces[cell->face_first + i], behind = f, front = f;
        enf_position position = enf_pool_classify(pool, f.loop, plane);
        if (position == ENF_POSITION_ACROSS) {
            enf_pool_cut(pool, f.loop, plane, &behind.loop, &front.loop);
            add_crossing_segment(splitter, f, behind.loop, plane);
        } else if (position == ENF_POSITION_BEHIND) {
            add_touching_edge(splitter, f);
        }
        if (position != ENF_POSITION_FRONT) add_face(splitter, behind);
        if (position == ENF_POSITION_FRONT || position == ENF_POSITION_ACROSS) {
            front.side |= FRONT_MARK;
            add_face(splitter, front);
        }
    }
    pool->share_cut = false;
    *behind_count = *front_count = 0;
    for (size_t i = base; i < splitter->face_count; i++) {
        if (splitter->faces[i].side & FRONT_MARK) {
            (*front_count)++;
        } else {
            (*behind_count)++;
        }
    }
}

/// The cut itself, as a loop counter-clockwise seen from the front of the plane: the segments chained.
static enf_loop cut_loop(enf_splitter *splitter, int32_t plane) {
    enf_pool *pool = &splitter->pool;
    enf_loop loop = {plane, (int32_t)pool->corner_count, 0};
    size_t count = splitter->segment_count;
    if (count < 3 || !enf_array_reserve(pool->corners, pool->corner_capacity, pool->corner_count + count)) {
        pool->failed = true;
        return loop;
    }
    segment at = splitter->segments[0];
    for (size_t i = 0; i < count; i++) {
        pool->corners[pool->corner_count++] = (enf_corner){at.from, at.plane};
        loop.count++;
        size_t k = 0;
        while (k < count && splitter->segments[k].from != at.to) k++;
        if (k == count) {
            pool->failed = true;
            return loop;
        }
        at = splitter->segments[k];
    }
    return loop;
}

/// Orders the new faces: all of the behind cell with its new face, then all of the front cell with its.
static bool order_faces(enf_splitter *splitter, size_t base, size_t behind_count, size_t front_count,
                        face cut) {
    size_t count = behind_count + front_count;
    if (!enf_array_reserve(splitter->faces, splitter->face_capacity, base + 2 * count + 2)) return false;
    face *source = splitter->faces + base, *sorted = source + count;
    size_t b = 0, f = behind_count + 1;
    for (size_t i = 0; i < count; i++) {
        face moved = source[i];
        bool front = moved.side & FRONT_MARK;
        moved.side &= 1;
        sorted[front ? f++ : b++] = moved;
    }
    cut.side = 0;
    sorted[behind_count] = cut;
    cut.side = 1;
    sorted[f] = cut;
    memmove(source, sorted, (count + 2) * sizeof *source);
    splitter->face_count = base + count + 2;
    return true;
}

// ---------------------------------------------------------------------------------------------- the tree

static void hang(enf_split_block *block, const job *job, int32_t what) {
    if (job->parent < 0) {
        block->root[block->root_count - 1] = what;
    } else {
        block->node_child[job->parent][job->child] = what;
    }
}

static bool emit_cell(enf_splitter *splitter, enf_split_block *block, const job *job, int32_t t) {
    size_t cell = block->cell_count;
    if (!enf_array_reserve(block->cell_tetrahedron, block->cell_tetrahedron_capacity, cell + 1) ||
        !enf_array_reserve(block->cell_face, block->cell_face_capacity, cell + 1)) {
        return false;
    }
    block->cell_tetrahedron[cell] = t;
    block->cell_face[cell] = block->faces.count;
    block->cell_count++;
    for (size_t i = 0; i < job->face_count; i++) {
        face f = splitter->faces[job->face_first + i];
        size_t count = (size_t)block->faces.count + 1;
        if (!enf_array_reserve(block->face_facet, block->face_facet_capacity, count) ||
            !enf_array_reserve(block->face_side, block->face_side_capacity, count) ||
            !append_loop(splitter, block, &block->faces, f.loop)) {
            return false;
        }
        block->face_facet[count - 1] = f.facet;
        block->face_side[count - 1] = f.side;
    }
    hang(block, job, -1 - (int32_t)cell);
    return true;
}

/// Pieces on the cut cover it; the others go to the cell behind (kept as they are) or in front (after them).
static bool deal_pieces(enf_splitter *splitter, enf_split_block *block, const job *job, int32_t plane,
                        int32_t cut, size_t *behind_count, size_t *front_count) {
    enf_pool *pool = &splitter->pool;
    size_t base = splitter->piece_count;
    *behind_count = *front_count = 0;
    for (int pass = -1; pass <= 1; pass += 2) {
        for (size_t i = 0; i < job->piece_count; i++) {
            piece one = splitter->pieces[job->piece_first + i];
            if (coplanar(splitter, one, plane)) {
                if (pass < 0 && !add_cover(splitter, block, one.loop, -1 - cut, plane, one.polygon))
                    return false;
                continue;
            }
            if (enf_pool_keep(pool, &one.loop, plane, pass)) add_piece(splitter, one);
        }
        *(pass < 0 ? behind_count : front_count) = splitter->piece_count - base;
    }
    *front_count -= *behind_count;
    return !pool->failed;
}

static bool cut_cell(enf_splitter *splitter, enf_split_block *block, job job_here) {
    size_t node = block->node_count;
    if (!enf_array_reserve(block->node_child, block->node_child_capacity, node + 1) ||
        !enf_array_reserve(block->node_plane, block->node_plane_capacity, node + 1)) {
        return false;
    }
    size_t chosen = choose(splitter, &job_here);
    int32_t plane = splitter->pieces[job_here.piece_first + chosen].loop.plane;
    block->node_plane[node] = plane;
    block->node_count++;
    hang(block, &job_here, (int32_t)node);

    size_t faces_behind, faces_front, pieces_behind, pieces_front;
    size_t face_base = splitter->face_count, piece_base = splitter->piece_count;
    cut_faces(splitter, &job_here, plane, &faces_behind, &faces_front);
    if (splitter->pool.failed) return false;
    face cut = {cut_loop(splitter, plane), -1 - (int32_t)node, 0};
    if (splitter->pool.failed || !order_faces(splitter, face_base, faces_behind, faces_front, cut))
        return false;
    if (!deal_pieces(splitter, block, &job_here, plane, (int32_t)node, &pieces_behind, &pieces_front))
        return false;
    size_t face_front = face_base + faces_behind + 1;
    add_job(splitter,
            (job){face_front, faces_front + 1, piece_base + pieces_behind, pieces_front, (int32_t)node, 1});
    add_job(splitter, (job){face_base, faces_behind + 1, piece_base, pieces_behind, (int32_t)node, 0});
    return !splitter->pool.failed;
}

static bool take_crossings(enf_splitter *splitter, enf_split_block *block) {
    const enf_geometry *geometry = &splitter->pool.geometry;
    size_t added = (size_t)geometry->crossing_count;
    if (!enf_array_reserve(block->crossings, block->crossing_capacity, block->crossing_count + added))
        return false;
    if (added) {
        memcpy(block->crossings + block->crossing_count, geometry->crossings,
               added * sizeof *block->crossings);
    }
    block->crossing_count += added;
    return true;
}

bool enf_splitter_cut(enf_splitter *splitter, enf_split_block *block, int32_t t) {
    enf_pool_empty(&splitter->pool);
    splitter->face_count = splitter->piece_count = splitter->job_count = 0;
    if (!enf_array_reserve(block->root, block->root_capacity, block->root_count + 1)) return false;
    block->root_count++;
    for (int k = 0; k < 4; k++) add_face(splitter, tetrahedron_face(splitter, t, k));
    if (!take_candidates(splitter, block, t)) return false;
    block->tetrahedra_cut += splitter->piece_count > 0;
    add_job(splitter, (job){0, 4, 0, splitter->piece_count, -1, 0});
    while (splitter->job_count > 0 && !splitter->pool.failed) {
        job next = splitter->jobs[--splitter->job_count];
        bool done =
            next.piece_count == 0 ? emit_cell(splitter, block, &next, t) : cut_cell(splitter, block, next);
        if (!done) return false;
    }
    return !splitter->pool.failed && take_crossings(splitter, block);
}
