// SPDX-License-Identifier: GPL-3.0-or-later
// A. M. Andrew, "Another efficient algorithm for convex hulls in two dimensions" (1979), in the coordinate
// plane that the points are seen best from.
#include "visibility/flat_hull.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int compare(const void *a, const void *b, int u, int v) {
    const double *one = a, *other = b;
    if (one[u] != other[u]) return one[u] < other[u] ? -1 : 1;
    return one[v] < other[v] ? -1 : one[v] > other[v];
}

static int compare_yz(const void *a, const void *b) {
    return compare(a, b, 1, 2);
}
static int compare_zx(const void *a, const void *b) {
    return compare(a, b, 2, 0);
}
static int compare_xy(const void *a, const void *b) {
    return compare(a, b, 0, 1);
}

enum { FEW = 24 };

/// As qsort does it, where that costs more than it gains.
static void sort_few(double (*points)[3], int32_t count, int (*compare)(const void *, const void *)) {
    for (int32_t i = 1; i < count; i++) {
        double point[3];
        int32_t at = i;
        memcpy(point, points[i], sizeof point);
        for (; at > 0 && compare(point, points[at - 1]) < 0; at--)
            memcpy(points[at], points[at - 1], sizeof point);
        memcpy(points[at], point, sizeof point);
    }
}

/// Twice the area of a, b, c; positive if they turn from axis u to axis v.
static double turn(const double a[3], const double b[3], const double c[3], int u, int v) {
    return (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
}

/// Adds the next corner of a chain that began at `start`.
static int32_t add(double (*hull)[3], int32_t made, int32_t start, const double next[3], int u, int v) {
    while (made >= start + 2 && turn(hull[made - 2], hull[made - 1], next, u, v) <= 0) made--;
    memcpy(hull[made], next, sizeof *hull);
    return made + 1;
}

static void reverse(double (*hull)[3], int32_t count) {
    double kept[3];
    for (int32_t i = 0, k = count - 1; i < k; i++, k--) {
        memcpy(kept, hull[i], sizeof kept);
        memcpy(hull[i], hull[k], sizeof kept);
        memcpy(hull[k], kept, sizeof kept);
    }
}

int32_t enf_flat_hull(double (*points)[3], int32_t count, const double normal[3], double (*hull)[3]) {
    static int (*const compares[3])(const void *, const void *) = {compare_yz, compare_zx, compare_xy};
    int along = 0;
    for (int axis = 1; axis < 3; axis++)
        if (fabs(normal[axis]) > fabs(normal[along])) along = axis;
    int u = (along + 1) % 3, v = (along + 2) % 3;
    int32_t made = 0;
    if (count < 2) {
        if (count == 1) memcpy(hull[0], points[0], sizeof *hull);
        return count;
    }
    if (count <= FEW)
        sort_few(points, count, compares[along]);
    else
        qsort(points, (size_t)count, sizeof *points, compares[along]);
    for (int32_t i = 0; i < count; i++) made = add(hull, made, 0, points[i], u, v);
    int32_t start = --made; // the last one begins the way back
    for (int32_t i = count - 1; i >= 0; i--) made = add(hull, made, start, points[i], u, v);
    made--;
    if (normal[along] < 0) reverse(hull, made);
    return made;
}
