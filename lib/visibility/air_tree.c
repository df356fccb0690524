// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/air_tree.h"

#include "base/array.h"
#include "visibility/window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Of the size of the world. Positions are good to 2^-50 of it, or so.
static const double relative_tolerance = 0x1p-40;

/// How planes are chosen: of so many walls, the one whose plane costs least. (Found by trying, on 25 levels:
/// the fewest openings. More candidates take longer than they save later.)
enum { CANDIDATES = 60 };
static const double cost_of_cut = 16, cost_of_imbalance = 0.2, worth_of_taken = 1;

/// Below this depth (where no building comes to) a part whose walls' planes would only peel it is halved.
enum { DEPTH_PEELED = 100, PEELED_MOST = 64 };
static const double peeled_share = 0.95, growth_most = 32;

typedef struct builder {
    enf_air_tree *tree;
    enf_walls *walls;
    double (*front)[3], (*back)[3]; ///< scratch: the parts of a wall
    size_t front_capacity, back_capacity;
    int32_t wall_most, leafs_most;
    enf_air_outcome outcome;
} builder;

typedef enum side { SIDE_ON = 0, SIDE_FRONT = 1, SIDE_BACK = 2, SIDE_BOTH = 3 } side;

static side side_of(double height, double tolerance) {
    return height > tolerance ? SIDE_FRONT : height < -tolerance ? SIDE_BACK : SIDE_ON;
}

/// The walls of a part, by their sides of a plane.
typedef struct census {
    int32_t counts[4];
} census;

typedef struct plane {
    double normal[3], offset;
} plane;

static side find_side(const builder *builder, int32_t number, const plane *plane) {
    const enf_wall *wall = &builder->walls->walls[number];
    const double height = enf_dot(wall->middle, plane->normal) - plane->offset;
    int sides = SIDE_ON;
    if (fabs(height) > wall->radius + builder->tree->tolerance) return height > 0 ? SIDE_FRONT : SIDE_BACK;
    for (int32_t i = 0; i < wall->count && sides != SIDE_BOTH; i++) {
        const double *corner = builder->walls->corners[wall->first + i];
        sides |= (int)side_of(enf_dot(corner, plane->normal) - plane->offset, builder->tree->tolerance);
    }
    return (side)sides;
}

static plane plane_of(const enf_wall *wall) {
    return (plane){{wall->normal[0], wall->normal[1], wall->normal[2]}, wall->offset};
}

static census count_sides(const builder *builder, const int32_t *part, int32_t count, const plane *plane) {
    census census = {{0}};
    for (int32_t i = 0; i < count; i++) census.counts[find_side(builder, part[i], plane)]++;
    return census;
}

/// Is the plane one of some walls'?
static bool is_known(const builder *builder, const plane *plane, const int32_t *walls, int32_t count) {
    for (int32_t k = 0; k < count; k++) {
        const enf_wall *wall = &builder->walls->walls[walls[k]];
        if (wall->offset == plane->offset && wall->normal[0] == plane->normal[0] &&
            wall->normal[1] == plane->normal[1] && wall->normal[2] == plane->normal[2])
            return true;
    }
    return false;
}

static double cost_of(const census *census) {
    return cost_of_cut * census->counts[SIDE_BOTH] +
           cost_of_imbalance * abs(census->counts[SIDE_FRONT] - census->counts[SIDE_BACK]) -
           worth_of_taken * census->counts[SIDE_ON];
}

/// Counts the sides of a plane, and finds its cost, if that is below `least`; false as soon as it can't be.
static bool find_cost(const builder *builder, const int32_t *part, int32_t count, const plane *plane,
                      double least, census *census, double *cost) {
    *census = (struct census){{0}};
    for (int32_t i = 0; i < count; i++) {
        const side side = find_side(builder, part[i], plane);
        census->counts[side]++;
        if (side == SIDE_BOTH && cost_of_cut * census->counts[SIDE_BOTH] -
                                         worth_of_taken * (census->counts[SIDE_ON] + count - i - 1) >=
                                     least)
            return false;
    }
    *cost = cost_of(census);
    return *cost < least;
}

static int compare_doubles(const void *a, const void *b) {
    double one = *(const double *)a, other = *(const double *)b;
    return one < other ? -1 : one > other;
}

/// Halves a part across its longest side: through the median of the walls' first corners. False if that
/// takes no wall out of the way.
static bool halve(builder *builder, const int32_t *part, int32_t count, plane *plane, census *census) {
    double least[3] = {INFINITY, INFINITY, INFINITY}, most[3] = {-INFINITY, -INFINITY, -INFINITY};
    double *along = enf_array_new((size_t)count, sizeof *along);
    if (!along) {
        builder->outcome = ENF_AIR_NO_MEMORY;
        return false;
    }
    for (int32_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            double at = builder->walls->corners[builder->walls->walls[part[i]].first][axis];
            if (at < least[axis]) least[axis] = at;
            if (at > most[axis]) most[axis] = at;
        }
    int longest = 0;
    for (int axis = 1; axis < 3; axis++)
        if (most[axis] - least[axis] > most[longest] - least[longest]) longest = axis;
    for (int32_t i = 0; i < count; i++)
        along[i] = builder->walls->corners[builder->walls->walls[part[i]].first][longest];
    qsort(along, (size_t)count, sizeof *along, compare_doubles);
    *plane = (struct plane){.offset = along[count / 2]};
    plane->normal[longest] = 1;
    free(along);
    *census = count_sides(builder, part, count, plane);
    return census->counts[SIDE_FRONT] > count / 4 && census->counts[SIDE_BACK] > count / 4;
}

/// The plane that divides the part.
static plane choose(builder *builder, const int32_t *part, int32_t count, int depth, census *census) {
    plane best = plane_of(&builder->walls->walls[part[0]]);
    double least = INFINITY;
    int32_t tries = count < CANDIDATES ? count : CANDIDATES, tried[CANDIDATES], tried_count = 0;
    for (int32_t k = 0; k < tries; k++) {
        const int32_t wall = part[(int64_t)k * count / tries];
        plane next = plane_of(&builder->walls->walls[wall]);
        if (is_known(builder, &next, tried, tried_count)) continue;
        tried[tried_count++] = wall;
        struct census counted;
        double cost;
        if (!find_cost(builder, part, count, &next, least, &counted, &cost)) continue;
        least = cost;
        best = next;
        *census = counted;
    }
    int32_t larger = census->counts[SIDE_FRONT] > census->counts[SIDE_BACK] ? census->counts[SIDE_FRONT]
                                                                            : census->counts[SIDE_BACK];
    if (depth >= DEPTH_PEELED && count > PEELED_MOST && larger > peeled_share * count) {
        plane middle;
        struct census counted;
        if (halve(builder, part, count, &middle, &counted)) {
            *census = counted;
            return middle;
        }
    }
    return best;
}

/// Cuts a wall in two, which are added. False without memory.
static bool cut(builder *builder, int32_t number, const plane *plane) {
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
        int side_a = (int)side_of(height_a, builder->tree->tolerance);
        int side_b = (int)side_of(height_b, builder->tree->tolerance);
        if (side_a != SIDE_BACK) memcpy(builder->front[front++], a, sizeof *builder->front);
        if (side_a != SIDE_FRONT) memcpy(builder->back[back++], a, sizeof *builder->back);
        if ((side_a | side_b) != SIDE_BOTH) continue;
        for (int axis = 0; axis < 3; axis++)
            builder->front[front][axis] = a[axis] + height_a / (height_a - height_b) * (b[axis] - a[axis]);
        memcpy(builder->back[back++], builder->front[front++], sizeof *builder->back);
    }
    return enf_walls_add(builder->walls, &wall, (const double(*)[3])builder->front, front) &&
           enf_walls_add(builder->walls, &wall, (const double(*)[3])builder->back, back);
}

static bool take_wall(enf_air_tree *tree, const enf_walls *walls, int32_t number) {
    if (!walls->walls[number].has_air_behind) return true;
    if (!enf_array_reserve(tree->thin_walls, tree->thin_capacity, tree->thin_wall_count + 1)) return false;
    tree->thin_walls[tree->thin_wall_count++] = number;
    return true;
}

/// Deals the walls of a part to the two sides of the plane, cutting those that lie on both.
static bool deal(builder *builder, const int32_t *part, int32_t count, const plane *plane, int32_t *sides[2],
                 int32_t counts[2]) {
    enf_walls *walls = builder->walls;
    for (int32_t i = 0; i < count; i++) {
        side side = find_side(builder, part[i], plane);
        if (side == SIDE_ON && !take_wall(builder->tree, walls, part[i])) return false;
        if (side == SIDE_FRONT) sides[1][counts[1]++] = part[i];
        if (side == SIDE_BACK) sides[0][counts[0]++] = part[i];
        if (side != SIDE_BOTH) continue;
        if (!cut(builder, part[i], plane)) return false;
        sides[1][counts[1]++] = walls->count - 2;
        sides[0][counts[0]++] = walls->count - 1;
    }
    return true;
}

static int32_t build(builder *builder, const int32_t *part, int32_t count, int depth);

/// Adds a node, and what is below it.
// NOLINTNEXTLINE(misc-no-recursion): ENF_AIR_DEPTH_MOST levels at most
static int32_t divide(builder *builder, const int32_t *part, int32_t count, int depth) {
    enf_air_tree *tree = builder->tree;
    census census = {{0}};
    plane plane = choose(builder, part, count, depth, &census);
    int32_t *lists = enf_array_new(2 * (size_t)count, sizeof *lists), counts[2] = {0};
    int32_t *sides[2] = {lists, lists + count}, node = tree->node_count;
    if (!lists || builder->outcome || !enf_array_reserve(tree->nodes, tree->node_capacity, node + 1)) {
        builder->outcome = ENF_AIR_NO_MEMORY;
        free(lists);
        return -1;
    }
    tree->nodes[tree->node_count++] =
        (enf_air_node){.normal = {plane.normal[0], plane.normal[1], plane.normal[2]},
                       .offset = plane.offset,
                       .wall_first = tree->thin_wall_count};
    if (!deal(builder, part, count, &plane, sides, counts)) builder->outcome = ENF_AIR_NO_MEMORY;
    tree->nodes[node].wall_count = tree->thin_wall_count - tree->nodes[node].wall_first;
    if (builder->walls->count > builder->wall_most) builder->outcome = ENF_AIR_TOO_DEEP;
    for (int s = 0; s < 2 && !builder->outcome; s++) {
        int32_t child = build(builder, sides[s], counts[s], depth + 1);
        tree->nodes[node].child[s] = child;
    }
    free(lists);
    return node;
}

/// The part as a leaf, or as a node; -1 - leaf or the node's number.
// NOLINTNEXTLINE(misc-no-recursion): ENF_AIR_DEPTH_MOST levels at most
static int32_t build(builder *builder, const int32_t *part, int32_t count, int depth) {
    if (builder->tree->leaf_count < builder->leafs_most) {
        if (count == 0) return -1 - builder->tree->leaf_count++;
        if (depth < ENF_AIR_DEPTH_MOST) return divide(builder, part, count, depth);
    }
    builder->outcome = ENF_AIR_TOO_DEEP;
    return -1;
}

enf_air_outcome enf_air_tree_make(enf_air_tree *tree, enf_walls *walls, double size, int32_t leafs_most) {
    *tree = (enf_air_tree){.tolerance = size * relative_tolerance};
    builder builder = {.tree = tree, .walls = walls, .leafs_most = leafs_most};
    builder.wall_most = (int32_t)fmin(growth_most * walls->count + 1000, INT32_MAX / 2);
    int32_t count = walls->count, *part = enf_array_new((size_t)count, sizeof *part);
    if (!part) return ENF_AIR_NO_MEMORY;
    for (int32_t i = 0; i < count; i++) part[i] = i;
    build(&builder, part, count, 0);
    free(part);
    free(builder.front);
    free(builder.back);
    return builder.outcome;
}

void enf_air_tree_free(enf_air_tree *tree) {
    free(tree->nodes);
    free(tree->thin_walls);
    *tree = (enf_air_tree){0};
}
