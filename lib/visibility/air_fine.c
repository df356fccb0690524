// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/air_fine.h"

#include "base/array.h"
#include "format/frame.h"
#include "visibility/fine_vertices.h"
#include "visibility/world_graph.h"

#include <stdlib.h>

static bool add_body(enf_bodies *bodies, size_t *capacity, const enf_file_view *view, int32_t fine,
                     enf_fine_vertices *list) {
    int32_t made = bodies->corner_first[bodies->count];
    if (!enf_fine_vertices_take(list, view, fine) ||
        !enf_array_reserve(bodies->corners, *capacity, made + list->count))
        return false;
    for (int32_t i = 0; i < list->count; i++)
        enf_view_to_world(view, view->vertex_position[list->vertices[i]], bodies->corners[made++]);
    bodies->owner[bodies->count++] = view->fine_cell[fine];
    bodies->corner_first[bodies->count] = made;
    return true;
}

static bool make_bodies(enf_bodies *bodies, const enf_file_view *view, int threads) {
    const size_t fine_count = (size_t)view->fine_count;
    enf_fine_vertices list = {0};
    size_t capacity = 0;
    *bodies = (enf_bodies){.cell_count = view->fine_count, .owner_count = view->cell_count};
    bodies->cell_first = enf_array_new(fine_count + 1, sizeof *bodies->cell_first);
    bodies->owner = enf_array_new(fine_count, sizeof *bodies->owner);
    bodies->corner_first = enf_array_zeroed(fine_count + 1, sizeof *bodies->corner_first);
    bool good = bodies->cell_first && bodies->owner && bodies->corner_first;
    for (int32_t fine = 0; good && fine < view->fine_count; fine++) {
        bodies->cell_first[fine] = bodies->count;
        if (view->fine_cell[fine] >= 0) good = add_body(bodies, &capacity, view, fine, &list);
    }
    if (good) bodies->cell_first[view->fine_count] = bodies->count;
    free(list.vertices);
    return good && enf_bodies_finish(bodies, threads);
}

enf_status enf_air_fine_make(enf_portal_graph *leafs, enf_air_parts *parts, const enf_file_view *view,
                             int threads, enf_error *error) {
    *parts = (enf_air_parts){0};
    enf_status status = enf_world_graph_make_fine(leafs, view, error);
    if (!status && !make_bodies(&parts->bodies, view, threads))
        status = enf_fail_memory(error, "the fine cells");
    return status;
}
