// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/world_air.h"

#include "visibility/air_openings.h"
#include "visibility/world_graph.h"

#include <math.h>

/// The largest coordinate in magnitude.
static double size_of(const enf_file_view *view) {
    double size = 0;
    for (int axis = 0; axis < 3; axis++) {
        size = fmax(size, fabs(view->frame->box_min[axis]));
        size = fmax(size, fabs(view->frame->box_max[axis]));
    }
    return size;
}

static enf_status partition(enf_world_air *air, const enf_air_tree *tree, const enf_walls *walls,
                            const enf_file_view *view, double size, enf_error *error) {
    enf_status status = enf_air_parts_make(&air->parts, tree, view, error);
    if (!status) status = enf_air_openings_make(&air->leafs, tree, walls, &air->parts, size, error);
    return status;
}

/// Walls of rock that share no planes make more leafs than cells. Beams through leafs take about as many
/// times longer as there are more openings, and more memory by the square; they are not worth more than this.
static const double leafs_worth = 4, leafs_most = 8000;

static bool are_worth_it(double leafs, double portals) {
    return leafs <= portals || (leafs <= leafs_worth * (1 + portals) && leafs <= leafs_most);
}

/// Portals of cells are worth looking at where there are not more of them than of leafs.
static void choose(enf_world_air *air, bool is_partitioned) {
    double portals = air->portals.opening_count, leafs = air->leafs.opening_count;
    air->uses_leafs = is_partitioned && are_worth_it(leafs, portals);
    air->uses_portals = !air->uses_leafs || portals <= leafs;
    if (!air->uses_portals) enf_portal_graph_free(&air->portals);
    if (air->uses_leafs) return;
    enf_portal_graph_free(&air->leafs);
    enf_air_parts_free(&air->parts);
}

enf_status enf_world_air_make(enf_world_air *air, const enf_file_view *view, enf_error *error) {
    *air = (enf_world_air){0};
    enf_walls walls = {0};
    enf_air_tree tree = {0};
    enf_air_outcome outcome = ENF_AIR_TOO_DEEP;
    double size = size_of(view);
    enf_status status = enf_world_graph_make(&air->portals, view, error);
    if (!status && view->has_exact) {
        status = enf_air_walls_make(&walls, view, error);
        if (!status) outcome = enf_air_tree_make(&tree, &walls, size);
        if (outcome == ENF_AIR_NO_MEMORY) status = enf_fail_memory(error, "the partition of the air");
    }
    if (!status && outcome == ENF_AIR_DONE) status = partition(air, &tree, &walls, view, size, error);
    if (!status) choose(air, outcome == ENF_AIR_DONE);
    enf_air_tree_free(&tree);
    enf_walls_free(&walls);
    return status;
}

void enf_world_air_free(enf_world_air *air) {
    enf_portal_graph_free(&air->portals);
    enf_portal_graph_free(&air->leafs);
    enf_air_parts_free(&air->parts);
    *air = (enf_world_air){0};
}
