// SPDX-License-Identifier: GPL-3.0-or-later
// The surfaces of the cells while they merge, and their silhouettes.
#include "build/surface.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Only the time depends on this: sides of a body that is looked at as a lid.
enum { MOST_LID_SIDES = 32 };

void enf_surface_free(enf_surface *surface) {
    for (int32_t cell = 0; cell < surface->cell_count; ++cell)
        if (surface->bodies[cell].side_capacity > 0) free(surface->bodies[cell].sides);
    free(surface->fine_sides);
    free(surface->piece_cell);
    free(surface->piece_open);
    free(surface->pieces);
    free(surface->corners);
    free(surface->vertices);
    free(surface->bodies);
    free(surface->moments);
    free(surface->moments_free);
    free(surface->facing);
    free(surface->piece_hidden);
    free(surface->hidden);
    free(surface->plugs);
    enf_contour_free(&surface->contour);
    enf_silhouette_free(&surface->silhouette);
    *surface = (enf_surface){0};
}

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

static double length_of(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

void enf_surface_forget_cells(enf_surface *surface) {
    free(surface->piece_cell);
    free(surface->piece_open);
    surface->piece_cell = NULL;
    surface->piece_open = NULL;
}

double enf_surface_piece_area(const enf_surface *surface, int32_t piece) {
    return length_of(surface->pieces[piece].area);
}

void enf_surface_drop(enf_surface *surface, int32_t piece) {
    surface->pieces[piece].area[0] = NAN;
}

static bool is_gone(const enf_surface_piece *piece) {
    return piece->area[0] != piece->area[0];
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

/// The moments of a fine cell: cones from a corner over triangles of its sides.
static enf_moments measure_fine(const enf_surface *surface, const enf_body *body) {
    enf_moments sums = {0};
    const double *origin = NULL, *corners[3];
    for (int32_t s = 0; s < body->side_count; ++s) {
        int32_t side = body->sides[s];
        const enf_surface_piece *piece = &surface->pieces[side / 2];
        const int32_t *outline = surface->corners + piece->first_corner;
        if (!origin && piece->corner_count > 0) origin = surface->vertices[outline[0]];
        for (int32_t i = 1; i + 1 < piece->corner_count; ++i) {
            corners[0] = surface->vertices[outline[0]];
            corners[1] = surface->vertices[outline[i]];
            corners[2] = surface->vertices[outline[i + 1]];
            enf_moments_add_cone(&sums, origin, corners, side & 1 ? -1 : 1);
        }
    }
    if (origin) enf_moments_finish(&sums, origin);
    return sums;
}

/// The moments of a body: where they are kept, or those of a fine cell in `fine`.
static enf_moments *moments_of(enf_surface *surface, const enf_body *body, enf_moments *fine) {
    if (body->moments >= 0) return &surface->moments[body->moments];
    *fine = measure_fine(surface, body);
    return fine;
}

/// Adds the moments of `other` to those of the body. They take a place that one of the two has, or a free
/// one.
static void merge_moments(enf_surface *surface, enf_body *body, enf_body *other) {
    enf_moments fine[2], *moments = moments_of(surface, body, &fine[0]);
    enf_moments_join(moments, moments_of(surface, other, &fine[1]));
    if (body->moments >= 0 && other->moments >= 0)
        surface->moments_free[surface->moments_free_count++] = other->moments;
    else if (body->moments < 0 && other->moments >= 0)
        body->moments = other->moments;
    else if (body->moments < 0)
        body->moments = surface->moments_free_count > 0 ? surface->moments_free[--surface->moments_free_count]
                                                        : surface->moments_count++;
    surface->moments[body->moments] = *moments;
    other->moments = -1;
}

static void free_sides(enf_body *body) {
    if (body->side_capacity > 0) free(body->sides);
    body->sides = NULL;
    body->side_count = 0;
    body->side_capacity = 0;
}

/// Moves the sides of `other` to those of the body: the fewer to the more, so a side moves only log n times.
static bool merge_sides(enf_body *body, enf_body *other) {
    enf_body *more = body->side_count >= other->side_count ? body : other,
             *fewer = more == body ? other : body;
    size_t capacity = (size_t)more->side_capacity, count = (size_t)more->side_count;
    size_t wanted = count + (size_t)fewer->side_count;
    if (wanted == 0) return true;
    int32_t *sides = capacity > 0 ? more->sides : NULL;
    if (!enf_array_reserve(sides, capacity, wanted)) return false;
    if (more->side_capacity == 0) memcpy(sides, more->sides, count * sizeof *sides);
    memcpy(sides + count, fewer->sides, (size_t)fewer->side_count * sizeof *sides);
    free_sides(fewer);
    more->side_capacity = 0; // its array has moved to `sides`
    free_sides(other);
    body->sides = sides;
    body->side_count = (int32_t)wanted;
    body->side_capacity = (int32_t)capacity;
    return true;
}

bool enf_surface_merge(enf_surface *surface, int32_t kept, int32_t gone) {
    enf_body *body = &surface->bodies[kept], *other = &surface->bodies[gone];
    merge_moments(surface, body, other);
    if (!merge_sides(body, other)) return false;
    body->fine_count += other->fine_count;
    body->volume += other->volume;
    for (int k = 0; k < 3; ++k) {
        if (other->low[k] < body->low[k]) body->low[k] = other->low[k];
        if (other->high[k] > body->high[k]) body->high[k] = other->high[k];
    }
    return true;
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Walks over the sides of a cell, takes out those of gone pieces, appends those that face the direction, and
/// returns half the sum of all projected areas.
static double collect_facing(enf_surface *surface, int32_t cell, const double direction[3],
                             size_t *facing_count) {
    enf_body *body = &surface->bodies[cell];
    bool hiding = surface->hidden_count > 0;
    double sum = 0;
    int32_t kept = 0;
    for (int32_t i = 0; i < body->side_count; ++i) {
        int32_t side = body->sides[i];
        const enf_surface_piece *piece = &surface->pieces[side / 2];
        if (is_gone(piece)) continue;
        body->sides[kept++] = side;
        if (hiding && surface->piece_hidden[side / 2]) continue;
        double projected = dot(piece->area, direction);
        sum += fabs(projected);
        if (side & 1 ? projected < 0 : projected > 0) surface->facing[(*facing_count)++] = side;
    }
    body->side_count = kept;
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
    const enf_body *body = &surface->bodies[neighbour];
    for (int32_t i = 0; i < body->side_count; ++i) {
        int32_t side = body->sides[i];
        if (is_gone(&surface->pieces[side / 2]) || surface->piece_hidden[side / 2]) continue;
        double projected = dot(surface->pieces[side / 2].area, direction);
        if (side & 1) projected = -projected;
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

/// Runs the outlines of the facing sides.
static bool find_contour(enf_surface *surface, size_t facing_count) {
    size_t corners = 0;
    for (size_t i = 0; i < facing_count; ++i)
        corners += (size_t)surface->pieces[surface->facing[i] / 2].corner_count;
    if (!enf_contour_start(&surface->contour, corners)) return false;
    for (size_t i = 0; i < facing_count; ++i) {
        const enf_surface_piece *piece = &surface->pieces[surface->facing[i] / 2];
        const int32_t *outline = surface->corners + piece->first_corner;
        int32_t times = surface->facing[i] & 1 ? -1 : 1;
        for (int32_t k = 0, last = piece->corner_count - 1; k < piece->corner_count; last = k++)
            enf_contour_run(&surface->contour, outline[last], outline[k], times);
    }
    return true;
}

/// Hands the edges that don't cancel to the sweep.
static bool add_contour(enf_surface *surface, const double direction[3]) {
    const enf_contour *contour = &surface->contour;
    double u[3], v[3];
    span_plane(direction, u, v);
    enf_silhouette_clear(&surface->silhouette);
    for (size_t i = 0; i < contour->filled_count; ++i) {
        const enf_contour_slot *edge = &contour->slots[contour->filled[i]];
        if (edge->times == 0) continue;
        const double *a = surface->vertices[edge->from], *b = surface->vertices[edge->to];
        double from[2] = {dot(a, u), dot(a, v)}, to[2] = {dot(b, u), dot(b, v)};
        if (!enf_silhouette_add(&surface->silhouette, from, to, edge->times)) return false;
    }
    return true;
}

double enf_surface_silhouette(enf_surface *surface, int32_t cell, const double direction[3], double enough) {
    const enf_body *body = &surface->bodies[cell];
    size_t facing_count;
    double bound, area = 0;
    if (!collect_all(surface, cell, direction, &facing_count, &bound)) return -1;
    if (bound <= enough || body->fine_count == 1) return bound;
    if (!find_contour(surface, facing_count) || !add_contour(surface, direction) ||
        !enf_silhouette_area(&surface->silhouette, &area))
        return -1;
    return area > 0 ? area : 0;
}

/// What bounds give way by for rounding.
#define BOUND_SLACK 0x1p-20

double enf_surface_silhouette_bound(const enf_surface *surface, int32_t cell, const double direction[3]) {
    const enf_body *body = &surface->bodies[cell];
    double longest = INFINITY;
    for (int k = 0; k < 3; ++k) {
        double way = ((double)body->high[k] - (double)body->low[k]) / fabs(direction[k]);
        if (way < longest) longest = way; // NaN: nothing along a flat side
    }
    double bound = longest > 0 && longest < INFINITY && body->volume > 0
                       ? body->volume / longest * (1 - BOUND_SLACK)
                       : 0;
    if (body->moments < 0) return bound;
    double other = enf_moments_silhouette_bound(&surface->moments[body->moments], direction);
    return other > bound ? other : bound;
}

double enf_surface_box_silhouette(const enf_surface *surface, int32_t cell, const double direction[3]) {
    const enf_body *body = &surface->bodies[cell];
    double size[3], area = 0;
    for (int k = 0; k < 3; ++k) size[k] = (double)body->high[k] - (double)body->low[k];
    for (int k = 0; k < 3; ++k) area += fabs(direction[k]) * size[(k + 1) % 3] * size[(k + 2) % 3];
    return area * (1 + BOUND_SLACK);
}

bool enf_surface_is_lid(const enf_surface *surface, int32_t cell) {
    const enf_body *body = &surface->bodies[cell];
    int remaining = 0;
    if (body->side_count > MOST_LID_SIDES) return false;
    for (int32_t i = 0; i < body->side_count && remaining <= 1; ++i)
        remaining += !is_gone(&surface->pieces[body->sides[i] / 2]);
    return remaining <= 1;
}
