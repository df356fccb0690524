// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/arrangement.h"

#include "base/array.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

void enf_arrangement_free(enf_arrangement *arrangement) {
    arrangement->tets.facet_corners = NULL; // the planes have them
    enf_tet_mesh_free(&arrangement->tets);
    free(arrangement->geometry.planes);
    free(arrangement->geometry.filters);
    free(arrangement->polygon_plane);
    free(arrangement->polygon_flipped);
    free(arrangement->cell_into);
    free(arrangement->hit_first);
    free(arrangement->hits);
    memset(arrangement, 0, sizeof *arrangement);
}

// ---------------------------------------------------------------------------------------------- planes

enum { BLOCK = 4096 }; ///< polygons a job

/// While the planes are made.
typedef struct plane_maker {
    enf_arrangement *arrangement;
    int32_t first;     ///< the first plane of a polygon
    uint64_t *buckets; ///< per polygon; then per plane that is kept
} plane_maker;

static bool same_plane(enf_geometry *geometry, int32_t plane, const int32_t points[3]) {
    for (int i = 0; i < 3; i++) {
        if (enf_geometry_side(geometry, points[i], plane) != 0) return false;
    }
    return true;
}

static size_t block_end(const enf_mesh *mesh, int32_t block) {
    size_t end = ((size_t)block + 1) * BLOCK;
    return end < mesh->polygon_count ? end : mesh->polygon_count;
}

/// A plane for each polygon, and what tells it from most others.
static void make_own_planes(void *user, int32_t block, int thread) {
    (void)thread;
    const plane_maker *maker = user;
    enf_geometry *geometry = &maker->arrangement->geometry;
    const enf_mesh *mesh = maker->arrangement->mesh;
    for (size_t p = (size_t)block * BLOCK; p < block_end(mesh, block); p++) {
        int32_t plane = maker->first + (int32_t)p;
        memcpy(geometry->planes[plane], mesh->polygon_plane[p], sizeof *geometry->planes);
        enf_geometry_set_plane(geometry, plane);
        maker->buckets[p] = enf_geometry_plane_bucket(geometry, plane);
    }
}

/// One plane for all polygons that lie in it. Buckets may tell equal planes apart (that costs time later,
/// nothing else: the exact tests still see that they coincide); they are joined only if they are exactly
/// equal. Those that stay move up.
static bool join_planes(const plane_maker *maker) {
    const enf_mesh *mesh = maker->arrangement->mesh;
    enf_geometry *geometry = &maker->arrangement->geometry;
    int32_t first = maker->first, kept = first;
    size_t slots = 16;
    while (slots < 2 * mesh->polygon_count) slots *= 2;
    int32_t *table = enf_array_new(slots, sizeof *table);
    if (!table) return false;
    for (size_t i = 0; i < slots; i++) table[i] = -1;
    for (size_t p = 0; p < mesh->polygon_count; p++) {
        uint64_t bucket = maker->buckets[p];
        size_t slot = bucket & (slots - 1);
        for (; table[slot] >= 0; slot = (slot + 1) & (slots - 1)) {
            if (maker->buckets[table[slot] - first] == bucket &&
                same_plane(geometry, table[slot], mesh->polygon_plane[p])) {
                break;
            }
        }
        if (table[slot] < 0) {
            table[slot] = kept;
            memcpy(geometry->planes[kept], geometry->planes[first + (int32_t)p], sizeof *geometry->planes);
            geometry->filters[kept - first] = geometry->filters[p];
            maker->buckets[kept - first] = bucket;
            kept++;
        }
        maker->arrangement->polygon_plane[p] = table[slot];
    }
    geometry->plane_count = geometry->filter_end = kept;
    free(table);
    return true;
}

/// The plane through each polygon edge, along the axis that the polygon faces most: never parallel to the
/// polygon. And whether the polygon faces the way its plane does: parallel normals are longest along the same
/// axis (of equals, the first is taken in both).
static void make_edge_planes(void *user, int32_t block, int thread) {
    (void)thread;
    const plane_maker *maker = user;
    enf_arrangement *arrangement = maker->arrangement;
    const enf_mesh *mesh = arrangement->mesh;
    enf_geometry *geometry = &arrangement->geometry;
    for (size_t p = (size_t)block * BLOCK; p < block_end(mesh, block); p++) {
        int sign, plane_sign;
        int axis = enf_geometry_dominant_axis(geometry, mesh->polygon_plane[p], &sign);
        enf_geometry_dominant_axis(geometry, geometry->planes[arrangement->polygon_plane[p]], &plane_sign);
        arrangement->polygon_flipped[p] = sign != plane_sign;
        int64_t begin = mesh->polygon_corner[p], end = mesh->polygon_corner[p + 1];
        for (int64_t c = begin; c < end; c++) {
            int32_t from = mesh->corners[c], to = mesh->corners[c + 1 < end ? c + 1 : begin];
            int32_t *plane = geometry->planes[arrangement->edge_plane_first + c];
            // normal = (to - from) x axis points out of the polygon where its normal's component is positive
            plane[0] = sign > 0 ? from : to;
            plane[1] = sign > 0 ? to : from;
            plane[2] = -1 - axis;
        }
    }
}

/// The planes of the facets are their corners: they stay where they are, and the others follow them.
static bool take_facet_planes(enf_arrangement *arrangement, size_t most) {
    enf_tet_mesh *tets = &arrangement->tets;
    void *planes = most <= SIZE_MAX / sizeof *tets->facet_corners
                       ? realloc(tets->facet_corners, most * sizeof *tets->facet_corners)
                       : NULL;
    if (planes) tets->facet_corners = planes;
    arrangement->geometry.planes = tets->facet_corners; // to be freed either way
    return planes;
}

static bool reserve_planes(enf_arrangement *arrangement) {
    const enf_mesh *mesh = arrangement->mesh;
    enf_geometry *geometry = &arrangement->geometry;
    size_t most = (size_t)arrangement->tets.facet_count + mesh->polygon_count + 1 +
                  (size_t)mesh->polygon_corner[mesh->polygon_count];
    arrangement->polygon_plane = enf_array_new(mesh->polygon_count, sizeof *arrangement->polygon_plane);
    arrangement->polygon_flipped = enf_array_new(mesh->polygon_count, sizeof *arrangement->polygon_flipped);
    geometry->filters = enf_array_new(mesh->polygon_count, sizeof *geometry->filters);
    return take_facet_planes(arrangement, most) && arrangement->polygon_plane &&
           arrangement->polygon_flipped && geometry->filters;
}

static bool make_planes(enf_arrangement *arrangement, int threads) {
    const enf_crew crew = {.threads = threads};
    const enf_mesh *mesh = arrangement->mesh;
    enf_geometry *geometry = &arrangement->geometry;
    int32_t blocks = (int32_t)((mesh->polygon_count + BLOCK - 1) / BLOCK),
            facets = arrangement->tets.facet_count;
    plane_maker maker = {.arrangement = arrangement, .first = facets};
    geometry->points = mesh->points;
    geometry->point_count = (int32_t)mesh->point_count;
    maker.buckets = enf_array_new(mesh->polygon_count, sizeof *maker.buckets);
    bool good = reserve_planes(arrangement) && maker.buckets;
    if (good) {
        geometry->filter_first = facets;
        geometry->plane_count = geometry->filter_end = facets + (int32_t)mesh->polygon_count;
        enf_parallel_for(&crew, blocks, make_own_planes, &maker);
        good = join_planes(&maker);
    }
    if (good) {
        arrangement->edge_plane_first = geometry->plane_count;
        geometry->plane_count += (int32_t)mesh->polygon_corner[mesh->polygon_count];
        enf_parallel_for(&crew, blocks, make_edge_planes, &maker);
    }
    free(maker.buckets);
    return good;
}

enf_status enf_arrangement_make(enf_arrangement *arrangement, const enf_mesh *mesh, enf_tet_mesh tets,
                                int threads, enf_error *error) {
    memset(arrangement, 0, sizeof *arrangement);
    arrangement->mesh = mesh;
    arrangement->tets = tets;
    if (make_planes(arrangement, threads)) return ENF_OK;
    enf_arrangement_free(arrangement);
    return enf_fail_memory(error, "the polygons' planes");
}
