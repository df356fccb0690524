// SPDX-License-Identifier: MIT
#include "run/path_table.h"

#include "run/path_spread.h"

#include <stdlib.h>

uint64_t enf_path_table_size(const enf_paths *paths) {
    uint64_t count = (uint64_t)paths->gate_count;
    return count * (count + 1) / 2 * sizeof *paths->table;
}

static int64_t *entry(const enf_paths *paths, int32_t a, int32_t b) {
    size_t high = (size_t)(a > b ? a : b), low = (size_t)(a > b ? b : a);
    return &paths->table[high * (high + 1) / 2 + low];
}

bool enf_path_table_make(enf_paths *paths) {
    uint64_t size = enf_path_table_size(paths);
    if (size > PTRDIFF_MAX) return false;
    enf_path_spread spread;
    paths->table = malloc((size_t)size + 1);
    bool good = enf_path_spread_make(&spread, paths) && paths->table;
    for (int32_t i = 0; good && i < paths->gate_count; i++) {
        enf_path_spread_run(&spread, i);
        for (int32_t k = 0; k <= i; k++) *entry(paths, i, k) = spread.cost[k];
    }
    enf_path_spread_free(&spread);
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
