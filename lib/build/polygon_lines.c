// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/polygon_lines.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

void enf_polygon_lines_free(enf_polygon_lines *lines) {
    free(lines->filters);
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

bool enf_polygon_lines_take(enf_polygon_lines *lines, const enf_arrangement *arrangement, int32_t polygon) {
    const enf_mesh *mesh = arrangement->mesh;
    int64_t first = mesh->polygon_corner[polygon];
    lines->arrangement = arrangement;
    lines->polygon = polygon;
    lines->count = (int32_t)(mesh->polygon_corner[polygon + 1] - first);
    lines->corners = mesh->corners + first;
    lines->first_plane = arrangement->edge_plane_first + (int32_t)first;
    lines->mark++;
    if (!enf_array_reserve(lines->filters, lines->filter_capacity, (size_t)lines->count)) return false;
    for (int32_t i = 0; i < lines->count; i++)
        enf_geometry_make_filter(&arrangement->geometry, lines->first_plane + i, &lines->filters[i]);
    return true;
}
