// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/air_pieces.h"

#include "base/array.h"
#include "base/parallel.h"
#include "format/frame.h"
#include "visibility/fine_vertices.h"
#include "visibility/flat_hull.h"
#include "visibility/window.h"

#include <stdlib.h>
#include <string.h>

/// The corners of a convex body, in the slicer's stack.
typedef struct body {
    size_t first;
    int32_t count;
    bool is_thin;
} body;

typedef struct slicer {
    const enf_air_tree *tree;
    int32_t share, cell;
    double (*stack)[3]; ///< bodies on the way down
    size_t stack_count, stack_capacity;
    double (*cap)[3]; ///< scratch: where a plane cuts a body
    size_t cap_capacity;
    enf_air_piece *pieces;
    int32_t piece_count;
    size_t piece_capacity;
    double (*corners)[3]; ///< of the pieces
    int32_t corner_count;
    size_t corner_capacity;
} slicer;

static double height_above(const enf_air_node *node, const double point[3]) {
    return enf_dot(node->normal, point) - node->offset;
}

static bool push_corner(slicer *slicer, const double corner[3]) {
    if (!enf_array_reserve(slicer->stack, slicer->stack_capacity, slicer->stack_count + 1)) return false;
    memcpy(slicer->stack[slicer->stack_count++], corner, sizeof *slicer->stack);
    return true;
}

/// Where the ways between corners on either side cross the plane; its hull is the cut through the body.
static bool find_cap(slicer *slicer, const enf_air_node *node, const body *body, int32_t *made) {
    double tolerance = slicer->tree->tolerance;
    int32_t count = 0;
    for (int32_t i = 0; i < body->count; i++) {
        double height = height_above(node, slicer->stack[body->first + (size_t)i]);
        if (height <= tolerance) continue;
        for (int32_t k = 0; k < body->count; k++) {
            const double *a = slicer->stack[body->first + (size_t)i],
                         *b = slicer->stack[body->first + (size_t)k];
            double other = height_above(node, b);
            if (other >= -tolerance) continue;
            if (!enf_array_reserve(slicer->cap, slicer->cap_capacity, 3 * (size_t)(count + 1) + 1))
                return false;
            for (int axis = 0; axis < 3; axis++)
                slicer->cap[count][axis] = a[axis] + height / (height - other) * (b[axis] - a[axis]);
            count++;
        }
    }
    *made = enf_flat_hull(slicer->cap, count, node->normal, slicer->cap + count);
    memmove(slicer->cap, slicer->cap + count, (size_t)*made * sizeof *slicer->cap);
    return true;
}

/// Pushes what is in front (side 1) or behind (side -1) of the plane.
static bool push_half(slicer *slicer, const enf_air_node *node, const body *whole, double side, int32_t cap,
                      body *half) {
    *half = (body){.first = slicer->stack_count, .is_thin = whole->is_thin};
    for (int32_t i = 0; i < whole->count; i++) {
        const double corner[3] = {slicer->stack[whole->first + (size_t)i][0],
                                  slicer->stack[whole->first + (size_t)i][1],
                                  slicer->stack[whole->first + (size_t)i][2]};
        if (side * height_above(node, corner) < -slicer->tree->tolerance) continue;
        if (!push_corner(slicer, corner)) return false;
    }
    for (int32_t i = 0; i < cap; i++)
        if (!push_corner(slicer, slicer->cap[i])) return false;
    half->count = (int32_t)(slicer->stack_count - half->first);
    return true;
}

static bool put_piece(slicer *slicer, int32_t leaf, const body *body) {
    if (!enf_array_reserve(slicer->pieces, slicer->piece_capacity, slicer->piece_count + 1) ||
        !enf_array_reserve(slicer->corners, slicer->corner_capacity, slicer->corner_count + body->count))
        return false;
    slicer->pieces[slicer->piece_count++] = (enf_air_piece){.leaf = leaf,
                                                            .cell = slicer->cell,
                                                            .share = slicer->share,
                                                            .first = slicer->corner_count,
                                                            .count = body->count,
                                                            .is_thin = body->is_thin};
    memcpy(slicer->corners + slicer->corner_count, slicer->stack + body->first,
           (size_t)body->count * sizeof *slicer->corners);
    slicer->corner_count += body->count;
    return true;
}

static bool sink(slicer *slicer, int32_t at, const body *body);

/// On both sides of the plane: cuts the body, and goes on with both halves.
// NOLINTNEXTLINE(misc-no-recursion): ENF_AIR_DEPTH_MOST levels at most
static bool cut(slicer *slicer, int32_t at, const body *whole) {
    const enf_air_node *node = &slicer->tree->nodes[at];
    size_t kept = slicer->stack_count;
    body halves[2];
    int32_t cap;
    bool good = find_cap(slicer, node, whole, &cap) && push_half(slicer, node, whole, -1, cap, &halves[0]) &&
                push_half(slicer, node, whole, 1, cap, &halves[1]);
    for (int side = 0; good && side < 2; side++) good = sink(slicer, node->child[side], &halves[side]);
    slicer->stack_count = kept;
    return good;
}

/// Takes the body down the tree.
// NOLINTNEXTLINE(misc-no-recursion): ENF_AIR_DEPTH_MOST levels at most
static bool sink(slicer *slicer, int32_t at, const body *given) {
    body body = *given;
    while (at >= 0) {
        const enf_air_node *node = &slicer->tree->nodes[at];
        bool is_front = false, is_back = false;
        for (int32_t i = 0; i < body.count; i++) {
            double height = height_above(node, slicer->stack[body.first + (size_t)i]);
            is_front = is_front || height > slicer->tree->tolerance;
            is_back = is_back || height < -slicer->tree->tolerance;
        }
        if (is_front && is_back) return cut(slicer, at, &body);
        if (!is_front && !is_back) {
            body.is_thin = true;
            if (!sink(slicer, node->child[0], &body)) return false;
        }
        at = node->child[is_front || !is_back];
    }
    return put_piece(slicer, -1 - at, &body);
}

/// The corners of a fine cell as the only body of the stack.
static bool take_fine_cell(slicer *slicer, const enf_file_view *view, int32_t fine, enf_fine_vertices *list,
                           body *body) {
    if (!enf_fine_vertices_take(list, view, fine)) return false;
    slicer->stack_count = 0;
    for (int32_t i = 0; i < list->count; i++) {
        double corner[3];
        enf_view_to_world(view, view->vertex_position[list->vertices[i]], corner);
        if (!push_corner(slicer, corner)) return false;
    }
    *body = (struct body){.count = list->count};
    return true;
}

static bool slice(slicer *slicer, const enf_file_view *view, int32_t begin, int32_t end) {
    enf_fine_vertices list = {0};
    bool good = true;
    int32_t root = slicer->tree->node_count > 0 ? 0 : -1;
    for (int32_t fine = begin; good && fine < end; fine++) {
        body body;
        slicer->cell = view->fine_cell[fine];
        if (slicer->cell < 0) continue;
        good = take_fine_cell(slicer, view, fine, &list, &body) && sink(slicer, root, &body);
    }
    free(list.vertices);
    return good;
}

static void free_slicer(slicer *slicer) {
    free(slicer->stack);
    free(slicer->cap);
    free(slicer->pieces);
    free(slicer->corners);
}

// ---------------------------------------------------------------------------------------------- threads

typedef struct slicing {
    const enf_air_tree *tree;
    const enf_file_view *view;
    slicer slicers[ENF_AIR_SHARES];
    bool good[ENF_AIR_SHARES];
} slicing;

static int32_t first_of(const slicing *slicing, int32_t share) {
    return (int32_t)((int64_t)slicing->view->fine_count * share / ENF_AIR_SHARES);
}

static void slice_share(void *user, int32_t share, int thread) {
    slicing *slicing = user;
    (void)thread;
    slicing->slicers[share] = (slicer){.tree = slicing->tree, .share = share};
    slicing->good[share] = slice(&slicing->slicers[share], slicing->view, first_of(slicing, share),
                                 first_of(slicing, share + 1));
}

/// Takes what a slicer has made. False without memory.
static bool take_share(enf_air_pieces *all, slicer *slicer) {
    if (slicer->piece_count > INT32_MAX - all->count ||
        !enf_array_reserve(all->items, all->capacity, all->count + slicer->piece_count))
        return false;
    if (slicer->piece_count > 0)
        memcpy(all->items + all->count, slicer->pieces, (size_t)slicer->piece_count * sizeof *all->items);
    all->count += slicer->piece_count;
    all->corners[slicer->share] = slicer->corners;
    slicer->corners = NULL;
    return true;
}

bool enf_air_pieces_make(enf_air_pieces *all, const enf_air_tree *tree, const enf_file_view *view,
                         int threads) {
    slicing slicing = {.tree = tree, .view = view};
    bool good = true;
    *all = (enf_air_pieces){0};
    enf_parallel_for(&(enf_crew){.threads = threads}, ENF_AIR_SHARES, slice_share, &slicing);
    for (int i = 0; i < ENF_AIR_SHARES; i++) {
        good = good && slicing.good[i] && take_share(all, &slicing.slicers[i]);
        free_slicer(&slicing.slicers[i]);
    }
    return good;
}

void enf_air_pieces_free(enf_air_pieces *all) {
    for (int i = 0; i < ENF_AIR_SHARES; i++) free(all->corners[i]);
    free(all->items);
    *all = (enf_air_pieces){0};
}
