// SPDX-License-Identifier: GPL-3.0-or-later
// Portals: the openings between cells, as pairs, made of few convex polygons.
#ifndef ENF_BUILD_PORTAL_H
#define ENF_BUILD_PORTAL_H

#include "build/complex.h"

/// An opening is a connected part of the open area between two cells: two doors between the same two rooms
/// are two openings. Each opening is a pair of portals: portal 2k leads from the lower cell number to the
/// higher, portal 2k + 1 (= 2k ^ 1) back.
typedef struct enf_portals {
    int32_t opening_count;
    int32_t (*opening_cell)[2];  ///< lower, higher cell number
    int32_t *opening_polygon;    ///< opening_count + 1 offsets into polygons
    double (*opening_centre)[3]; ///< bounding sphere, grid steps
    double *opening_radius;

    enf_loops polygons;     ///< convex; counter-clockwise seen from the front of polygon_plane
    int32_t *polygon_plane; ///< a plane of the complex
    uint8_t *polygon_side;  ///< 1: the higher cell lies in front of the plane; 0: the lower does
    double *polygon_area;   ///< grid steps squared
    int32_t
        pieces_merged; ///< open pieces that went into the polygons (the report: pieces - polygons were saved)
    int32_t slivers;   ///< polygons dropped because their rounded corners span no area
} enf_portals;

void enf_portals_free(enf_portals *portals);

/// Finds the openings between cells. `cell_of`: the cell of every fine cell, -1 for discarded ones.
enf_status enf_portals_find(enf_portals *portals, const enf_complex *complex, const int32_t *cell_of,
                            enf_error *error);

#endif
