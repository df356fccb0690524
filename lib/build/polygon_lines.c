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

void enf_polygon_lines_take(enf_polygon_lines *lines, const enf_arrangement *arrangement, int32_t polygon) {
    const enf_mesh *mesh = arrangement->mesh;
    int64_t first = mesh->polygon_corner[polygon];
    lines->arrangement = arrangement;
    lines->polygon = polygon;
    lines->count = (int32_t)(mesh->polygon_corner[polygon + 1] - first);
    lines->corners = mesh->corners + first;
    lines->first_plane = arrangement->edge_plane_first + (int32_t)first;
    lines->filters_made = 0;
    lines->mark++;
}

int enf_polygon_lines_find_side(enf_polygon_lines *lines, enf_geometry *geometry, int32_t vertex, int32_t i) {
    int32_t plane = lines->first_plane + i;
    if (i >= ENF_LINES_KNOWN_MAX) return enf_geometry_side(geometry, vertex, plane);
    enf_plane_filter *filter = &lines->filters[i];
    if (!(lines->filters_made >> i & 1)) {
        enf_geometry_make_filter(geometry, plane, filter);
        lines->filters_made |= UINT32_C(1) << i;
    }
    struct enf_known_sides *known = &lines->known[vertex];
    if (known->mark != lines->mark) {
        known->mark = lines->mark;
        known->sides = 0;
    }
    int side = enf_geometry_side_by(geometry, vertex, plane, filter);
    known->sides |= (uint64_t)(unsigned)(side + 2) << (2 * (unsigned)i);
    return side;
}
