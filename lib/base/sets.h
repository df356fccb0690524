// SPDX-License-Identifier: MIT
// Disjoint sets of numbers: each item points to a smaller one of its set, the smallest to itself (union-find
// with path halving; R. E. Tarjan and J. van Leeuwen, 1984). The smallest item stands for the set, so the
// result does not depend on the order of the unions.
#ifndef ENF_BASE_SETS_H
#define ENF_BASE_SETS_H

#include <stdbool.h>
#include <stdint.h>

static inline void enf_sets_start(int32_t *parent, int32_t count) {
    for (int32_t i = 0; i < count; i++) parent[i] = i;
}

static inline int32_t enf_sets_find(int32_t *parent, int32_t item) {
    while (parent[item] != item) {
        parent[item] = parent[parent[item]];
        item = parent[item];
    }
    return item;
}

/// Most members of large sets point to the same one: no need to look further.
static inline bool enf_sets_joined(int32_t *parent, int32_t a, int32_t b) {
    return parent[a] == parent[b] || enf_sets_find(parent, a) == enf_sets_find(parent, b);
}

static inline void enf_sets_unite(int32_t *parent, int32_t a, int32_t b) {
    a = enf_sets_find(parent, a);
    b = enf_sets_find(parent, b);
    if (a < b) parent[b] = a;
    if (b < a) parent[a] = b;
}

#endif
