// SPDX-License-Identifier: GPL-3.0-or-later
// Corners that lie outside are added to the window one by one, in the coordinate plane that the opening is
// seen best from: the edges that a corner lies outside of give way to it. Most windows that meet share most
// of their corners. Where these edges are not in one run, as the window has next to no area, the hull is made
// anew: A. M. Andrew, "Another efficient algorithm for convex hulls in two dimensions" (1979).
#include "visibility/hull.h"

#include "base/four.h"

#include <math.h>
#include <string.h>

// ---------------------------------------------------------------------------------------------- anew

typedef struct point {
    double at[3];
} point;

/// Twice the area of a, b, c; positive if they turn counter-clockwise.
static double turn(const point *a, const point *b, const point *c, const int32_t axes[2]) {
    const int u = axes[0], v = axes[1];
    return (b->at[u] - a->at[u]) * (c->at[v] - a->at[v]) - (b->at[v] - a->at[v]) * (c->at[u] - a->at[u]);
}

static bool is_before(const point *a, const point *b, const int32_t axes[2]) {
    const int u = axes[0], v = axes[1];
    return a->at[u] < b->at[u] || (a->at[u] == b->at[u] && a->at[v] < b->at[v]);
}

static int32_t sort_corners(const enf_outline *outline, const int32_t axes[2], point *sorted, int32_t count) {
    for (int32_t i = 0; i < outline->count; i++) {
        int32_t at = count++;
        point corner;
        enf_outline_corner(outline, i, corner.at);
        for (; at > 0 && is_before(&corner, &sorted[at - 1], axes); at--) sorted[at] = sorted[at - 1];
        sorted[at] = corner;
    }
    return count;
}

/// Adds the next corner of a chain that began at `start`.
static int32_t add_corner(const point **chain, int32_t made, int32_t start, const point *next,
                          const int32_t axes[2]) {
    while (made >= start + 2 && turn(chain[made - 2], chain[made - 1], next, axes) <= 0) made--;
    chain[made] = next;
    return made + 1;
}

static void make_anew(enf_window *window, const enf_outline *other, const int32_t axes[2]) {
    point sorted[2 * ENF_WINDOW_MOST];
    const point *chain[2 * ENF_WINDOW_MOST + 2];
    const enf_outline own = enf_window_outline(window);
    int32_t count = sort_corners(&own, axes, sorted, 0), made = 0;
    count = sort_corners(other, axes, sorted, count);
    for (int32_t i = 0; i < count; i++) made = add_corner(chain, made, 0, &sorted[i], axes);
    const int32_t start = --made; // the last one begins the way back
    for (int32_t i = count - 1; i >= 0; i--) made = add_corner(chain, made, start, &sorted[i], axes);
    made--;
    if (made > ENF_WINDOW_MOST) made = ENF_WINDOW_MOST; // callers keep far fewer
    double hull[ENF_WINDOW_MOST][3];
    for (int32_t i = 0; i < made; i++) memcpy(hull[i], chain[i]->at, sizeof *hull);
    enf_window_copy(window, (const double(*)[3])hull, made);
}

// ---------------------------------------------------------------------------------------------- one by one

enum { EDGES_MOST = 31 }; ///< of windows that corners are added to one by one: two rounds are a 64-bit word

/// The edges of a window, as the coordinate plane has them.
typedef struct edges {
    double u[EDGES_MOST + ENF_OUTLINE_MORE], v[EDGES_MOST + ENF_OUTLINE_MORE]; ///< the way along each
    double least[EDGES_MOST + ENF_OUTLINE_MORE]; ///< the turn to what is outside by the tolerance
} edges;

ENF_PART_OF_WIDE void find_edges(const double *us, const double *vs, int32_t count, double tolerance,
                                 edges *edges) {
    for (int32_t i = 0; i < count; i += ENF_FOUR) {
        const enf_four u = enf_four_load(us + i + 1) - enf_four_load(us + i),
                       v = enf_four_load(vs + i + 1) - enf_four_load(vs + i);
        enf_four_store(edges->u + i, u);
        enf_four_store(edges->v + i, v);
        enf_four_store(edges->least + i, -tolerance * (enf_four_abs(u) + enf_four_abs(v)));
    }
}

/// Which corners of the other lie outside of the window; none if all are within the tolerance of it.
ENF_PART_OF_WIDE uint64_t find_outside(const enf_window *window, const enf_outline *other,
                                       const int32_t axes[2], double tolerance) {
    const double *us = window->at[axes[0]], *vs = window->at[axes[1]];
    edges edges;
    enf_four_mask far = {0};
    uint64_t outside = 0;
    find_edges(us, vs, window->count, tolerance, &edges);
    for (int32_t k = 0; k < other->count; k += ENF_FOUR) {
        const enf_four u = enf_four_load(other->at[axes[0]] + k), v = enf_four_load(other->at[axes[1]] + k);
        enf_four_mask out = {0};
        for (int32_t i = 0; i < window->count; i++) {
            const enf_four turn = edges.u[i] * (v - vs[i]) - edges.v[i] * (u - us[i]);
            out |= turn < 0;
            far |= turn < edges.least[i];
        }
        outside |= (uint64_t)enf_four_bits(out) << k;
    }
    if (!((far[0] | far[1]) | (far[2] | far[3]))) return 0;
    return outside & ((UINT64_C(1) << other->count) - 1);
}

/// The corners of two windows, and the hull of those of one and some of the other.
typedef struct rim {
    double at[3][2 * (EDGES_MOST + ENF_OUTLINE_MORE)];
    const double *u, *v; ///< the two that the coordinate plane is about
    int32_t count;
    uint8_t corners[2 * EDGES_MOST + 2]; ///< round the hull; the first one again at the end
} rim;

static void make_rim(const enf_window *window, const enf_outline *other, const int32_t axes[2], rim *rim) {
    const int32_t count = window->count;
    for (int axis = 0; axis < 3; axis++) {
        enf_outline_copy(rim->at[axis], window->at[axis], count);
        enf_outline_copy(rim->at[axis] + count, other->at[axis], other->count);
    }
    rim->u = rim->at[axes[0]];
    rim->v = rim->at[axes[1]];
    for (int32_t i = 0; i < count; i++) rim->corners[i] = (uint8_t)i;
    rim->corners[count] = 0;
    rim->count = count;
}

/// Which edges of the rim, bit by bit, a point lies outside of; also those that it is in line with.
static void find_sides(const rim *rim, double u, double v, uint64_t *out, uint64_t *in_line) {
    double from_u = rim->u[rim->corners[0]], from_v = rim->v[rim->corners[0]];
    *out = *in_line = 0;
    for (int32_t i = 0; i < rim->count; i++) {
        const double to_u = rim->u[rim->corners[i + 1]], to_v = rim->v[rim->corners[i + 1]];
        const double turn = (to_u - from_u) * (v - from_v) - (to_v - from_v) * (u - from_u);
        *out |= (uint64_t)(turn < 0) << i;
        *in_line |= (uint64_t)(turn <= 0) << i;
        from_u = to_u;
        from_v = to_v;
    }
}

/// A run of edges, round the end perhaps, that holds all of some, and of others what is next to them. False
/// if there is no such run, or if nothing else is left. *first and *after are the edges that it begins and
/// ends at.
static bool find_run(uint64_t some, uint64_t others, int32_t count, int32_t *first, int32_t *after) {
    const uint64_t all = (UINT64_C(1) << count) - 1, twice = others | others << count;
    const int32_t one = __builtin_ctzll(some), ahead = __builtin_ctzll(~(twice >> one)),
                  back = __builtin_clzll(~(twice << (64 - count - one))), length = back + ahead;
    if (length >= count) return false;
    const int32_t begin = one >= back ? one - back : one - back + count;
    const uint64_t run = ((UINT64_C(1) << length) - 1) << begin;
    *first = begin;
    *after = begin + length < count ? begin + length : begin + length - count;
    return !(some & ~(run | run >> count) & all);
}

/// Puts a corner in the place of a run of edges: between that where it begins and that where it ends.
static void replace_run(rim *rim, int32_t first, int32_t after, int32_t corner) {
    uint8_t *corners = rim->corners;
    if (first < after) {
        memmove(corners + first + 2, corners + after, (size_t)(rim->count - after) * sizeof *corners);
        corners[first + 1] = (uint8_t)corner;
        rim->count -= after - first - 2;
    } else { // from the end, round to the beginning; `after` may be that
        memmove(corners, corners + after, (size_t)(first - after + 1) * sizeof *corners);
        corners[first - after + 1] = (uint8_t)corner;
        rim->count = first - after + 2;
    }
    corners[rim->count] = corners[0];
}

/// Adds corners of the other, whose places begin at `begin`. False if the rest is to be done anew.
static bool add_corners(rim *rim, uint64_t corners, int32_t begin) {
    for (; corners; corners &= corners - 1) {
        const int32_t corner = begin + __builtin_ctzll(corners);
        uint64_t out, in_line;
        int32_t first, after;
        if (rim->count > EDGES_MOST) return false;
        find_sides(rim, rim->u[corner], rim->v[corner], &out, &in_line);
        if (!out) continue;
        if (!find_run(out, in_line, rim->count, &first, &after)) return false;
        replace_run(rim, first, after, corner);
    }
    return true;
}

/// Makes the window what the rim says.
static void take_rim(enf_window *window, const rim *rim) {
    for (int axis = 0; axis < 3; axis++) {
        for (int32_t i = 0; i < rim->count; i++) window->at[axis][i] = rim->at[axis][rim->corners[i]];
        enf_outline_close(window->at[axis], rim->count);
    }
    window->count = rim->count;
}

static bool is_within(const enf_window *window, const enf_outline *other, const int32_t axes[2],
                      double tolerance) {
    const double *us = window->at[axes[0]], *vs = window->at[axes[1]];
    for (int32_t i = 0; i < window->count; i++) {
        const double u = us[i + 1] - us[i], v = vs[i + 1] - vs[i], least = -tolerance * (fabs(u) + fabs(v));
        for (int32_t k = 0; k < other->count; k++)
            if (u * (other->at[axes[1]][k] - vs[i]) - v * (other->at[axes[0]][k] - us[i]) < least)
                return false;
    }
    return true;
}

ENF_WIDE_TOO bool enf_hull_extend(enf_window *window, const enf_outline *other, const int32_t axes[2],
                                  double tolerance) {
    if (window->count > EDGES_MOST || other->count > EDGES_MOST) {
        if (is_within(window, other, axes, tolerance)) return false;
        make_anew(window, other, axes);
        return true;
    }
    if (window->count < 3) { // no inside to be in
        make_anew(window, other, axes);
        return true;
    }
    const uint64_t outside = find_outside(window, other, axes, tolerance);
    if (!outside) return false;
    rim rim;
    make_rim(window, other, axes, &rim);
    if (add_corners(&rim, outside, window->count))
        take_rim(window, &rim);
    else
        make_anew(window, other, axes);
    return true;
}
