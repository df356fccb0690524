// SPDX-License-Identifier: MIT
// One search per gate: E. W. Dijkstra, "A note on two problems in connexion with graphs", Numerische
// Mathematik 1 (1959). Gates have no direction here: a path that goes to a gate's point and back into the
// same cell is always longer than the straight step (see path_graph.h).
#include "run/path_table.h"

#include "base/array.h"
#include "run/path_heap.h"

#include <stdlib.h>

uint64_t enf_path_table_size(const enf_paths *paths) {
    uint64_t count = (uint64_t)paths->gate_count;
    return count * (count + 1) / 2 * sizeof *paths->table;
}

static int64_t *entry(const enf_paths *paths, int32_t a, int32_t b) {
    size_t high = (size_t)(a > b ? a : b), low = (size_t)(a > b ? b : a);
    return &paths->table[high * (high + 1) / 2 + low];
}

typedef struct spreading {
    const enf_paths *paths;
    enf_path_heap heap;
    int64_t *cost; ///< per gate
    int8_t *state; ///< per gate: 0 not seen, 1 in the heap, 2 done
} spreading;

static void reach(spreading *s, int32_t portal, int64_t cost) {
    int32_t gate = s->paths->gate[portal / 2];
    if (s->state[gate] == 2 || (s->state[gate] == 1 && s->cost[gate] <= cost)) return;
    if (s->state[gate] == 0)
        enf_path_heap_add(&s->heap, gate, cost);
    else
        enf_path_heap_sink(&s->heap, gate, cost);
    s->state[gate] = 1;
    s->cost[gate] = cost;
}

/// From a portal's point through the cell it leads out of, if that is a junction, and along its chain.
static void spread(spreading *s, int32_t portal, int64_t cost) {
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

static void search_from(spreading *s, int32_t start) {
    const enf_paths *paths = s->paths;
    for (int32_t i = 0; i < paths->gate_count; i++) s->state[i] = 0;
    reach(s, 2 * paths->gate_pair[start], 0);
    while (s->heap.count > 0) {
        enf_path_heap_entry first = enf_path_heap_pop(&s->heap);
        s->state[first.node] = 2;
        for (int k = 0; k < 2; k++) spread(s, 2 * paths->gate_pair[first.node] + k, first.key);
    }
    for (int32_t i = 0; i <= start; i++) *entry(paths, start, i) = s->state[i] ? s->cost[i] : ENF_PATH_NEVER;
}

bool enf_path_table_make(enf_paths *paths) {
    uint64_t size = enf_path_table_size(paths);
    if (size > PTRDIFF_MAX) return false;
    size_t gates = (size_t)paths->gate_count;
    spreading s = {.paths = paths};
    bool good = enf_path_heap_make(&s.heap, paths->gate_count);
    paths->table = malloc((size_t)size + 1);
    s.cost = enf_array_new(gates, sizeof *s.cost);
    s.state = enf_array_new(gates, sizeof *s.state);
    good = good && paths->table && s.cost && s.state;
    for (int32_t i = 0; good && i < paths->gate_count; i++) search_from(&s, i);
    enf_path_heap_free(&s.heap);
    free(s.cost);
    free(s.state);
    return good;
}

/// The gate on the way on from a portal, and the length up to it. Before a portal: `backward`.
static int32_t gate_of(const enf_paths *paths, int32_t portal, bool backward, int64_t *length) {
    *length = 0;
    if (paths->gate[portal / 2] >= 0) return paths->gate[portal / 2];
    int32_t end = backward ? paths->head[portal] : paths->tail[portal];
    *length = backward ? paths->offset[portal] : paths->offset[end] - paths->offset[portal];
    return paths->gate[end / 2];
}

int64_t enf_path_table_rest(const enf_paths *paths, int32_t portal, const enf_path_goal *goal) {
    int64_t best = ENF_PATH_NEVER, before, behind;
    int32_t count, from = gate_of(paths, portal, false, &before);
    const int32_t *exits = enf_path_exits(paths, goal->cell, &count);
    for (int32_t i = 0; i < count; i++) {
        int32_t last = exits[i] ^ 1, to = gate_of(paths, last, true, &behind);
        int64_t end = enf_path_last_step(paths, last, goal), length = ENF_PATH_NEVER;
        if (paths->head[portal] == paths->head[last] && paths->offset[portal] <= paths->offset[last])
            length = paths->offset[last] - paths->offset[portal];
        int64_t between = from < 0 || to < 0 ? ENF_PATH_NEVER : *entry(paths, from, to);
        if (between < ENF_PATH_NEVER && before + between + behind < length)
            length = before + between + behind;
        if (length < ENF_PATH_NEVER && length + end < best) best = length + end;
    }
    return best;
}
