// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/contact.h"

#include <math.h>
#include <string.h>

/// Corners of one outline; an edge, if there are two.
typedef struct contact {
    int count;
    double ends[2][3];
} contact;

/// The corners whose height is within the band of the highest (side 1) or the lowest (side -1); more than two
/// are counted only.
static contact find_contact(const enf_outline *outline, const double normal[3], double side, double band) {
    double heights[ENF_WINDOW_MOST], highest = -INFINITY;
    for (int32_t i = 0; i < outline->count; i++) {
        heights[i] = side * (normal[0] * outline->at[0][i] + normal[1] * outline->at[1][i] +
                             normal[2] * outline->at[2][i]);
        if (heights[i] > highest) highest = heights[i];
    }
    contact contact = {0};
    for (int32_t i = 0; i < outline->count; i++) {
        if (heights[i] < highest - band) continue;
        if (contact.count < 2) enf_outline_corner(outline, i, contact.ends[contact.count]);
        contact.count++;
    }
    if (contact.count == 1) memcpy(contact.ends[1], contact.ends[0], sizeof contact.ends[0]);
    return contact;
}

static double clamp(double share) {
    return share > 0 ? (share < 1 ? share : 1) : 0; // 0 for NaN
}

/// The share of the way from a to b that is nearest to a point.
static double nearest_share(const double a[3], const double b[3], const double point[3]) {
    double along[3], way[3];
    for (int axis = 0; axis < 3; axis++) {
        along[axis] = b[axis] - a[axis];
        way[axis] = point[axis] - a[axis];
    }
    return clamp(enf_dot(along, way) / enf_dot(along, along));
}

static double distance_to(const double a[3], const double b[3], const double point[3]) {
    double share = nearest_share(a, b, point), way[3];
    for (int axis = 0; axis < 3; axis++) way[axis] = a[axis] + share * (b[axis] - a[axis]) - point[axis];
    return sqrt(enf_dot(way, way));
}

/// Where the lines of the two edges are nearest to each other, if that is on both edges: their distance.
/// Otherwise an end of one is nearest to the other edge.
static double crossing_distance(const contact *one, const contact *two) {
    double u[3], v[3], w[3];
    for (int axis = 0; axis < 3; axis++) {
        u[axis] = one->ends[1][axis] - one->ends[0][axis];
        v[axis] = two->ends[1][axis] - two->ends[0][axis];
        w[axis] = one->ends[0][axis] - two->ends[0][axis];
    }
    double uu = enf_dot(u, u), uv = enf_dot(u, v), vv = enf_dot(v, v), uw = enf_dot(u, w), vw = enf_dot(v, w);
    double divisor = uu * vv - uv * uv, s = (uv * vw - vv * uw) / divisor, t = (uu * vw - uv * uw) / divisor;
    if (!(s > 0 && s < 1 && t > 0 && t < 1)) return INFINITY;
    for (int axis = 0; axis < 3; axis++) w[axis] += s * u[axis] - t * v[axis];
    return sqrt(enf_dot(w, w));
}

double enf_contact_distance(const enf_outline *below, const enf_outline *above, const double normal[3],
                            double band) {
    contact one = find_contact(below, normal, 1, band), two = find_contact(above, normal, -1, band);
    if (one.count > 2 || two.count > 2) return 0;
    double least = crossing_distance(&one, &two);
    for (int end = 0; end < 2; end++) {
        least = fmin(least, distance_to(one.ends[0], one.ends[1], two.ends[end]));
        least = fmin(least, distance_to(two.ends[0], two.ends[1], one.ends[end]));
    }
    return least;
}
