// SPDX-License-Identifier: MIT
// E. W. Dijkstra, "A note on two problems in connexion with graphs", Numerische Mathematik 1 (1959). Gates
// have no direction here: a path that goes to a gate's point and back into the same cell is always longer
// than the straight step (see path_graph.h).
#include "run/path_spread.h"

#include "base/array.h"

#include <stdlib.h>

bool enf_path_spread_make(enf_path_spread *spread, const enf_paths *paths) {
    *spread = (enf_path_spread){.paths = paths};
    bool good = enf_path_heap_make(&spread->heap, paths->gate_count);
    spread->cost = enf_array_new((size_t)paths->gate_count, sizeof *spread->cost);
    return good && spread->cost;
}

void enf_path_spread_free(enf_path_spread *spread) {
    enf_path_heap_free(&spread->heap);
    free(spread->cost);
}

static void reach(enf_path_spread *s, int32_t portal, int64_t cost) {
    int32_t gate = s->paths->gate[portal / 2];
    if (s->cost[gate] <= cost) return;
    if (s->cost[gate] == ENF_PATH_NEVER)
        enf_path_heap_add(&s->heap, gate, cost);
    else
        enf_path_heap_sink(&s->heap, gate, cost);
    s->cost[gate] = cost;
}

/// From a portal's point through the cell it leads out of, if that is a junction, and along its chain.
static void go_on(enf_path_spread *s, int32_t portal, int64_t cost) {
    const enf_paths *paths = s->paths;
    int32_t cell = paths->view->portals[portal].from, count;
    if (!paths->is_junction[cell]) return;
    const int32_t *exits = enf_path_exits(paths, cell, &count);
    for (int32_t i = 0; i < count; i++)
        if (exits[i] / 2 != portal / 2)
            reach(s, exits[i],
                  cost +
                      enf_path_step(paths, enf_path_place(paths, portal), enf_path_place(paths, exits[i])));
    int32_t tail = paths->tail[portal];
    if (tail != portal) reach(s, tail, cost + paths->offset[tail]);
}

void enf_path_spread_run(enf_path_spread *s, int32_t start) {
    for (int32_t i = 0; i < s->paths->gate_count; i++) s->cost[i] = ENF_PATH_NEVER;
    s->heap.count = 0;
    reach(s, 2 * s->paths->gate_pair[start], 0);
    while (s->heap.count > 0) {
        enf_path_heap_entry first = enf_path_heap_pop(&s->heap);
        for (int k = 0; k < 2; k++) go_on(s, 2 * s->paths->gate_pair[first.node] + k, first.key);
    }
}
