// SPDX-License-Identifier: GPL-3.0-or-later
// A. M. Andrew, "Another efficient algorithm for convex hulls in two dimensions" (1979), in the coordinate
// plane that the opening is seen best from.
#include "visibility/hull.h"

#include <math.h>
#include <string.h>

typedef const double corner[3];

/// Twice the area of a, b, c; positive if they turn counter-clockwise.
static double turn(corner a, corner b, corner c, const int32_t axes[2]) {
    int u = axes[0], v = axes[1];
    return (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
}

static bool is_within(const enf_window *window, const enf_window *other, const int32_t axes[2],
                      double tolerance) {
    int u = axes[0], v = axes[1];
    for (int32_t i = 0; i < window->count; i++) {
        const double *a = window->corners[i], *b = window->corners[i + 1 < window->count ? i + 1 : 0];
        double least = -tolerance * (fabs(b[u] - a[u]) + fabs(b[v] - a[v]));
        for (int32_t k = 0; k < other->count; k++)
            if (turn(a, b, other->corners[k], axes) < least) return false;
    }
    return true;
}

static bool is_before(corner a, corner b, const int32_t axes[2]) {
    return a[axes[0]] < b[axes[0]] || (a[axes[0]] == b[axes[0]] && a[axes[1]] < b[axes[1]]);
}

static int32_t sort_corners(const enf_window *windows[2], const int32_t axes[2], const double **sorted) {
    int32_t count = 0;
    for (int w = 0; w < 2; w++)
        for (int32_t i = 0; i < windows[w]->count; i++) {
            int32_t at = count++;
            for (; at > 0 && is_before(windows[w]->corners[i], sorted[at - 1], axes); at--)
                sorted[at] = sorted[at - 1];
            sorted[at] = windows[w]->corners[i];
        }
    return count;
}

/// Adds the next corner of a chain that began at `start`.
static int32_t add_corner(const double **chain, int32_t made, int32_t start, corner next,
                          const int32_t axes[2]) {
    while (made >= start + 2 && turn(chain[made - 2], chain[made - 1], next, axes) <= 0) made--;
    chain[made] = next;
    return made + 1;
}

bool enf_hull_extend(enf_window *window, const enf_window *other, const int32_t axes[2], double tolerance) {
    if (is_within(window, other, axes, tolerance)) return false;
    const enf_window *windows[2] = {window, other};
    const double *sorted[2 * ENF_WINDOW_MOST], *chain[2 * ENF_WINDOW_MOST + 2];
    int32_t count = sort_corners(windows, axes, sorted), made = 0;
    for (int32_t i = 0; i < count; i++) made = add_corner(chain, made, 0, sorted[i], axes);
    int32_t start = --made; // the last one begins the way back
    for (int32_t i = count - 1; i >= 0; i--) made = add_corner(chain, made, start, sorted[i], axes);
    made--;
    if (made > ENF_WINDOW_MOST) made = ENF_WINDOW_MOST; // callers keep far fewer
    double hull[ENF_WINDOW_MOST][3];
    for (int32_t i = 0; i < made; i++) memcpy(hull[i], chain[i], sizeof *hull);
    enf_window_copy(window, (const double(*)[3])hull, made);
    return true;
}
