// SPDX-License-Identifier: GPL-3.0-or-later
// What the exact stages share while they run: tetrahedra, all planes, space as it is cut, and which polygon
// lies where.
#ifndef ENF_BUILD_ARRANGEMENT_H
#define ENF_BUILD_ARRANGEMENT_H

#include "base/parallel.h"
#include "build/clean.h"
#include "build/geometry.h"
#include "build/tetrahedra.h"

/// A polygon may lie on facets of this source (see enf_share).
typedef struct enf_hit {
    int32_t polygon, source;
    uint32_t
        lines; ///< a bit for each of the polygon's first edges that may not have all of these facets inside
} enf_hit;

typedef struct enf_arrangement {
    const enf_mesh *mesh;
    enf_tet_mesh tets;

    /// Planes: first one per facet of the tetrahedra (their corners, in one array with the rest), then one
    /// per plane that polygons lie in (with filters), then one per polygon corner (the edge that leaves it;
    /// the polygon lies behind it).
    enf_geometry geometry;
    int32_t edge_plane_first; ///< plane of mesh corner c: edge_plane_first + c
    int32_t *polygon_plane;   ///< per polygon
    bool *polygon_flipped;    ///< the polygon's front is the plane's back

    bool plain;         ///< cells are not joined
    int32_t *hit_first; ///< per facet of the tetrahedra, offsets into `hits`; from flood on
    enf_hit *hits;
    int32_t *cell_into; ///< from split to connect: the cell that each cell went into, or itself
} enf_arrangement;

void enf_arrangement_free(enf_arrangement *arrangement);

/// Planes for clean polygons over tetrahedra (taken over).
enf_status enf_arrangement_make(enf_arrangement *arrangement, const enf_mesh *mesh, enf_tet_mesh tets,
                                int threads, enf_error *error);

#endif
