// SPDX-License-Identifier: GPL-3.0-or-later
// Most polygons of a finely drawn world are facets of the triangulation already, or tiled by a few: they are
// looked up. Candidates for the others by flooding: the tetrahedra that a polygon touches are connected
// through their facets, so a walk that starts at one of its corners and enters every neighbour that may touch
// it finds them all, in time proportional to what it finds.
#include "build/arrangement.h"

#include "base/array.h"
#include "base/parallel.h"
#include "base/wide.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void enf_arrangement_free(enf_arrangement *arrangement) {
    enf_tet_mesh_free(&arrangement->tets);
    free(arrangement->geometry.planes);
    free(arrangement->geometry.filters);
    free(arrangement->polygon_plane);
    free(arrangement->polygon_flipped);
    free(arrangement->candidate_offset);
    free(arrangement->candidates);
    memset(arrangement, 0, sizeof *arrangement);
}

// ---------------------------------------------------------------------------------------------- planes

static bool same_plane(enf_geometry *geometry, int32_t plane, const int32_t points[3]) {
    for (int i = 0; i < 3; i++) {
        if (enf_geometry_side(geometry, points[i], plane) != 0) return false;
    }
    return true;
}

static void add_plane(enf_geometry *geometry, int32_t a, int32_t b, int32_t c) {
    int32_t plane = geometry->plane_count++;
    geometry->planes[plane][0] = a;
    geometry->planes[plane][1] = b;
    geometry->planes[plane][2] = c;
    enf_geometry_set_plane(geometry, plane);
}

/// One plane for all polygons that lie in it. Buckets may tell equal planes apart (that costs time later,
/// nothing else: the exact tests still see that they coincide); they are joined only if they are exactly
/// equal.
static bool add_polygon_planes(enf_arrangement *arrangement) {
    const enf_mesh *mesh = arrangement->mesh;
    enf_geometry *geometry = &arrangement->geometry;
    size_t slots = 16;
    while (slots < 2 * mesh->polygon_count) slots *= 2;
    int32_t *table = enf_array_new(slots, sizeof *table);
    uint64_t *bucket_of = enf_array_new(mesh->polygon_count, sizeof *bucket_of); // by plane made
    if (!table || !bucket_of) {
        free(table);
        free(bucket_of);
        return false;
    }
    for (size_t i = 0; i < slots; i++) table[i] = -1;
    int32_t first = geometry->plane_count;
    for (size_t p = 0; p < mesh->polygon_count; p++) {
        const int32_t *points = mesh->polygon_plane[p];
        add_plane(geometry, points[0], points[1], points[2]);
        int32_t plane = geometry->plane_count - 1, found = -1;
        uint64_t bucket = enf_geometry_plane_bucket(geometry, plane);
        size_t slot = bucket & (slots - 1);
        for (; table[slot] >= 0; slot = (slot + 1) & (slots - 1)) {
            if (bucket_of[table[slot] - first] == bucket && same_plane(geometry, table[slot], points)) {
                found = table[slot];
                break;
            }
        }
        if (found >= 0) {
            geometry->plane_count--;
            arrangement->polygon_flipped[p] = !enf_geometry_same_way(geometry, plane, found);
            arrangement->polygon_plane[p] = found;
        } else {
            table[slot] = plane;
            bucket_of[plane - first] = bucket;
            arrangement->polygon_plane[p] = plane;
            arrangement->polygon_flipped[p] = false;
        }
    }
    free(table);
    free(bucket_of);
    return true;
}

/// The plane through each polygon edge, along the axis that the polygon faces most: never parallel to the
/// polygon.
static void add_edge_planes(enf_arrangement *arrangement) {
    const enf_mesh *mesh = arrangement->mesh;
    arrangement->edge_plane_first = arrangement->geometry.plane_count;
    for (size_t p = 0; p < mesh->polygon_count; p++) {
        int sign;
        int axis = enf_geometry_dominant_axis(&arrangement->geometry, mesh->polygon_plane[p], &sign);
        int64_t begin = mesh->polygon_corner[p], end = mesh->polygon_corner[p + 1];
        for (int64_t c = begin; c < end; c++) {
            int32_t from = mesh->corners[c], to = mesh->corners[c + 1 < end ? c + 1 : begin];
            // normal = (to - from) x axis points out of the polygon where its normal's component is positive
            add_plane(&arrangement->geometry, sign > 0 ? from : to, sign > 0 ? to : from, -1 - axis);
        }
    }
}

static bool make_planes(enf_arrangement *arrangement) {
    const enf_mesh *mesh = arrangement->mesh;
    enf_geometry *geometry = &arrangement->geometry;
    geometry->points = mesh->points;
    geometry->point_count = (int32_t)mesh->point_count;
    size_t most = (size_t)arrangement->tets.facet_count + mesh->polygon_count + 1 +
                  (size_t)mesh->polygon_corner[mesh->polygon_count];
    arrangement->polygon_plane = enf_array_new(mesh->polygon_count, sizeof *arrangement->polygon_plane);
    arrangement->polygon_flipped = enf_array_new(mesh->polygon_count, sizeof *arrangement->polygon_flipped);
    geometry->planes = enf_array_new(most, sizeof *geometry->planes);
    geometry->filters = enf_array_new(most, sizeof *geometry->filters);
    if (!arrangement->polygon_plane || !arrangement->polygon_flipped || !geometry->planes ||
        !geometry->filters) {
        return false;
    }
    for (int32_t f = 0; f < arrangement->tets.facet_count; f++) {
        const int32_t *corner = arrangement->tets.facet_corners[f];
        add_plane(geometry, corner[0], corner[1], corner[2]);
    }
    if (!add_polygon_planes(arrangement)) return false;
    add_edge_planes(arrangement);
    return true;
}

// ---------------------------------------------------------------------------------------------- candidates

typedef struct found {
    int32_t tetrahedron;
    enf_candidate candidate;
} found;

enum { BLOCK = 256 }; ///< polygons a job

typedef struct flood_block {
    found *found;
    size_t count, capacity;
} flood_block;

typedef struct flood_worker {
    enf_geometry geometry; ///< for its counters
    int32_t *stamp;        ///< per tetrahedron: the last polygon + 1 that tested it
    int32_t *point_stamp;  ///< per point: the last polygon + 1 whose plane it was held against
    int8_t *point_side;    ///< and the answer
    int32_t *stack;
    size_t capacity;
    bool failed;
} flood_worker;

typedef struct flood {
    const enf_arrangement *arrangement;
    flood_block *blocks;
    flood_worker *workers;
} flood;

typedef struct box {
    double low[3], high[3];
} box;

typedef enum contact {
    CONTACT_NONE,  ///< apart
    CONTACT_TOUCH, ///< they may share boundary points, but no inner point of the tetrahedron
    CONTACT_ENTER, ///< the polygon may reach inside
} contact;

static contact box_contact(const box *box, const double *points, const int32_t corner[4]) {
    contact found = CONTACT_ENTER;
    for (int i = 0; i < 3; i++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int k = 0; k < 4; k++) {
            double x = points[3 * (size_t)corner[k] + (size_t)i];
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        if (high < box->low[i] || low > box->high[i]) return CONTACT_NONE;
        if (high == box->low[i] || low == box->high[i]) found = CONTACT_TOUCH;
    }
    return found;
}

static box polygon_box(const enf_mesh *mesh, size_t polygon) {
    box out;
    for (int i = 0; i < 3; i++) {
        out.low[i] = HUGE_VAL;
        out.high[i] = -HUGE_VAL;
    }
    for (int64_t c = mesh->polygon_corner[polygon]; c < mesh->polygon_corner[polygon + 1]; c++) {
        const double *x = mesh->points + 3 * (size_t)mesh->corners[c];
        for (int i = 0; i < 3; i++) {
            out.low[i] = fmin(out.low[i], x[i]);
            out.high[i] = fmax(out.high[i], x[i]);
        }
    }
    return out;
}

/// By the polygon's edge planes: one that has the whole tetrahedron outside, or none of it strictly inside.
static contact edge_contact(flood_worker *worker, const enf_arrangement *arrangement, size_t polygon,
                            const int32_t corner[4]) {
    const enf_mesh *mesh = arrangement->mesh;
    contact found = CONTACT_ENTER;
    for (int64_t c = mesh->polygon_corner[polygon]; c < mesh->polygon_corner[polygon + 1]; c++) {
        int32_t plane = arrangement->edge_plane_first + (int32_t)c;
        bool on = false, inside = false;
        for (int k = 0; k < 4 && !inside; k++) {
            int side = enf_geometry_side(&worker->geometry, corner[k], plane);
            on |= side == 0;
            inside = side < 0;
        }
        if (!inside && !on) return CONTACT_NONE;
        if (!inside) found = CONTACT_TOUCH;
    }
    return found;
}

/// The side of the polygon's plane on which a point lies; asked once for all the tetrahedra around the point.
static int side_of_plane(flood_worker *worker, const enf_arrangement *arrangement, size_t polygon,
                         int32_t point) {
    const int32_t mark = (int32_t)polygon + 1;
    if (worker->point_stamp[point] != mark) {
        worker->point_stamp[point] = mark;
        worker->point_side[point] =
            (int8_t)enf_geometry_side(&worker->geometry, point, arrangement->polygon_plane[polygon]);
    }
    return worker->point_side[point];
}

/// How the polygon meets a tetrahedron: -2 not at all, -1 it may touch it, else as enf_candidate.how.
static int meets(flood_worker *worker, const enf_arrangement *arrangement, size_t polygon, const box *box,
                 const int32_t corner[4]) {
    contact boxes = box_contact(box, arrangement->mesh->points, corner);
    if (boxes == CONTACT_NONE) return -2;
    int behind = 0, front = 0, off = -1;
    for (int k = 0; k < 4; k++) {
        int sign = side_of_plane(worker, arrangement, polygon, corner[k]);
        behind += sign < 0;
        front += sign > 0;
        if (sign != 0) off = k;
    }
    if (behind == 4 || front == 4) return -2;
    bool across = behind && front;
    if (across ? boxes == CONTACT_TOUCH : behind + front != 1) return -1;
    switch (edge_contact(worker, arrangement, polygon, corner)) {
    case CONTACT_NONE:
        return -2;
    case CONTACT_TOUCH:
        return -1;
    default:
        return across ? ENF_MEETS_ACROSS : off;
    }
}

static bool owns_facet(const enf_tet_mesh *tets, int32_t tetrahedron, int k) {
    const int32_t *sides = tets->facet_sides[tets->facets[tetrahedron][k]];
    return sides[0] == tetrahedron || sides[0] < 0;
}

enum { FACETED_CORNERS_MAX = 16 }; ///< polygons with more are flooded at once

/// The facets that tile the polygon, where the triangulation carries it already: facets do not overlap, so
/// there is at most one way to triangulate it with them, and the facet at each edge is found by trying all
/// apexes. Returns their number (corners - 2), or 0 if they do not tile it.
static int tiling_facets(const enf_arrangement *arrangement, size_t polygon, int32_t *facets) {
    const enf_mesh *mesh = arrangement->mesh;
    const int32_t *corner = mesh->corners + mesh->polygon_corner[polygon];
    int corners = (int)(mesh->polygon_corner[polygon + 1] - mesh->polygon_corner[polygon]), count = 0;
    if (corners > FACETED_CORNERS_MAX) return 0;
    struct {
        int first, last;
    } stack[FACETED_CORNERS_MAX] = {{0, corners - 1}}; // chains of corners still to be closed by a facet
    for (int depth = 1; depth > 0;) {
        int first = stack[--depth].first, last = stack[depth].last, apex = first + 1;
        int32_t facet = -1;
        for (; apex < last; apex++) {
            facet = enf_tet_mesh_facet(&arrangement->tets, corner[first], corner[apex], corner[last]);
            if (facet >= 0) break;
        }
        if (facet < 0) return 0;
        facets[count++] = facet;
        if (apex > first + 1) {
            stack[depth].first = first;
            stack[depth++].last = apex;
        }
        if (last > apex + 1) {
            stack[depth].first = apex;
            stack[depth++].last = last;
        }
    }
    return count;
}

static bool add_found(flood_block *block, int32_t tetrahedron, int32_t polygon, int how) {
    if (!enf_array_reserve(block->found, block->capacity, block->count + 1)) return false;
    block->found[block->count++] = (found){tetrahedron, {polygon, how}};
    return true;
}

/// A polygon that facets tile crosses nothing: it covers them, and that is all.
static bool add_faceted(const enf_tet_mesh *tets, flood_block *block, size_t polygon, const int32_t *facets,
                        int facet_count) {
    for (int i = 0; i < facet_count; i++) {
        const int32_t *sides = tets->facet_sides[facets[i]];
        int32_t owner = sides[0] >= 0 ? sides[0] : sides[1];
        int k = 0;
        while (tets->facets[owner][k] != facets[i]) k++;
        if (!add_found(block, owner, (int32_t)polygon, k)) return false;
    }
    return true;
}

static bool flood_polygon(const enf_arrangement *arrangement, flood_worker *worker, flood_block *block,
                          size_t polygon) {
    const enf_mesh *mesh = arrangement->mesh;
    const enf_tet_mesh *tets = &arrangement->tets;
    const box box = polygon_box(mesh, polygon);
    const int32_t mark = (int32_t)polygon + 1;
    int32_t start = tets->point_tetrahedron[mesh->corners[mesh->polygon_corner[polygon]]];
    size_t depth = 0;
    if (!enf_array_reserve(worker->stack, worker->capacity, 1)) return false;
    worker->stamp[start] = mark;
    worker->stack[depth++] = start;
    while (depth > 0) {
        int32_t t = worker->stack[--depth];
        int how = meets(worker, arrangement, polygon, &box, tets->corners[t]);
        if (how == -2) continue;
        if (how == ENF_MEETS_ACROSS || (how >= 0 && owns_facet(tets, t, how))) {
            if (!add_found(block, t, (int32_t)polygon, how)) return false;
        }
        if (!enf_array_reserve(worker->stack, worker->capacity, depth + 4)) return false;
        for (int k = 0; k < 4; k++) {
            const int32_t *sides = tets->facet_sides[tets->facets[t][k]];
            int32_t next = sides[0] == t ? sides[1] : sides[0];
            if (next < 0 || worker->stamp[next] == mark) continue;
            worker->stamp[next] = mark;
            worker->stack[depth++] = next;
        }
    }
    return true;
}

static void flood_job(void *user, int32_t index, int thread) {
    flood *all = user;
    flood_worker *worker = &all->workers[thread];
    size_t end = ((size_t)index + 1) * BLOCK;
    if (end > all->arrangement->mesh->polygon_count) end = all->arrangement->mesh->polygon_count;
    for (size_t p = (size_t)index * BLOCK; p < end && !worker->failed; p++) {
        int32_t facets[FACETED_CORNERS_MAX];
        int tiling = tiling_facets(all->arrangement, p, facets);
        bool good = tiling ? add_faceted(&all->arrangement->tets, &all->blocks[index], p, facets, tiling)
                           : flood_polygon(all->arrangement, worker, &all->blocks[index], p);
        if (!good) worker->failed = true;
    }
}

/// Sorts what was found by tetrahedron; within one, polygons stay ascending.
static bool sort_candidates(enf_arrangement *arrangement, const flood_block *blocks, int32_t block_count) {
    size_t tets = (size_t)arrangement->tets.count, total = 0;
    for (int32_t b = 0; b < block_count; b++) total += blocks[b].count;
    int64_t *offset = arrangement->candidate_offset = enf_array_zeroed(tets + 2, sizeof *offset);
    arrangement->candidates = enf_array_new(total, sizeof *arrangement->candidates);
    if (!offset || !arrangement->candidates) return false;
    for (int32_t b = 0; b < block_count; b++) {
        for (size_t i = 0; i < blocks[b].count; i++) offset[blocks[b].found[i].tetrahedron + 2]++;
    }
    for (size_t t = 0; t < tets; t++) offset[t + 2] += offset[t + 1];
    for (int32_t b = 0; b < block_count; b++) {
        for (size_t i = 0; i < blocks[b].count; i++) {
            const found *f = &blocks[b].found[i];
            arrangement->candidates[offset[f->tetrahedron + 1]++] = f->candidate;
        }
    }
    return true;
}

static bool find_candidates(enf_arrangement *arrangement, const enf_crew *crew, bool *stopped) {
    int threads = crew->threads;
    int32_t block_count = (int32_t)((arrangement->mesh->polygon_count + BLOCK - 1) / BLOCK);
    flood all = {.arrangement = arrangement,
                 .blocks = enf_array_zeroed((size_t)block_count, sizeof *all.blocks),
                 .workers = enf_array_zeroed((size_t)threads, sizeof *all.workers)};
    bool good = all.blocks && all.workers;
    for (int w = 0; good && w < threads; w++) {
        all.workers[w].geometry = arrangement->geometry;
        all.workers[w].geometry.decided_by_filter = all.workers[w].geometry.decided_exactly = 0;
        all.workers[w].stamp = enf_array_zeroed((size_t)arrangement->tets.count, sizeof(int32_t));
        all.workers[w].point_stamp = enf_array_zeroed(arrangement->mesh->point_count, sizeof(int32_t));
        all.workers[w].point_side = enf_array_new(arrangement->mesh->point_count, sizeof(int8_t));
        good = all.workers[w].stamp && all.workers[w].point_stamp && all.workers[w].point_side;
    }
    if (good) {
        *stopped = !enf_parallel_for(crew, block_count, flood_job, &all);
        for (int w = 0; w < threads; w++) good = good && !all.workers[w].failed;
        good = good && sort_candidates(arrangement, all.blocks, block_count);
    }
    for (int w = 0; all.workers && w < threads; w++) {
        arrangement->geometry.decided_by_filter += all.workers[w].geometry.decided_by_filter;
        arrangement->geometry.decided_exactly += all.workers[w].geometry.decided_exactly;
        free(all.workers[w].stamp);
        free(all.workers[w].point_stamp);
        free(all.workers[w].point_side);
        free(all.workers[w].stack);
    }
    for (int32_t b = 0; all.blocks && b < block_count; b++) free(all.blocks[b].found);
    free(all.blocks);
    free(all.workers);
    return good;
}

enf_status enf_arrangement_make(enf_arrangement *arrangement, const enf_mesh *mesh, enf_tet_mesh tets,
                                const enf_crew *crew, enf_error *error) {
    memset(arrangement, 0, sizeof *arrangement);
    arrangement->mesh = mesh;
    arrangement->tets = tets;
    bool stopped = false;
    bool good = make_planes(arrangement) && find_candidates(arrangement, crew, &stopped);
    if (!good || stopped) {
        enf_arrangement_free(arrangement);
        return good ? enf_fail(error, ENF_NO_RESOURCES, "cancelled")
                    : enf_fail_memory(error, "the polygons' candidates");
    }
    free(arrangement->tets.facet_table); // for looking polygons up; not needed any more
    arrangement->tets.facet_table = NULL;
    return ENF_OK;
}
