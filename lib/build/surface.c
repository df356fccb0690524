// SPDX-License-Identifier: GPL-3.0-or-later
// The surfaces of the cells while they merge, and their silhouettes.
#include "build/surface.h"

#include "base/array.h"
#include "build/pair_table.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void enf_surface_free(enf_surface *surface) {
    free(surface->piece_cell);
    free(surface->piece_open);
    free(surface->piece_gone);
    free(surface->piece_area);
    free(surface->piece_edge);
    free(surface->piece_edges);
    free(surface->sides);
    free(surface->edges);
    free(surface->vertices);
    free(surface->bodies);
    free(surface->edge_sum);
    free(surface->touched);
    free(surface->facing);
    free(surface->piece_hidden);
    free(surface->hidden);
    free(surface->plugs);
    enf_silhouette_free(&surface->silhouette);
    *surface = (enf_surface){0};
}

/// A piece of the graph on its way into canonical order.
typedef struct sorted_piece {
    uint32_t cells[2]; ///< -1 becomes the largest number
    int32_t piece;
    int32_t start; ///< its smallest corner, where the outline begins
    bool turned;   ///< the outline is to be run backwards, because the cells were swapped
    const enf_graph *graph;
} sorted_piece;

static const double *corner_of(const sorted_piece *sorted, int32_t i) {
    const enf_graph *graph = sorted->graph;
    int64_t begin = graph->piece_corner[sorted->piece], end = graph->piece_corner[sorted->piece + 1];
    int64_t count = end - begin,
            at = sorted->turned ? sorted->start - (int64_t)i : sorted->start + (int64_t)i;
    return graph->corners[begin + ((at % count) + count) % count];
}

static int32_t corner_count_of(const sorted_piece *sorted) {
    const enf_graph *graph = sorted->graph;
    return (int32_t)(graph->piece_corner[sorted->piece + 1] - graph->piece_corner[sorted->piece]);
}

static int compare_points(const double a[3], const double b[3]) {
    for (int k = 0; k < 3; ++k)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

static int compare_pieces(const void *first, const void *second) {
    const sorted_piece *a = first, *b = second;
    for (int k = 0; k < 2; ++k)
        if (a->cells[k] != b->cells[k]) return a->cells[k] < b->cells[k] ? -1 : 1;
    bool open_a = a->graph->piece_open[a->piece], open_b = b->graph->piece_open[b->piece];
    if (open_a != open_b) return open_a ? -1 : 1;
    int32_t count_a = corner_count_of(a), count_b = corner_count_of(b);
    for (int32_t i = 0; i < count_a && i < count_b; ++i) {
        int order = compare_points(corner_of(a, i), corner_of(b, i));
        if (order) return order;
    }
    return (count_a > count_b) - (count_a < count_b);
}

/// Checks one piece and prepares it for sorting; *wanted tells whether it bounds anything.
static enf_status prepare_piece(const enf_graph *graph, int32_t piece, sorted_piece *sorted, bool *wanted,
                                enf_error *error) {
    int32_t back = graph->piece_cell[piece][0], front = graph->piece_cell[piece][1];
    int64_t begin = graph->piece_corner[piece], end = graph->piece_corner[piece + 1];
    if (back < -1 || back >= graph->cell_count || front < -1 || front >= graph->cell_count || begin < 0 ||
        end < begin || end - begin > INT32_MAX)
        return enf_fail(error, ENF_BAD_INPUT,
                        "cell graph: piece %d has cells %d and %d of %d, corners %lld to %lld", (int)piece,
                        (int)back, (int)front, (int)graph->cell_count, (long long)begin, (long long)end);
    *wanted = back != front && end - begin >= 3;
    bool turned = (uint32_t)back > (uint32_t)front;
    *sorted = (sorted_piece){.cells = {(uint32_t)(turned ? front : back), (uint32_t)(turned ? back : front)},
                             .piece = piece,
                             .turned = turned,
                             .graph = graph};
    for (int64_t i = begin + 1; i < end; ++i)
        if (compare_points(graph->corners[i], graph->corners[begin + sorted->start]) < 0)
            sorted->start = (int32_t)(i - begin);
    return ENF_OK;
}

static enf_status sort_pieces(const enf_graph *graph, sorted_piece *sorted, int32_t *count,
                              int64_t *corner_count, enf_error *error) {
    *count = 0;
    *corner_count = 0;
    for (int32_t piece = 0; piece < graph->piece_count; ++piece) {
        bool wanted = false;
        enf_status status = prepare_piece(graph, piece, &sorted[*count], &wanted, error);
        if (status != ENF_OK) return status;
        if (wanted) *corner_count += corner_count_of(&sorted[(*count)++]);
    }
    if (*corner_count > INT32_MAX / 2)
        return enf_fail(error, ENF_NO_RESOURCES, "cell graph: more than %d corners; split the world",
                        INT32_MAX / 2);
    qsort(sorted, (size_t)*count, sizeof *sorted, compare_pieces);
    return ENF_OK;
}

static bool allocate(enf_surface *surface, size_t pieces, size_t corners, size_t cells) {
    surface->piece_cell = enf_array_new(pieces, sizeof *surface->piece_cell);
    surface->piece_open = enf_array_new(pieces, sizeof *surface->piece_open);
    surface->piece_gone = enf_array_zeroed(pieces, sizeof *surface->piece_gone);
    surface->piece_hidden = enf_array_zeroed(pieces, sizeof *surface->piece_hidden);
    surface->piece_area = enf_array_new(pieces, sizeof *surface->piece_area);
    surface->piece_edge = enf_array_zeroed(pieces + 1, sizeof *surface->piece_edge);
    surface->piece_edges = enf_array_new(corners, sizeof *surface->piece_edges);
    surface->sides = enf_array_new(2 * pieces, sizeof *surface->sides);
    surface->edges = enf_array_new(corners, sizeof *surface->edges);
    surface->vertices = enf_array_new(corners, sizeof *surface->vertices);
    surface->edge_sum = enf_array_zeroed(corners, sizeof *surface->edge_sum);
    surface->bodies = enf_array_new(cells, sizeof *surface->bodies);
    return surface->piece_cell && surface->piece_open && surface->piece_gone && surface->piece_hidden &&
           surface->piece_area && surface->piece_edge && surface->piece_edges && surface->sides &&
           surface->edges && surface->vertices && surface->edge_sum && surface->bodies;
}

/// Finds or adds a vertex in a table of vertex numbers (open addressing).
static int32_t vertex_at(enf_surface *surface, int32_t *table, size_t mask, const double corner[3]) {
    double point[3] = {corner[0] + 0.0, corner[1] + 0.0, corner[2] + 0.0}; // -0 becomes 0
    uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
        uint64_t bits;
        memcpy(&bits, &point[k], sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    for (size_t slot = hash & mask;; slot = (slot + 1) & mask) {
        if (table[slot] < 0) {
            table[slot] = surface->vertex_count;
            memcpy(surface->vertices[surface->vertex_count], point, sizeof point);
            return surface->vertex_count++;
        }
        if (memcmp(surface->vertices[table[slot]], point, sizeof point) == 0) return table[slot];
    }
}

static int32_t edge_at(enf_surface *surface, enf_pair_table *table, int32_t from, int32_t to) {
    int32_t *edge = enf_pair_table_at(table, from, to);
    if (*edge < 0) {
        *edge = surface->edge_count++;
        surface->edges[*edge][0] = from < to ? from : to;
        surface->edges[*edge][1] = from < to ? to : from;
    }
    return 2 * *edge + (from > to);
}

/// Area vector of the outline, from the cross products with its first corner.
static void measure_piece(enf_surface *surface, int32_t piece, const sorted_piece *sorted) {
    double sum[3] = {0, 0, 0};
    const double *origin = corner_of(sorted, 0);
    for (int32_t i = 1; i + 1 < corner_count_of(sorted); ++i) {
        const double *p = corner_of(sorted, i), *q = corner_of(sorted, i + 1);
        double a[3], b[3];
        for (int k = 0; k < 3; ++k) {
            a[k] = p[k] - origin[k];
            b[k] = q[k] - origin[k];
        }
        for (int k = 0; k < 3; ++k)
            sum[k] += a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
    enf_surface_side *sides = &surface->sides[2 * piece];
    for (int k = 0; k < 3; ++k) {
        sides[0].outward[k] = sum[k] / 2;
        sides[1].outward[k] = -sum[k] / 2;
    }
    surface->piece_area[piece] = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]) / 2;
}

static bool fill_pieces(enf_surface *surface, const sorted_piece *sorted, int32_t count, size_t corners) {
    size_t slots = 16;
    while (slots < 2 * corners) slots *= 2;
    int32_t *vertex_table = enf_array_new(slots, sizeof *vertex_table);
    enf_pair_table edge_table;
    if (!enf_pair_table_create(&edge_table, corners) || !vertex_table) {
        free(vertex_table);
        enf_pair_table_free(&edge_table);
        return false;
    }
    for (size_t i = 0; i < slots; ++i) vertex_table[i] = -1;
    int64_t at = 0;
    for (int32_t piece = 0; piece < count; ++piece) {
        const sorted_piece *from = &sorted[piece];
        surface->piece_cell[piece][0] = (int32_t)from->cells[0];
        surface->piece_cell[piece][1] = (int32_t)from->cells[1];
        surface->piece_open[piece] = from->graph->piece_open[from->piece] && (int32_t)from->cells[1] >= 0;
        measure_piece(surface, piece, from);
        int32_t corner_count = corner_count_of(from);
        int32_t first = vertex_at(surface, vertex_table, slots - 1, corner_of(from, 0)), last = first;
        for (int32_t i = 1; i <= corner_count; ++i) {
            int32_t next =
                i < corner_count ? vertex_at(surface, vertex_table, slots - 1, corner_of(from, i)) : first;
            if (next != last) surface->piece_edges[at++] = edge_at(surface, &edge_table, last, next);
            last = next;
        }
        surface->piece_edge[piece + 1] = at;
    }
    surface->piece_count = count;
    free(vertex_table);
    enf_pair_table_free(&edge_table);
    return true;
}

/// Adds a side to its fine cell's list, bounding box and (by the divergence theorem) volume.
static void add_side(enf_surface *surface, int32_t side, int32_t cell) {
    enf_body *body = &surface->bodies[cell];
    enf_surface_side *added = &surface->sides[side];
    added->next = -1;
    bool first = body->first_side < 0;
    if (first)
        body->first_side = side;
    else
        surface->sides[body->last_side].next = side;
    body->last_side = side;
    ++body->side_count;
    int32_t piece = side / 2;
    const double *point = NULL, *origin = NULL;
    for (int64_t i = surface->piece_edge[piece]; i < surface->piece_edge[piece + 1]; ++i)
        for (int end = 0; end < 2; ++end) {
            point = surface->vertices[surface->edges[surface->piece_edges[i] / 2][end]];
            for (int k = 0; k < 3; ++k) {
                body->low[k] = fmin(body->low[k], point[k]);
                body->high[k] = fmax(body->high[k], point[k]);
            }
        }
    int64_t origin_edge = surface->piece_edge[body->first_side / 2];
    if (origin_edge < surface->piece_edge[body->first_side / 2 + 1])
        origin = surface->vertices[surface->edges[surface->piece_edges[origin_edge] / 2][0]];
    if (!point || !origin) return;
    for (int k = 0; k < 3; ++k) body->volume += (point[k] - origin[k]) * added->outward[k] / 3;
}

static void fill_bodies(enf_surface *surface, int32_t cell_count) {
    surface->cell_count = cell_count;
    for (int32_t cell = 0; cell < cell_count; ++cell)
        surface->bodies[cell] = (enf_body){.first_side = -1,
                                           .last_side = -1,
                                           .fine_count = 1,
                                           .low = {INFINITY, INFINITY, INFINITY},
                                           .high = {-INFINITY, -INFINITY, -INFINITY}};
    for (int32_t piece = 0; piece < surface->piece_count; ++piece)
        for (int s = 0; s < 2; ++s)
            if (surface->piece_cell[piece][s] >= 0)
                add_side(surface, 2 * piece + s, surface->piece_cell[piece][s]);
}

enf_status enf_surface_create(enf_surface *surface, const enf_graph *graph, enf_error *error) {
    *surface = (enf_surface){0};
    sorted_piece *sorted = enf_array_new((size_t)graph->piece_count, sizeof *sorted);
    if (!sorted) return enf_fail_memory(error, "the pieces of the cell graph");
    int32_t count;
    int64_t corners;
    enf_status status = sort_pieces(graph, sorted, &count, &corners, error);
    if (status == ENF_OK && (!allocate(surface, (size_t)count, (size_t)corners, (size_t)graph->cell_count) ||
                             !fill_pieces(surface, sorted, count, (size_t)corners)))
        status = enf_fail_memory(error, "the surfaces of the cells");
    free(sorted);
    if (status == ENF_OK)
        fill_bodies(surface, graph->cell_count);
    else
        enf_surface_free(surface);
    return status;
}

void enf_surface_merge(enf_surface *surface, int32_t kept, int32_t gone) {
    enf_body *body = &surface->bodies[kept], *other = &surface->bodies[gone];
    if (body->first_side < 0)
        body->first_side = other->first_side;
    else
        surface->sides[body->last_side].next = other->first_side;
    if (other->last_side >= 0) body->last_side = other->last_side;
    body->side_count += other->side_count;
    body->fine_count += other->fine_count;
    body->volume += other->volume;
    for (int k = 0; k < 3; ++k) {
        body->low[k] = fmin(body->low[k], other->low[k]);
        body->high[k] = fmax(body->high[k], other->high[k]);
    }
    other->first_side = other->last_side = -1;
    other->side_count = 0;
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Walks over the sides of a cell, unlinks those of gone pieces, appends those that face the direction, and
/// returns half the sum of all projected areas.
static double collect_facing(enf_surface *surface, int32_t cell, const double direction[3],
                             size_t *facing_count) {
    enf_body *body = &surface->bodies[cell];
    double sum = 0;
    int32_t last = -1;
    for (int32_t side = body->first_side, next; side >= 0; side = next) {
        next = surface->sides[side].next;
        if (surface->piece_gone[side / 2]) {
            if (last < 0)
                body->first_side = next;
            else
                surface->sides[last].next = next;
            --body->side_count;
            continue;
        }
        last = side;
        if (surface->piece_hidden[side / 2]) continue;
        double projected = dot(surface->sides[side].outward, direction);
        sum += fabs(projected);
        if (projected > 0) surface->facing[(*facing_count)++] = side;
    }
    body->last_side = last;
    return sum / 2;
}

bool enf_surface_hide(enf_surface *surface, int32_t piece) {
    if (!enf_array_reserve(surface->hidden, surface->hidden_capacity, surface->hidden_count + 1))
        return false;
    surface->hidden[surface->hidden_count++] = piece;
    surface->piece_hidden[piece] = true;
    return true;
}

static void show_pieces(enf_surface *surface, size_t from) {
    while (surface->hidden_count > from)
        surface->piece_hidden[surface->hidden[--surface->hidden_count]] = false;
}

bool enf_surface_plug(enf_surface *surface, int32_t neighbour, const double direction[3],
                      size_t hidden_before) {
    bool towards = false, away = false;
    for (int32_t side = surface->bodies[neighbour].first_side; side >= 0; side = surface->sides[side].next) {
        if (surface->piece_gone[side / 2] || surface->piece_hidden[side / 2]) continue;
        double projected = dot(surface->sides[side].outward, direction);
        towards = towards || projected > 0;
        away = away || projected < 0;
    }
    if (towards && away) {
        show_pieces(surface, hidden_before);
        return true;
    }
    if (!enf_array_reserve(surface->plugs, surface->plug_capacity, surface->plug_count + 1)) return false;
    surface->plugs[surface->plug_count++] = neighbour;
    return true;
}

/// Collects the facing sides of the cell and its plugs.
static bool collect_all(enf_surface *surface, int32_t cell, const double direction[3], size_t *facing_count,
                        double *bound) {
    size_t sides = (size_t)surface->bodies[cell].side_count;
    for (size_t i = 0; i < surface->plug_count; ++i)
        sides += (size_t)surface->bodies[surface->plugs[i]].side_count;
    *facing_count = 0;
    *bound = 0;
    bool fine = enf_array_reserve(surface->facing, surface->facing_capacity, sides);
    if (fine) *bound = collect_facing(surface, cell, direction, facing_count);
    for (size_t i = 0; fine && i < surface->plug_count; ++i)
        *bound += collect_facing(surface, surface->plugs[i], direction, facing_count);
    show_pieces(surface, 0);
    surface->plug_count = 0;
    return fine;
}

/// Two unit vectors that span the plane across the direction; axis directions give axis vectors.
static void span_plane(const double direction[3], double u[3], double v[3]) {
    int smallest = 0;
    for (int k = 1; k < 3; ++k)
        if (fabs(direction[k]) < fabs(direction[smallest])) smallest = k;
    int a = (smallest + 1) % 3, b = (smallest + 2) % 3;
    double length = hypot(direction[a], direction[b]);
    u[smallest] = 0;
    u[a] = -direction[b] / length;
    u[b] = direction[a] / length;
    for (int k = 0; k < 3; ++k)
        v[k] = direction[(k + 1) % 3] * u[(k + 2) % 3] - direction[(k + 2) % 3] * u[(k + 1) % 3];
}

/// Sums up how often the facing pieces run each edge.
static bool sum_edges(enf_surface *surface, size_t facing_count, size_t *touched_count) {
    size_t count = 0;
    for (size_t i = 0; i < facing_count; ++i) {
        int32_t side = surface->facing[i], piece = side / 2;
        int64_t begin = surface->piece_edge[piece], end = surface->piece_edge[piece + 1];
        if (!enf_array_reserve(surface->touched, surface->touched_capacity, count + (size_t)(end - begin))) {
            for (size_t k = 0; k < count; ++k) surface->edge_sum[surface->touched[k]] = 0;
            return false;
        }
        for (int64_t k = begin; k < end; ++k) {
            int32_t edge = surface->piece_edges[k] / 2;
            bool backwards = (surface->piece_edges[k] & 1) != (side & 1);
            surface->edge_sum[edge] += backwards ? -1 : 1;
            surface->touched[count++] = edge;
        }
    }
    *touched_count = count;
    return true;
}

/// Hands the edges that don't cancel to the sweep.
static bool add_contour(enf_surface *surface, size_t touched_count, const double direction[3]) {
    double u[3], v[3];
    span_plane(direction, u, v);
    enf_silhouette_clear(&surface->silhouette);
    bool fine = true;
    for (size_t i = 0; i < touched_count; ++i) {
        int32_t edge = surface->touched[i], times = surface->edge_sum[edge];
        if (times == 0) continue;
        surface->edge_sum[edge] = 0;
        const double *a = surface->vertices[surface->edges[edge][0]],
                     *b = surface->vertices[surface->edges[edge][1]];
        double from[2] = {dot(a, u), dot(a, v)}, to[2] = {dot(b, u), dot(b, v)};
        fine = fine && enf_silhouette_add(&surface->silhouette, from, to, times);
    }
    return fine;
}

double enf_surface_silhouette(enf_surface *surface, int32_t cell, const double direction[3], double enough) {
    const enf_body *body = &surface->bodies[cell];
    size_t facing_count, touched_count;
    double bound;
    if (!collect_all(surface, cell, direction, &facing_count, &bound)) return -1;
    if (bound <= enough || body->fine_count == 1) return bound;
    double area = 0;
    if (!sum_edges(surface, facing_count, &touched_count) ||
        !add_contour(surface, touched_count, direction) || !enf_silhouette_area(&surface->silhouette, &area))
        return -1;
    return area > 0 ? area : 0;
}

double enf_surface_silhouette_bound(const enf_surface *surface, int32_t cell, const double direction[3]) {
    const enf_body *body = &surface->bodies[cell];
    double extent = 0;
    for (int k = 0; k < 3; ++k) extent += fabs(direction[k]) * (body->high[k] - body->low[k]);
    return extent > 0 && body->volume > 0 ? body->volume / extent * (1 - 0x1p-20) : 0;
}

bool enf_surface_is_lid(const enf_surface *surface, int32_t cell) {
    const enf_surface_side *sides = surface->sides, *only = NULL;
    for (int32_t side = surface->bodies[cell].first_side, seen = 0; side >= 0; side = sides[side].next) {
        if (++seen > 32) return false;
        if (surface->piece_gone[side / 2]) continue;
        if (only) return false;
        only = &sides[side];
    }
    return true;
}
