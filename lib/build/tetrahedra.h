// SPDX-License-Identifier: GPL-3.0-or-later
// The tetrahedra of the clean points with their facets paired, and which tetrahedra each polygon meets.
#ifndef ENF_BUILD_TETRAHEDRA_H
#define ENF_BUILD_TETRAHEDRA_H

#include "enfilade/base.h"

typedef struct enf_tet_mesh {
    int32_t count;
    int32_t (*corners)[4]; ///< point numbers, positively oriented
    int32_t (*facets)[4];  ///< the facet opposite each corner

    int32_t facet_count;
    int32_t (*facet_corners)[3]; ///< ascending; the front of the facet is where they turn counter-clockwise
    int32_t (*facet_sides)[2];   ///< the tetrahedron behind, in front; -1: outside the hull

    int32_t point_count;
    int32_t *point_tetrahedron; ///< one tetrahedron at each point, or -1

    uint32_t *slot_begin; ///< point_count + 1: where the slots of each lowest corner begin
    int32_t *slots;       ///< facets by their corners; -1: free. Open hashing among those of a lowest corner
} enf_tet_mesh;

void enf_tet_mesh_free(enf_tet_mesh *mesh);

/// Pairs the faces of `count` tetrahedra by their corners; takes over `corners` (freed on failure too).
/// ENF_NO_RESOURCES, with words, if a face has more than two tetrahedra or two on one side: the
/// tetrahedralizer's output is broken then.
enf_status enf_tet_mesh_pair(enf_tet_mesh *mesh, int32_t (*corners)[4], size_t count, int32_t point_count,
                             enf_error *error);

/// Which corner is the point? One of them is.
static inline int enf_tetrahedron_place(const int32_t corner[4], int32_t point) {
    return (corner[1] == point) + 2 * (corner[2] == point) + 3 * (corner[3] == point);
}

/// The three corners other than number `opposite`, ascending. Returns the side of their plane (1 in front, 0
/// behind) on which the fourth corner of a positively oriented tetrahedron lies.
int enf_tetrahedron_face(const int32_t tetrahedron[4], int opposite, int32_t face[3]);

/// Lists facets by their corners that have been given others. (Where the old ones led, they are not found any
/// more.) False without memory.
bool enf_tet_mesh_list(enf_tet_mesh *mesh, const int32_t *facets, size_t count);

/// Gives back the memory of the lists: no facet can be found by its corners any more.
void enf_tet_mesh_unlist(enf_tet_mesh *mesh);

/// The facet with these three corners, in any order, or -1.
int32_t enf_tet_mesh_facet(const enf_tet_mesh *mesh, int32_t a, int32_t b, int32_t c);

/// Brings a facet that will be looked for near the processor, in steps 0, 1 and 2, each some time after the
/// one before.
void enf_tet_mesh_fetch_facet(const enf_tet_mesh *mesh, int32_t a, int32_t b, int32_t c, int step);

enum { ENF_TILING_CORNERS_MAX = 16 }; ///< of polygons with more it is not asked

/// The facets that tile a polygon, where the triangulation carries it already: facets do not overlap, so
/// there is at most one way to triangulate it with them, and the facet at each edge is found by trying all
/// apexes. Returns their number (corners - 2), or 0 if they do not tile it.
int enf_tet_mesh_tiling(const enf_tet_mesh *mesh, const int32_t *corner, int64_t corners, int32_t *facets);

#endif
