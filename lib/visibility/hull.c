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

static int32_t sort_corners(const enf_window *window, const int32_t axes[2], point *sorted, int32_t count) {
    const enf_outline outline = enf_window_outline(window);
    for (int32_t i = 0; i < window->count; i++) {
        int32_t at = count++;
        point corner;
        enf_outline_corner(&outline, i, corner.at);
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

static void make_anew(enf_window *window, const enf_window *other, const int32_t axes[2]) {
    point sorted[2 * ENF_WINDOW_MOST];
    const point *chain[2 * ENF_WINDOW_MOST + 2];
    int32_t count = sort_corners(window, axes, sorted, 0), made = 0;
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
ENF_PART_OF_WIDE uint64_t find_outside(const enf_window *window, const enf_window *other,
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

/// Which edges of a window, bit by bit, a point lies outside of; also those that it is in line with.
static void find_sides(const enf_window *window, double u, double v, const int32_t axes[2], uint64_t *out,
                       uint64_t *in_line) {
    const double *us = window->at[axes[0]], *vs = window->at[axes[1]];
    *out = *in_line = 0;
    for (int32_t i = 0; i < window->count; i++) {
        const double turn = (us[i + 1] - us[i]) * (v - vs[i]) - (vs[i + 1] - vs[i]) * (u - us[i]);
        *out |= (uint64_t)(turn < 0) << i;
        *in_line |= (uint64_t)(turn <= 0) << i;
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

/// Puts a point in the place of a run of edges: between the corner where it begins, and that where it ends.
static void replace_run(double *along, int32_t count, int32_t first, int32_t after, double point) {
    if (first < after) {
        memmove(along + first + 2, along + after, (size_t)(count - after) * sizeof *along);
        along[first + 1] = point;
        enf_outline_close(along, count - (after - first) + 2);
    } else { // from the end, round to the beginning; `after` may be that
        memmove(along, along + after, (size_t)(first - after + 1) * sizeof *along);
        along[first - after + 1] = point;
        enf_outline_close(along, first - after + 2);
    }
}

/// False if the rest is to be done anew.
static bool add_corners(enf_window *window, const enf_window *other, uint64_t corners,
                        const int32_t axes[2]) {
    for (; corners; corners &= corners - 1) {
        const int32_t k = __builtin_ctzll(corners);
        uint64_t out, in_line;
        int32_t first, after;
        if (window->count > EDGES_MOST) return false;
        find_sides(window, other->at[axes[0]][k], other->at[axes[1]][k], axes, &out, &in_line);
        if (!out) continue;
        if (!find_run(out, in_line, window->count, &first, &after)) return false;
        for (int axis = 0; axis < 3; axis++)
            replace_run(window->at[axis], window->count, first, after, other->at[axis][k]);
        window->count = first < after ? window->count - (after - first) + 2 : first - after + 2;
    }
    return true;
}

static bool is_within(const enf_window *window, const enf_window *other, const int32_t axes[2],
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

ENF_WIDE_TOO bool enf_hull_extend(enf_window *window, const enf_window *other, const int32_t axes[2],
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
    if (!add_corners(window, other, outside, axes)) make_anew(window, other, axes);
    return true;
}
