// SPDX-License-Identifier: GPL-3.0-or-later
// A polygon's edges as lines in its plane, and on which side of them vertices lie: asked once per vertex.
#ifndef ENF_BUILD_POLYGON_LINES_H
#define ENF_BUILD_POLYGON_LINES_H

#include "build/arrangement.h"

enum { ENF_LINES_KNOWN_MAX = 32 }; ///< edges whose answers are kept; those of further ones are not

typedef struct enf_polygon_lines {
    const enf_arrangement *arrangement;
    int32_t polygon, count;    ///< count: its edges
    const int32_t *corners;    ///< its points
    int32_t first_plane;       ///< of edge 0
    enf_plane_filter *filters; ///< of its edges
    size_t filter_capacity;

    int32_t mark;
    struct enf_known_sides {
        int32_t mark;
        uint64_t sides; ///< two bits an edge: 0 unknown, else sign + 2
    } *known;           ///< per vertex
    size_t known_capacity;
} enf_polygon_lines;

/// From now on the lines are those of this polygon. False without memory.
bool enf_polygon_lines_take(enf_polygon_lines *lines, const enf_arrangement *arrangement, int32_t polygon);
void enf_polygon_lines_free(enf_polygon_lines *lines);

/// Makes room for what is known of vertices below this number.
bool enf_polygon_lines_reserve(enf_polygon_lines *lines, size_t vertex_count);

/// Forgets what is known of a vertex (its number will be given to another one).
static inline void enf_polygon_lines_forget(enf_polygon_lines *lines, int32_t vertex) {
    lines->known[vertex].mark = 0;
}

/// -1: the vertex, which must lie in the polygon's plane or off it as a witness, is inside edge i's line (where
/// the polygon is), +1: outside, 0: on it. Exact.
static inline int enf_polygon_lines_side(enf_polygon_lines *lines, enf_geometry *geometry, int32_t vertex,
                                         int32_t i) {
    struct enf_known_sides *known = &lines->known[vertex];
    if (known->mark != lines->mark) {
        known->mark = lines->mark;
        known->sides = 0;
    }
    unsigned shift = 2 * (unsigned)i;
    if (i < ENF_LINES_KNOWN_MAX && (known->sides >> shift & 3)) return (int)(known->sides >> shift & 3) - 2;
    int side = enf_geometry_side_by(geometry, vertex, lines->first_plane + i, &lines->filters[i]);
    if (i < ENF_LINES_KNOWN_MAX) known->sides |= (uint64_t)(unsigned)(side + 2) << shift;
    return side;
}

#endif
