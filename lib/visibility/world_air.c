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
    if (!status) status = enf_air_openings_make(&air->graph, tree, walls, &air->parts, size, error);
    air->is_partitioned = !status;
    return status;
}

enf_status enf_world_air_make(enf_world_air *air, const enf_file_view *view, enf_error *error) {
    *air = (enf_world_air){0};
    if (!view->has_exact) return enf_world_graph_make(&air->graph, view, error);
    enf_walls walls;
    enf_air_tree tree = {0};
    double size = size_of(view);
    enf_status status = enf_air_walls_make(&walls, view, error);
    enf_air_outcome outcome = ENF_AIR_DONE;
    if (!status) outcome = enf_air_tree_make(&tree, &walls, size);
    if (outcome == ENF_AIR_NO_MEMORY) status = enf_fail_memory(error, "the partition of the air");
    if (!status && outcome == ENF_AIR_DONE) status = partition(air, &tree, &walls, view, size, error);
    if (!status && outcome == ENF_AIR_TOO_DEEP) status = enf_world_graph_make(&air->graph, view, error);
    enf_air_tree_free(&tree);
    enf_walls_free(&walls);
    return status;
}

void enf_world_air_free(enf_world_air *air) {
    enf_portal_graph_free(&air->graph);
    enf_air_parts_free(&air->parts);
    *air = (enf_world_air){0};
}
