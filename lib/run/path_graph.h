// SPDX-License-Identifier: MIT
// The graph that paths are searched in: a point per pair of portals, and the chains of cells with exactly two
// portals, contracted.
//
// Lengths are whole numbers of a unit, so that sums do not depend on their order, equal lengths are equal,
// and a path can be followed by numbers that add up. A step counts two units more than its straight length,
// rounded down: then a step is always shorter than two steps by way of a third point, however they round.
#ifndef ENF_RUN_PATH_GRAPH_H
#define ENF_RUN_PATH_GRAPH_H

#include "enfilade/path.h"

#define ENF_PATH_NEVER INT64_MAX

struct enf_paths {
    const enf_world *world;
    const enf_file_view *view;
    double unit;        ///< units in a world unit, a power of two
    double longest;     ///< units; no step is longer
    double (*place)[3]; ///< per pair of portals: a point on it, in units
    bool *is_junction;  ///< per cell: it has not just two portals, or is to count as if
    int32_t junction_count;
    int32_t *head, *tail; ///< per portal: the first and last portal of its chain
    int64_t *offset;      ///< per portal: length from the head
    int32_t *gate;        ///< per pair of portals: its number among those next to a junction, or -1
    int32_t gate_count;
    int32_t *gate_pair; ///< per gate
    int64_t *table;     ///< null, or lengths between gates i >= j at i * (i + 1) / 2 + j
    int32_t *component; ///< per cell: the lowest cell that portals connect it with
    int32_t landmark_count;
    int64_t *landmarks; ///< per gate: lengths from all landmarks
};

/// The point of a portal, in units.
static inline const double *enf_path_place(const enf_paths *paths, int32_t portal) {
    return paths->place[portal / 2];
}

/// A point of the world in units.
void enf_path_to_units(const enf_paths *paths, const double world[3], double units[3]);

/// The length of a step, at least 2.
int64_t enf_path_step(const enf_paths *paths, const double a[3], const double b[3]);

/// A straight length, rounded down: no way between the points is shorter.
int64_t enf_path_straight(const enf_paths *paths, const double a[3], const double b[3]);

/// Where one comes out that enters a portal at its point, in units. The matrix of a transform, or null.
void enf_path_come_out(const enf_paths *paths, int32_t portal, const double *matrix, double place[3]);

/// The portals that lead out of a cell.
static inline const int32_t *enf_path_exits(const enf_paths *paths, int32_t cell, int32_t *count) {
    const enf_file_cell *c = &paths->view->cells[cell];
    *count = c->portal_count;
    return paths->view->cell_portals + c->portal_first;
}

/// The portal after one that leads into a cell that is no junction; and the one before one that leads out of
/// such a cell.
int32_t enf_path_after(const enf_paths *paths, int32_t portal);
int32_t enf_path_before(const enf_paths *paths, int32_t portal);

/// Fills all but the table. False without memory.
bool enf_path_graph_make(enf_paths *paths, bool contract);
void enf_path_graph_free(enf_paths *paths);

#endif
