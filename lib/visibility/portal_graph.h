// SPDX-License-Identifier: GPL-3.0-or-later
// Cells and the openings between them, as visibility sees them: from a .prt file or from a compiled world.
#ifndef ENF_VISIBILITY_PORTAL_GRAPH_H
#define ENF_VISIBILITY_PORTAL_GRAPH_H

#include "enfilade/base.h"

/// Openings have two directed portals: portal 2k leads through opening k from its first cell into its second,
/// portal 2k + 1 (= 2k ^ 1, its twin) back. A line passes portal 2k if it passes all edges of the winding on
/// the inner side, strictly, in the direction of the winding's normal (right-hand rule); the twin, against
/// it.
typedef struct enf_portal_graph {
    int32_t cell_count;         ///< clusters of a .prt
    int32_t opening_count;      ///< pairs of directed portals
    int32_t (*opening_cell)[2]; ///< the winding's normal points from the first into the second; they differ
    int32_t *opening_corner;    ///< opening_count + 1 offsets into corners
    double (*corners)[3];       ///< convex windings, 3 or more corners each, finite, in the file's units
    size_t corner_capacity, opening_capacity;

    int32_t leaf_count; ///< of a .prt; 0: every cell is one leaf
    int32_t *leaf_cell; ///< leaf_count: the cell of each leaf; null if leaf_count is 0

    // Made by enf_portal_graph_finish.
    int32_t *cell_portal;  ///< cell_count + 1 offsets into cell_portals
    int32_t *cell_portals; ///< the directed portals that lead out of each cell, ascending
} enf_portal_graph;

static inline int32_t enf_portal_from(const enf_portal_graph *graph, int32_t portal) {
    return graph->opening_cell[portal >> 1][portal & 1];
}

static inline int32_t enf_portal_to(const enf_portal_graph *graph, int32_t portal) {
    return graph->opening_cell[portal >> 1][!(portal & 1)];
}

/// Adds an opening; the corners are copied. False without memory.
bool enf_portal_graph_add(enf_portal_graph *graph, int32_t from, int32_t to, const double (*corners)[3],
                          int32_t count);

/// Once all openings are there: which portals leave which cell.
enf_status enf_portal_graph_finish(enf_portal_graph *graph, enf_error *error);

void enf_portal_graph_free(enf_portal_graph *graph);

/// Reads a .prt file (PRT1, PRT1-AM, PRT2; gzipped or not; "-": standard input) and finishes the graph.
/// ENF_BAD_INPUT with file and line for whatever is not as the format says.
enf_status enf_portal_graph_read(enf_portal_graph *graph, const char *path, enf_error *error);

#endif
