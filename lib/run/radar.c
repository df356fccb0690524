// SPDX-License-Identifier: MIT
// Cells near a point, by a search that spreads portal by portal.
#include "run/path_finder.h"

#include <math.h>
#include <string.h>

typedef struct radar {
    enf_path_finder *finder;
    const enf_instance *instance;
    int64_t most; ///< units
    enf_near_cell *out;
    int32_t capacity, count;
} radar;

static void forget_cells(enf_path_finder *finder) {
    if (++finder->cell_now != 0) return;
    memset(finder->cell_stamp, 0, (size_t)finder->paths->view->cell_count * sizeof *finder->cell_stamp);
    finder->cell_now = 1;
}

static void list_cell(radar *r, int32_t cell, int32_t portal, int64_t cost) {
    enf_path_finder *finder = r->finder;
    if (finder->cell_stamp[cell] == finder->cell_now) return;
    finder->cell_stamp[cell] = finder->cell_now;
    if (r->count < r->capacity)
        r->out[r->count] = (enf_near_cell){cell, portal, (double)cost / finder->paths->unit};
    r->count++;
}

/// To all portals that lead out of a cell, from a place in it.
static void spread(radar *r, int32_t cell, int32_t came, const double place[3], int64_t cost) {
    const enf_paths *paths = r->finder->paths;
    int32_t count;
    const int32_t *exits = enf_path_exits(paths, cell, &count);
    for (int32_t i = 0; i < count; i++) {
        int64_t next = cost + enf_path_step(paths, place, enf_path_place(paths, exits[i]));
        if (exits[i] != came && next <= r->most)
            enf_path_search_reach(&r->finder->search, exits[i], next, next);
    }
}

static void run(radar *r, int32_t cell, const double place[3]) {
    enf_path_search *search = &r->finder->search;
    const int32_t *transforms;
    bool plain = enf_instance_transforms(r->instance, &transforms) == 0; // or else a twin may lead elsewhere
    enf_path_search_begin(search);
    forget_cells(r->finder);
    list_cell(r, cell, -1, 0);
    spread(r, cell, -1, place, 0);
    while (search->heap.count > 0 && r->count <= r->capacity) {
        int32_t portal = enf_path_heap_pop(&search->heap).node;
        enf_passage passage = enf_instance_passage(r->instance, r->finder->paths->view, portal);
        double out[3];
        if (passage.to < 0) continue;
        enf_path_come_out(r->finder->paths, portal, passage.matrix, out);
        list_cell(r, passage.to, portal, search->cost[portal]);
        spread(r, passage.to, plain ? portal ^ 1 : -1, out, search->cost[portal]);
    }
}

enf_status enf_path_near(enf_path_finder *finder, const enf_instance *instance, int32_t cell,
                         const double point[3], double distance, enf_near_cell *out, int32_t capacity,
                         int32_t *count, enf_error *error) {
    *count = 0;
    const enf_paths *paths = finder->paths;
    enf_path_goal start;
    if (!point) return enf_fail(error, ENF_BAD_USAGE, "what is near needs a point");
    if (isnan(distance)) return enf_fail(error, ENF_BAD_USAGE, "the distance is no number");
    enf_status status = enf_path_find_goal(paths, cell, point, &start, error);
    if (status || start.cell < 0 || distance < 0) return status;
    double units = distance * paths->unit;
    radar r = {finder, instance, units < 0x1p62 ? (int64_t)units : ENF_PATH_NEVER, out, capacity, 0};
    run(&r, start.cell, start.point);
    *count = r.count;
    return ENF_OK;
}
