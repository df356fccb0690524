// SPDX-License-Identifier: GPL-3.0-or-later
// What the exact stages share while they run: tetrahedra, all planes with their filters, and which polygon
// needs looking at in which tetrahedron.
#ifndef ENF_BUILD_ARRANGEMENT_H
#define ENF_BUILD_ARRANGEMENT_H

#include "base/parallel.h"
#include "build/clean.h"
#include "build/geometry.h"
#include "build/tetrahedra.h"

enum { ENF_MEETS_ACROSS = 4 }; ///< the polygon's plane passes through the tetrahedron's inside

typedef struct enf_candidate {
    int32_t polygon;
    int32_t how; ///< 0..3: lies in the plane of the facet opposite that corner; ENF_MEETS_ACROSS
} enf_candidate;

typedef struct enf_arrangement {
    const enf_mesh *mesh;
    enf_tet_mesh tets;

    /// Planes: first one per facet of the tetrahedra, then one per plane that polygons lie in, then one per
    /// polygon corner (the edge that leaves it; the polygon lies behind it).
    enf_geometry geometry; ///< points and planes; no crossings of its own
    size_t plane_capacity, filter_capacity;
    int32_t edge_plane_first; ///< plane of mesh corner c: edge_plane_first + c
    int32_t *polygon_plane;   ///< per polygon
    bool *polygon_flipped;    ///< the polygon's front is the plane's back

    int64_t *candidate_offset; ///< per tetrahedron, count + 1
    enf_candidate *candidates; ///< ascending polygons
} enf_arrangement;

void enf_arrangement_free(enf_arrangement *arrangement);

/// Planes and candidates for clean polygons over tetrahedra (taken over). Candidates are found by walking
/// from each polygon's corners through the tetrahedra it touches.
enf_status enf_arrangement_make(enf_arrangement *arrangement, const enf_mesh *mesh, enf_tet_mesh tets,
                                const enf_crew *crew, enf_error *error);

#endif
