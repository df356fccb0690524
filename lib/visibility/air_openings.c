// SPDX-License-Identifier: GPL-3.0-or-later
// As level compilers make portals (J. Carmack's qbsp, 1996): the part of each node's plane that lies within
// the node is dealt out to the leafs in front of it and behind it.
#include "visibility/air_openings.h"

#include "base/array.h"
#include "base/parallel.h"
#include "visibility/flat_hull.h"
#include "visibility/winding.h"
#include "visibility/window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// A convex polygon in the maker's stack.
typedef struct sheet {
    size_t first;
    int32_t count;
} sheet;

typedef struct maker {
    enf_portal_graph *graph;
    const enf_air_tree *tree;
    const enf_air_parts *parts;
    int32_t *parent; ///< per node; -1: the root
    bool *has_air;   ///< per node: some leaf below is air
    double size;
    double (*stack)[3];
    size_t count, capacity;
    const enf_air_node *node; ///< whose plane it is
} maker;

static double area_of(const double (*corners)[3], int32_t count, const double normal[3]) {
    double area = 0;
    for (int32_t i = 2; i < count; i++) {
        double a[3], b[3];
        for (int axis = 0; axis < 3; axis++) {
            a[axis] = corners[i - 1][axis] - corners[0][axis];
            b[axis] = corners[i][axis] - corners[0][axis];
        }
        for (int axis = 0; axis < 3; axis++) {
            int u = (axis + 1) % 3, v = (axis + 2) % 3;
            area += normal[axis] * (a[u] * b[v] - a[v] * b[u]) / 2;
        }
    }
    return area;
}

static bool push(maker *maker, const double corner[3]) {
    if (!enf_array_reserve(maker->stack, maker->capacity, maker->count + 1)) return false;
    memcpy(maker->stack[maker->count++], corner, sizeof *maker->stack);
    return true;
}

static double height_above(const double normal[3], double offset, const double point[3]) {
    return enf_dot(normal, point) - offset;
}

/// Pushes the part of the sheet that is in front (side 1) or behind (side -1) of a plane: nothing (count 0)
/// if that is no more than an edge.
static bool push_half(maker *maker, const sheet *whole, const double normal[3], double offset, double side,
                      sheet *half) {
    double tolerance = maker->tree->tolerance;
    bool is_beyond = false;
    *half = (sheet){.first = maker->count};
    for (int32_t i = 0; i < whole->count; i++) {
        double a[3], b[3];
        memcpy(a, maker->stack[whole->first + (size_t)i], sizeof a);
        memcpy(b, maker->stack[whole->first + (size_t)(i + 1 < whole->count ? i + 1 : 0)], sizeof b);
        double height = side * height_above(normal, offset, a), next = side * height_above(normal, offset, b);
        is_beyond = is_beyond || height > tolerance;
        if (height >= -tolerance && !push(maker, a)) return false;
        if ((height > tolerance && next < -tolerance) || (height < -tolerance && next > tolerance)) {
            for (int axis = 0; axis < 3; axis++) a[axis] += height / (height - next) * (b[axis] - a[axis]);
            if (!push(maker, a)) return false;
        }
    }
    half->count = is_beyond ? (int32_t)(maker->count - half->first) : 0;
    if (half->count < 3) half->count = 0;
    if (half->count == 0) maker->count = half->first;
    return true;
}

// ---------------------------------------------------------------------------------------------- openings

static bool add_opening(maker *maker, int32_t behind, int32_t front, const double (*corners)[3],
                        int32_t count) {
    double normal[3];
    if (!enf_winding_normal(corners, count, normal)) return true; // as thin as rounding
    return enf_portal_graph_add(maker->graph, maker->parts->leaf_of[behind], maker->parts->leaf_of[front],
                                corners, count);
}

/// Convex polygons in the maker's stack.
typedef struct sheets {
    sheet *items;
    int32_t count;
    size_t capacity;
} sheets;

static bool append(sheets *sheets, const sheet *sheet) {
    if (!enf_array_reserve(sheets->items, sheets->capacity, sheets->count + 1)) return false;
    sheets->items[sheets->count++] = *sheet;
    return true;
}

/// The line of a wall's edge within its plane: what is outside lies in front. False if the edge has no
/// length.
static bool find_edge(const maker *maker, const enf_wall *wall, int32_t edge, double outwards[3],
                      double *offset) {
    const double(*corners)[3] = (const double(*)[3])(maker->tree->thin.corners + wall->first);
    const double *a = corners[edge], *b = corners[edge + 1 < wall->count ? edge + 1 : 0];
    for (int axis = 0; axis < 3; axis++) {
        int u = (axis + 1) % 3, v = (axis + 2) % 3;
        outwards[axis] = (b[u] - a[u]) * wall->normal[v] - (b[v] - a[v]) * wall->normal[u];
    }
    double length = sqrt(enf_dot(outwards, outwards));
    if (!(length > 0)) return false;
    for (int axis = 0; axis < 3; axis++) outwards[axis] /= length;
    *offset = enf_dot(outwards, a);
    return true;
}

/// Appends what a thin wall leaves of a sheet: what lies outside of one edge after the other.
static bool take_out_of(maker *maker, const enf_wall *wall, const sheet *whole, sheets *left) {
    sheet rest = *whole, out, inside;
    int32_t before = left->count;
    for (int32_t i = 0; i < wall->count && rest.count > 0; i++) {
        double outwards[3], offset;
        if (!find_edge(maker, wall, i, outwards, &offset)) continue;
        if (!push_half(maker, &rest, outwards, offset, 1, &out) ||
            !push_half(maker, &rest, outwards, offset, -1, &inside) || (out.count > 0 && !append(left, &out)))
            return false;
        rest = inside;
    }
    if (rest.count > 0) return true;
    left->count = before; // the wall is elsewhere
    return append(left, whole);
}

/// Adds the hull of the sheets as one opening if it is no larger than they are together, or each by itself.
static bool add_sheets(maker *maker, int32_t behind, int32_t front, const sheet *sheets, int32_t count) {
    double area = 0, (*points)[3];
    int32_t corners = 0, made;
    for (int32_t s = 0; s < count; s++) {
        area += area_of((const double(*)[3])(maker->stack + sheets[s].first), sheets[s].count,
                        maker->node->normal);
        corners += sheets[s].count;
    }
    points = enf_array_new(3 * (size_t)corners + 1, sizeof *points);
    if (!points) return false;
    for (int32_t s = 0, at = 0; s < count; at += sheets[s++].count)
        memcpy(points + at, maker->stack + sheets[s].first, (size_t)sheets[s].count * sizeof *points);
    made = enf_flat_hull(points, corners, maker->node->normal, points + corners);
    const double(*hull)[3] = (const double(*)[3])(points + corners);
    bool is_whole = made >= 3 && area_of(hull, made, maker->node->normal) <= area * (1 + 0x1p-20);
    bool good = !is_whole || add_opening(maker, behind, front, hull, made);
    for (int32_t s = 0; good && !is_whole && s < count; s++)
        good = add_opening(maker, behind, front, (const double(*)[3])(maker->stack + sheets[s].first),
                           sheets[s].count);
    free(points);
    return good;
}

/// Adds what thin walls leave of the sheet.
static bool pierce(maker *maker, int32_t behind, int32_t front, const sheet *sheet) {
    size_t kept = maker->count;
    sheets lists[2] = {{0}};
    int now = 0;
    bool good = append(&lists[now], sheet);
    for (int32_t i = 0; good && i < maker->node->wall_count; i++, now = !now) {
        const enf_wall *wall = &maker->tree->thin.walls[maker->node->wall_first + i];
        lists[!now].count = 0;
        for (int32_t s = 0; good && s < lists[now].count; s++)
            good = take_out_of(maker, wall, &lists[now].items[s], &lists[!now]);
    }
    if (good && lists[now].count > 0)
        good = add_sheets(maker, behind, front, lists[now].items, lists[now].count);
    free(lists[0].items);
    free(lists[1].items);
    maker->count = kept;
    return good;
}

// ---------------------------------------------------------------------------------------------- dealing

static bool is_air(const maker *maker, int32_t at) {
    return at >= 0 ? maker->has_air[at] : maker->parts->leaf_of[-1 - at] >= 0;
}

static bool deal(maker *maker, int32_t at, const sheet *sheet, int32_t front);

/// A leaf: the one in front is found first, then those behind.
// NOLINTNEXTLINE(misc-no-recursion): ENF_AIR_DEPTH_MOST levels at most
static bool arrive(maker *maker, int32_t leaf, const sheet *sheet, int32_t front) {
    if (front < 0) return deal(maker, maker->node->child[0], sheet, leaf);
    if (maker->node->wall_count > 0) return pierce(maker, leaf, front, sheet);
    return add_opening(maker, leaf, front, (const double(*)[3])(maker->stack + sheet->first), sheet->count);
}

/// Takes the sheet down the tree. `front`: the leaf in front of it, if that is known, or -1.
// NOLINTNEXTLINE(misc-no-recursion): ENF_AIR_DEPTH_MOST levels at most
static bool deal(maker *maker, int32_t at, const sheet *sheet, int32_t front) {
    if (!is_air(maker, at)) return true;
    if (at < 0) return arrive(maker, -1 - at, sheet, front);
    const enf_air_node *node = &maker->tree->nodes[at];
    size_t kept = maker->count;
    struct sheet halves[2];
    bool good = push_half(maker, sheet, node->normal, node->offset, -1, &halves[0]) &&
                push_half(maker, sheet, node->normal, node->offset, 1, &halves[1]);
    if (good && halves[0].count == 0 && halves[1].count == 0) halves[0] = halves[1] = *sheet; // in the plane
    for (int side = 0; good && side < 2; side++)
        if (halves[side].count > 0) good = deal(maker, node->child[side], &halves[side], front);
    maker->count = kept;
    return good;
}

/// Pushes a square in the node's plane that is larger than the world.
static bool push_square(maker *maker, const enf_air_node *node, sheet *sheet) {
    int along = 0;
    for (int axis = 1; axis < 3; axis++)
        if (fabs(node->normal[axis]) > fabs(node->normal[along])) along = axis;
    double u[3] = {0}, v[3], reach = 4 * maker->size;
    u[(along + 1) % 3] = 1;
    double part = enf_dot(u, node->normal);
    for (int axis = 0; axis < 3; axis++) u[axis] -= part * node->normal[axis];
    double length = sqrt(enf_dot(u, u));
    for (int axis = 0; axis < 3; axis++) u[axis] /= length;
    for (int axis = 0; axis < 3; axis++) {
        int next = (axis + 1) % 3, last = (axis + 2) % 3;
        v[axis] = node->normal[next] * u[last] - node->normal[last] * u[next];
    }
    *sheet = (struct sheet){maker->count, 4};
    for (int i = 0; i < 4; i++) {
        double corner[3], along_u = i == 1 || i == 2 ? reach : -reach, along_v = i < 2 ? -reach : reach;
        for (int axis = 0; axis < 3; axis++)
            corner[axis] = node->normal[axis] * node->offset + along_u * u[axis] + along_v * v[axis];
        if (!push(maker, corner)) return false;
    }
    return true;
}

/// The part of the node's plane within the node, dealt out.
static bool open_node(maker *maker, int32_t number) {
    const enf_air_tree *tree = maker->tree;
    sheet sheet, half;
    maker->node = &tree->nodes[number];
    maker->count = 0;
    if (!is_air(maker, maker->node->child[0]) || !is_air(maker, maker->node->child[1])) return true;
    if (!push_square(maker, maker->node, &sheet)) return false;
    for (int32_t below = number, at = maker->parent[number]; at >= 0; below = at, at = maker->parent[at]) {
        const enf_air_node *node = &tree->nodes[at];
        double side = node->child[1] == below ? 1 : -1;
        if (!push_half(maker, &sheet, node->normal, node->offset, side, &half)) return false;
        if (half.count == 0) return true;
        sheet = half;
    }
    return deal(maker, maker->node->child[1], &sheet, -1);
}

static void find_relations(maker *maker) {
    const enf_air_tree *tree = maker->tree;
    if (tree->node_count > 0) maker->parent[0] = -1;
    for (int32_t i = tree->node_count - 1; i >= 0; i--) // children have higher numbers
        for (int side = 0; side < 2; side++) {
            int32_t child = tree->nodes[i].child[side];
            if (child >= 0) maker->parent[child] = i;
            maker->has_air[i] = maker->has_air[i] || is_air(maker, child);
        }
}

// ---------------------------------------------------------------------------------------------- all

/// Of the nodes, however many threads there are.
enum { SHARES = 64 };

/// The openings of some nodes.
typedef struct share {
    enf_portal_graph graph; ///< not finished
    bool good;
} share;

typedef struct making {
    const maker *maker; ///< as each share begins
    share shares[SHARES];
} making;

static void open_share(void *user, int32_t number, int thread) {
    making *making = user;
    share *share = &making->shares[number];
    maker maker = *making->maker;
    const int64_t nodes = maker.tree->node_count;
    (void)thread;
    maker.graph = &share->graph;
    share->good = true;
    for (int64_t i = nodes * number / SHARES; share->good && i < nodes * (number + 1) / SHARES; i++)
        share->good = open_node(&maker, (int32_t)i);
    free(maker.stack);
}

/// Appends openings. False without memory.
static bool take_openings(enf_portal_graph *graph, const enf_portal_graph *from) {
    bool good = true;
    for (int32_t i = 0; good && i < from->opening_count; i++)
        good = enf_portal_graph_add(graph, from->opening_cell[i][0], from->opening_cell[i][1],
                                    (const double(*)[3])(from->corners + from->opening_corner[i]),
                                    from->opening_corner[i + 1] - from->opening_corner[i]);
    return good;
}

enf_status enf_air_openings_make(enf_portal_graph *graph, const enf_air_tree *tree,
                                 const enf_air_parts *parts, double size, int threads, enf_error *error) {
    maker maker = {.tree = tree, .parts = parts, .size = size};
    making making = {.maker = &maker};
    *graph = (enf_portal_graph){.cell_count = parts->bodies.cell_count};
    maker.parent = enf_array_new((size_t)tree->node_count, sizeof *maker.parent);
    maker.has_air = enf_array_zeroed((size_t)tree->node_count, sizeof *maker.has_air);
    bool good = maker.parent && maker.has_air;
    if (good) {
        find_relations(&maker);
        enf_parallel_for(&(enf_crew){.threads = threads}, SHARES, open_share, &making);
    }
    for (int i = 0; i < SHARES; i++) {
        good = good && making.shares[i].good && take_openings(graph, &making.shares[i].graph);
        enf_portal_graph_free(&making.shares[i].graph);
    }
    free(maker.parent);
    free(maker.has_air);
    return good ? enf_portal_graph_finish(graph, error) : enf_fail_memory(error, "the openings");
}
