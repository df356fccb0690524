// SPDX-License-Identifier: MIT
// Four boxes at a time, in single precision. The boxes in the file are larger than what they hold by 2^-19 of
// the world's extent. That covers what is rounded here: the ends of the segment (2^-24 of the extent), ways
// shorter than 2^-22 of it taken as that long, and the arithmetic of slabs (T. Ize, "Robust BVH ray
// traversal", 2013; 2^-21). So no box is missed.
//
// What takes time is waiting: for a node to come from memory, for its boxes to be compared before the next
// one is known. So several nodes are opened at a time, and nothing branches on which children are met.
#include "run/walk.h"

#include <math.h>
#if defined(__SSE__)
#include <xmmintrin.h>
#endif

typedef float four_floats __attribute__((vector_size(16)));
typedef int32_t four_numbers __attribute__((vector_size(16)));
typedef float any_floats __attribute__((vector_size(16), aligned(4), may_alias));
typedef int32_t any_numbers __attribute__((vector_size(16), aligned(4), may_alias));

#if defined(__SSE__)
static inline four_floats larger(four_floats a, four_floats b) {
    return _mm_max_ps(a, b);
}

static inline four_floats smaller(four_floats a, four_floats b) {
    return _mm_min_ps(a, b);
}

static inline unsigned bits_of(four_numbers mask) {
    return (unsigned)_mm_movemask_ps((four_floats)mask);
}
#else
static inline four_floats choose(four_numbers which, four_floats yes, four_floats no) {
    return (four_floats)((which & (four_numbers)yes) | (~which & (four_numbers)no));
}

static inline four_floats larger(four_floats a, four_floats b) {
    return choose(a > b, a, b);
}

static inline four_floats smaller(four_floats a, four_floats b) {
    return choose(a < b, a, b);
}

static inline unsigned bits_of(four_numbers mask) {
    return (unsigned)((mask[0] & 1) | (mask[1] & 2) | (mask[2] & 4) | (mask[3] & 8));
}
#endif

void enf_walk_begin(enf_walk *walk, const enf_file_view *view, const enf_segment *segment,
                    const enf_file_barrier_node *nodes, int32_t node_count) {
    walk->nodes = nodes;
    walk->below = NULL;
    walk->most = 1;
    walk->count = node_count > 0;
    walk->waiting[0] = (enf_walk_waiting){0, 0};
    const float least = (float)(view->sight->extent * 0x1p-22);
    for (int a = 0; a < 3; a++) {
        float way = (float)(segment->to[a] - segment->from[a]);
        walk->backward[a] = way < 0;
        if (fabsf(way) < least) way = walk->backward[a] ? -least : least;
        walk->origin[a] = (float)segment->from[a];
        walk->inverse[a] = 1 / way;
    }
}

/// For each of four children met, how many others begin farther; those that are not met come last, to be
/// overwritten. No two of the keys may be equal.
static inline four_numbers places_of(four_numbers key) {
    four_numbers one = {key[1], key[2], key[3], key[0]}, two = {key[2], key[3], key[0], key[1]},
                 three = {key[3], key[0], key[1], key[2]};
    return -((key < one) + (key < two) + (key < three));
}

/// What an axis leaves of the shares of the segment that are inside the boxes.
static inline void clip(const enf_walk *walk, const enf_file_barrier_node *node, int axis, four_floats *begin,
                        four_floats *end) {
    four_floats low = *(const any_floats *)node->bound[axis][walk->backward[axis]];
    four_floats high = *(const any_floats *)node->bound[axis][1 - walk->backward[axis]];
    *begin = larger((low - walk->origin[axis]) * walk->inverse[axis], *begin);
    *end = smaller((high - walk->origin[axis]) * walk->inverse[axis], *end);
}

/// Puts the children of a node that the segment meets on a stack, the nearest on top. How many.
static inline int open_node(const enf_walk *walk, const enf_file_barrier_node *node, enf_walk_waiting *top) {
    four_floats begin = {0, 0, 0, 0}, end = {walk->most, walk->most, walk->most, walk->most};
    clip(walk, node, 0, &begin, &end);
    clip(walk, node, 1, &begin, &end);
    clip(walk, node, 2, &begin, &end);
    const four_numbers own = {0, 1, 2, 3}, none = {-4, -4, -4, -4};
    four_numbers met = (begin <= end) & (*(const any_numbers *)node->child != -1);
    four_numbers key = ((((four_numbers)begin & met) | ~met) & none) | own;
    int32_t places[4], keys[4];
    *(any_numbers *)places = places_of(key);
    *(any_numbers *)keys = key;
    top[places[0]] = (enf_walk_waiting){node->child[0], keys[0]};
    top[places[1]] = (enf_walk_waiting){node->child[1], keys[1]};
    top[places[2]] = (enf_walk_waiting){node->child[2], keys[2]};
    top[places[3]] = (enf_walk_waiting){node->child[3], keys[3]};
    return (int)(UINT64_C(0x4332322132212110) >> (4 * bits_of(met)) & 15);
}

/// Is a child a node that is of interest?
static inline bool is_wanted(const enf_walk *walk, int32_t child) {
    return child >= 0 &&
           (!walk->below || atomic_load_explicit(&walk->below[child], memory_order_relaxed) != 0);
}

int32_t enf_walk_next(enf_walk *walk) {
    const enf_file_barrier_node *nodes = walk->nodes;
    enf_walk_waiting *waiting = walk->waiting;
    const union {
        float share;
        int32_t bits;
    } most = {walk->most};
    int count = walk->count;
    int32_t found = -1;
    while (count > 0 && found < 0) {
        enf_walk_waiting top = waiting[--count];
        if (top.begin > most.bits) continue;
        if (top.child < 0) {
            found = -2 - top.child;
            continue;
        }
        if (!is_wanted(walk, top.child)) continue;
        int32_t batch[ENF_WALK_BATCH];
        int n = 1;
        batch[0] = top.child;
        while (n < ENF_WALK_BATCH && count > 0 && is_wanted(walk, waiting[count - 1].child))
            batch[n++] = waiting[--count].child;
        while (n > 0) count += open_node(walk, &nodes[batch[--n]], &waiting[count]);
    }
    walk->count = count;
    return found;
}
