// SPDX-License-Identifier: GPL-3.0-or-later
// The hull grows point by point: what a new point sees of it is taken off, and the rim is joined to the point
// (M. Kallay, "Convex hull made easy", 1986).
#include "visibility/body.h"

#include <math.h>
#include <string.h>

enum {
    POINTS_MOST = 64,             ///< that a hull is made of
    FACES_MOST = 8 * POINTS_MOST, ///< that are made on the way
    ROUNDS_MOST = 8               ///< hulls that are made until there are few enough points
};

typedef struct face {
    int32_t corner[3]; ///< counter-clockwise from outside
    double normal[3], offset;
    bool is_seen, is_gone;
} face;

typedef struct hull {
    const double (*points)[3];
    int32_t count, face_count;
    double tolerance;
    bool failed;
    int16_t face_of[POINTS_MOST][POINTS_MOST]; ///< whose edge leads from one point to the other; -1: none's
    face faces[FACES_MOST];
} hull;

static void subtract(const double a[3], const double b[3], double out[3]) {
    for (int axis = 0; axis < 3; axis++) out[axis] = a[axis] - b[axis];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int axis = 0; axis < 3; axis++) {
        int u = (axis + 1) % 3, v = (axis + 2) % 3;
        out[axis] = a[u] * b[v] - a[v] * b[u];
    }
}

/// Makes the length 1. False if there is none.
static bool normalise(double vector[3]) {
    double length = sqrt(enf_dot(vector, vector));
    if (!(length > 0)) return false;
    for (int axis = 0; axis < 3; axis++) vector[axis] /= length;
    return true;
}

static double height_above(const hull *hull, const face *face, int32_t point) {
    return enf_dot(face->normal, hull->points[point]) - face->offset;
}

static void add_face(hull *hull, int32_t a, int32_t b, int32_t c) {
    double ab[3], ac[3];
    face *face = &hull->faces[hull->face_count];
    subtract(hull->points[b], hull->points[a], ab);
    subtract(hull->points[c], hull->points[a], ac);
    cross(ab, ac, face->normal);
    if (hull->face_count + 1 == FACES_MOST || !normalise(face->normal)) {
        hull->failed = true;
        return;
    }
    face->offset = enf_dot(face->normal, hull->points[a]);
    face->corner[0] = a;
    face->corner[1] = b;
    face->corner[2] = c;
    face->is_seen = face->is_gone = false;
    hull->face_of[a][b] = hull->face_of[b][c] = hull->face_of[c][a] = (int16_t)hull->face_count++;
}

/// Four points that span a tetrahedron: each the farthest from those before it. False if they are flat.
static bool find_first(const hull *hull, int32_t first[4]) {
    double farthest[3] = {0}, way[3], edge[3], normal[3];
    memset(first, 0, 4 * sizeof *first);
    for (int32_t i = 1; i < hull->count; i++) {
        subtract(hull->points[i], hull->points[0], way);
        if (enf_dot(way, way) > farthest[0]) farthest[0] = enf_dot(way, way), first[1] = i;
    }
    subtract(hull->points[first[1]], hull->points[0], edge);
    if (!normalise(edge)) return false;
    for (int32_t i = 1; i < hull->count; i++) {
        subtract(hull->points[i], hull->points[0], way);
        cross(edge, way, normal);
        if (enf_dot(normal, normal) > farthest[1]) farthest[1] = enf_dot(normal, normal), first[2] = i;
    }
    subtract(hull->points[first[2]], hull->points[0], way);
    cross(edge, way, normal);
    if (!normalise(normal)) return false;
    double height = 0;
    for (int32_t i = 1; i < hull->count; i++) {
        subtract(hull->points[i], hull->points[0], way);
        if (fabs(enf_dot(normal, way)) > farthest[2])
            farthest[2] = fabs(height = enf_dot(normal, way)), first[3] = i;
    }
    if (height > 0) { // the fourth has to lie behind the first three
        int32_t kept = first[1];
        first[1] = first[2];
        first[2] = kept;
    }
    return farthest[2] > 16 * hull->tolerance;
}

/// Takes off what the point sees, and joins it to the rim.
static void add_point(hull *hull, int32_t point) {
    int32_t count = hull->face_count;
    bool sees = false;
    for (int32_t i = 0; i < count; i++) {
        face *face = &hull->faces[i];
        face->is_seen = !face->is_gone && height_above(hull, face, point) > hull->tolerance;
        sees = sees || face->is_seen;
    }
    for (int32_t i = 0; sees && i < count && !hull->failed; i++) {
        face *face = &hull->faces[i];
        for (int k = 0; face->is_seen && k < 3 && !hull->failed; k++) {
            int32_t a = face->corner[k], b = face->corner[(k + 1) % 3];
            if (hull->face_of[b][a] < 0)
                hull->failed = true;
            else if (!hull->faces[hull->face_of[b][a]].is_seen)
                add_face(hull, a, b, point);
        }
    }
    for (int32_t i = 0; i < count; i++) {
        hull->faces[i].is_gone = hull->faces[i].is_gone || hull->faces[i].is_seen;
        hull->faces[i].is_seen = false;
    }
}

/// Closed, with all points behind all faces.
static bool is_right(const hull *hull) {
    for (int32_t i = 0; i < hull->face_count; i++) {
        const face *face = &hull->faces[i];
        if (face->is_gone) continue;
        for (int k = 0; k < 3; k++) {
            int32_t a = face->corner[k], b = face->corner[(k + 1) % 3];
            if (hull->face_of[a][b] != i || hull->face_of[b][a] < 0) return false;
            if (hull->faces[hull->face_of[b][a]].is_gone) return false;
        }
        for (int32_t p = 0; p < hull->count; p++)
            if (height_above(hull, face, p) > 4 * hull->tolerance) return false;
    }
    return true;
}

static bool make_hull(hull *hull, const double (*points)[3], int32_t count, double tolerance) {
    int32_t first[4];
    hull->points = points;
    hull->count = count;
    hull->tolerance = tolerance;
    hull->face_count = 0;
    hull->failed = count > POINTS_MOST;
    if (hull->failed || !find_first(hull, first)) return false;
    memset(hull->face_of, -1, sizeof hull->face_of);
    add_face(hull, first[0], first[1], first[2]);
    add_face(hull, first[0], first[2], first[3]);
    add_face(hull, first[2], first[1], first[3]);
    add_face(hull, first[1], first[0], first[3]);
    for (int32_t i = 0; i < count && !hull->failed; i++) add_point(hull, i);
    return !hull->failed && is_right(hull);
}

// ---------------------------------------------------------------------------------------------- the body

static void find_box(enf_body *body, const double (*points)[3], int32_t count) {
    for (int axis = 0; axis < 3; axis++) {
        double low = points[0][axis], high = low;
        for (int32_t i = 1; i < count; i++) {
            double at = points[i][axis];
            low = at < low ? at : low;
            high = at > high ? at : high;
        }
        body->middle[axis] = (low + high) / 2;
        body->half[axis] = (high - low) / 2 + 0x1p-50 * (fabs(low) + fabs(high));
    }
}

static void close_corners(enf_body *body, int32_t count) {
    body->corners.count = count;
    for (int axis = 0; axis < 3; axis++) {
        enf_outline_close(body->at[axis], count);
        body->corners.at[axis] = body->at[axis];
    }
}

/// Two faces that meet: their numbers and normals.
typedef struct meeting {
    int32_t faces[2];
    const double *normals[2]; ///< of the one to the left of the edge, seen from outside, and of the other
} meeting;

static void put_edge(enf_body *body, const double from[3], const double to[3], const meeting *meeting) {
    double along[3], left[3], right[3];
    subtract(to, from, along);
    cross(meeting->normals[0], along, left);
    cross(along, meeting->normals[1], right);
    if (!normalise(left) || !normalise(right)) return;
    int32_t index = body->edge_count++;
    for (int side = 0; side < 2; side++) {
        const int32_t face = meeting->faces[side];
        if (face < ENF_BODY_FACES && index < 64)
            body->edges[side][face / 4][1 << face % 4] |= UINT64_C(1) << index;
    }
    for (int axis = 0; axis < 3; axis++) {
        body->from[axis][index] = from[axis];
        body->along[axis][index] = along[axis];
        body->left[axis][index] = left[axis];
        body->right[axis][index] = right[axis];
    }
}

/// Repeats the first edge up to the next four.
static void close_edges(enf_body *body) {
    for (int32_t i = body->edge_count; body->edge_count > 0 && i % 4; i++)
        for (int axis = 0; axis < 3; axis++) {
            body->from[axis][i] = body->from[axis][0];
            body->along[axis][i] = body->along[axis][0];
            body->left[axis][i] = body->left[axis][0];
            body->right[axis][i] = body->right[axis][0];
        }
}

/// Fills up to the next four, and finds the edges of sets of faces from those of each.
static void close_faces(enf_body *body) {
    if (body->face_count > ENF_BODY_FACES || body->edge_count > 64) body->face_count = 0;
    for (int32_t i = body->face_count; i % 4; i++) {
        for (int axis = 0; axis < 3; axis++) body->normal[axis][i] = 0;
        body->offset[i] = 0;
        for (int side = 0; side < 2; side++) body->edges[side][i / 4][1 << i % 4] = 0;
    }
    for (int32_t group = 0; 4 * group < body->face_count; group++)
        for (int side = 0; side < 2; side++) {
            uint64_t *edges = body->edges[side][group];
            edges[0] = 0;
            for (int set = 1; set < 16; set++) edges[set] = edges[set & (set - 1)] | edges[set & -set];
        }
}

/// Faces that meet at an angle smaller than this are one.
static const double flat_angle = 0x1p-20;

static bool are_one(const face *face, const struct face *other) {
    double sine[3];
    cross(face->normal, other->normal, sine);
    return enf_dot(sine, sine) < flat_angle * flat_angle;
}

static void put_face(enf_body *body, const double normal[3], double offset) {
    const int32_t index = body->face_count++;
    if (index >= ENF_BODY_FACES) return;
    for (int axis = 0; axis < 3; axis++) body->normal[axis][index] = normal[axis];
    body->offset[index] = offset;
    for (int side = 0; side < 2; side++) body->edges[side][index / 4][1 << index % 4] = 0;
}

/// The number of the first face that each is one with.
static void number_faces(enf_body *body, const hull *hull, int32_t *numbers) {
    int32_t queue[FACES_MOST];
    for (int32_t i = 0; i < hull->face_count; i++) numbers[i] = -1;
    for (int32_t i = 0; i < hull->face_count; i++) {
        int32_t count = 0;
        if (hull->faces[i].is_gone || numbers[i] >= 0) continue;
        numbers[i] = body->face_count;
        queue[count++] = i;
        for (int32_t at = 0; at < count; at++) {
            const face *face = &hull->faces[queue[at]];
            for (int k = 0; k < 3; k++) {
                const int32_t next = hull->face_of[face->corner[(k + 1) % 3]][face->corner[k]];
                if (numbers[next] >= 0 || !are_one(face, &hull->faces[next])) continue;
                numbers[next] = body->face_count;
                queue[count++] = next;
            }
        }
        put_face(body, hull->faces[i].normal, hull->faces[i].offset);
    }
}

static bool take_hull(enf_body *body, const hull *hull) {
    bool is_corner[POINTS_MOST] = {false};
    int32_t count = 0, numbers[FACES_MOST];
    number_faces(body, hull, numbers);
    for (int32_t i = 0; i < hull->face_count; i++) {
        const face *face = &hull->faces[i];
        for (int k = 0; !face->is_gone && k < 3; k++) {
            int32_t a = face->corner[k], b = face->corner[(k + 1) % 3], opposite = hull->face_of[b][a];
            const struct face *other = &hull->faces[opposite];
            is_corner[a] = true;
            if (a > b || are_one(face, other)) continue;
            if (body->edge_count == ENF_BODY_EDGES - 4) return false;
            put_edge(body, hull->points[a], hull->points[b],
                     &(meeting){{numbers[i], numbers[opposite]}, {face->normal, other->normal}});
        }
    }
    for (int32_t i = 0; i < hull->count; i++) {
        if (!is_corner[i]) continue;
        if (count == ENF_BODY_CORNERS) return false;
        for (int axis = 0; axis < 3; axis++) body->at[axis][count] = hull->points[i][axis];
        count++;
    }
    close_corners(body, count);
    return true;
}

/// The box as the body.
static void take_box(enf_body *body) {
    double normals[6][3] = {{0}}; // up each axis, and down
    body->edge_count = body->face_count = 0;
    for (int k = 0; k < 6; k++) {
        normals[k][k % 3] = k < 3 ? 1 : -1;
        put_face(body, normals[k], normals[k][k % 3] * body->middle[k % 3] + body->half[k % 3]);
    }
    for (int i = 0; i < 8; i++)
        for (int axis = 0; axis < 3; axis++)
            body->at[axis][i] = body->middle[axis] + (i >> axis & 1 ? body->half[axis] : -body->half[axis]);
    for (int axis = 0; axis < 3; axis++)
        for (int i = 0; i < 4; i++) { // four edges along each axis
            int u = (axis + 1) % 3, v = (axis + 2) % 3, low = (i & 1) << u | (i >> 1) << v,
                high = low | 1 << axis;
            const int one = i & 1 ? u : 3 + u, other = i >> 1 ? v : 3 + v;
            double from[3], to[3];
            for (int k = 0; k < 3; k++) {
                from[k] = body->at[k][low];
                to[k] = body->at[k][high];
            }
            const bool turns = (i & 1) == i >> 1; // the first face has to lie to the left of the edge
            const int left = turns ? one : other, right = turns ? other : one;
            put_edge(body, from, to, &(meeting){{left, right}, {normals[left], normals[right]}});
        }
    close_corners(body, 8);
}

/// Keeps the corners of a hull of some points. Returns how many.
static int32_t keep_corners(const hull *hull, double (*points)[3], int32_t count) {
    bool is_corner[POINTS_MOST] = {false};
    int32_t made = 0;
    for (int32_t i = 0; i < hull->face_count; i++)
        for (int k = 0; !hull->faces[i].is_gone && k < 3; k++) is_corner[hull->faces[i].corner[k]] = true;
    for (int32_t i = 0; i < count; i++)
        if (is_corner[i]) memmove(points[made++], points[i], sizeof *points);
    return made;
}

static bool is_outside(const hull *hull, const double point[3]) {
    for (int32_t i = 0; i < hull->face_count; i++) {
        const face *face = &hull->faces[i];
        if (!face->is_gone && enf_dot(face->normal, point) - face->offset > hull->tolerance) return true;
    }
    return false;
}

/// The farthest points along the axes and the diagonals, both ways: of most others they leave nothing.
static int32_t take_farthest(const double (*points)[3], int32_t count, double (*kept)[3]) {
    static const double ways[][3] = {{1, 0, 0},  {0, 1, 0},  {0, 0, 1},  {1, 1, 1},
                                     {1, 1, -1}, {1, -1, 1}, {1, -1, -1}};
    int32_t made = 0;
    for (size_t k = 0; k < sizeof ways / sizeof *ways; k++) {
        int32_t low = 0, high = 0;
        double lowest = enf_dot(ways[k], points[0]), highest = lowest;
        for (int32_t i = 1; i < count; i++) {
            const double at = enf_dot(ways[k], points[i]);
            if (at < lowest) lowest = at, low = i;
            if (at > highest) highest = at, high = i;
        }
        memcpy(kept[made++], points[low], sizeof *kept);
        memcpy(kept[made++], points[high], sizeof *kept);
    }
    return made;
}

/// Of some points the farthest, and then as many as a hull is made of; where there are more, the corners of a
/// hull of some, and others outside of it, in some rounds. Returns how many there are, or -1 if their hull
/// has too many corners.
static int32_t thin_out(hull *hull, const double (*points)[3], int32_t count, double tolerance,
                        double (*kept)[3]) {
    int32_t made = take_farthest(points, count, kept), next = 0;
    for (int round = 0; round < ROUNDS_MOST; round++) {
        for (; made < POINTS_MOST && next < count; next++)
            if (round == 0 || is_outside(hull, points[next]))
                memcpy(kept[made++], points[next], sizeof *kept);
        if (next == count) return made;
        if (!make_hull(hull, (const double(*)[3])kept, made, tolerance)) return -1;
        made = keep_corners(hull, kept, made);
    }
    return -1;
}

void enf_body_make(enf_body *body, const double (*points)[3], int32_t count, double tolerance) {
    hull hull;
    double kept[POINTS_MOST][3];
    find_box(body, points, count);
    body->edge_count = body->face_count = 0;
    const int32_t made = thin_out(&hull, points, count, tolerance / ROUNDS_MOST, kept);
    if (made < 0 || !make_hull(&hull, (const double(*)[3])kept, made, tolerance) || !take_hull(body, &hull))
        take_box(body);
    close_edges(body);
    close_faces(body);
}
