// SPDX-License-Identifier: MIT
// Walks through a tree of barriers along a segment.
// A walk takes no memory but its own, and ends: the file's trees have been checked.
#ifndef ENF_RUN_WALK_H
#define ENF_RUN_WALK_H

#include "run/segment.h"

#include <stdatomic.h>
#include <stdint.h>

/// So many nodes are opened at a time.
#define ENF_WALK_BATCH 4

/// Every level leaves at most so many children waiting, as the deeper ones are on top.
#define ENF_WALK_WAITING_MAX (4 * ENF_WALK_BATCH * (ENF_FILE_BARRIER_DEPTH_MAX + 1))

/// A node or barrier and where its box begins, a share of the segment: the bits of a float, which compare as
/// numbers as none is negative, the lowest two of them used to tell siblings apart.
typedef struct enf_walk_waiting {
    int32_t child, begin;
} enf_walk_waiting;

typedef struct enf_walk {
    const enf_file_barrier_node *nodes;
    const _Atomic int32_t *below; ///< per node: 0 if it is of no interest; null: all are
    float origin[3], inverse[3];
    int backward[3]; ///< 1: the segment goes to smaller coordinates
    float most;      ///< only boxes that begin before this share of the segment; may be lowered on the way
    int count;
    enf_walk_waiting waiting[ENF_WALK_WAITING_MAX];
} enf_walk;

void enf_walk_begin(enf_walk *walk, const enf_file_view *view, const enf_segment *segment,
                    const enf_file_barrier_node *nodes, int32_t node_count);

/// Only boxes that begin before a share of the segment from now on.
static inline void enf_walk_shorten(enf_walk *walk, double share) {
    float most = (float)share * (1 + 0x1p-22f);
    if (most < walk->most) walk->most = most;
}

/// The next barrier whose box the segment meets, roughly from near to far; -1: that was the last.
int32_t enf_walk_next(enf_walk *walk);

#endif
