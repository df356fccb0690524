// SPDX-License-Identifier: MIT
// Views: options and memory.
#include "enfilade/view.h"

#include "base/options.h"
#include "run/open.h"
#include "run/view_parts.h"

#include <math.h>
#include <stdlib.h>

enum { EDGES_DEFAULT = 8, REGIONS_DEFAULT = 8, TRANSFORMS_DEFAULT = 4, VISITS_DEFAULT = 16384 };

static enf_status fill_options(enf_view *view, enf_error *error) {
    enf_view_options *o = &view->options;
    if (o->edges_max == 0) o->edges_max = EDGES_DEFAULT;
    if (o->edges_max > ENF_VIEW_EDGES_MAX) o->edges_max = ENF_VIEW_EDGES_MAX;
    if (o->regions_max == 0) o->regions_max = REGIONS_DEFAULT;
    if (o->transforms_max == 0) o->transforms_max = TRANSFORMS_DEFAULT;
    if (o->visit_capacity == 0) {
        int64_t most = 2 * (int64_t)view->file->cell_count + 64;
        o->visit_capacity = most < VISITS_DEFAULT ? (int32_t)most : VISITS_DEFAULT;
    }
    if (o->edges_max < 4) return enf_fail(error, ENF_BAD_USAGE, "a region needs 4 edges or more");
    if (o->regions_max < 0 || o->visit_capacity < 0 || o->visit_capacity > INT32_MAX / 4)
        return enf_fail(error, ENF_BAD_USAGE, "a view's capacities must be above 0 and below %d",
                        INT32_MAX / 4);
    if (!(o->pixels_min >= 0)) return enf_fail(error, ENF_BAD_USAGE, "an area can't be less than 0");
    if ((unsigned)o->outside > ENF_VIEW_OUTSIDE_ALL)
        return enf_fail(error, ENF_BAD_USAGE, "outside: nothing or all");
    return ENF_OK;
}

static double find_reach(const enf_file_view *file) {
    double reach = 0;
    for (int a = 0; a < 3; a++)
        reach = fmax(reach, fmax(fabs(file->frame->box_min[a]), fabs(file->frame->box_max[a])));
    return reach;
}

enf_status enf_view_create(enf_view **out, const enf_world *world, const enf_view_options *options,
                           enf_error *error) {
    *out = NULL;
    enf_view_options chosen;
    enf_status status = enf_options_take(&chosen, sizeof chosen, options, "enf_view_options", error);
    if (!status) status = enf_world_need(world, ENF_LOAD_CELLS | ENF_LOAD_LOCATION | ENF_LOAD_SEEN, error);
    if (status) return status;
    enf_view *view = calloc(1, sizeof *view);
    if (!view) return enf_fail_memory(error, "a view");
    view->options = chosen;
    view->world = world;
    view->file = enf_world_file(world);
    view->reach = find_reach(view->file);
    view->hint = -1;
    status = fill_options(view, error);
    if (!status) {
        const enf_view_options *o = &view->options;
        int32_t cells = view->file->cell_count;
        view->entry_capacity = cells > o->visit_capacity ? cells : o->visit_capacity;
        bool fits = enf_queue_create(&view->queue, o);
        fits = enf_seen_create(&view->seen, view->file) && fits;
        view->entries = calloc((size_t)view->entry_capacity + 1, sizeof *view->entries);
        view->order = calloc((size_t)view->entry_capacity + 1, sizeof *view->order);
        if (!fits || !view->entries || !view->order) status = enf_fail_memory(error, "a view");
    }
    if (status) {
        enf_view_free(view);
        return status;
    }
    *out = view;
    return ENF_OK;
}

void enf_view_free(enf_view *view) {
    if (!view) return;
    enf_queue_free(&view->queue);
    enf_seen_free(&view->seen);
    free(view->entries);
    free(view->order);
    free(view);
}
