// SPDX-License-Identifier: MIT
#include "run/query.h"

#include "base/options.h"
#include "run/open.h"
#include "run/take.h"

#include <math.h>
#include <stdlib.h>

enum { CELLS_MORE = 1024, IMAGES_DEFAULT = 64 };

static enf_status check_options(const enf_query_options *options, enf_error *error) {
    if (options->cells_max >= 0 && options->images_max >= 0) return ENF_OK;
    return enf_fail(error, ENF_BAD_USAGE, "a query object for %ld cells and %ld images; give numbers from 0",
                    (long)options->cells_max, (long)options->images_max);
}

enf_status enf_query_create(enf_query **out, const enf_world *world, const enf_query_options *given,
                            enf_error *error) {
    *out = NULL;
    enf_query_options chosen, *options = &chosen;
    enf_status status = enf_options_take(&chosen, sizeof chosen, given, "enf_query_options", error);
    if (!status) status = check_options(options, error);
    uint32_t loads = ENF_LOAD_CELLS | ENF_LOAD_LOCATION;
    if (!status) status = enf_world_need(world, loads | (options->skip_triangles ? 0 : ENF_LOAD_DRAW), error);
    if (status) return status;
    enf_query *query = calloc(1, sizeof *query);
    if (!query) return enf_fail_memory(error, "a query object");
    const enf_file_view *view = enf_world_file(world);
    query->world = world;
    query->view = view;
    for (int a = 0; a < 3; a++)
        query->world_size =
            fmax(query->world_size, fmax(fabs(view->frame->box_min[a]), fabs(view->frame->box_max[a])));
    int32_t most = view->cell_count < INT32_MAX - CELLS_MORE ? view->cell_count + CELLS_MORE : INT32_MAX;
    query->flooded_max = options->cells_max ? options->cells_max : most;
    query->images_max = options->images_max ? options->images_max : IMAGES_DEFAULT;
    query->seen = enf_take((size_t)view->cell_count, sizeof *query->seen);
    query->first = enf_take((size_t)view->cell_count, sizeof *query->first);
    query->flooded = enf_take((size_t)query->flooded_max, sizeof *query->flooded);
    query->images = enf_take((size_t)query->images_max, sizeof *query->images);
    bool taken = query->seen && query->first && query->flooded && query->images;
    if (!options->skip_triangles) {
        query->triangle_seen = enf_take((size_t)view->triangle_count, sizeof *query->triangle_seen);
        taken = taken && query->triangle_seen;
    }
    if (!taken) {
        enf_query_free(query);
        return enf_fail_memory(error, "a query object");
    }
    if (query->triangle_seen) enf_near_prepare(&query->near_index, view, query->triangle_seen);
    *out = query;
    return ENF_OK;
}

void enf_query_free(enf_query *query) {
    if (!query) return;
    free(query->seen);
    free(query->first);
    free(query->flooded);
    free(query->images);
    free(query->triangle_seen);
    free(query);
}
