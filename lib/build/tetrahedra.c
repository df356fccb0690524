// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/tetrahedra.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

void enf_tet_mesh_free(enf_tet_mesh *mesh) {
    free(mesh->corners);
    free(mesh->facets);
    free(mesh->facet_corners);
    free(mesh->facet_sides);
    free(mesh->point_tetrahedron);
    free(mesh->facet_table);
    memset(mesh, 0, sizeof *mesh);
}

/// The three corners other than `opposite`, ascending. Returns the side of their plane (1 in front, 0 behind)
/// on which the fourth corner of a positively oriented tetrahedron lies.
static int sorted_face(const int32_t tetrahedron[4], int opposite, int32_t face[3]) {
    int side = opposite & 1; // (1,2,3|0) and (0,1,3|2) are odd permutations, the other two even
    for (int i = 0, n = 0; i < 4; i++) {
        if (i != opposite) face[n++] = tetrahedron[i];
    }
    static const int steps[3][2] = {{0, 1}, {1, 2}, {0, 1}};
    for (int i = 0; i < 3; i++) {
        int a = steps[i][0], b = steps[i][1];
        if (face[a] < face[b]) continue;
        int32_t swap = face[a];
        face[a] = face[b];
        face[b] = swap;
        side ^= 1;
    }
    return side;
}

static uint64_t hash_face(const int32_t face[3]) {
    uint64_t hash = (uint64_t)(uint32_t)face[0] * UINT64_C(0x9E3779B97F4A7C15);
    hash = (hash ^ (hash >> 29) ^ (uint32_t)face[1]) * UINT64_C(0xBF58476D1CE4E5B9);
    hash = (hash ^ (hash >> 32) ^ (uint32_t)face[2]) * UINT64_C(0x94D049BB133111EB);
    return hash ^ (hash >> 31);
}

/// Where the face is in the table, or where it would be.
static size_t slot_of(const enf_tet_mesh *mesh, const int32_t face[3]) {
    size_t slot = hash_face(face) & mesh->facet_table_mask;
    for (int32_t facet; (facet = mesh->facet_table[slot]) >= 0; slot = (slot + 1) & mesh->facet_table_mask) {
        if (memcmp(mesh->facet_corners[facet], face, 3 * sizeof *face) == 0) break;
    }
    return slot;
}

int32_t enf_tet_mesh_facet(const enf_tet_mesh *mesh, int32_t a, int32_t b, int32_t c) {
    const int32_t corners[4] = {a, b, c, -1};
    int32_t face[3];
    sorted_face(corners, 3, face);
    return mesh->facet_table[slot_of(mesh, face)];
}

static enf_status pair_faces(enf_tet_mesh *mesh, enf_error *error) {
    for (int32_t t = 0; t < mesh->count; t++) {
        for (int k = 0; k < 4; k++) {
            int32_t face[3];
            int side = sorted_face(mesh->corners[t], k, face);
            size_t slot = slot_of(mesh, face);
            int32_t facet = mesh->facet_table[slot];
            if (facet < 0) {
                facet = mesh->facet_table[slot] = mesh->facet_count++;
                memcpy(mesh->facet_corners[facet], face, sizeof face);
                mesh->facet_sides[facet][0] = mesh->facet_sides[facet][1] = -1;
            }
            if (mesh->facet_sides[facet][side] >= 0) {
                return enf_fail(
                    error, ENF_NO_RESOURCES,
                    "the tetrahedralizer returned overlapping tetrahedra %d and %d; try the other one "
                    "(--tetrahedralizer)",
                    (int)mesh->facet_sides[facet][side], (int)t);
            }
            mesh->facet_sides[facet][side] = t;
            mesh->facets[t][k] = facet;
        }
    }
    return ENF_OK;
}

enf_status enf_tet_mesh_pair(enf_tet_mesh *mesh, int32_t (*corners)[4], size_t count, int32_t point_count,
                             enf_error *error) {
    memset(mesh, 0, sizeof *mesh);
    mesh->corners = corners;
    if (count > INT32_MAX / 8) {
        enf_tet_mesh_free(mesh);
        return enf_fail(error, ENF_NO_RESOURCES, "%zu tetrahedra are more than this build can number", count);
    }
    mesh->count = (int32_t)count;
    mesh->point_count = point_count;
    size_t slots = 16;
    while (slots < 3 * count) slots *= 2; // there are about twice as many facets as tetrahedra
    mesh->facet_table = enf_array_new(slots, sizeof *mesh->facet_table);
    mesh->facet_table_mask = slots - 1;
    mesh->facets = enf_array_new(count, sizeof *mesh->facets);
    mesh->facet_corners = enf_array_new(4 * count, sizeof *mesh->facet_corners);
    mesh->facet_sides = enf_array_new(4 * count, sizeof *mesh->facet_sides);
    mesh->point_tetrahedron = enf_array_new((size_t)point_count, sizeof *mesh->point_tetrahedron);
    enf_status status = ENF_OK;
    if (!mesh->facet_table || !mesh->facets || !mesh->facet_corners || !mesh->facet_sides ||
        !mesh->point_tetrahedron) {
        status = enf_fail_memory(error, "the tetrahedra's faces");
    } else {
        for (size_t i = 0; i < slots; i++) mesh->facet_table[i] = -1;
        for (int32_t i = 0; i < point_count; i++) mesh->point_tetrahedron[i] = -1;
        for (int32_t t = mesh->count - 1; t >= 0; t--) {
            for (int k = 0; k < 4; k++) mesh->point_tetrahedron[corners[t][k]] = t;
        }
        status = pair_faces(mesh, error);
        for (int32_t i = 0; i < point_count && status == ENF_OK; i++) {
            if (mesh->point_tetrahedron[i] >= 0) continue;
            status = enf_fail(error, ENF_NO_RESOURCES,
                              "the tetrahedralizer left out point %d; try the other one (--tetrahedralizer)",
                              (int)i);
        }
    }
    if (status != ENF_OK) {
        enf_tet_mesh_free(mesh);
        return status;
    }
    void *trimmed = realloc(mesh->facet_corners, (size_t)mesh->facet_count * sizeof *mesh->facet_corners);
    if (trimmed) mesh->facet_corners = trimmed;
    trimmed = realloc(mesh->facet_sides, (size_t)mesh->facet_count * sizeof *mesh->facet_sides);
    if (trimmed) mesh->facet_sides = trimmed;
    return ENF_OK;
}
