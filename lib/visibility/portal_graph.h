// SPDX-License-Identifier: GPL-3.0-or-later
// Cells and the openings between them, as visibility sees them: from a .prt file or from a compiled world.
#ifndef ENF_VISIBILITY_PORTAL_GRAPH_H
#define ENF_VISIBILITY_PORTAL_GRAPH_H

#include "enfilade/base.h"

/// Openings have two directed portals: portal 2k leads through opening k from its first cell into its second,
/// portal 2k + 1 (= 2k ^ 1, its twin) back. A line passes portal 2k if it passes all edges of the winding on
/// the inner side, strictly, in the direction of the winding's normal (right-hand rule); the twin, against
/// it. A winding is planar only up to rounding: where the line comes to the portal is where it goes through
/// the fan of triangles from the winding's first corner. Portals are passed in order if each is come to after
/// the one before it, strictly.
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

    // Found by enf_portal_graph_find_non_convex.
    int32_t non_convex_cells, first_non_convex_cell; ///< how many; the first of them, or -1
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

/// Once all openings are there: which portals leave which cell. No array is null then.
enf_status enf_portal_graph_finish(enf_portal_graph *graph, enf_error *error);

void enf_portal_graph_free(enf_portal_graph *graph);

/// False if a corner of one of the cell's portals lies on the wrong side of the plane of another, by more
/// than enf_winding_tolerance of the two. A cell with portals on one side only may hide more from this.
bool enf_portal_graph_is_convex(const enf_portal_graph *graph, int32_t cell);

/// Counts the cells that are not convex in a finished graph. Line of sight inside of such a cell is not
/// certain.
void enf_portal_graph_find_non_convex(enf_portal_graph *graph);

/// Reads a .prt file (PRT1, PRT1-AM, PRT2; gzipped or not; "-": standard input) and finishes the graph, which
/// is overwritten. ENF_BAD_INPUT with file and line for whatever is not as the format says (read_prt.h), and
/// ENF_NO_RESOURCES if the file cannot be read; the graph is empty then.
enf_status enf_portal_graph_read(enf_portal_graph *graph, const char *path, enf_error *error);

#endif
