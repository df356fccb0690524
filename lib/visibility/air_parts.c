// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/air_parts.h"

#include "base/array.h"
#include "base/parallel.h"
#include "format/frame.h"
#include "visibility/distinct.h"
#include "visibility/fine_vertices.h"
#include "visibility/flat_hull.h"
#include "visibility/window.h"

#include <stdlib.h>
#include <string.h>

/// What a fine cell, or the hull of some, leaves of itself in a leaf.
typedef struct piece {
    int32_t leaf, cell;
    int32_t share;        ///< whose corners
    int32_t first, count; ///< corners
    bool is_thin;         ///< lies within the tolerance of a plane on the way: it does not say what is air
} piece;

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
    piece *pieces;
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
    slicer->pieces[slicer->piece_count++] = (piece){.leaf = leaf,
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

enum { SHARES = 64 }; ///< of the fine cells, however many threads there are

typedef struct slicing {
    const enf_air_tree *tree;
    const enf_file_view *view;
    slicer slicers[SHARES];
    bool good[SHARES];
} slicing;

static int32_t first_of(const slicing *slicing, int32_t share) {
    return (int32_t)((int64_t)slicing->view->fine_count * share / SHARES);
}

static void slice_share(void *user, int32_t share, int thread) {
    slicing *slicing = user;
    (void)thread;
    slicing->slicers[share] = (slicer){.tree = slicing->tree, .share = share};
    slicing->good[share] = slice(&slicing->slicers[share], slicing->view, first_of(slicing, share),
                                 first_of(slicing, share + 1));
}

/// The pieces of all shares; their corners are where the slicers have put them.
typedef struct pieces {
    piece *items;
    int32_t count;
    size_t corner_count;
    slicing slicing;
} pieces;

static const double (*corners_of(const pieces *all, const piece *piece))[3] {
    return (const double(*)[3])(all->slicing.slicers[piece->share].corners + piece->first);
}

/// False without memory; free *all in any case.
static bool slice_all(pieces *all, const enf_air_tree *tree, const enf_file_view *view, int threads) {
    const enf_crew crew = {.threads = threads};
    slicing *slicing = &all->slicing;
    size_t count = 0;
    bool good = true;
    slicing->tree = tree;
    slicing->view = view;
    enf_parallel_for(&crew, SHARES, slice_share, slicing);
    for (int i = 0; i < SHARES; i++) {
        count += (size_t)slicing->slicers[i].piece_count;
        all->corner_count += (size_t)slicing->slicers[i].corner_count;
        good = good && slicing->good[i];
    }
    all->items = enf_array_new(count, sizeof *all->items);
    if (!good || !all->items || count > INT32_MAX || all->corner_count > INT32_MAX) return false;
    for (int i = 0; i < SHARES; i++) {
        const slicer *slicer = &slicing->slicers[i];
        if (slicer->piece_count == 0) continue;
        memcpy(all->items + all->count, slicer->pieces, (size_t)slicer->piece_count * sizeof *all->items);
        all->count += slicer->piece_count;
    }
    return true;
}

static void free_pieces(pieces *all) {
    for (int i = 0; i < SHARES; i++) free_slicer(&all->slicing.slicers[i]);
    free(all->items);
}

// ---------------------------------------------------------------------------------------------- parts

/// Moves pieces into the order of one of their numbers, below `limit`; those with the same one stay in the
/// order that they are in. `first` has limit + 1 places.
static void order_by(const piece *from, piece *to, int32_t count, bool by_leaf, int32_t limit,
                     int32_t *first) {
    memset(first, 0, ((size_t)limit + 1) * sizeof *first);
    for (int32_t i = 0; i < count; i++) first[1 + (by_leaf ? from[i].leaf : from[i].cell)]++;
    for (int32_t k = 0; k < limit; k++) first[k + 1] += first[k];
    for (int32_t i = 0; i < count; i++) to[first[by_leaf ? from[i].leaf : from[i].cell]++] = from[i];
}

/// Leaf by leaf, and there cell by cell. False without memory.
static bool order(pieces *all, int32_t leaf_count, int32_t cell_count) {
    const size_t limit = (size_t)(leaf_count > cell_count ? leaf_count : cell_count);
    piece *scratch = enf_array_new((size_t)all->count, sizeof *scratch);
    int32_t *first = enf_array_new(limit + 1, sizeof *first);
    const bool good = scratch && first;
    if (good) {
        order_by(all->items, scratch, all->count, false, cell_count, first);
        order_by(scratch, all->items, all->count, true, leaf_count, first);
    }
    free(scratch);
    free(first);
    return good;
}

/// Drops the thin pieces of leafs that have no others: those are rock.
static void drop_thin(pieces *all) {
    int32_t kept = 0;
    for (int32_t i = 0, end; i < all->count; i = end) {
        bool is_air = false;
        for (end = i; end < all->count && all->items[end].leaf == all->items[i].leaf; end++)
            is_air = is_air || !all->items[end].is_thin;
        for (int32_t k = i; is_air && k < end; k++) all->items[kept++] = all->items[k];
    }
    all->count = kept;
}

/// Copies the corners of pieces i..end-1, each once. False without memory.
static bool put_corners(enf_bodies *parts, const pieces *all, int32_t begin, int32_t end,
                        enf_distinct *distinct) {
    int32_t first = parts->corner_first[parts->count], made = first;
    for (int32_t i = begin; i < end; i++) {
        memcpy(parts->corners + made, corners_of(all, &all->items[i]),
               (size_t)all->items[i].count * sizeof *parts->corners);
        made += all->items[i].count;
    }
    const int32_t kept = enf_distinct_keep(distinct, parts->corners + first, made - first);
    parts->corner_first[parts->count + 1] = first + kept;
    return kept >= 0;
}

static bool join_pieces(enf_air_parts *air, const pieces *all, int32_t leaf_count, int32_t cell_count) {
    enf_bodies *parts = &air->bodies;
    enf_distinct distinct = {0};
    const size_t pieces = (size_t)all->count, leafs = (size_t)leaf_count;
    parts->owner_count = cell_count;
    air->leaf_of = enf_array_new(leafs, sizeof *air->leaf_of);
    parts->cell_first = enf_array_new(leafs + 1, sizeof *parts->cell_first);
    parts->owner = enf_array_new(pieces, sizeof *parts->owner);
    parts->corner_first = enf_array_new(pieces + 1, sizeof *parts->corner_first);
    parts->corners = enf_array_new(all->corner_count, sizeof *parts->corners);
    air->lost = enf_array_new((size_t)cell_count, sizeof *air->lost);
    bool *found = enf_array_zeroed((size_t)cell_count, sizeof *found);
    bool good = air->leaf_of && parts->cell_first && parts->owner && parts->corner_first && parts->corners &&
                air->lost && found;
    if (good) parts->corner_first[0] = 0;
    for (int32_t leaf = 0, i = 0; good && leaf < leaf_count; leaf++) {
        bool is_air = i < all->count && all->items[i].leaf == leaf;
        air->leaf_of[leaf] = is_air ? parts->cell_count++ : -1;
        if (is_air) parts->cell_first[air->leaf_of[leaf]] = parts->count;
        for (int32_t end; i < all->count && all->items[i].leaf == leaf; i = end) {
            const piece *piece = &all->items[i];
            for (end = i;
                 end < all->count && all->items[end].leaf == leaf && all->items[end].cell == piece->cell;)
                end++;
            good = good && put_corners(parts, all, i, end, &distinct);
            parts->owner[parts->count++] = piece->cell;
            found[piece->cell] = true;
        }
    }
    if (good) parts->cell_first[parts->cell_count] = parts->count;
    for (int32_t c = 0; good && c < cell_count; c++)
        if (!found[c]) air->lost[air->lost_count++] = c;
    free(found);
    free(distinct.slots);
    return good;
}

enf_status enf_air_parts_make(enf_air_parts *air, const enf_air_tree *tree, const enf_file_view *view,
                              int threads, enf_error *error) {
    pieces all = {0};
    *air = (enf_air_parts){0};
    bool good = slice_all(&all, tree, view, threads) && order(&all, tree->leaf_count, view->cell_count);
    if (good) {
        drop_thin(&all);
        good = join_pieces(air, &all, tree->leaf_count, view->cell_count);
    }
    free_pieces(&all);
    good = good && enf_bodies_finish(&air->bodies);
    return good ? ENF_OK : enf_fail_memory(error, "the parts of cells");
}

void enf_air_parts_free(enf_air_parts *air) {
    enf_bodies_free(&air->bodies);
    free(air->leaf_of);
    free(air->lost);
    *air = (enf_air_parts){0};
}
