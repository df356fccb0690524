// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/polygon_lines.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

void enf_polygon_lines_free(enf_polygon_lines *lines) {
    free(lines->known);
    memset(lines, 0, sizeof *lines);
}

bool enf_polygon_lines_reserve(enf_polygon_lines *lines, size_t vertex_count) {
    size_t known = lines->known_capacity;
    if (vertex_count <= known) return true;
    if (!enf_array_reserve(lines->known, lines->known_capacity, vertex_count)) return false;
    memset(lines->known + known, 0, (lines->known_capacity - known) * sizeof *lines->known);
    return true;
}

void enf_polygon_lines_take(enf_polygon_lines *lines, const enf_arrangement *arrangement, int32_t polygon,
                            uint32_t wanted) {
    const enf_mesh *mesh = arrangement->mesh;
    int64_t first = mesh->polygon_corner[polygon];
    lines->polygon = polygon;
    lines->count = (int32_t)(mesh->polygon_corner[polygon + 1] - first);
    lines->corners = mesh->corners + first;
    lines->first_plane = arrangement->edge_plane_first + (int32_t)first;
    lines->wanted = lines->count < ENF_LINES_FEW ? wanted & ((UINT32_C(1) << lines->count) - 1) : wanted;
    lines->mark++;
    for (uint32_t left = lines->wanted; left; left &= left - 1) {
        int i = __builtin_ctz(left);
        enf_geometry_make_filter(&arrangement->geometry, lines->first_plane + i, &lines->filters[i]);
    }
}

void enf_polygon_lines_find(enf_polygon_lines *lines, enf_geometry *geometry, int32_t vertex) {
    uint32_t sides[2];
    enf_geometry_sides_by(geometry, vertex, lines->first_plane, lines->wanted, lines->filters, sides);
    enf_line_sides *known = &lines->known[vertex];
    known->mark = lines->mark;
    known->inside = sides[0];
    known->outside = sides[1];
}
