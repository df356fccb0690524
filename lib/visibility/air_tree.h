// SPDX-License-Identifier: GPL-3.0-or-later
// A binary space partition by walls, until no leaf has a wall in its inside: every leaf is convex, and all of
// it is air or all of it rock (H. Fuchs, Z. Kedem, B. Naylor, "On visible surface generation by a priori tree
// structures", 1980).
#ifndef ENF_VISIBILITY_AIR_TREE_H
#define ENF_VISIBILITY_AIR_TREE_H

#include "visibility/air_walls.h"

typedef struct enf_air_node {
    double normal[3], offset; ///< the plane: normal . x = offset; the normal has length 1
    int32_t child[2];         ///< behind, in front; >= 0: a node with a higher number; < 0: leaf -1 - child
    int32_t wall_first, wall_count; ///< thin walls in the plane, of the tree's
} enf_air_node;

typedef struct enf_air_tree {
    double tolerance; ///< world units: what is nearer to a plane counts as on it
    int32_t node_count, leaf_count;
    enf_air_node *nodes;
    size_t node_capacity;
    enf_walls thin; ///< parts of walls with air on both sides
} enf_air_tree;

/// What a tree may have at most, so that worlds which no tree suits end soon.
enum { ENF_AIR_DEPTH_MOST = 1000 };

typedef enum enf_air_outcome { ENF_AIR_DONE, ENF_AIR_TOO_DEEP, ENF_AIR_NO_MEMORY } enf_air_outcome;

/// Builds the tree, on some threads: what comes out is the same for any number. It has copies of the
/// walls that it keeps; *walls is used for scratch, and of no more use. `size` is the largest coordinate in
/// magnitude. With more leafs than `leafs_most` it is too deep. *tree is overwritten; free it in any case.
enf_air_outcome enf_air_tree_make(enf_air_tree *tree, enf_walls *walls, double size, int32_t leafs_most,
                                  int threads);
void enf_air_tree_free(enf_air_tree *tree);

#endif
