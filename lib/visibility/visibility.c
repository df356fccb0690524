// SPDX-License-Identifier: GPL-3.0-or-later
// Provisional: only what is connected, by flood.
#include "visibility/visibility.h"

#include "base/array.h"
#include "base/timer.h"

#include <stdlib.h>
#include <string.h>

static const char *const names[ENF_METHOD_COUNT] = {"reach", "facing", "hourglass", "lp", "exact"};

const char *enf_method_name(enf_method method) {
    return names[method];
}

bool enf_method_find(const char *name, enf_method *method) {
    for (int i = 0; i < ENF_METHOD_COUNT; i++) {
        if (strcmp(names[i], name) != 0) continue;
        *method = (enf_method)i;
        return true;
    }
    return false;
}

/// Everything that is connected with the cell. `queue` has room for all cells.
static void flood(enf_pvs *pvs, const enf_portal_graph *graph, int32_t cell, int32_t *queue) {
    int32_t count = 0;
    queue[count++] = cell;
    for (int32_t at = 0; at < count; at++)
        for (int32_t k = graph->cell_portal[queue[at]]; k < graph->cell_portal[queue[at] + 1]; k++) {
            int32_t to = enf_portal_to(graph, graph->cell_portals[k]);
            if (enf_pvs_get(pvs, cell, to)) continue;
            enf_pvs_set(pvs, cell, to);
            queue[count++] = to;
        }
}

static enf_status flood_all(enf_visibility *visibility, const enf_portal_graph *graph,
                            const enf_visibility_options *options, enf_error *error) {
    int32_t *queue = enf_array_new((size_t)graph->cell_count, sizeof *queue);
    enf_status status = queue ? ENF_OK : enf_fail_memory(error, "the visible sets");
    for (int32_t i = 0; !status && i < graph->cell_count; i++) {
        flood(&visibility->pvs, graph, i, queue);
        if (options->progress &&
            !options->progress(options->progress_user, "reach", (double)i / graph->cell_count))
            status = enf_fail(error, ENF_NO_RESOURCES, "cancelled");
    }
    free(queue);
    return status;
}

enf_status enf_visibility_run(enf_visibility *visibility, const enf_portal_graph *graph,
                              const enf_visibility_options *options, enf_error *error) {
    double started = enf_timer_now(), cpu_started = enf_timer_cpu();
    *visibility = (enf_visibility){.method = options->method};
    if (options->method != ENF_METHOD_REACH)
        return enf_fail(error, ENF_BAD_USAGE, "--method %s is not built yet; use reach",
                        enf_method_name(options->method));
    enf_status status = enf_pvs_new(&visibility->pvs, graph->cell_count, error);
    if (!status) status = flood_all(visibility, graph, options, error);
    visibility->seconds = enf_timer_now() - started;
    visibility->cpu_seconds = enf_timer_cpu() - cpu_started;
    return status;
}

void enf_visibility_free(enf_visibility *visibility) {
    enf_pvs_free(&visibility->pvs);
    free(visibility->witnesses);
    free(visibility->witness_cells);
    *visibility = (enf_visibility){0};
}
