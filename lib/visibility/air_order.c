// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/air_order.h"

#include "base/array.h"
#include "visibility/window.h"

#include <stdlib.h>
#include <string.h>

/// What there is of a part of the tree: a node, a leaf, or nothing but rock.
typedef struct part {
    int32_t leafs;  ///< 0: rock
    int32_t number; ///< of the node; of the leaf if that is all
} part;

static part find_part(const part *parts, const int32_t *leaf_of, int32_t child) {
    if (child >= 0) return parts[child];
    const int32_t leaf = leaf_of[-1 - child];
    return (part){.leafs = leaf >= 0, .number = leaf};
}

static part add_node(enf_air_order *order, const enf_air_node *from, const part sides[2]) {
    const int32_t number = order->node_count++;
    enf_air_order_node *node = &order->nodes[number];
    *node =
        (enf_air_order_node){.offset = from->offset, .above = -1, .leafs = {sides[0].leafs, sides[1].leafs}};
    memcpy(node->normal, from->normal, sizeof node->normal);
    for (int side = 0; side < 2; side++) {
        int32_t *above = sides[side].leafs > 1 ? &order->nodes[sides[side].number].above
                                               : &order->above[sides[side].number];
        *above = 2 * number + side;
    }
    return (part){sides[0].leafs + sides[1].leafs, number};
}

bool enf_air_order_make(enf_air_order *order, const enf_air_tree *tree, const int32_t *leaf_of,
                        int32_t leaf_count) {
    *order = (enf_air_order){.leaf_count = leaf_count};
    order->nodes = enf_array_new((size_t)leaf_count, sizeof *order->nodes);
    order->above = enf_array_new((size_t)leaf_count, sizeof *order->above);
    part *parts = enf_array_new((size_t)tree->node_count, sizeof *parts);
    const bool good = order->nodes && order->above && parts;
    for (int32_t i = 0; good && i < leaf_count; i++) order->above[i] = -1;
    for (int32_t i = tree->node_count - 1; good && i >= 0; i--) { // children have higher numbers
        const enf_air_node *node = &tree->nodes[i];
        const part sides[2] = {find_part(parts, leaf_of, node->child[0]),
                               find_part(parts, leaf_of, node->child[1])};
        if (sides[0].leafs && sides[1].leafs)
            parts[i] = add_node(order, node, sides);
        else
            parts[i] = sides[sides[0].leafs == 0];
    }
    free(parts);
    return good;
}

void enf_air_order_free(enf_air_order *order) {
    free(order->nodes);
    free(order->above);
    *order = (enf_air_order){0};
}

bool enf_air_ranks_make(enf_air_ranks *ranks, const enf_air_order *order) {
    *ranks = (enf_air_ranks){.order = order};
    ranks->nodes = enf_array_zeroed((size_t)order->node_count, sizeof *ranks->nodes);
    return ranks->nodes != NULL;
}

void enf_air_ranks_free(enf_air_ranks *ranks) {
    free(ranks->nodes);
    *ranks = (enf_air_ranks){0};
}

void enf_air_ranks_begin(enf_air_ranks *ranks, const double point[3]) {
    memcpy(ranks->point, point, sizeof ranks->point);
    ranks->point_number++; // every cast has its own; there are fewer than 2^31
}

/// The first rank on one side of a node that is known.
static int32_t find_first(const enf_air_ranks *ranks, int32_t above) {
    if (above < 0) return 0;
    const enf_air_rank *rank = &ranks->nodes[above >> 1];
    return rank->first + ((above & 1) != rank->near ? ranks->order->nodes[above >> 1].leafs[rank->near] : 0);
}

int32_t enf_air_ranks_find(enf_air_ranks *ranks, int32_t leaf) {
    const enf_air_order *order = ranks->order;
    int32_t path[ENF_AIR_DEPTH_MOST + 1], count = 0;
    for (int32_t at = order->above[leaf]; at >= 0; at = order->nodes[at >> 1].above) {
        if (ranks->nodes[at >> 1].point == ranks->point_number) break;
        path[count++] = at >> 1;
    }
    while (count > 0) {
        const enf_air_order_node *node = &order->nodes[path[--count]];
        ranks->nodes[path[count]] =
            (enf_air_rank){.point = ranks->point_number,
                           .first = find_first(ranks, node->above),
                           .near = enf_dot(node->normal, ranks->point) >= node->offset};
    }
    return find_first(ranks, order->above[leaf]);
}
