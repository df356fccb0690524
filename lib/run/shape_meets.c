// SPDX-License-Identifier: MIT
// Whether a shape meets a convex polygon. A sphere does if the polygon's nearest point is near enough: the
// centre's foot on the plane if that lies inside, otherwise a point of an edge (C. Ericson, "Real-Time
// Collision Detection", 2005, 5.1). A box does if something is left of the polygon's plane when it is clipped
// by the faces of the box and the edges of the polygon (I. E. Sutherland, G. W. Hodgman, "Reentrant polygon
// clipping", 1974). Comparisons are written so that what is not a number counts as near.
#include "run/shape.h"

#include "run/vector.h"

#include <math.h>
#include <string.h>

#define CORNERS_MAX 32 // of the clipped polygon; clips that would make more are left out: it stays too large

static double square_to_segment(const double point[3], const double from[3], const double to[3]) {
    double along[3], off[3], square = 0;
    for (int a = 0; a < 3; a++) {
        along[a] = to[a] - from[a];
        off[a] = point[a] - from[a];
    }
    double length = enf_dot(along, along), share = length > 0 ? enf_dot(along, off) / length : 0;
    share = share > 0 ? (share < 1 ? share : 1) : 0;
    for (int a = 0; a < 3; a++) square += (off[a] - share * along[a]) * (off[a] - share * along[a]);
    return square;
}

static double height_above(const double plane[4], const double point[3]) {
    return enf_dot(plane, point) + plane[3];
}

/// Where the line between two points crosses a plane that has them on different sides.
static void cross_plane(const double from[3], const double to[3], double height_from, double height_to,
                        double out[3]) {
    double share = height_from / (height_from - height_to);
    for (int a = 0; a < 3; a++) out[a] = from[a] + share * (to[a] - from[a]);
}

/// The edges of a polygon that may be cut, one after the other; the last one is the edge of the cut.
typedef struct edges {
    double nearest; ///< square of the distance to the edges so far
    double at[3];   ///< the point that is measured from
    double crossing[2][3];
    int crossings;
} edges;

static void take_edge(edges *edges, const double from[3], const double to[3]) {
    double square = square_to_segment(edges->at, from, to);
    if (!(square > edges->nearest)) edges->nearest = square;
}

static void take_cut_edge(edges *edges, const double *from, const double *to, const double cut[4],
                          double slack) {
    double here = height_above(cut, from) + slack, there = height_above(cut, to) + slack;
    if (!(here < 0) && !(there < 0)) {
        take_edge(edges, from, to);
        return;
    }
    if (here < 0 && there < 0) return;
    double *at = edges->crossing[edges->crossings > 0];
    cross_plane(from, to, here, there, at);
    edges->crossings++;
    take_edge(edges, here < 0 ? at : from, here < 0 ? to : at);
}

static bool is_zero(const double v[3]) {
    return v[0] == 0 && v[1] == 0 && v[2] == 0;
}

/// True if the centre's foot on the polygon's plane lies on the positive side of the cut.
static bool foot_is_open(const double centre[3], double height, const enf_face *face, double slack) {
    double foot[3];
    for (int a = 0; a < 3; a++) foot[a] = centre[a] - height * face->normal[a];
    return !(height_above(face->cut, foot) + slack < 0);
}

static bool sphere_meets(const double centre[3], double radius, const enf_face *face, double slack) {
    double off[3], limit = radius + slack;
    double cut_slack = face->cut ? slack * sqrt(enf_dot(face->cut, face->cut)) : 0;
    edges edges = {.nearest = INFINITY};
    memcpy(edges.at, centre, sizeof edges.at);
    for (int a = 0; a < 3; a++) off[a] = centre[a] - face->vertices[0][a];
    double height = enf_dot(face->normal, off);
    if (fabs(height) > limit) return false;
    bool inside = !is_zero(face->normal) && (!face->cut || foot_is_open(centre, height, face, cut_slack));
    for (int32_t i = 0; i < face->count; i++) {
        const double *from = face->vertices[i], *to = face->vertices[i + 1 < face->count ? i + 1 : 0];
        double edge[3], inwards[3];
        for (int a = 0; a < 3; a++) {
            edge[a] = to[a] - from[a];
            off[a] = centre[a] - from[a];
        }
        enf_cross(face->normal, edge, inwards);
        inside = inside && !(enf_dot(inwards, off) < 0);
        if (face->cut)
            take_cut_edge(&edges, from, to, face->cut, cut_slack);
        else
            take_edge(&edges, from, to);
    }
    if (edges.crossings > 1) take_edge(&edges, edges.crossing[0], edges.crossing[1]);
    return inside || !(edges.nearest > limit * limit);
}

typedef struct clipped {
    double corner[CORNERS_MAX][3];
    int count;
} clipped;

/// Keeps what is on the positive side of a plane, or less than `slack` below it.
static void clip(clipped *polygon, const double plane[4], double slack) {
    clipped kept = {.count = 0};
    if (polygon->count >= CORNERS_MAX) return;
    for (int i = 0; i < polygon->count; i++) {
        const double *from = polygon->corner[i], *to = polygon->corner[i + 1 < polygon->count ? i + 1 : 0];
        double here = height_above(plane, from) + slack, there = height_above(plane, to) + slack;
        if (!(here < 0)) memcpy(kept.corner[kept.count++], from, sizeof kept.corner[0]);
        if (kept.count == CORNERS_MAX) return; // rounding made it concave: leave it as it is
        if ((here < 0) != (there < 0)) cross_plane(from, to, here, there, kept.corner[kept.count++]);
        if (kept.count == CORNERS_MAX) return;
    }
    polygon->count = kept.count;
    memcpy(polygon->corner, kept.corner, (size_t)kept.count * sizeof kept.corner[0]);
}

/// A square in the plane through the origin with that normal.
static void make_square(clipped *square, const double normal[3], double half) {
    int least = 0;
    for (int a = 1; a < 3; a++)
        if (fabs(normal[a]) < fabs(normal[least])) least = a;
    double axis[3] = {0}, u[3], v[3];
    axis[least] = 1;
    enf_cross(normal, axis, u);
    double length = sqrt(enf_dot(u, u));
    for (int a = 0; a < 3; a++) u[a] /= length;
    enf_cross(normal, u, v);
    square->count = 4;
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++)
            square->corner[i][a] = half * ((i == 1 || i == 2 ? u[a] : -u[a]) + (i >= 2 ? v[a] : -v[a]));
}

/// The box's own faces against the polygon's corners.
static bool boxes_meet(const enf_shape *box, const enf_face *face, double slack) {
    for (int a = 0; a < 3; a++) {
        double low = INFINITY, high = -INFINITY;
        for (int32_t i = 0; i < face->count; i++) {
            low = fmin(low, face->vertices[i][a]);
            high = fmax(high, face->vertices[i][a]);
        }
        if (low - box->centre[a] > box->half[a] + slack || box->centre[a] - high > box->half[a] + slack)
            return false;
    }
    return true;
}

/// How far the polygon's plane is from the centre of the box; false if the box does not reach it.
static bool plane_meets(const enf_shape *box, const enf_face *face, double slack, double *height) {
    double off[3], reach = slack;
    for (int a = 0; a < 3; a++) {
        off[a] = face->vertices[0][a] - box->centre[a];
        reach += fabs(face->normal[a]) * box->half[a];
    }
    *height = enf_dot(face->normal, off);
    return !(fabs(*height) > reach);
}

// Clipped polygons have their coordinates relative to the centre of the box.

/// The part of the polygon's plane that lies in the box.
static void clip_by_box(clipped *left, const enf_shape *box, const double normal[3], double height,
                        double slack) {
    make_square(left, normal, enf_shape_reach(box) + 4 * slack);
    for (int i = 0; i < 4; i++)
        for (int a = 0; a < 3; a++) left->corner[i][a] += height * normal[a];
    for (int side = 0; side < 6; side++) {
        double plane[4] = {0, 0, 0, box->half[side / 2]};
        plane[side / 2] = side % 2 ? 1 : -1;
        clip(left, plane, slack);
    }
}

static void clip_by_cut(clipped *left, const enf_shape *box, const double cut[4], double slack) {
    const double plane[4] = {cut[0], cut[1], cut[2], height_above(cut, box->centre)};
    clip(left, plane, slack * sqrt(enf_dot(cut, cut)));
}

static void clip_by_edges(clipped *left, const enf_shape *box, const enf_face *face, double slack) {
    for (int32_t i = 0; i < face->count && left->count > 0; i++) {
        const double *from = face->vertices[i], *to = face->vertices[i + 1 < face->count ? i + 1 : 0];
        double edge[3], off[3], plane[4];
        for (int a = 0; a < 3; a++) {
            edge[a] = to[a] - from[a];
            off[a] = from[a] - box->centre[a];
        }
        enf_cross(face->normal, edge, plane);
        plane[3] = -enf_dot(plane, off);
        clip(left, plane, slack * sqrt(enf_dot(edge, edge)));
    }
}

static bool box_meets(const enf_shape *box, const enf_face *face, double slack) {
    const double *normal = face->normal;
    clipped left;
    double height;
    if (!boxes_meet(box, face, slack)) return false;
    if (is_zero(normal)) return true;
    if (!plane_meets(box, face, slack, &height)) return false;
    clip_by_box(&left, box, normal, height, slack);
    if (face->cut) clip_by_cut(&left, box, face->cut, slack);
    clip_by_edges(&left, box, face, slack);
    return left.count > 0;
}

bool enf_shape_meets_face(const enf_shape *shape, const enf_face *face, double slack) {
    if (shape->kind == ENF_SHAPE_BOX) return box_meets(shape, face, slack);
    return sphere_meets(shape->centre, shape->radius, face, slack);
}
