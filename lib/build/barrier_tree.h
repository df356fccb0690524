// SPDX-License-Identifier: GPL-3.0-or-later
// Trees of boxes for lines of sight.
#ifndef ENF_BUILD_BARRIER_TREE_H
#define ENF_BUILD_BARRIER_TREE_H

#include "enfilade/format.h"

/// The box around one barrier, rounded outwards.
typedef struct enf_barrier_box {
    float min[3], max[3];
    int32_t barrier;
} enf_barrier_box;

typedef struct enf_barrier_tree {
    enf_file_barrier_node *nodes;
    int32_t node_count;
} enf_barrier_tree;

/// Puts the boxes into an order where neighbours are near each other, and numbers them from `first` on in the
/// nodes; the caller moves the barriers likewise. nodes is null for no boxes; otherwise it is the caller's to
/// free. False without memory.
bool enf_barrier_tree_make(enf_barrier_tree *tree, enf_barrier_box *boxes, int32_t count, int32_t first);

#endif
