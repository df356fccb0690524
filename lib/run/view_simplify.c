// SPDX-License-Identifier: MIT
// Polygons of fewer edges around polygons. An edge can go if its two neighbours meet beyond it; what they
// then add is a triangle. Of five edges or more of a convex polygon some edge can always go: the outer angles
// at the ends of all edges add up to 4 pi, so they are below pi at one of them. Edges that are nearly
// parallel meet far away: then the rectangle around is better.
#include "run/view_region.h"

#include <math.h>
#include <string.h>

/// Where the edges before and after edge i (from corner i on) meet. Infinity: they don't, beyond it.
static double grow(const double (*corners)[2], int32_t count, int32_t i, double meet[2]) {
    const double *before = corners[(i + count - 1) % count], *from = corners[i];
    const double *to = corners[(i + 1) % count], *after = corners[(i + 2) % count];
    double u[2] = {from[0] - before[0], from[1] - before[1]};
    double v[2] = {after[0] - to[0], after[1] - to[1]};
    double edge[2] = {to[0] - from[0], to[1] - from[1]};
    double turn = u[0] * v[1] - u[1] * v[0];
    double along = edge[0] * v[1] - edge[1] * v[0]; // from + u along / turn
    double rise = u[0] * edge[1] - u[1] * edge[0];
    if (!(turn > 0 && along >= 0 && rise >= 0)) return INFINITY;
    double share = along / turn;
    meet[0] = from[0] + u[0] * share;
    meet[1] = from[1] + u[1] * share;
    double area = 0.5 * share * rise;
    return isfinite(area) && isfinite(meet[0]) && isfinite(meet[1]) ? area : INFINITY;
}

/// Edge i goes, its ends become one corner.
static int32_t remove_edge(double (*corners)[2], int32_t count, int32_t i, const double corner[2]) {
    int32_t gone = (i + 1) % count;
    memcpy(corners[i], corner, sizeof *corners);
    memmove(corners + gone, corners + gone + 1, (size_t)(count - gone - 1) * sizeof *corners);
    return count - 1;
}

int32_t enf_polygon_tidy(double (*corners)[2], int32_t count, double shortest) {
    for (int32_t i = 0; i < count && count > 3;) {
        const double *from = corners[i], *to = corners[i + 1 < count ? i + 1 : 0];
        double u = to[0] - from[0], v = to[1] - from[1], meet[2];
        if (u * u + v * v >= shortest * shortest) {
            i++;
            continue;
        }
        bool meets = grow((const double(*)[2])corners, count, i, meet) < shortest * shortest &&
                     fabs(meet[0] - from[0]) + fabs(meet[1] - from[1]) < 4 * shortest;
        if (!meets) memcpy(meet, from, sizeof meet);
        count = remove_edge(corners, count, i, meet);
        i = 0;
    }
    return count;
}

/// Makes a polygon the rectangle around some points. Returns its four corners.
static int32_t take_rectangle(double (*corners)[2], const double low[2], const double high[2]) {
    for (int i = 0; i < 4; i++) {
        corners[i][0] = i == 1 || i == 2 ? high[0] : low[0];
        corners[i][1] = i >= 2 ? high[1] : low[1];
    }
    return 4;
}

int32_t enf_polygon_simplify(double (*corners)[2], int32_t count, int32_t edges_max) {
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    if (count <= edges_max) return count;
    for (int32_t i = 0; i < count; i++)
        for (int axis = 0; axis < 2; axis++) {
            low[axis] = fmin(low[axis], corners[i][axis]);
            high[axis] = fmax(high[axis], corners[i][axis]);
        }
    while (count > edges_max) {
        double least = INFINITY, best[2] = {0, 0}, meet[2];
        int32_t edge = -1;
        for (int32_t i = 0; i < count; i++) {
            double area = grow((const double(*)[2])corners, count, i, meet);
            if (!(area < least)) continue;
            least = area;
            edge = i;
            memcpy(best, meet, sizeof best);
        }
        if (edge < 0) break; // not convex
        count = remove_edge(corners, count, edge, best);
    }
    const double area = (high[0] - low[0]) * (high[1] - low[1]);
    const bool is_good = count <= edges_max && enf_polygon_area((const double(*)[2])corners, count) <= area;
    return is_good ? count : take_rectangle(corners, low, high);
}
