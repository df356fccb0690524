// SPDX-License-Identifier: MIT
// Walks through a tree of barriers along a segment, four boxes at a time, in single precision. The boxes in
// the file are larger than what they hold by 2^-19 of the world's extent. That covers what is rounded here:
// the ends of the segment (2^-24 of the extent), ways shorter than 2^-22 of it taken as that long, and the
// arithmetic of slabs (T. Ize, "Robust BVH ray traversal", 2013; 2^-21). So no box is missed.
//
// A walk takes no memory but its own, and ends: the file's trees have been checked.
#ifndef ENF_RUN_WALK_H
#define ENF_RUN_WALK_H

#include "run/segment.h"

#include <math.h>
#include <stdint.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

/// Every level leaves at most three children waiting.
#define ENF_WALK_WAITING_MAX (3 * ENF_FILE_BARRIER_DEPTH_MAX + 4)

typedef struct enf_walk {
    const enf_file_barrier_node *nodes;
    float origin[3], inverse[3];
    int backward[3]; ///< 1: the segment goes to smaller coordinates
    float most;      ///< only boxes that begin before this share of the segment; may be lowered on the way
    int count;
    struct {
        int32_t child;
        float begin;
    } waiting[ENF_WALK_WAITING_MAX];
} enf_walk;

typedef float enf_walk_four __attribute__((vector_size(16)));
typedef int32_t enf_walk_mask __attribute__((vector_size(16)));
typedef float enf_walk_anywhere __attribute__((vector_size(16), aligned(4), may_alias));

#if defined(__SSE__)
static inline enf_walk_four enf_walk_larger(enf_walk_four a, enf_walk_four b) {
    return _mm_max_ps(a, b);
}

static inline enf_walk_four enf_walk_smaller(enf_walk_four a, enf_walk_four b) {
    return _mm_min_ps(a, b);
}

static inline unsigned enf_walk_bits(enf_walk_mask mask) {
    return (unsigned)_mm_movemask_ps((enf_walk_four)mask);
}
#else
static inline enf_walk_four enf_walk_choose(enf_walk_mask which, enf_walk_four yes, enf_walk_four no) {
    return (enf_walk_four)((which & (enf_walk_mask)yes) | (~which & (enf_walk_mask)no));
}

static inline enf_walk_four enf_walk_larger(enf_walk_four a, enf_walk_four b) {
    return enf_walk_choose(a > b, a, b);
}

static inline enf_walk_four enf_walk_smaller(enf_walk_four a, enf_walk_four b) {
    return enf_walk_choose(a < b, a, b);
}

static inline unsigned enf_walk_bits(enf_walk_mask mask) {
    return (unsigned)((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
}
#endif

static inline void enf_walk_begin(enf_walk *walk, const enf_file_view *view, const enf_segment *segment,
                                  const enf_file_barrier_node *nodes, int32_t node_count) {
    walk->nodes = nodes;
    walk->most = 1;
    walk->count = node_count > 0;
    walk->waiting[0].child = 0;
    walk->waiting[0].begin = 0;
    const float least = (float)(view->sight->extent * 0x1p-22);
    for (int a = 0; a < 3; a++) {
        float way = (float)(segment->to[a] - segment->from[a]);
        walk->backward[a] = way < 0;
        if (fabsf(way) < least) way = walk->backward[a] ? -least : least;
        walk->origin[a] = (float)segment->from[a];
        walk->inverse[a] = 1 / way;
    }
}

/// Only boxes that begin before a share of the segment from now on.
static inline void enf_walk_shorten(enf_walk *walk, double share) {
    float most = (float)share * (1 + 0x1p-22f);
    if (most < walk->most) walk->most = most;
}

/// Puts the children of a node that the segment meets on the stack, the nearest on top.
static inline void enf_walk_open(enf_walk *walk, int32_t number) {
    const enf_file_barrier_node *node = &walk->nodes[number];
    enf_walk_four begin = {0, 0, 0, 0}, end = {walk->most, walk->most, walk->most, walk->most};
    for (int a = 0; a < 3; a++) {
        enf_walk_four low = *(const enf_walk_anywhere *)node->bound[a][walk->backward[a]];
        enf_walk_four high = *(const enf_walk_anywhere *)node->bound[a][1 - walk->backward[a]];
        begin = enf_walk_larger((low - walk->origin[a]) * walk->inverse[a], begin);
        end = enf_walk_smaller((high - walk->origin[a]) * walk->inverse[a], end);
    }
    float begins[4];
    *(enf_walk_anywhere *)begins = begin;
    int first = walk->count;
    for (unsigned met = enf_walk_bits(begin <= end); met; met &= met - 1) {
        int k = __builtin_ctz(met);
        if (node->child[k] == -1) continue;
        int at = walk->count++;
        for (; at > first && walk->waiting[at - 1].begin < begins[k]; at--)
            walk->waiting[at] = walk->waiting[at - 1];
        walk->waiting[at].child = node->child[k];
        walk->waiting[at].begin = begins[k];
    }
}

/// The next barrier whose box the segment meets, roughly from near to far; -1: that was the last.
static inline int32_t enf_walk_next(enf_walk *walk) {
    while (walk->count > 0) {
        walk->count--;
        int32_t child = walk->waiting[walk->count].child;
        if (walk->waiting[walk->count].begin > walk->most) continue;
        if (child < 0) return -2 - child;
        enf_walk_open(walk, child);
    }
    return -1;
}

#endif
