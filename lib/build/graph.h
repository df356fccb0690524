// SPDX-License-Identifier: GPL-3.0-or-later
// The cell graph that decimation works on: kept fine cells, and the flat convex pieces between them.
#ifndef ENF_BUILD_GRAPH_H
#define ENF_BUILD_GRAPH_H

#include "build/complex.h"

/// Plain arrays, doubles: decimation steers by areas, nothing topological is decided from these coordinates.
/// Graph units are grid steps times 2^53, so coordinates are within [-1, 1].
typedef struct enf_graph {
    int32_t cell_count;

    int32_t piece_count;
    int32_t (
        *piece_cell)[2]; ///< the cell behind the piece (its normal points away from it) and the cell in front
                         ///< of it; -1 on either side: nothing kept there (wall, hull or discarded region)
    bool *piece_open;    ///< true: one can pass (a graph edge, both cells >= 0); false: occluded or boundary
    int64_t *piece_corner;       ///< piece_count + 1 offsets into corners
    int32_t *corners;            ///< vertices: convex polygons, counter-clockwise seen from the front
    const double (*vertices)[3]; ///< borrowed from the complex; equal ones may have several numbers
    double scale;                ///< coordinates times this are in graph units; a power of two
} enf_graph;

void enf_graph_free(enf_graph *graph);

/// The graph over the fine cells with node_of[cell] >= 0: the number of the node they belong to,
/// 0..node_count-1. A node is a convex fine cell, with the hairline cells that go with it (build/hairline.h).
enf_status enf_graph_build(enf_graph *graph, const enf_complex *complex, const int32_t *node_of,
                           int32_t node_count, enf_error *error);

#endif
