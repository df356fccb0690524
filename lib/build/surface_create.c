// SPDX-License-Identifier: GPL-3.0-or-later
// The surfaces of the fine cells, from the graph: pieces in canonical order, corners by number, bodies.
#include "base/array.h"
#include "build/surface.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// A piece of the graph on its way into canonical order.
typedef struct sorted_piece {
    uint32_t beyond; ///< the larger of its cells; -1 becomes the largest number
    int32_t piece;
    int32_t start; ///< its smallest corner, where the outline begins
    bool turned;   ///< the outline is to be run backwards, because the cells were swapped
} sorted_piece;

/// All of them, in lists by the smaller cell.
typedef struct sorted_pieces {
    const enf_graph *graph;
    sorted_piece *pieces;
    int32_t *first; ///< per cell and one more: where its list begins
    int64_t corner_count;
} sorted_pieces;

/// The vertex of the graph at a corner.
static int32_t corner_of(const enf_graph *graph, const sorted_piece *sorted, int32_t i) {
    int64_t begin = graph->piece_corner[sorted->piece], end = graph->piece_corner[sorted->piece + 1];
    int64_t count = end - begin,
            at = sorted->turned ? sorted->start - (int64_t)i : sorted->start + (int64_t)i;
    if (at < 0) at += count;
    return graph->corners[begin + (at < count ? at : at - count)];
}

/// Its place in graph units.
static void take_corner(const enf_graph *graph, const sorted_piece *sorted, int32_t i, double corner[3]) {
    const double *at = graph->vertices[corner_of(graph, sorted, i)];
    for (int k = 0; k < 3; ++k) corner[k] = at[k] * graph->scale;
}

static int32_t corner_count_of(const enf_graph *graph, int32_t piece) {
    return (int32_t)(graph->piece_corner[piece + 1] - graph->piece_corner[piece]);
}

static int compare_points(const double a[3], const double b[3]) {
    for (int k = 0; k < 3; ++k)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

/// The order of pieces with the same smaller cell.
static bool comes_before(const enf_graph *graph, const sorted_piece *a, const sorted_piece *b) {
    if (a->beyond != b->beyond) return a->beyond < b->beyond;
    bool open_a = graph->piece_open[a->piece], open_b = graph->piece_open[b->piece];
    if (open_a != open_b) return open_a;
    int32_t count_a = corner_count_of(graph, a->piece), count_b = corner_count_of(graph, b->piece);
    for (int32_t i = 0; i < count_a && i < count_b; ++i) {
        int order =
            compare_points(graph->vertices[corner_of(graph, a, i)], graph->vertices[corner_of(graph, b, i)]);
        if (order) return order < 0;
    }
    return count_a < count_b;
}

/// A heap sort: the lists are short, but one cell may have any number of pieces. Pieces that compare equal
/// are equal to the last bit, so their order does not matter.
static void sort_list(const enf_graph *graph, sorted_piece *list, int32_t count) {
    for (int32_t built = count / 2, end = count; end > 1;) {
        sorted_piece moved;
        if (built > 0) {
            moved = list[--built];
        } else {
            moved = list[--end];
            list[end] = list[0];
        }
        int64_t place = built, child;
        while ((child = 2 * place + 1) < end) {
            if (child + 1 < end && comes_before(graph, &list[child], &list[child + 1])) ++child;
            if (!comes_before(graph, &moved, &list[child])) break;
            list[place] = list[child];
            place = child;
        }
        list[place] = moved;
    }
}

static enf_status check_piece(const enf_graph *graph, int32_t piece, enf_error *error) {
    int32_t back = graph->piece_cell[piece][0], front = graph->piece_cell[piece][1];
    int64_t begin = graph->piece_corner[piece], end = graph->piece_corner[piece + 1];
    if (back >= -1 && back < graph->cell_count && front >= -1 && front < graph->cell_count && begin >= 0 &&
        end >= begin && end - begin <= INT32_MAX)
        return ENF_OK;
    return enf_fail(error, ENF_BAD_INPUT,
                    "cell graph: piece %d has cells %d and %d of %d, corners %lld to %lld", (int)piece,
                    (int)back, (int)front, (int)graph->cell_count, (long long)begin, (long long)end);
}

/// The smaller cell of a piece that bounds anything (-1 counts as the largest number), or -1.
static int32_t lower_cell(const enf_graph *graph, int32_t piece) {
    int32_t back = graph->piece_cell[piece][0], front = graph->piece_cell[piece][1];
    if (back == front || corner_count_of(graph, piece) < 3) return -1;
    return (uint32_t)back < (uint32_t)front ? back : front;
}

static void fill_list(const sorted_pieces *sorted, int32_t piece, int32_t *place) {
    const enf_graph *graph = sorted->graph;
    int32_t cell = lower_cell(graph, piece);
    if (cell < 0) return;
    int64_t begin = graph->piece_corner[piece], end = graph->piece_corner[piece + 1];
    bool turned = graph->piece_cell[piece][0] != cell;
    sorted_piece *added = &sorted->pieces[place[cell]++];
    *added = (sorted_piece){
        .beyond = (uint32_t)graph->piece_cell[piece][!turned], .piece = piece, .turned = turned};
    for (int64_t i = begin + 1; i < end; ++i)
        if (compare_points(graph->vertices[graph->corners[i]],
                           graph->vertices[graph->corners[begin + added->start]]) < 0)
            added->start = (int32_t)(i - begin);
}

static void free_sorted(sorted_pieces *sorted) {
    free(sorted->pieces);
    free(sorted->first);
}

/// Count, prefix sum, fill; then each cell's list by itself.
static enf_status sort_pieces(sorted_pieces *sorted, const enf_graph *graph, enf_error *error) {
    size_t cells = (size_t)graph->cell_count;
    *sorted = (sorted_pieces){.graph = graph};
    sorted->first = enf_array_zeroed(cells + 2, sizeof *sorted->first);
    if (!sorted->first) return enf_fail_memory(error, "the pieces of the cell graph");
    int32_t *place = sorted->first + 1; // shifted by one while filling
    for (int32_t piece = 0; piece < graph->piece_count; ++piece) {
        enf_status status = check_piece(graph, piece, error);
        if (status != ENF_OK) return status;
        int32_t cell = lower_cell(graph, piece);
        if (cell < 0) continue;
        ++place[cell + 1];
        sorted->corner_count += corner_count_of(graph, piece);
    }
    if (sorted->corner_count > INT32_MAX / 2)
        return enf_fail(error, ENF_NO_RESOURCES, "cell graph: more than %d corners; split the world",
                        INT32_MAX / 2);
    for (size_t i = 0; i < cells; ++i) place[i + 1] += place[i];
    sorted->pieces = enf_array_new((size_t)place[cells], sizeof *sorted->pieces);
    if (!sorted->pieces) return enf_fail_memory(error, "the pieces of the cell graph");
    for (int32_t piece = 0; piece < graph->piece_count; ++piece) fill_list(sorted, piece, place);
    for (size_t i = 0; i < cells; ++i)
        sort_list(graph, sorted->pieces + sorted->first[i], sorted->first[i + 1] - sorted->first[i]);
    return ENF_OK;
}

static bool allocate(enf_surface *surface, size_t pieces, size_t corners, size_t cells) {
    surface->piece_cell = enf_array_new(pieces, sizeof *surface->piece_cell);
    surface->piece_open = enf_array_new(pieces, sizeof *surface->piece_open);
    surface->piece_hidden = enf_array_zeroed(pieces, sizeof *surface->piece_hidden);
    surface->pieces = enf_array_new(pieces, sizeof *surface->pieces);
    surface->corners = enf_array_new(corners, sizeof *surface->corners);
    surface->bodies = enf_array_new(cells, sizeof *surface->bodies);
    surface->fine_sides = enf_array_new(2 * pieces, sizeof *surface->fine_sides);
    // A body with moments has two fine cells or more.
    surface->moments = enf_array_new(cells / 2, sizeof *surface->moments);
    surface->moments_free = enf_array_new(cells / 2, sizeof *surface->moments_free);
    return surface->piece_cell && surface->piece_open && surface->piece_hidden && surface->pieces &&
           surface->corners && surface->bodies && surface->fine_sides && surface->moments &&
           surface->moments_free;
}

/// Vertices by their coordinates: open addressing, at most half full, -1 is free.
typedef struct vertex_table {
    int32_t *slots;
    size_t mask;
    int32_t *number_of; ///< for each vertex of the graph its number here, or -1: not looked up yet
} vertex_table;

/// Where the point is, or would be.
static size_t slot_of(const enf_surface *surface, const vertex_table *table, const double point[3]) {
    uint64_t hash = 0;
    for (int k = 0; k < 3; ++k) {
        uint64_t bits;
        memcpy(&bits, &point[k], sizeof bits);
        hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
        hash ^= hash >> 32;
    }
    size_t slot = hash & table->mask;
    while (table->slots[slot] >= 0 &&
           memcmp(surface->vertices[table->slots[slot]], point, 3 * sizeof *point) != 0)
        slot = (slot + 1) & table->mask;
    return slot;
}

static bool grow_table(const enf_surface *surface, vertex_table *table) {
    size_t slots = table->slots ? 2 * (table->mask + 1) : 1024;
    int32_t *grown = enf_array_new(slots, sizeof *grown);
    if (!grown) return false;
    for (size_t i = 0; i < slots; ++i) grown[i] = -1;
    free(table->slots);
    table->slots = grown;
    table->mask = slots - 1;
    for (int32_t v = 0; v < surface->vertex_count; ++v)
        table->slots[slot_of(surface, table, surface->vertices[v])] = v;
    return true;
}

static bool create_table(vertex_table *table, const enf_graph *graph) {
    int32_t highest = -1;
    int64_t corners = graph->piece_count > 0 ? graph->piece_corner[graph->piece_count] : 0;
    for (int64_t i = 0; i < corners; ++i)
        if (graph->corners[i] > highest) highest = graph->corners[i];
    *table = (vertex_table){.number_of = enf_array_new((size_t)highest + 1, sizeof *table->number_of)};
    for (int32_t v = 0; table->number_of && v <= highest; ++v) table->number_of[v] = -1;
    return table->number_of != NULL;
}

/// Finds or adds a vertex of the graph. Negative without memory.
static int32_t find_vertex(enf_surface *surface, vertex_table *table, const enf_graph *graph,
                           int32_t number) {
    double point[3];
    for (int k = 0; k < 3; ++k) point[k] = graph->vertices[number][k] * graph->scale + 0.0; // -0 becomes 0
    if (2 * (size_t)surface->vertex_count >= table->mask && !grow_table(surface, table)) return -1;
    size_t slot = slot_of(surface, table, point);
    if (table->slots[slot] >= 0) return table->slots[slot];
    if (!enf_array_reserve(surface->vertices, surface->vertex_capacity, (size_t)surface->vertex_count + 1))
        return -1;
    memcpy(surface->vertices[surface->vertex_count], point, sizeof point);
    return table->slots[slot] = surface->vertex_count++;
}

/// The number here of a corner. Negative without memory.
static int32_t vertex_at(enf_surface *surface, vertex_table *table, const enf_graph *graph,
                         const sorted_piece *sorted, int32_t corner) {
    int32_t vertex = corner_of(graph, sorted, corner), *number = &table->number_of[vertex];
    if (*number < 0) *number = find_vertex(surface, table, graph, vertex);
    return *number;
}

/// Area vector of the outline, from the cross products with its first corner.
static void measure_piece(const enf_graph *graph, const sorted_piece *sorted, double area[3]) {
    double sum[3] = {0, 0, 0}, origin[3];
    take_corner(graph, sorted, 0, origin);
    for (int32_t i = 1; i + 1 < corner_count_of(graph, sorted->piece); ++i) {
        double a[3], b[3];
        take_corner(graph, sorted, i, a);
        take_corner(graph, sorted, i + 1, b);
        for (int k = 0; k < 3; ++k) {
            a[k] -= origin[k];
            b[k] -= origin[k];
        }
        for (int k = 0; k < 3; ++k)
            sum[k] += a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    }
    for (int k = 0; k < 3; ++k) area[k] = sum[k] / 2;
}

/// Appends the outline of one piece; neighbouring corners with the same coordinates are one.
static bool add_outline(enf_surface *surface, const enf_graph *graph, const sorted_piece *from,
                        vertex_table *vertices, enf_surface_piece *piece) {
    int32_t *corners = surface->corners + piece->first_corner, count = 0;
    for (int32_t i = 0; i < corner_count_of(graph, from->piece); ++i) {
        int32_t vertex = vertex_at(surface, vertices, graph, from, i);
        if (vertex < 0) return false;
        if (count == 0 || corners[count - 1] != vertex) corners[count++] = vertex;
    }
    while (count > 0 && corners[count - 1] == corners[0]) --count;
    piece->corner_count = count;
    return true;
}

static bool fill_pieces(enf_surface *surface, const sorted_pieces *sorted) {
    const enf_graph *graph = sorted->graph;
    vertex_table vertices;
    bool good = create_table(&vertices, graph);
    int32_t at = 0, piece = 0;
    for (int32_t cell = 0; cell < graph->cell_count; ++cell) {
        for (; good && piece < sorted->first[cell + 1]; ++piece) {
            const sorted_piece *from = &sorted->pieces[piece];
            enf_surface_piece *filled = &surface->pieces[piece];
            surface->piece_cell[piece][0] = cell;
            surface->piece_cell[piece][1] = (int32_t)from->beyond;
            surface->piece_open[piece] = graph->piece_open[from->piece] && (int32_t)from->beyond >= 0;
            measure_piece(graph, from, filled->area);
            filled->first_corner = at;
            good = add_outline(surface, graph, from, &vertices, filled);
            at += filled->corner_count;
        }
    }
    surface->piece_count = piece;
    free(vertices.slots);
    free(vertices.number_of);
    return good;
}

static float round_down(double value) {
    float rounded = (float)value;
    return (double)rounded > value ? nextafterf(rounded, -INFINITY) : rounded;
}

/// Extends the bounding box; a coordinate that is no number extends nothing.
static void include_point(enf_body *body, const double point[3]) {
    for (int k = 0; k < 3; ++k) {
        if (point[k] < (double)body->low[k]) body->low[k] = round_down(point[k]);
        if (point[k] > (double)body->high[k]) body->high[k] = -round_down(-point[k]);
    }
}

/// A corner of the piece, or null when it has none left.
static const double *first_corner_of(const enf_surface *surface, int32_t piece) {
    const enf_surface_piece *at = &surface->pieces[piece];
    return at->corner_count > 0 ? surface->vertices[surface->corners[at->first_corner]] : NULL;
}

/// Adds a side to its fine cell's list, bounding box and (by the divergence theorem) volume.
static void add_side(enf_surface *surface, int32_t side, int32_t cell) {
    enf_body *body = &surface->bodies[cell];
    enf_surface_piece *piece = &surface->pieces[side / 2];
    body->sides[body->side_count++] = side;
    for (int32_t i = 0; i < piece->corner_count; ++i)
        include_point(body, surface->vertices[surface->corners[piece->first_corner + i]]);
    const double *point = first_corner_of(surface, side / 2);
    const double *origin = first_corner_of(surface, body->sides[0] / 2);
    if (!point || !origin) return;
    for (int k = 0; k < 3; ++k) {
        double outward = piece->area[k];
        body->volume += (point[k] - origin[k]) * (side & 1 ? -outward : outward) / 3;
    }
}

/// Gives each fine cell its part of one array of sides.
static void fill_bodies(enf_surface *surface, int32_t cell_count) {
    surface->cell_count = cell_count;
    for (int32_t cell = 0; cell < cell_count; ++cell)
        surface->bodies[cell] = (enf_body){.fine_count = 1,
                                           .moments = -1,
                                           .low = {INFINITY, INFINITY, INFINITY},
                                           .high = {-INFINITY, -INFINITY, -INFINITY}};
    for (int32_t piece = 0; piece < surface->piece_count; ++piece)
        for (int s = 0; s < 2; ++s)
            if (surface->piece_cell[piece][s] >= 0)
                ++surface->bodies[surface->piece_cell[piece][s]].side_count;
    int32_t *sides = surface->fine_sides;
    for (int32_t cell = 0; cell < cell_count; ++cell) {
        enf_body *body = &surface->bodies[cell];
        body->sides = sides;
        sides += body->side_count;
        body->side_count = 0;
    }
    for (int32_t piece = 0; piece < surface->piece_count; ++piece)
        for (int s = 0; s < 2; ++s)
            if (surface->piece_cell[piece][s] >= 0)
                add_side(surface, 2 * piece + s, surface->piece_cell[piece][s]);
}

enf_status enf_surface_create(enf_surface *surface, const enf_graph *graph, enf_error *error) {
    *surface = (enf_surface){0};
    sorted_pieces sorted;
    enf_status status = sort_pieces(&sorted, graph, error);
    if (status == ENF_OK && (!allocate(surface, (size_t)sorted.first[graph->cell_count],
                                       (size_t)sorted.corner_count, (size_t)graph->cell_count) ||
                             !fill_pieces(surface, &sorted)))
        status = enf_fail_memory(error, "the surfaces of the cells");
    free_sorted(&sorted);
    if (status == ENF_OK)
        fill_bodies(surface, graph->cell_count);
    else
        enf_surface_free(surface);
    return status;
}
