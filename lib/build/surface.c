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
