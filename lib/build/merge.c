// SPDX-License-Identifier: GPL-3.0-or-later
// Greedy merging in the manner of S. Hertel and K. Mehlhorn (1983): an edge between two convex parts may go
// if both its ends stay convex. A corner that becomes straight goes too, so longer edges can match in later
// rounds.
#include "build/merge.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

typedef struct edge {
    int32_t from, to; ///< vertices
    int32_t loop, corner;
} edge;

static int compare_edges(const void *a, const void *b) {
    const edge *x = a, *y = b;
    if (x->from != y->from) return x->from < y->from ? -1 : 1;
    if (x->to != y->to) return x->to < y->to ? -1 : 1;
    if (x->loop != y->loop) return x->loop < y->loop ? -1 : 1;
    return (x->corner > y->corner) - (x->corner < y->corner);
}

static enf_corner corner_at(const enf_pool *pool, enf_loop loop, int32_t i) {
    return pool->corners[loop.first + (i % loop.count + loop.count) % loop.count];
}

/// The side of `vertex` as seen from edge i of the loop: +1 inside, 0 on the edge's line, -1 outside.
static int inside_edge(enf_pool *pool, enf_loop loop, int32_t i, int32_t vertex) {
    i = (i % loop.count + loop.count) % loop.count;
    int side = enf_geometry_side(&pool->geometry, vertex, corner_at(pool, loop, i).edge_plane);
    return side == 0 ? 0 : side * enf_pool_edge_side(pool, loop, i);
}

static void push_corner(enf_pool *pool, enf_loop *loop, enf_corner corner) {
    if (!enf_array_reserve(pool->corners, pool->corner_capacity, pool->corner_count + 1)) {
        pool->failed = true;
        return;
    }
    pool->corners[pool->corner_count++] = corner;
    loop->count++;
}

/// Joins a and b at a's edge i and b's edge j (the same edge, the other way round) if the union is convex.
static bool join(enf_pool *pool, enf_loop *a, int32_t i, enf_loop b, int32_t j) {
    int at_start = inside_edge(pool, *a, i - 1, corner_at(pool, b, j + 2).vertex);
    if (at_start < 0) return false;
    int at_end = inside_edge(pool, b, j - 1, corner_at(pool, *a, i + 2).vertex);
    if (at_end < 0) return false;
    // a from the end of the shared edge round to its start, then b from there round to the end. A straight
    // corner is left out: the edge before it goes on.
    enf_loop joined = {a->plane, (int32_t)pool->corner_count, 0};
    for (int32_t k = 1; k < a->count; k++) {
        if (k == 1 && at_end == 0) continue;
        push_corner(pool, &joined, corner_at(pool, *a, i + k));
    }
    for (int32_t k = 1; k < b.count; k++) {
        if (k == 1 && at_start == 0) continue;
        push_corner(pool, &joined, corner_at(pool, b, j + k));
    }
    if (pool->failed) return false;
    *a = joined;
    return true;
}

static size_t list_edges(const enf_pool *pool, const enf_loop *loops, int32_t count, edge *edges) {
    size_t n = 0;
    for (int32_t l = 0; l < count; l++) {
        for (int32_t c = 0; c < loops[l].count; c++) {
            edges[n++] =
                (edge){corner_at(pool, loops[l], c).vertex, corner_at(pool, loops[l], c + 1).vertex, l, c};
        }
    }
    qsort(edges, n, sizeof *edges, compare_edges);
    return n;
}

/// Each loop is joined at most once a round, so that the edge list stays right.
static int32_t round_of_joins(enf_pool *pool, enf_loop *loops, int32_t count, edge *edges, bool *used) {
    size_t edge_count = list_edges(pool, loops, count, edges);
    memset(used, 0, (size_t)count * sizeof *used);
    for (int32_t l = 0; l < count && !pool->failed; l++) {
        for (int32_t c = 0; c < loops[l].count && !used[l]; c++) {
            edge key = {corner_at(pool, loops[l], c + 1).vertex, corner_at(pool, loops[l], c).vertex, -1, -1};
            size_t low = 0, high = edge_count;
            while (low < high) {
                size_t middle = (low + high) / 2;
                if (compare_edges(&edges[middle], &key) < 0) {
                    low = middle + 1;
                } else {
                    high = middle;
                }
            }
            if (low == edge_count || edges[low].from != key.from || edges[low].to != key.to) continue;
            int32_t other = edges[low].loop;
            if (other == l || used[other] || !join(pool, &loops[l], c, loops[other], edges[low].corner))
                continue;
            used[l] = used[other] = true;
            loops[other].count = 0;
        }
    }
    int32_t kept = 0;
    for (int32_t l = 0; l < count; l++) {
        if (loops[l].count > 0) loops[kept++] = loops[l];
    }
    return kept;
}

int32_t enf_pool_merge(enf_pool *pool, enf_loop *loops, int32_t count) {
    size_t corners = 0;
    for (int32_t l = 0; l < count; l++) corners += (size_t)loops[l].count;
    edge *edges = enf_array_new(corners, sizeof *edges);
    bool *used = enf_array_new((size_t)count, sizeof *used);
    pool->failed |= !edges || !used;
    while (!pool->failed && count > 1) {
        int32_t left = round_of_joins(pool, loops, count, edges, used);
        if (left == count) break;
        count = left;
    }
    free(edges);
    free(used);
    return count;
}
