// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/arrangement.h"

#include "base/array.h"
#include <stdlib.h>
#include <string.h>

void enf_arrangement_free(enf_arrangement *arrangement) {
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
        enf_geometry_set_plane(geometry, plane);
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
    geometry->filters = enf_array_new(mesh->polygon_count, sizeof *geometry->filters);
    geometry->filter_first = arrangement->tets.facet_count;
    geometry->filter_end = geometry->filter_first + (int32_t)mesh->polygon_count;
    if (!arrangement->polygon_plane || !arrangement->polygon_flipped || !geometry->planes ||
        !geometry->filters) {
        return false;
    }
    for (int32_t f = 0; f < arrangement->tets.facet_count; f++) {
        const int32_t *corner = arrangement->tets.facet_corners[f];
        add_plane(geometry, corner[0], corner[1], corner[2]);
    }
    if (!add_polygon_planes(arrangement)) return false;
    geometry->filter_end = geometry->plane_count;
    add_edge_planes(arrangement);
    return true;
}

enf_status enf_arrangement_make(enf_arrangement *arrangement, const enf_mesh *mesh, enf_tet_mesh tets,
                                enf_error *error) {
    memset(arrangement, 0, sizeof *arrangement);
    arrangement->mesh = mesh;
    arrangement->tets = tets;
    if (make_planes(arrangement)) return ENF_OK;
    enf_arrangement_free(arrangement);
    return enf_fail_memory(error, "the polygons' planes");
}
