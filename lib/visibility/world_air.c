// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/world_air.h"

#include "visibility/air_fine.h"
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

static enf_status partition(enf_world_air *air, const enf_air_tree *tree, const enf_file_view *view,
                            double size, int threads, enf_error *error) {
    enf_status status = enf_air_parts_make(&air->parts, tree, view, threads, error);
    if (!status) status = enf_air_openings_make(&air->leafs, tree, &air->parts, size, threads, error);
    if (!status && !enf_air_order_make(&air->order, tree, air->parts.leaf_of, air->parts.bodies.cell_count))
        status = enf_fail_memory(error, "the order of the leafs");
    return status;
}

/// Walls of rock that share no planes make more leafs than cells, and more than there are fine cells in the
/// end. Beams through leafs take about as many times longer as there are more openings.
static const double leafs_worth = 4, leafs_most = 8000;

/// So many openings of leafs are worth it.
static double find_most(double portals) {
    return fmax(portals, fmin(leafs_worth * (1 + portals), leafs_most));
}

/// A tree has about as many leafs as walls have planes, and more for the walls that planes cut. (2.2 to 2.9
/// times as many in 25 levels; with next to no cuts, 1.1 times.) So many planes make too many.
static const double planes_share = 0.75;

/// A tree with more leafs has too many openings. (Most leafs are rock, and those that are air have some
/// each.)
static int32_t find_leafs_most(double portals) {
    static const double small = 1000;
    return (int32_t)(small + find_most(portals));
}

/// With leafs of some kind, portals of cells are worth looking at where a partition has more openings.
static enf_status choose(enf_world_air *air, bool is_partitioned, bool only_partition,
                         const enf_file_view *view, int threads, enf_error *error) {
    const double portals = air->portals.opening_count, leafs = air->leafs.opening_count;
    const bool has_partition = is_partitioned && leafs <= find_most(portals);
    air->uses_leafs = has_partition || (view->has_exact && !only_partition);
    air->has_partition = has_partition;
    air->uses_portals = !air->uses_leafs || (has_partition && portals <= leafs);
    if (!air->uses_portals) enf_portal_graph_free(&air->portals);
    if (has_partition || !air->uses_leafs) return ENF_OK;
    enf_portal_graph_free(&air->leafs);
    enf_air_parts_free(&air->parts);
    enf_air_order_free(&air->order);
    return enf_air_fine_make(&air->leafs, &air->parts, view, threads, error);
}

/// Gives up before it begins where planes are too many.
static enf_air_outcome make_tree(enf_air_tree *tree, enf_walls *walls, double size, int32_t leafs_most,
                                 int threads) {
    const int32_t planes = enf_walls_count_planes(walls, size);
    if (planes < 0) return ENF_AIR_NO_MEMORY;
    if (planes > planes_share * leafs_most) return ENF_AIR_TOO_DEEP;
    return enf_air_tree_make(tree, walls, size, leafs_most, threads);
}

enf_status enf_world_air_make(enf_world_air *air, const enf_file_view *view, bool only_partition, int threads,
                              enf_error *error) {
    *air = (enf_world_air){0};
    enf_walls walls = {0};
    enf_air_tree tree = {0};
    enf_air_outcome outcome = ENF_AIR_TOO_DEEP;
    double size = size_of(view);
    enf_status status = enf_world_graph_make(&air->portals, view, error);
    if (!status && view->has_exact) {
        status = enf_air_walls_make(&walls, view, threads, error);
        if (!status)
            outcome = make_tree(&tree, &walls, size, find_leafs_most(air->portals.opening_count), threads);
        if (outcome == ENF_AIR_NO_MEMORY) status = enf_fail_memory(error, "the partition of the air");
    }
    if (!status && outcome == ENF_AIR_DONE) status = partition(air, &tree, view, size, threads, error);
    if (!status) status = choose(air, outcome == ENF_AIR_DONE, only_partition, view, threads, error);
    enf_air_tree_free(&tree);
    enf_walls_free(&walls);
    return status;
}

void enf_world_air_free(enf_world_air *air) {
    enf_portal_graph_free(&air->portals);
    enf_portal_graph_free(&air->leafs);
    enf_air_parts_free(&air->parts);
    enf_air_order_free(&air->order);
    *air = (enf_world_air){0};
}
