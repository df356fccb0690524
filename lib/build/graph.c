// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/graph.h"

#include "base/array.h"
#include "build/loop.h"

#include <stdlib.h>
#include <string.h>

void enf_graph_free(enf_graph *graph) {
    free(graph->piece_cell);
    free(graph->piece_open);
    free(graph->piece_corner);
    free(graph->corners);
    memset(graph, 0, sizeof *graph);
}

static bool allocate(enf_graph *graph, size_t pieces, size_t corners) {
    graph->piece_cell = enf_array_new(pieces, sizeof *graph->piece_cell);
    graph->piece_open = enf_array_new(pieces, sizeof *graph->piece_open);
    graph->piece_corner = enf_array_new(pieces + 1, sizeof *graph->piece_corner);
    graph->corners = enf_array_new(corners, sizeof *graph->corners);
    return graph->piece_cell && graph->piece_open && graph->piece_corner && graph->corners;
}

enf_status enf_graph_build(enf_graph *graph, const enf_complex *complex, const int32_t *node_of,
                           int32_t node_count, enf_error *error) {
    memset(graph, 0, sizeof *graph);
    graph->vertices = (const double(*)[3])complex->vertex_position;
    graph->scale = 0x1p-53;
    bool good = true;
    for (int pass = 0; good && pass < 2; pass++) { // count, then fill
        int32_t count = 0;
        int64_t corners = 0;
        for (int32_t p = 0; p < complex->pieces.count; p++) {
            const int32_t *cell = enf_complex_piece_cells(complex, p);
            int32_t node[2], corner_count;
            for (int side = 0; side < 2; side++) node[side] = cell[side] < 0 ? -1 : node_of[cell[side]];
            if (node[0] == node[1]) continue; // nothing of it is kept, or it lies inside a node
            const enf_corner *corner = enf_complex_piece(complex, p, &corner_count);
            if (pass == 1) {
                memcpy(graph->piece_cell[count], node, sizeof node);
                graph->piece_open[count] =
                    complex->piece_cover[p] == ENF_PIECE_OPEN && node[0] >= 0 && node[1] >= 0;
                graph->piece_corner[count] = corners;
                for (int32_t c = 0; c < corner_count; c++) graph->corners[corners + c] = corner[c].vertex;
            }
            corners += corner_count;
            count++;
        }
        if (pass == 0) {
            good = allocate(graph, (size_t)count, (size_t)corners);
        } else {
            graph->piece_corner[count] = corners;
            graph->piece_count = count;
        }
    }
    graph->cell_count = node_count;
    if (good) return ENF_OK;
    enf_graph_free(graph);
    return enf_fail_memory(error, "the cell graph");
}
