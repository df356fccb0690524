// SPDX-License-Identifier: GPL-3.0-or-later
// Fuzz target for the reader of portal files (libFuzzer: clang -fsanitize=fuzzer,address,undefined; also
// called by test_prt.c with mutated files). Whatever the bytes are, the outcome is an error that names a line
// or a graph that keeps its promises.
#include "visibility/read_prt.h"
#include "visibility/winding.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void require(bool promise) {
    if (!promise) abort();
}

static void check_openings(const enf_portal_graph *graph) {
    require(graph->opening_corner[0] == 0);
    for (int32_t i = 0; i < graph->opening_count; i++) {
        int32_t first = graph->opening_corner[i], end = graph->opening_corner[i + 1], corner;
        require(end - first >= 3 && end - first <= ENF_WINDING_CORNERS_MAX);
        require(enf_winding_judge((const double(*)[3])graph->corners + first, end - first, &corner) ==
                ENF_WINDING_FINE);
        for (int side = 0; side < 2; side++)
            require(graph->opening_cell[i][side] >= 0 && graph->opening_cell[i][side] < graph->cell_count);
        require(graph->opening_cell[i][0] != graph->opening_cell[i][1]);
        for (int32_t k = first; k < end; k++)
            for (int a = 0; a < 3; a++) require(isfinite(graph->corners[k][a]));
    }
}

static void check_cells(enf_portal_graph *graph) {
    require(graph->cell_portal[0] == 0 && graph->cell_portal[graph->cell_count] == 2 * graph->opening_count);
    for (int32_t cell = 0; cell < graph->cell_count; cell++)
        for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++)
            require(enf_portal_from(graph, graph->cell_portals[k]) == cell);
    for (int32_t leaf = 0; leaf < graph->leaf_count; leaf++)
        require(graph->leaf_cell[leaf] >= 0 && graph->leaf_cell[leaf] < graph->cell_count);
    enf_portal_graph_find_non_convex(graph);
    require((graph->non_convex_cells > 0) == (graph->first_non_convex_cell >= 0));
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    char *copy = calloc(size + 1, 1); // exactly as large, so that a sanitizer sees one byte too many
    enf_portal_graph graph = {0};
    enf_source source = {0};
    enf_error error = {0};
    if (!copy) return 0;
    if (size) memcpy(copy, data, size);
    enf_status status = enf_source_over(&source, "fuzz", copy, size, &error);
    if (!status) status = enf_read_prt(&graph, &source, &error);
    enf_source_close(&source);
    if (!status) {
        check_openings(&graph);
        check_cells(&graph);
    } else {
        require(status == ENF_NO_RESOURCES || strncmp(error.text, "fuzz:", 5) == 0);
        require(!graph.corners && !graph.cell_portal && !graph.leaf_cell);
    }
    enf_portal_graph_free(&graph);
    free(copy);
    return 0;
}
