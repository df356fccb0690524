// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/portal_graph.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

bool enf_portal_graph_add(enf_portal_graph *graph, int32_t from, int32_t to, const double (*corners)[3],
                          int32_t count) {
    size_t openings = (size_t)graph->opening_count;
    size_t first = graph->opening_corner ? (size_t)graph->opening_corner[openings] : 0;
    size_t capacity = graph->opening_capacity, offsets = graph->opening_corner ? capacity : 0;
    if (!enf_array_reserve(graph->opening_corner, offsets, openings + 2)) return false;
    if (!enf_array_reserve(graph->opening_cell, capacity, openings + 2)) return false;
    graph->opening_capacity = offsets < capacity ? offsets : capacity;
    if (!enf_array_reserve(graph->corners, graph->corner_capacity, first + (size_t)count)) return false;
    if (openings == 0) graph->opening_corner[0] = 0;
    memcpy(graph->corners + first, corners, (size_t)count * sizeof *corners);
    graph->opening_cell[openings][0] = from;
    graph->opening_cell[openings][1] = to;
    graph->opening_corner[openings + 1] = (int32_t)first + count;
    graph->opening_count++;
    return true;
}

enf_status enf_portal_graph_finish(enf_portal_graph *graph, enf_error *error) {
    size_t portals = 2 * (size_t)graph->opening_count;
    graph->cell_portal = enf_array_zeroed((size_t)graph->cell_count + 1, sizeof *graph->cell_portal);
    graph->cell_portals = enf_array_new(portals, sizeof *graph->cell_portals);
    if (!graph->opening_corner) graph->opening_corner = enf_array_zeroed(1, sizeof *graph->opening_corner);
    if (!graph->cell_portal || !graph->cell_portals || !graph->opening_corner)
        return enf_fail_memory(error, "the portal graph");
    for (int32_t p = 0; p < (int32_t)portals; p++) graph->cell_portal[enf_portal_from(graph, p) + 1]++;
    for (int32_t c = 0; c < graph->cell_count; c++) graph->cell_portal[c + 1] += graph->cell_portal[c];
    for (int32_t p = (int32_t)portals - 1; p >= 0; p--) // offsets move down to the starts while they are used
        graph->cell_portals[--graph->cell_portal[enf_portal_from(graph, p) + 1]] = p;
    // Each cell's offset now stands one place too far to the right.
    memmove(graph->cell_portal, graph->cell_portal + 1,
            (size_t)graph->cell_count * sizeof *graph->cell_portal);
    graph->cell_portal[graph->cell_count] = (int32_t)portals;
    return ENF_OK;
}

void enf_portal_graph_free(enf_portal_graph *graph) {
    free(graph->opening_cell);
    free(graph->opening_corner);
    free(graph->corners);
    free(graph->leaf_cell);
    free(graph->cell_portal);
    free(graph->cell_portals);
    memset(graph, 0, sizeof *graph);
}
