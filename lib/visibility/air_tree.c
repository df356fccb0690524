// SPDX-License-Identifier: GPL-3.0-or-later
// On several threads, the top of the tree comes first, down to parts of some walls; then the branches, each
// with walls of its own; then they are put together. Nodes, leafs and thin walls are numbered as if all had
// been built from the root on, first behind each plane and then in front of it, so that no one can tell.
#include "visibility/air_tree.h"

#include "base/array.h"
#include "base/parallel.h"
#include "visibility/air_plane.h"
#include "visibility/window.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/// Of the size of the world. Positions are good to 2^-50 of it, or so.
static const double relative_tolerance = 0x1p-40;

/// No more walls than this times as many, when they are cut.
static const double growth_most = 32;

/// Branches have this part of all walls at most, and no less than so many.
enum { BRANCH_PART = 4, BRANCH_LEAST = 200 };

/// Branches as children: so much and the number of the branch.
enum { BRANCHES = 1 << 30 };

/// What all builders have made together, and may make.
typedef struct limits {
    atomic_int walls, leafs;
    int32_t wall_most, leafs_most;
} limits;

/// A part of the tree that is built by itself.
typedef struct branch {
    int32_t depth;
    enf_walls walls; ///< its own
    enf_air_tree tree;
    int32_t root;
    enf_air_outcome outcome;
} branch;

typedef struct branches {
    branch *items;
    int32_t count;
    size_t capacity;
} branches;

typedef struct builder {
    enf_air_tree *tree;
    enf_walls *walls;
    limits *limits;
    branches *branches; ///< null: there are none
    int32_t branch_most;
    int threads;
    double (*front)[3], (*back)[3]; ///< scratch: the parts of a wall
    size_t front_capacity, back_capacity;
    enf_air_outcome outcome;
} builder;

static void free_builder(builder *builder) {
    free(builder->front);
    free(builder->back);
}

// ---------------------------------------------------------------------------------------------- walls

/// Cuts a wall in two, which are added. False without memory.
static bool cut(builder *builder, int32_t number, const enf_air_plane *plane) {
    const enf_wall wall = builder->walls->walls[number];
    int32_t front = 0, back = 0;
    if (!enf_array_reserve(builder->front, builder->front_capacity, 2 * wall.count) ||
        !enf_array_reserve(builder->back, builder->back_capacity, 2 * wall.count))
        return false;
    for (int32_t i = 0; i < wall.count; i++) {
        const double *a = builder->walls->corners[wall.first + i];
        const double *b = builder->walls->corners[wall.first + (i + 1 < wall.count ? i + 1 : 0)];
        double height_a = enf_dot(a, plane->normal) - plane->offset;
        double height_b = enf_dot(b, plane->normal) - plane->offset;
        int side_a = (int)enf_air_side_of(height_a, builder->tree->tolerance);
        int side_b = (int)enf_air_side_of(height_b, builder->tree->tolerance);
        if (side_a != ENF_AIR_BACK) memcpy(builder->front[front++], a, sizeof *builder->front);
        if (side_a != ENF_AIR_FRONT) memcpy(builder->back[back++], a, sizeof *builder->back);
        if ((side_a | side_b) != ENF_AIR_BOTH) continue;
        for (int axis = 0; axis < 3; axis++)
            builder->front[front][axis] = a[axis] + height_a / (height_a - height_b) * (b[axis] - a[axis]);
        memcpy(builder->back[back++], builder->front[front++], sizeof *builder->back);
    }
    atomic_fetch_add(&builder->limits->walls, 2);
    return enf_walls_add(builder->walls, &wall, (const double(*)[3])builder->front, front) &&
           enf_walls_add(builder->walls, &wall, (const double(*)[3])builder->back, back);
}

static bool add_copy(enf_walls *to, const enf_walls *from, int32_t number) {
    const enf_wall *wall = &from->walls[number];
    return enf_walls_add(to, wall, (const double(*)[3])(from->corners + wall->first), wall->count);
}

/// Deals the walls of a part to the two sides of the plane, cutting those that lie on both.
static bool deal(builder *builder, const enf_air_part *part, const enf_air_plane *plane, int32_t *sides[2],
                 int32_t counts[2]) {
    enf_walls *walls = builder->walls;
    for (int32_t i = 0; i < part->count; i++) {
        const int32_t wall = part->items[i];
        const enf_air_side side = enf_air_plane_side(plane, walls, wall, part->tolerance);
        if (side == ENF_AIR_ON && walls->walls[wall].has_air_behind &&
            !add_copy(&builder->tree->thin, walls, wall))
            return false;
        if (side == ENF_AIR_FRONT) sides[1][counts[1]++] = wall;
        if (side == ENF_AIR_BACK) sides[0][counts[0]++] = wall;
        if (side != ENF_AIR_BOTH) continue;
        if (!cut(builder, wall, plane)) return false;
        sides[1][counts[1]++] = walls->count - 2;
        sides[0][counts[0]++] = walls->count - 1;
    }
    return true;
}

// ---------------------------------------------------------------------------------------------- nodes

static int32_t build(builder *builder, const int32_t *items, int32_t count, int depth);

/// Adds a node, and what is below it.
// NOLINTNEXTLINE(misc-no-recursion): ENF_AIR_DEPTH_MOST levels at most
static int32_t divide(builder *builder, const enf_air_part *part) {
    enf_air_tree *tree = builder->tree;
    enf_air_plane plane;
    int32_t *lists = enf_array_new(2 * (size_t)part->count, sizeof *lists), counts[2] = {0};
    int32_t *sides[2] = {lists, lists + part->count}, node = tree->node_count;
    if (!lists || !enf_air_plane_choose(part, builder->threads, &plane) ||
        !enf_array_reserve(tree->nodes, tree->node_capacity, node + 1)) {
        builder->outcome = ENF_AIR_NO_MEMORY;
        free(lists);
        return -1;
    }
    tree->nodes[tree->node_count++] =
        (enf_air_node){.normal = {plane.normal[0], plane.normal[1], plane.normal[2]},
                       .offset = plane.offset,
                       .wall_first = tree->thin.count};
    if (!deal(builder, part, &plane, sides, counts)) builder->outcome = ENF_AIR_NO_MEMORY;
    tree->nodes[node].wall_count = tree->thin.count - tree->nodes[node].wall_first;
    if (!builder->outcome && atomic_load(&builder->limits->walls) > builder->limits->wall_most)
        builder->outcome = ENF_AIR_TOO_DEEP;
    for (int s = 0; s < 2 && !builder->outcome; s++) {
        int32_t child = build(builder, sides[s], counts[s], part->depth + 1);
        tree->nodes[node].child[s] = child;
    }
    free(lists);
    return node;
}

static int32_t add_leaf(builder *builder) {
    if (atomic_fetch_add(&builder->limits->leafs, 1) >= builder->limits->leafs_most)
        builder->outcome = ENF_AIR_TOO_DEEP;
    return -1 - builder->tree->leaf_count++;
}

/// Leaves a part for later.
static int32_t add_branch(builder *builder, const int32_t *items, int32_t count, int depth) {
    branches *branches = builder->branches;
    if (!enf_array_reserve(branches->items, branches->capacity, branches->count + 1)) {
        builder->outcome = ENF_AIR_NO_MEMORY;
        return -1;
    }
    branch *added = &branches->items[branches->count];
    *added = (branch){.depth = depth, .tree = {.tolerance = builder->tree->tolerance}};
    for (int32_t i = 0; i < count; i++)
        if (!add_copy(&added->walls, builder->walls, items[i])) builder->outcome = ENF_AIR_NO_MEMORY;
    return BRANCHES + branches->count++;
}

/// The part as a leaf, or as a node; -1 - leaf or the node's number, or a branch.
// NOLINTNEXTLINE(misc-no-recursion): ENF_AIR_DEPTH_MOST levels at most
static int32_t build(builder *builder, const int32_t *items, int32_t count, int depth) {
    if (count == 0) return add_leaf(builder);
    if (depth == ENF_AIR_DEPTH_MOST) {
        builder->outcome = ENF_AIR_TOO_DEEP;
        return -1;
    }
    if (builder->branches && count <= builder->branch_most) return add_branch(builder, items, count, depth);
    return divide(builder, &(enf_air_part){.walls = builder->walls,
                                           .items = items,
                                           .count = count,
                                           .depth = depth,
                                           .tolerance = builder->tree->tolerance});
}

/// All walls there are.
static int32_t build_all(builder *builder, int depth) {
    const int32_t count = builder->walls->count;
    int32_t *items = enf_array_new((size_t)count, sizeof *items), root = -1;
    if (!items) builder->outcome = ENF_AIR_NO_MEMORY;
    for (int32_t i = 0; items && i < count; i++) items[i] = i;
    if (items) root = build(builder, items, count, depth);
    free(items);
    return root;
}

// ---------------------------------------------------------------------------------------------- branches

typedef struct growing {
    branches *branches;
    limits *limits;
} growing;

static void grow_branch(void *user, int32_t number, int thread) {
    const growing *growing = user;
    branch *branch = &growing->branches->items[number];
    builder builder = {
        .tree = &branch->tree, .walls = &branch->walls, .limits = growing->limits, .threads = 1};
    (void)thread;
    branch->root = build_all(&builder, branch->depth);
    branch->outcome = builder.outcome;
    free_builder(&builder);
}

static void free_branches(branches *branches) {
    for (int32_t i = 0; i < branches->count; i++) {
        enf_walls_free(&branches->items[i].walls);
        enf_air_tree_free(&branches->items[i].tree);
    }
    free(branches->items);
}

/// Puts trees together.
typedef struct assembler {
    enf_air_tree *tree;
    const branches *branches;
} assembler;

/// Adds a node of another tree, but for its children. False without memory.
static bool add_node(enf_air_tree *tree, const enf_air_tree *from, const enf_air_node *node) {
    if (!enf_array_reserve(tree->nodes, tree->node_capacity, tree->node_count + 1)) return false;
    enf_air_node *added = &tree->nodes[tree->node_count++];
    *added = *node;
    added->wall_first = tree->thin.count;
    for (int32_t i = 0; i < node->wall_count; i++)
        if (!add_copy(&tree->thin, &from->thin, node->wall_first + i)) return false;
    return true;
}

/// Adds what is below a child of another tree. False without memory.
// NOLINTNEXTLINE(misc-no-recursion): ENF_AIR_DEPTH_MOST levels at most
static bool assemble(const assembler *assembler, const enf_air_tree *from, int32_t child, int32_t *added) {
    enf_air_tree *tree = assembler->tree;
    if (child < 0) {
        *added = -1 - tree->leaf_count++;
        return true;
    }
    if (child >= BRANCHES) {
        const branch *branch = &assembler->branches->items[child - BRANCHES];
        return assemble(assembler, &branch->tree, branch->root, added);
    }
    *added = tree->node_count;
    if (!add_node(tree, from, &from->nodes[child])) return false;
    for (int s = 0; s < 2; s++) {
        int32_t below;
        if (!assemble(assembler, from, from->nodes[child].child[s], &below)) return false;
        tree->nodes[*added].child[s] = below;
    }
    return true;
}

/// The top of the tree, its branches, and both together.
static enf_air_outcome build_in_branches(enf_air_tree *tree, enf_walls *walls, limits *limits, int threads) {
    branches branches = {0};
    enf_air_tree top = {.tolerance = tree->tolerance};
    builder builder = {.tree = &top,
                       .walls = walls,
                       .limits = limits,
                       .branches = &branches,
                       .branch_most = walls->count / BRANCH_PART,
                       .threads = threads};
    if (builder.branch_most < BRANCH_LEAST) builder.branch_most = BRANCH_LEAST;
    int32_t root = build_all(&builder, 0);
    if (!builder.outcome)
        enf_parallel_for(&(enf_crew){.threads = threads}, branches.count, grow_branch,
                         &(growing){&branches, limits});
    for (int32_t i = 0; i < branches.count; i++)
        if (branches.items[i].outcome > builder.outcome) builder.outcome = branches.items[i].outcome;
    if (!builder.outcome && !assemble(&(assembler){tree, &branches}, &top, root, &root))
        builder.outcome = ENF_AIR_NO_MEMORY;
    free_branches(&branches);
    enf_air_tree_free(&top);
    free_builder(&builder);
    return builder.outcome;
}

enf_air_outcome enf_air_tree_make(enf_air_tree *tree, enf_walls *walls, double size, int32_t leafs_most,
                                  int threads) {
    limits limits = {.leafs_most = leafs_most};
    *tree = (enf_air_tree){.tolerance = size * relative_tolerance};
    limits.wall_most = (int32_t)fmin(growth_most * walls->count + 1000, INT32_MAX / 2);
    atomic_init(&limits.walls, walls->count);
    atomic_init(&limits.leafs, 0);
    if (threads > 1 && walls->count > BRANCH_LEAST) return build_in_branches(tree, walls, &limits, threads);
    builder builder = {.tree = tree, .walls = walls, .limits = &limits, .threads = 1};
    build_all(&builder, 0);
    free_builder(&builder);
    return builder.outcome;
}

void enf_air_tree_free(enf_air_tree *tree) {
    free(tree->nodes);
    enf_walls_free(&tree->thin);
    *tree = (enf_air_tree){0};
}
