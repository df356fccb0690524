// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/tetrahedra.h"

#include "base/array.h"
#include "base/fetch.h"

#include <stdlib.h>
#include <string.h>

void enf_tet_mesh_unlist(enf_tet_mesh *mesh) {
    free(mesh->slot_begin);
    free(mesh->slots);
    mesh->slot_begin = NULL;
    mesh->slots = NULL;
}

void enf_tet_mesh_free(enf_tet_mesh *mesh) {
    enf_tet_mesh_unlist(mesh);
    free(mesh->corners);
    free(mesh->facets);
    free(mesh->facet_corners);
    free(mesh->facet_sides);
    free(mesh->point_tetrahedron);
    memset(mesh, 0, sizeof *mesh);
}

/// Puts two corners in ascending order; 1 if they were not, 0 if they were.
static int order(int32_t *a, int32_t *b) {
    const int32_t first = *a, second = *b;
    const int turned = first > second;
    *a = turned ? second : first;
    *b = turned ? first : second;
    return turned;
}

int enf_tetrahedron_face(const int32_t tetrahedron[4], int opposite, int32_t face[3]) {
    int side = opposite & 1; // (1,2,3|0) and (0,1,3|2) are odd permutations, the other two even
    for (int k = 0; k < 3; k++) face[k] = tetrahedron[k + (k >= opposite)];
    side ^= order(&face[0], &face[1]);
    side ^= order(&face[1], &face[2]);
    return side ^ order(&face[0], &face[1]);
}

static uint32_t hash_edge(int32_t a, int32_t b) {
    return (uint32_t)((((uint64_t)(uint32_t)a << 32 | (uint32_t)b) * UINT64_C(0x9E3779B97F4A7C15)) >> 32);
}

/// Where the face would best lie among the slots of its lowest corner.
static inline uint32_t home_of(const int32_t face[3], uint32_t count) {
    return (uint32_t)((uint64_t)hash_edge(face[1], face[2]) * count >> 32);
}

/// The slot of the face with these ascending corners, or where it would be. The lowest corner says where to
/// look, so that faces that are near in space are near in memory.
static inline int32_t *slot_of(const enf_tet_mesh *mesh, const int32_t face[3]) {
    int32_t *slots = mesh->slots + mesh->slot_begin[face[0]];
    const uint32_t count = mesh->slot_begin[face[0] + 1] - mesh->slot_begin[face[0]];
    uint32_t at = home_of(face, count);
    for (int32_t facet; (facet = slots[at]) >= 0; at = at + 1 < count ? at + 1 : 0) {
        const int32_t *corner = mesh->facet_corners[facet];
        if (corner[1] == face[1] && corner[2] == face[2] && corner[0] == face[0]) break;
    }
    return &slots[at];
}

int32_t enf_tet_mesh_facet(const enf_tet_mesh *mesh, int32_t a, int32_t b, int32_t c) {
    const int32_t corners[4] = {a, b, c, -1};
    int32_t face[3];
    enf_tetrahedron_face(corners, 3, face);
    return *slot_of(mesh, face);
}

void enf_tet_mesh_fetch_facet(const enf_tet_mesh *mesh, int32_t a, int32_t b, int32_t c, int step) {
    const int32_t corners[4] = {a, b, c, -1};
    int32_t face[3];
    enf_tetrahedron_face(corners, 3, face);
    const uint32_t *begin = &mesh->slot_begin[face[0]];
    if (step == 0) {
        enf_fetch(begin);
        return;
    }
    const int32_t *slot = mesh->slots + begin[0] + home_of(face, begin[1] - begin[0]);
    if (step == 1)
        enf_fetch(slot);
    else if (*slot >= 0)
        enf_fetch(mesh->facet_corners[*slot]);
}

enum { SPARE_SLOTS = 6 }; ///< at each corner, one of them for good: facets that flips make seldom need more

/// A slot for every face of every tetrahedron, by its lowest corner, and spare ones at each corner. Most
/// faces come twice: that leaves half of the slots free.
static enf_status make_slots(enf_tet_mesh *mesh, enf_error *error) {
    uint32_t *begin = mesh->slot_begin = enf_array_zeroed((size_t)mesh->point_count + 1, sizeof *begin);
    if (!begin) return enf_fail_memory(error, "the tetrahedra's faces");
    for (int32_t t = 0; t < mesh->count; t++) { // three faces have the lowest corner, one the next
        int32_t pair[2][2], *one = pair[0], *other = pair[1];
        memcpy(pair, mesh->corners[t], sizeof pair);
        order(&one[0], &one[1]);
        order(&other[0], &other[1]);
        order(&one[0], &other[0]);
        begin[one[0] + 1] += 3;
        begin[(one[1] < other[0] ? one[1] : other[0]) + 1]++;
    }
    for (int32_t i = 0; i < mesh->point_count; i++) begin[i + 1] += begin[i] + SPARE_SLOTS;
    const size_t slots = begin[mesh->point_count];
    mesh->slots = enf_array_new(slots, sizeof *mesh->slots);
    if (!mesh->slots) return enf_fail_memory(error, "the tetrahedra's faces");
    memset(mesh->slots, 0xff, slots * sizeof *mesh->slots); // -1
    return ENF_OK;
}

/// All facets anew, with twice as many slots. False without memory.
static bool list_all(enf_tet_mesh *mesh) {
    uint32_t *begin = mesh->slot_begin;
    memset(begin, 0, ((size_t)mesh->point_count + 1) * sizeof *begin);
    for (int32_t f = 0; f < mesh->facet_count; f++) begin[mesh->facet_corners[f][0] + 1] += 2;
    for (int32_t i = 0; i < mesh->point_count; i++) begin[i + 1] += begin[i] + 1;
    const size_t slots = begin[mesh->point_count];
    free(mesh->slots);
    mesh->slots = enf_array_new(slots, sizeof *mesh->slots);
    if (!mesh->slots) return false;
    memset(mesh->slots, 0xff, slots * sizeof *mesh->slots); // -1
    for (int32_t f = 0; f < mesh->facet_count; f++) *slot_of(mesh, mesh->facet_corners[f]) = f;
    return true;
}

/// Has a lowest corner a free slot left?
static bool has_free_slot(const enf_tet_mesh *mesh, int32_t lowest) {
    for (uint32_t i = mesh->slot_begin[lowest + 1]; i-- > mesh->slot_begin[lowest];) {
        if (mesh->slots[i] < 0) return true;
    }
    return false;
}

bool enf_tet_mesh_list(enf_tet_mesh *mesh, const int32_t *facets, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const int32_t *corner = mesh->facet_corners[facets[i]];
        *slot_of(mesh, corner) = facets[i];
        if (!has_free_slot(mesh, corner[0])) return list_all(mesh);
    }
    return true;
}

static enf_status pair_faces(enf_tet_mesh *mesh, enf_error *error) {
    for (int32_t t = 0; t < mesh->count; t++) {
        for (int k = 0; k < 4; k++) {
            int32_t face[3];
            int side = enf_tetrahedron_face(mesh->corners[t], k, face);
            int32_t *slot = slot_of(mesh, face), facet = *slot;
            if (facet < 0) {
                facet = *slot = mesh->facet_count++;
                memcpy(mesh->facet_corners[facet], face, sizeof face);
                mesh->facet_sides[facet][0] = mesh->facet_sides[facet][1] = -1;
            }
            if (mesh->facet_sides[facet][side] >= 0) {
                return enf_fail(
                    error, ENF_NO_RESOURCES,
                    "the tetrahedralizer returned overlapping tetrahedra %d and %d; try another one "
                    "(--tetrahedralizer)",
                    (int)mesh->facet_sides[facet][side], (int)t);
            }
            mesh->facet_sides[facet][side] = t;
            mesh->facets[t][k] = facet;
        }
    }
    return ENF_OK;
}

/// Finds a tetrahedron at each point: the first.
static enf_status find_tetrahedra(enf_tet_mesh *mesh, enf_error *error) {
    for (int32_t i = 0; i < mesh->point_count; i++) mesh->point_tetrahedron[i] = -1;
    for (int32_t t = mesh->count - 1; t >= 0; t--) {
        for (int k = 0; k < 4; k++) mesh->point_tetrahedron[mesh->corners[t][k]] = t;
    }
    for (int32_t i = 0; i < mesh->point_count; i++) {
        if (mesh->point_tetrahedron[i] >= 0) continue;
        return enf_fail(error, ENF_NO_RESOURCES,
                        "the tetrahedralizer left out point %d; try another one (--tetrahedralizer)", (int)i);
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
    mesh->facets = enf_array_new(count, sizeof *mesh->facets);
    mesh->facet_corners = enf_array_new(4 * count, sizeof *mesh->facet_corners);
    mesh->facet_sides = enf_array_new(4 * count, sizeof *mesh->facet_sides);
    mesh->point_tetrahedron = enf_array_new((size_t)point_count, sizeof *mesh->point_tetrahedron);
    enf_status status = ENF_OK;
    if (!mesh->facets || !mesh->facet_corners || !mesh->facet_sides || !mesh->point_tetrahedron)
        status = enf_fail_memory(error, "the tetrahedra's faces");
    if (!status) status = make_slots(mesh, error);
    if (!status) status = pair_faces(mesh, error);
    if (!status) status = find_tetrahedra(mesh, error);
    if (status != ENF_OK) {
        enf_tet_mesh_free(mesh);
        return status;
    }
    enf_array_trim(mesh->facet_corners, mesh->facet_count);
    enf_array_trim(mesh->facet_sides, mesh->facet_count);
    return ENF_OK;
}

int enf_tet_mesh_tiling(const enf_tet_mesh *tets, const int32_t *corner, int64_t corners, int32_t *facets) {
    int count = 0;
    if (corners > ENF_TILING_CORNERS_MAX) return 0;
    struct {
        int first, last;
    } stack[ENF_TILING_CORNERS_MAX] = {
        {0, (int)corners - 1}}; // chains of corners still to be closed by a facet
    for (int depth = 1; depth > 0;) {
        int first = stack[--depth].first, last = stack[depth].last, apex = first + 1;
        int32_t facet = -1;
        for (; apex < last; apex++) {
            facet = enf_tet_mesh_facet(tets, corner[first], corner[apex], corner[last]);
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
