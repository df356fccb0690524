// SPDX-License-Identifier: GPL-3.0-or-later
// A polygon's edges as lines in its plane, and on which side of them vertices lie: asked once per vertex.
#ifndef ENF_BUILD_POLYGON_LINES_H
#define ENF_BUILD_POLYGON_LINES_H

#include "build/arrangement.h"

enum { ENF_LINES_FEW = 32 }; ///< edges that fit the masks below; further ones are asked for singly

/// What is known of a vertex: a bit for each of the edges that were wanted when it was first asked about.
typedef struct enf_line_sides {
    int32_t mark;
    int32_t plane_sign; ///< the owner's: see flood.c
    uint32_t inside;    ///< strictly on the polygon's side
    uint32_t outside;   ///< strictly on the other one
} enf_line_sides;

typedef struct enf_polygon_lines {
    int32_t polygon, count; ///< count: its edges
    const int32_t *corners; ///< its points
    int32_t first_plane;    ///< of edge 0
    uint32_t wanted;        ///< the edges that matter
    enf_plane_filter filters[ENF_LINES_FEW];

    int32_t mark;
    enf_line_sides *known; ///< per vertex
    size_t known_capacity;
} enf_polygon_lines;

/// From now on the lines are those of this polygon; of the first ENF_LINES_FEW only the wanted ones.
void enf_polygon_lines_take(enf_polygon_lines *lines, const enf_arrangement *arrangement, int32_t polygon,
                            uint32_t wanted);
void enf_polygon_lines_free(enf_polygon_lines *lines);

/// Makes room for what is known of vertices below this number. False without memory.
bool enf_polygon_lines_reserve(enf_polygon_lines *lines, size_t vertex_count);

/// Forgets what is known of a vertex (its number will be given to another one).
static inline void enf_polygon_lines_forget(enf_polygon_lines *lines, int32_t vertex) {
    lines->known[vertex].mark = 0;
}

/// Asks the geometry; see enf_polygon_lines_at.
void enf_polygon_lines_find(enf_polygon_lines *lines, enf_geometry *geometry, int32_t vertex);

/// On which sides of the wanted lines the vertex lies. A line stands for a plane that is not parallel to the
/// polygon, so vertices off the polygon's plane get an answer as well. Exact.
static inline const enf_line_sides *enf_polygon_lines_at(enf_polygon_lines *lines, enf_geometry *geometry,
                                                         int32_t vertex) {
    if (lines->known[vertex].mark != lines->mark) enf_polygon_lines_find(lines, geometry, vertex);
    return &lines->known[vertex];
}

#endif
