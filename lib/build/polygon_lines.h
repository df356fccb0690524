// SPDX-License-Identifier: GPL-3.0-or-later
// A polygon's edges as lines in its plane, and on which side of them vertices lie: asked once per vertex.
#ifndef ENF_BUILD_POLYGON_LINES_H
#define ENF_BUILD_POLYGON_LINES_H

#include "build/arrangement.h"

enum { ENF_LINES_KNOWN_MAX = 32 }; ///< edges whose answers are kept; those of further ones are not

typedef struct enf_polygon_lines {
    const enf_arrangement *arrangement;
    int32_t polygon, count; ///< count: its edges
    const int32_t *corners; ///< its points
    int32_t first_plane;    ///< of edge 0
    uint32_t filters_made;  ///< a bit for each of the first edges
    enf_plane_filter filters[ENF_LINES_KNOWN_MAX];

    int32_t mark;
    struct enf_known_sides {
        int32_t mark;
        int32_t plane_sign; ///< the owner's: see flood.c
        uint64_t sides;     ///< two bits an edge: 0 unknown, else sign + 2
    } *known;           ///< per vertex
    size_t known_capacity;
} enf_polygon_lines;

/// From now on the lines are those of this polygon.
void enf_polygon_lines_take(enf_polygon_lines *lines, const enf_arrangement *arrangement, int32_t polygon);
void enf_polygon_lines_free(enf_polygon_lines *lines);

/// Makes room for what is known of vertices below this number. False without memory.
bool enf_polygon_lines_reserve(enf_polygon_lines *lines, size_t vertex_count);

/// Forgets what is known of a vertex (its number will be given to another one).
static inline void enf_polygon_lines_forget(enf_polygon_lines *lines, int32_t vertex) {
    lines->known[vertex].mark = 0;
}

/// Asks the geometry; see enf_polygon_lines_side.
int enf_polygon_lines_find_side(enf_polygon_lines *lines, enf_geometry *geometry, int32_t vertex, int32_t i);

/// -1: the vertex is inside edge i's line, where the polygon is; +1: outside; 0: on it. The line stands for a
/// plane that is not parallel to the polygon, so vertices off the polygon's plane get an answer as well. Exact.
static inline int enf_polygon_lines_side(enf_polygon_lines *lines, enf_geometry *geometry, int32_t vertex,
                                         int32_t i) {
    const struct enf_known_sides *known = &lines->known[vertex];
    if (i < ENF_LINES_KNOWN_MAX && known->mark == lines->mark) {
        unsigned side = (unsigned)(known->sides >> (2 * (unsigned)i)) & 3;
        if (side) return (int)side - 2;
    }
    return enf_polygon_lines_find_side(lines, geometry, vertex, i);
}

#endif
