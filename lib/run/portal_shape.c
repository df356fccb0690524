// SPDX-License-Identifier: MIT
#include "run/portal_shape.h"

#include "run/vector.h"

#include <string.h>

/// A point that beats others by the least value.
typedef struct champion {
    double value, point[3];
} champion;

static void challenge(champion *best, double value, const double point[3]) {
    if (!(value < best->value)) return; // nor what is no number
    best->value = value;
    memcpy(best->point, point, sizeof best->point);
}

/// Is a point of a polygon's plane inside?
static bool is_inside(const enf_file_view *view, const enf_file_portal_polygon *polygon,
                      const double point[3]) {
    const double(*corner)[3] = view->portal_vertices + polygon->vertex_first;
    for (int32_t i = 0, before = polygon->vertex_count - 1; i < polygon->vertex_count; before = i++) {
        double edge[3], arm[3], across[3];
        enf_subtract(corner[i], corner[before], edge);
        enf_subtract(point, corner[before], arm);
        enf_cross(edge, arm, across);
        if (!(enf_dot(across, polygon->plane) >= 0)) return false;
    }
    return true;
}

static double clamp_share(double share) {
    return share > 0 ? share < 1 ? share : 1 : 0; // 0 for what is no number
}

/// The point of a plane below a point, and the height.
static double drop(const double plane[4], const double point[3], double foot[3]) {
    double height = enf_dot(plane, point) + plane[3];
    for (int a = 0; a < 3; a++) foot[a] = point[a] - height * plane[a];
    return height;
}

static void nearest_of_polygon(const enf_file_view *view, const enf_file_portal_polygon *polygon,
                               const double to[3], champion *best) {
    double foot[3];
    drop(polygon->plane, to, foot);
    if (is_inside(view, polygon, foot)) {
        challenge(best, enf_distance(to, foot), foot);
        return;
    }
    const double(*corner)[3] = view->portal_vertices + polygon->vertex_first;
    for (int32_t i = 0, before = polygon->vertex_count - 1; i < polygon->vertex_count; before = i++) {
        double edge[3], arm[3], point[3];
        enf_subtract(corner[i], corner[before], edge);
        enf_subtract(to, corner[before], arm);
        enf_between(corner[before], corner[i], clamp_share(enf_dot(edge, arm) / enf_dot(edge, edge)), point);
        challenge(best, enf_distance(to, point), point);
    }
}

bool enf_portal_nearest(const enf_file_view *view, int32_t portal, const double to[3], double nearest[3]) {
    const enf_file_portal *p = &view->portals[portal];
    champion best = {.value = INFINITY};
    for (int32_t i = 0; i < p->polygon_count; i++)
        nearest_of_polygon(view, &view->portal_polygons[p->polygon_first + i], to, &best);
    if (best.value < INFINITY) memcpy(nearest, best.point, sizeof best.point);
    return best.value < INFINITY;
}

static double way_by(const double a[3], const double b[3], const double by[3]) {
    return enf_distance(a, by) + enf_distance(by, b);
}

/// The triangles that a and b span with the edge's line, unfolded into one plane.
void enf_edge_between(const double from[3], const double to[3], const double a[3], const double b[3],
                      double best[3]) {
    double edge[3], arms[2][3], share[2], away[2], point[3];
    enf_subtract(to, from, edge);
    double square = enf_dot(edge, edge);
    for (int k = 0; k < 2; k++) {
        enf_subtract(k ? b : a, from, arms[k]);
        share[k] = enf_dot(arms[k], edge) / square;
        enf_between(from, to, share[k], point);
        away[k] = enf_distance(k ? b : a, point);
    }
    double sum = away[0] + away[1];
    double at = sum > 0 ? (share[0] * away[1] + share[1] * away[0]) / sum : share[0];
    enf_between(from, to, clamp_share(at), best);
}

/// Where the straight way meets the plane, if that is inside; if both ends lie on one side, one of them is
/// reflected first. Otherwise the best point is on the border: the length is convex.
static void between_of_polygon(const enf_file_view *view, const enf_file_portal_polygon *polygon,
                               const double a[3], const double b[3], champion *best) {
    double foot[2][3], point[3];
    double height = fabs(drop(polygon->plane, a, foot[0])), other = fabs(drop(polygon->plane, b, foot[1]));
    double sum = height + other;
    enf_between(foot[0], foot[1], sum > 0 ? height / sum : 0, point);
    if (is_inside(view, polygon, point)) {
        challenge(best, way_by(a, b, point), point);
        return;
    }
    const double(*corner)[3] = view->portal_vertices + polygon->vertex_first;
    for (int32_t i = 0, before = polygon->vertex_count - 1; i < polygon->vertex_count; before = i++) {
        enf_edge_between(corner[before], corner[i], a, b, point);
        challenge(best, way_by(a, b, point), point);
    }
}

bool enf_portal_between(const enf_file_view *view, int32_t portal, const double a[3], const double b[3],
                        double found[3]) {
    const enf_file_portal *p = &view->portals[portal];
    champion best = {.value = INFINITY};
    for (int32_t i = 0; i < p->polygon_count; i++)
        between_of_polygon(view, &view->portal_polygons[p->polygon_first + i], a, b, &best);
    if (best.value < INFINITY) memcpy(found, best.point, sizeof best.point);
    return best.value < INFINITY;
}

/// Adds the polygon's triangles to a sum of centroids weighted by area.
static void add_polygon(const enf_file_view *view, const enf_file_portal_polygon *polygon, double scale,
                        double sum[3], double *area) {
    double corner[3][3];
    for (int32_t i = 0; i < polygon->vertex_count; i++) {
        const double *vertex = view->portal_vertices[polygon->vertex_first + i];
        if (i > 2) memcpy(corner[1], corner[2], sizeof corner[1]);
        for (int a = 0; a < 3; a++) corner[i < 2 ? i : 2][a] = vertex[a] * scale;
        if (i < 2) continue;
        double edges[2][3], across[3];
        enf_subtract(corner[1], corner[0], edges[0]);
        enf_subtract(corner[2], corner[0], edges[1]);
        enf_cross(edges[0], edges[1], across);
        double part = sqrt(enf_dot(across, across));
        for (int a = 0; a < 3; a++) sum[a] += part * ((corner[0][a] + corner[1][a] + corner[2][a]) / 3);
        *area += part;
    }
}

void enf_portal_middle(const enf_file_view *view, int32_t portal, double scale, double middle[3]) {
    const enf_file_portal *p = &view->portals[portal];
    double sum[3] = {0, 0, 0}, area = 0, world[3];
    for (int32_t i = 0; i < p->polygon_count; i++)
        add_polygon(view, &view->portal_polygons[p->polygon_first + i], scale, sum, &area);
    const double *corner = view->portal_vertices[view->portal_polygons[p->polygon_first].vertex_first];
    for (int a = 0; a < 3; a++) middle[a] = area > 0 ? sum[a] / area : corner[a] * scale;
    if (p->polygon_count == 1) return;
    for (int a = 0; a < 3; a++) world[a] = middle[a] / scale;
    if (!enf_portal_nearest(view, portal, world, world)) return;
    for (int a = 0; a < 3; a++) world[a] *= scale;
    if (isfinite(world[0]) && isfinite(world[1]) && isfinite(world[2])) memcpy(middle, world, sizeof world);
}
