// SPDX-License-Identifier: MIT
#include "run/changed.h"

#include "run/take.h"

#include <string.h>

/// The pair of portals that a child of a node is a polygon of; -1: it is none.
static int32_t pair_of(const enf_file_view *view, int32_t child) {
    if (child >= -1) return -1;
    const enf_file_barrier *barrier = &view->barriers[-2 - child];
    return barrier->kind == ENF_FILE_BARRIER_PORTAL ? barrier->index / 2 : -1;
}

/// Counts the polygons of each pair: pair_first[p + 1] is where the ones of pair p end.
static void count_polygons(enf_changed *changed, const enf_file_view *view) {
    const int32_t pairs = view->portal_count / 2;
    for (int32_t n = 0; n < changed->node_count; n++) {
        for (int k = 0; k < 4; k++) {
            int32_t pair = pair_of(view, view->portal_nodes[n].child[k]);
            if (pair >= 0) changed->pair_first[pair + 1]++;
        }
    }
    for (int32_t p = 0; p < pairs; p++) changed->pair_first[p + 1] += changed->pair_first[p];
}

/// Fills in parents and the nodes of each pair; pair_first ends up one place further than it was.
static void link_nodes(enf_changed *changed, const enf_file_view *view) {
    changed->parent[0] = -1;
    for (int32_t n = 0; n < changed->node_count; n++) {
        for (int k = 0; k < 4; k++) {
            int32_t child = view->portal_nodes[n].child[k], pair = pair_of(view, child);
            if (child >= 0) changed->parent[child] = n;
            if (pair >= 0) changed->nodes[changed->pair_first[pair]++] = n;
        }
    }
}

bool enf_changed_make(enf_changed *changed, const enf_file_view *view) {
    *changed = (enf_changed){0};
    if (!view->portal_nodes || view->portal_node_count == 0) return true;
    const size_t nodes = (size_t)view->portal_node_count, pairs = (size_t)view->portal_count / 2;
    changed->node_count = view->portal_node_count;
    changed->below = enf_take(nodes, sizeof *changed->below);
    changed->parent = enf_take(nodes, sizeof *changed->parent);
    changed->pair_first = enf_take(pairs + 1, sizeof *changed->pair_first);
    if (!changed->below || !changed->parent || !changed->pair_first) return false;
    count_polygons(changed, view);
    changed->nodes = enf_take((size_t)changed->pair_first[pairs], sizeof *changed->nodes);
    if (!changed->nodes) return false;
    link_nodes(changed, view);
    memmove(changed->pair_first + 1, changed->pair_first, pairs * sizeof *changed->pair_first);
    changed->pair_first[0] = 0;
    return true;
}

void enf_changed_free(enf_changed *changed) {
    free(changed->below);
    free(changed->parent);
    free(changed->pair_first);
    free(changed->nodes);
}

void enf_changed_add(enf_changed *changed, int32_t pair, int32_t change) {
    if (changed->node_count == 0) return;
    for (int32_t i = changed->pair_first[pair]; i < changed->pair_first[pair + 1]; i++)
        for (int32_t node = changed->nodes[i]; node >= 0; node = changed->parent[node])
            atomic_fetch_add_explicit(&changed->below[node], change, memory_order_relaxed);
}
