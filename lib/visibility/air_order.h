// SPDX-License-Identifier: GPL-3.0-or-later
// Leafs of a partition in the order in which lines from a point come to them: of each node, all leafs on the
// point's side come before all others (R. A. Schumacker et al., "Study for applying computer-generated images
// to visual simulation", 1969; H. Fuchs et al., 1980).
#ifndef ENF_VISIBILITY_AIR_ORDER_H
#define ENF_VISIBILITY_AIR_ORDER_H

#include "visibility/air_tree.h"

/// Of the nodes of a tree those with air on both sides; parents have higher numbers.
typedef struct enf_air_order_node {
    double normal[3], offset; ///< the plane
    int32_t above;            ///< twice the node above, and 1 if this one is in front of it; -1: none
    int32_t leafs[2];         ///< how many are behind, in front
} enf_air_order_node;

typedef struct enf_air_order {
    int32_t node_count, leaf_count;
    enf_air_order_node *nodes;
    int32_t *above; ///< per leaf that is air, as a node's
} enf_air_order;

/// `leaf_of`: per leaf of the tree its number among the `leaf_count` that are air, or -1. False without
/// memory. *order is overwritten; free it in any case.
bool enf_air_order_make(enf_air_order *order, const enf_air_tree *tree, const int32_t *leaf_of,
                        int32_t leaf_count);
void enf_air_order_free(enf_air_order *order);

/// What is known of a node for one point.
typedef struct enf_air_rank {
    int32_t point; ///< the number of the point that it is about
    int32_t first; ///< the rank of the first leaf
    int32_t near;  ///< the side that the point is on
} enf_air_rank;

/// Ranks, found when they are asked for.
typedef struct enf_air_ranks {
    const enf_air_order *order; ///< not owned
    double point[3];
    int32_t point_number;
    enf_air_rank *nodes;
} enf_air_ranks;

/// False without memory; free it in any case.
bool enf_air_ranks_make(enf_air_ranks *ranks, const enf_air_order *order);
void enf_air_ranks_free(enf_air_ranks *ranks);

/// From here on ranks are about this point.
void enf_air_ranks_begin(enf_air_ranks *ranks, const double point[3]);

/// How many leafs come before this one.
int32_t enf_air_ranks_find(enf_air_ranks *ranks, int32_t leaf);

#endif
