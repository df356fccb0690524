// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/world_pairs.h"

#include "base/array.h"
#include "format/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WAY_MOST = 200 };

enf_status enf_world_pairs_make(enf_world_pairs *pairs, const enf_world_air *air, enf_world_lines *lines,
                                uint64_t seed, enf_error *error) {
    *pairs = (enf_world_pairs){.air = air, .lines = lines, .squeeze = {.seed = seed}};
    pairs->pieces[0].cell = pairs->pieces[1].cell = -1;
    const size_t portals = 2 * (size_t)air->leafs.opening_count;
    if (!enf_shapes_make(&pairs->shapes, &air->leafs)) return enf_fail_memory(error, "the pairs");
    pairs->squeeze.shapes = &pairs->shapes;
    pairs->is_guided = enf_array_zeroed(portals, sizeof *pairs->is_guided);
    pairs->marked = enf_array_new(portals, sizeof *pairs->marked);
    pairs->is_on_way = enf_array_zeroed((size_t)air->leafs.cell_count, sizeof *pairs->is_on_way);
    pairs->way = enf_array_new(WAY_MOST, sizeof *pairs->way);
    pairs->windows = enf_array_new(WAY_MOST, sizeof *pairs->windows);
    if (pairs->is_guided && pairs->marked && pairs->is_on_way && pairs->way && pairs->windows) return ENF_OK;
    return enf_fail_memory(error, "the pairs");
}

void enf_world_pairs_free(enf_world_pairs *pairs) {
    enf_shapes_free(&pairs->shapes);
    free(pairs->is_guided);
    free(pairs->marked);
    free(pairs->is_on_way);
    free(pairs->way);
    free(pairs->windows);
    for (int i = 0; i < 2; i++) free(pairs->pieces[i].items);
    free(pairs->vertices.vertices);
    free(pairs->corners);
    *pairs = (enf_world_pairs){0};
}

// ---------------------------------------------------------------------------------------------- one pair

typedef struct deciding {
    enf_world_pairs *pairs;
    int32_t cell, other;
    int32_t leaf;  ///< that ways begin in
    enf_body body; ///< the part of the cell that ways begin at
    enf_solid from;
    bool is_seen, is_open;
} deciding;

static bool try_line(void *user, const enf_line *line) {
    const deciding *deciding = user;
    enf_world_lines *lines = deciding->pairs->lines;
    enf_world_lines_follow(lines, line, deciding->cell);
    return enf_pvs_get(&lines->seen, deciding->cell, deciding->other);
}

static void mark(enf_world_pairs *pairs, int32_t portal) {
    if (pairs->is_guided[portal ^ 1]) return;
    pairs->is_guided[portal ^ 1] = true;
    pairs->marked[pairs->marked_count++] = portal;
}

/// Which portals may be seen from the other cell, towards which the ways go? From each to those behind it
/// that separators leave something of.
static void find_guides(enf_world_pairs *pairs, int32_t other) {
    const enf_bodies *bodies = &pairs->air->parts.bodies;
    const enf_portal_graph *leafs = &pairs->air->leafs;
    const int32_t whole = bodies->whole_first[other];
    enf_body body;
    for (int32_t i = 0; i < pairs->marked_count; i++) pairs->is_guided[pairs->marked[i] ^ 1] = false;
    pairs->marked_count = 0;
    enf_body_make(&body, (const double(*)[3])(bodies->wholes + whole), bodies->whole_first[other + 1] - whole,
                  pairs->shapes.tolerance / 8);
    for (int32_t k = bodies->owner_first[other]; k < bodies->owner_first[other + 1]; k++)
        for (int32_t i = leafs->cell_portal[bodies->cells[k]]; i < leafs->cell_portal[bodies->cells[k] + 1];
             i++)
            mark(pairs, leafs->cell_portals[i]);
    for (int32_t i = 0; i < pairs->marked_count; i++) {
        const int32_t via = pairs->marked[i], leaf = enf_portal_to(leafs, via);
        const enf_outline outline = enf_shape_outline(&pairs->shapes, via >> 1);
        enf_separators separators;
        enf_window left;
        enf_separators_from_body(&separators, &pairs->shapes, &body, &outline, via);
        for (int32_t k = leafs->cell_portal[leaf]; k < leafs->cell_portal[leaf + 1]; k++) {
            const int32_t next = leafs->cell_portals[k];
            if (pairs->is_guided[next ^ 1] || next == (via ^ 1)) continue;
            if (enf_separators_cut(&separators, &pairs->shapes, next, &left) != ENF_REMAINS_NOTHING)
                mark(pairs, next);
        }
    }
}

/// The other cell's part in a leaf; -1: it has none.
static int32_t find_part(const enf_bodies *bodies, int32_t leaf, int32_t owner) {
    for (int32_t body = bodies->cell_first[leaf]; body < bodies->cell_first[leaf + 1]; body++)
        if (bodies->owner[body] == owner) return body;
    return -1;
}

static void take_part(const enf_bodies *bodies, int32_t body, enf_solid *solid) {
    const int32_t first = bodies->corner_first[body];
    enf_solid_make(solid, (const double(*)[3])(bodies->corners + first),
                   bodies->corner_first[body + 1] - first);
}

// ---------------------------------------------------------------------------------------------- pieces

/// The hull of a leaf, which its bodies tile.
static bool find_leaf(enf_world_pairs *pairs, int32_t leaf, enf_body *hull) {
    const enf_bodies *bodies = &pairs->air->parts.bodies;
    int32_t count = 0;
    for (int32_t body = bodies->cell_first[leaf]; body < bodies->cell_first[leaf + 1]; body++)
        for (int32_t i = bodies->corner_first[body]; i < bodies->corner_first[body + 1]; i++) {
            if (!enf_array_reserve(pairs->corners, pairs->corner_capacity, count + 1)) return false;
            memcpy(pairs->corners[count++], bodies->corners[i], sizeof *pairs->corners);
        }
    enf_body_make(hull, (const double(*)[3])pairs->corners, count, pairs->shapes.tolerance / 8);
    return true;
}

/// Cuts a solid to what lies in the inside of a hull. False if that is nothing.
static bool cut_to(enf_solid *solid, const enf_body *hull, double tolerance) {
    for (int32_t i = 0; i < hull->edge_count; i++)
        for (int side = 0; side < 2; side++) {
            const double(*into)[ENF_BODY_EDGES] = side ? hull->left : hull->right;
            enf_cut cut = {.least = tolerance};
            for (int axis = 0; axis < 3; axis++) {
                const int u = (axis + 1) % 3, v = (axis + 2) % 3;
                cut.normal[axis] = hull->along[u][i] * into[v][i] - hull->along[v][i] * into[u][i];
            }
            const double length = sqrt(enf_dot(cut.normal, cut.normal)) * (side ? -1 : 1);
            for (int axis = 0; axis < 3; axis++) {
                cut.normal[axis] /= length;
                cut.least += cut.normal[axis] * hull->from[axis][i];
            }
            if (!enf_solid_cut(solid, &cut)) return false;
        }
    return true;
}

static bool add_piece(enf_world_pieces *pieces, int32_t leaf, const enf_solid *solid) {
    if (!enf_array_reserve(pieces->items, pieces->capacity, pieces->count + 1)) return false;
    pieces->items[pieces->count++] = (enf_world_piece){leaf, *solid};
    return true;
}

static bool take_fine_cell(enf_world_pairs *pairs, int32_t fine, enf_solid *solid) {
    const enf_file_view *view = pairs->lines->view;
    if (!enf_fine_vertices_take(&pairs->vertices, view, fine) ||
        !enf_array_reserve(pairs->corners, pairs->corner_capacity, pairs->vertices.count))
        return false;
    for (int32_t i = 0; i < pairs->vertices.count; i++)
        enf_view_to_world(view, view->vertex_position[pairs->vertices.vertices[i]], pairs->corners[i]);
    enf_solid_make(solid, (const double(*)[3])pairs->corners, pairs->vertices.count);
    return true;
}

/// What the fine cells of a cell leave in a leaf.
static bool add_pieces(enf_world_pairs *pairs, enf_world_pieces *pieces, int32_t leaf) {
    enf_body hull;
    bool good = find_leaf(pairs, leaf, &hull);
    for (int32_t fine = 0; good && fine < pairs->lines->view->fine_count; fine++) {
        enf_solid solid;
        if (pairs->lines->view->fine_cell[fine] != pieces->cell) continue;
        good = take_fine_cell(pairs, fine, &solid);
        if (good && cut_to(&solid, &hull, pairs->shapes.tolerance)) good = add_piece(pieces, leaf, &solid);
    }
    return good;
}

static bool make_pieces(enf_world_pairs *pairs, enf_world_pieces *pieces, int32_t cell) {
    const enf_bodies *bodies = &pairs->air->parts.bodies;
    bool good = true;
    if (pieces->cell == cell) return true;
    pieces->cell = cell;
    pieces->count = 0;
    for (int32_t k = bodies->owner_first[cell]; good && k < bodies->owner_first[cell + 1]; k++)
        good = add_pieces(pairs, pieces, bodies->cells[k]);
    return good;
}

// ---------------------------------------------------------------------------------------------- ways

static enf_status squeeze(deciding *deciding, int32_t length, const enf_solid *from, const enf_solid *to,
                          enf_squeeze_answer *answer, enf_error *error) {
    enf_world_pairs *pairs = deciding->pairs;
    pairs->ways++;
    return enf_squeeze_run(&pairs->squeeze, from, pairs->way, pairs->windows, length, to, answer, error);
}

/// Whose parts see each other, may not do so.
static enf_status look_closely(deciding *deciding, int32_t first, int32_t length, int32_t last,
                               enf_error *error) {
    enf_world_pairs *pairs = deciding->pairs;
    enf_world_pieces *from = &pairs->pieces[0], *to = &pairs->pieces[1];
    enf_status status = ENF_OK;
    if (!make_pieces(pairs, from, deciding->cell) || !make_pieces(pairs, to, deciding->other))
        return enf_fail_memory(error, "the pieces");
    for (int32_t i = 0; i < from->count; i++)
        for (int32_t k = 0; from->items[i].leaf == first && k < to->count; k++) {
            enf_squeeze_answer answer;
            if (to->items[k].leaf != last || status || deciding->is_seen) continue;
            if (pairs->squeeze.steps <= 0) {
                deciding->is_open = true;
                continue;
            }
            status = squeeze(deciding, length, &from->items[i].solid, &to->items[k].solid, &answer, error);
            deciding->is_seen = deciding->is_seen || answer == ENF_SQUEEZE_SEEN;
            deciding->is_open = deciding->is_open || answer == ENF_SQUEEZE_OPEN;
        }
    return status;
}

/// The way so far has come to a part of the other cell.
static enf_status arrive(deciding *deciding, int32_t leaf, int32_t length, int32_t part,
                         const enf_separators *separators, enf_error *error) {
    enf_world_pairs *pairs = deciding->pairs;
    enf_squeeze_answer answer;
    enf_solid to;
    take_part(&pairs->air->parts.bodies, part, &to);
    if (separators && !enf_solid_cut_all(&to, separators)) return ENF_OK;
    pairs->squeeze.is_rough = true;
    enf_status status = squeeze(deciding, length, &deciding->from, &to, &answer, error);
    pairs->squeeze.is_rough = false;
    deciding->is_seen = deciding->is_seen || answer == ENF_SQUEEZE_SEEN;
    if (status || answer != ENF_SQUEEZE_OPEN) return status;
    return look_closely(deciding, deciding->leaf, length, leaf, error);
}

/// Does some of the part lie before the portal?
static bool is_before(const deciding *deciding, int32_t portal) {
    const enf_shapes *shapes = &deciding->pairs->shapes;
    for (int32_t i = 0; i < deciding->from.count; i++)
        if (enf_shape_height(shapes, portal, deciding->from.corners[i]) < -shapes->tolerance) return true;
    return false;
}

/// Goes on from a leaf, `length` portals away from the first.
// NOLINTNEXTLINE(misc-no-recursion): WAY_MOST leafs at most
static enf_status go_on(deciding *deciding, int32_t leaf, int32_t length, enf_error *error) {
    enf_world_pairs *pairs = deciding->pairs;
    const enf_portal_graph *leafs = &pairs->air->leafs;
    const int32_t via = length > 0 ? pairs->way[length - 1] : -1,
                  part = find_part(&pairs->air->parts.bodies, leaf, deciding->other);
    enf_separators separators;
    enf_status status = ENF_OK;
    if (pairs->squeeze.steps <= 0 || length == WAY_MOST) deciding->is_open = true;
    if (pairs->squeeze.steps <= 0 || length == WAY_MOST || deciding->is_seen) return ENF_OK;
    if (via >= 0) {
        const enf_outline window = enf_window_outline(&pairs->windows[length - 1]);
        pairs->squeeze.steps--;
        enf_separators_from_body(&separators, &pairs->shapes, &deciding->body, &window, via);
    }
    if (part >= 0) status = arrive(deciding, leaf, length, part, via < 0 ? NULL : &separators, error);
    pairs->is_on_way[leaf] = true;
    for (int32_t k = leafs->cell_portal[leaf]; !status && k < leafs->cell_portal[leaf + 1]; k++) {
        const int32_t next = leafs->cell_portals[k];
        if (!pairs->is_guided[next] || pairs->is_on_way[enf_portal_to(leafs, next)] ||
            !is_before(deciding, next))
            continue;
        enf_window *window = &pairs->windows[length];
        enf_shape_window(&pairs->shapes, next, window);
        if (via >= 0 && !enf_squeeze_window(window, &separators)) continue;
        pairs->way[length] = next;
        status = go_on(deciding, enf_portal_to(leafs, next), length + 1, error);
    }
    pairs->is_on_way[leaf] = false;
    return status;
}

enf_status enf_world_pairs_decide(enf_world_pairs *pairs, int32_t cell, int32_t other, int64_t steps,
                                  enf_squeeze_answer *answer, enf_error *error) {
    const enf_bodies *bodies = &pairs->air->parts.bodies;
    deciding deciding = {.pairs = pairs, .cell = cell, .other = other};
    enf_status status = ENF_OK;
    pairs->squeeze.steps = steps;
    pairs->squeeze.is_tiny = false;
    pairs->squeeze.try_line = try_line;
    pairs->squeeze.user = &deciding;
    find_guides(pairs, other);
    for (int32_t k = bodies->owner_first[cell]; !status && k < bodies->owner_first[cell + 1]; k++) {
        const int32_t leaf = deciding.leaf = bodies->cells[k];
        take_part(bodies, find_part(bodies, leaf, cell), &deciding.from);
        enf_body_make(&deciding.body, (const double(*)[3])deciding.from.corners, deciding.from.count,
                      pairs->shapes.tolerance / 8);
        status = go_on(&deciding, leaf, 0, error);
    }
    if (bodies->owner_first[cell] == bodies->owner_first[cell + 1] ||
        bodies->owner_first[other] == bodies->owner_first[other + 1])
        deciding.is_open = true; // too thin for leafs
    *answer = deciding.is_seen ? ENF_SQUEEZE_SEEN : deciding.is_open ? ENF_SQUEEZE_OPEN : ENF_SQUEEZE_HIDDEN;
    return status;
}
