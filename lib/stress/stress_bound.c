// SPDX-License-Identifier: GPL-3.0-or-later
// Where three polygons cross: for every pair the segment that they share, cut by all later polygons.
#include "stress/stress_hard.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CORNERS_MAX = 8 };
static const double angle_least =
    1e-3; ///< of two planes, and of a line and a plane: else rounding may decide
static const double inside_least = 0x1p-38; ///< of the soup's size: nearer to an edge is not counted

/// A flat convex polygon: the inside is where edge . x + edge_offset > 0 for all edges, distances in soup
/// sizes.
typedef struct flat {
    double normal[3], offset;
    double edge[CORNERS_MAX][3], edge_offset[CORNERS_MAX];
    int count;
} flat;

static double dot(const double u[3], const double v[3]) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

static void cross(const double u[3], const double v[3], double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
}

static bool normalize(double v[3]) {
    double length = sqrt(dot(v, v));
    for (int a = 0; a < 3; a++) v[a] /= length;
    return length > 0 && isfinite(length);
}

static bool make_flat(flat *out, const double (*corner)[3], int count) {
    double u[3], v[3];
    for (int a = 0; a < 3; a++) u[a] = corner[1][a] - corner[0][a], v[a] = corner[2][a] - corner[0][a];
    cross(u, v, out->normal);
    if (!normalize(out->normal)) return false;
    out->offset = -dot(out->normal, corner[0]);
    out->count = count;
    for (int i = 0; i < count; i++) {
        for (int a = 0; a < 3; a++) u[a] = corner[(i + 1) % count][a] - corner[i][a];
        cross(out->normal, u, out->edge[i]);
        if (!normalize(out->edge[i])) return false;
        out->edge_offset[i] = -dot(out->edge[i], corner[i]);
    }
    return true;
}

/// Cuts the part of the line at + t way that lies in the polygon out of [*low, *high].
static bool clip(const flat *polygon, const double at[3], const double way[3], double *low, double *high) {
    for (int i = 0; i < polygon->count; i++) {
        double slope = dot(polygon->edge[i], way),
               height = dot(polygon->edge[i], at) + polygon->edge_offset[i] - inside_least;
        if (fabs(slope) < 1e-9) {
            if (height <= 0) return false;
        } else if (slope > 0) {
            *low = fmax(*low, -height / slope);
        } else {
            *high = fmin(*high, -height / slope);
        }
    }
    return *low < *high;
}

/// The segment that two polygons share.
static bool share(const flat *p, const flat *q, double at[3], double way[3], double *low, double *high) {
    double n[3];
    cross(p->normal, q->normal, n);
    double square = dot(n, n);
    if (square < angle_least * angle_least) return false;
    double one[3], two[3];
    cross(q->normal, n, one);
    cross(n, p->normal, two);
    for (int a = 0; a < 3; a++) {
        at[a] = -(p->offset * one[a] + q->offset * two[a]) / square;
        way[a] = n[a] / sqrt(square);
    }
    *low = -HUGE_VAL, *high = HUGE_VAL;
    return clip(p, at, way, low, high) && clip(q, at, way, low, high);
}

static bool holds(const flat *polygon, const double at[3]) {
    for (int i = 0; i < polygon->count; i++)
        if (dot(polygon->edge[i], at) + polygon->edge_offset[i] <= inside_least) return false;
    return true;
}

static int64_t count_on_segment(const flat *flats, size_t first, size_t count, const double at[3],
                                const double way[3], double low, double high) {
    int64_t found = 0;
    for (size_t k = first; k < count; k++) {
        double slope = dot(flats[k].normal, way);
        if (fabs(slope) < angle_least) continue;
        double t = -(dot(flats[k].normal, at) + flats[k].offset) / slope;
        if (!(t > low && t < high)) continue;
        const double point[3] = {at[0] + t * way[0], at[1] + t * way[1], at[2] + t * way[2]};
        found += holds(&flats[k], point);
    }
    return found;
}

/// Polygons in units of the soup's size, about its middle.
static size_t list_flats(const enf_stress_case *made, size_t most, double stretch, flat *flats) {
    const enf_soup *soup = &made->soup;
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, size = 0;
    size_t count = 0, polygons = soup->polygon_count < most ? soup->polygon_count : most;
    for (int64_t i = 0; i < 3 * soup->polygon_corner[polygons]; i++) {
        int a = (int)(i % 3);
        double x = (a == 2 ? stretch : 1) * soup->points[3 * soup->corner_point[i / 3] + a];
        low[a] = fmin(low[a], x);
        high[a] = fmax(high[a], x);
    }
    for (int a = 0; a < 3; a++) size = fmax(size, high[a] - low[a]);
    for (size_t p = 0; p < polygons; p++) {
        int64_t first = soup->polygon_corner[p], corners = soup->polygon_corner[p + 1] - first;
        if (corners < 3 || corners > CORNERS_MAX) continue;
        double at[CORNERS_MAX][3];
        for (int64_t i = 0; i < corners; i++) {
            const double *from = soup->points + 3 * (size_t)soup->corner_point[first + i];
            for (int a = 0; a < 3; a++)
                at[i][a] = ((a == 2 ? stretch : 1) * from[a] - (low[a] + high[a]) / 2) / size;
        }
        count += make_flat(&flats[count], (const double(*)[3])at, (int)corners);
    }
    return count;
}

int64_t enf_stress_count_crossings(const enf_stress_case *made, size_t most, double stretch, size_t *used) {
    flat *flats = enf_array_new(most, sizeof *flats);
    size_t count = flats ? list_flats(made, most, stretch, flats) : 0;
    int64_t found = 0;
    *used = count;
    for (size_t i = 0; i < count; i++) {
        for (size_t j = i + 1; j < count; j++) {
            double at[3], way[3], low, high;
            if (!share(&flats[i], &flats[j], at, way, &low, &high)) continue;
            found += count_on_segment(flats, j + 1, count, at, way, low, high);
        }
    }
    free(flats);
    return found;
}
