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
    int32_t *face_cell = enf_complex_face_cells(complex);
    const enf_loops *pieces = &complex->pieces;
    bool good = face_cell != NULL;
    for (int pass = 0; good && pass < 2; pass++) { // count, then fill
        int32_t count = 0;
        int64_t corners = 0;
        for (int32_t p = 0; p < pieces->count; p++) {
            int32_t node[2];
            for (int side = 0; side < 2; side++) {
                int32_t face = complex->piece_face[p][side];
                node[side] = face < 0 ? -1 : node_of[face_cell[face]];
            }
            if (node[0] == node[1]) continue; // nothing of it is kept, or it lies inside a node
            if (pass == 1) {
                memcpy(graph->piece_cell[count], node, sizeof node);
                graph->piece_open[count] =
                    complex->piece_cover[p] == ENF_PIECE_OPEN && node[0] >= 0 && node[1] >= 0;
                graph->piece_corner[count] = corners;
                for (int64_t c = pieces->offset[p]; c < pieces->offset[p + 1]; c++) {
                    const double *at = complex->vertex_position[pieces->corners[c].vertex];
                    double *to = graph->corners[corners + c - pieces->offset[p]];
                    for (int k = 0; k < 3; k++) to[k] = at[k] * 0x1p-53;
                }
            }
            corners += pieces->offset[p + 1] - pieces->offset[p];
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
    free(face_cell);
    if (good) return ENF_OK;
    enf_graph_free(graph);
    return enf_fail_memory(error, "the cell graph");
}
