// SPDX-License-Identifier: GPL-3.0-or-later
// Which cells are not convex, as far as their portals tell.
#include "visibility/portal_graph.h"
#include "visibility/winding.h"

#include <math.h>

/// The corners of a portal's opening.
static const double (*corners_of(const enf_portal_graph *graph, int32_t portal, int32_t *count))[3] {
    const int32_t *offset = &graph->opening_corner[portal >> 1];
    *count = offset[1] - offset[0];
    return (const double(*)[3])graph->corners + offset[0];
}

/// Does the whole of `other` lie on this side of the portal's plane, where the portal's cell is?
static bool is_behind(const enf_portal_graph *graph, int32_t portal, const double normal[3], int32_t other) {
    int32_t count, other_count;
    const double(*plane)[3] = corners_of(graph, portal, &count);
    const double(*corners)[3] = corners_of(graph, other, &other_count);
    double tolerance = fmax(enf_winding_tolerance(plane, count), enf_winding_tolerance(corners, other_count));
    double sign = portal & 1 ? -1 : 1; // the normal leads out of the first cell
    for (int32_t i = 0; i < other_count; i++) {
        double height = 0;
        for (int a = 0; a < 3; a++) height += normal[a] * (corners[i][a] - plane[0][a]);
        if (sign * height > tolerance) return false;
    }
    return true;
}

bool enf_portal_graph_is_convex(const enf_portal_graph *graph, int32_t cell) {
    int32_t first = graph->cell_portal[cell], end = graph->cell_portal[cell + 1];
    for (int32_t i = first; i < end; i++) {
        int32_t portal = graph->cell_portals[i], count;
        const double(*corners)[3] = corners_of(graph, portal, &count);
        double normal[3];
        if (!enf_winding_normal(corners, count, normal)) continue;
        for (int32_t k = first; k < end; k++)
            if (k != i && !is_behind(graph, portal, normal, graph->cell_portals[k])) return false;
    }
    return true;
}

void enf_portal_graph_find_non_convex(enf_portal_graph *graph) {
    graph->non_convex_cells = 0;
    graph->first_non_convex_cell = -1;
    for (int32_t cell = 0; cell < graph->cell_count; cell++) {
        if (enf_portal_graph_is_convex(graph, cell)) continue;
        if (graph->non_convex_cells++ == 0) graph->first_non_convex_cell = cell;
    }
}
