// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/separator.h"

#include "visibility/contact.h"

#include <math.h>

typedef struct tangent {
    double normal[3]; ///< length 1
    double tilt;      ///< how far the plane may move, anywhere in the world, if its corners move by 1
} tangent;

/// The plane through the edge from a to b that touches the window, which is on its front side: of the planes
/// through the edge and a corner, the one that has no other corner behind it.
static bool find_tangent(const double a[3], const double b[3], const enf_window *window, double extent,
                         tangent *tangent) {
    double edge[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, normal[3] = {0}, arm = 0;
    for (int32_t i = 0; i < window->count; i++) {
        const double *corner = window->corners[i];
        double way[3] = {corner[0] - a[0], corner[1] - a[1], corner[2] - a[2]};
        if (i > 0 && enf_dot(normal, way) >= 0) continue;
        normal[0] = edge[1] * way[2] - edge[2] * way[1];
        normal[1] = edge[2] * way[0] - edge[0] * way[2];
        normal[2] = edge[0] * way[1] - edge[1] * way[0];
        arm = fabs(way[0]) + fabs(way[1]) + fabs(way[2]);
    }
    arm += fabs(edge[0]) + fabs(edge[1]) + fabs(edge[2]);
    double square = enf_dot(normal, normal), inverse = 1 / sqrt(square);
    if (!(square > 0) || !(inverse < HUGE_VAL)) return false;
    for (int axis = 0; axis < 3; axis++) tangent->normal[axis] = normal[axis] * inverse;
    tangent->tilt = 2 + 2 * arm * extent * inverse;
    return true;
}

/// (fmax would be a call here, for the sake of NaN.)
static double highest(const enf_window *window, const double normal[3]) {
    double highest = enf_dot(normal, window->corners[0]);
    for (int32_t i = 1; i < window->count; i++) {
        double height = enf_dot(normal, window->corners[i]);
        if (height > highest) highest = height;
    }
    return highest;
}

static double lowest(const enf_window *window, const double normal[3]) {
    double lowest = enf_dot(normal, window->corners[0]);
    for (int32_t i = 1; i < window->count; i++) {
        double height = enf_dot(normal, window->corners[i]);
        if (height < lowest) lowest = height;
    }
    return lowest;
}

/// Corners this near to a plane may touch it. Points of a window next to the plane, but for its tolerance,
/// are not further from those corners than 2^-14 of the window's size, or so.
static const double band_tolerances = 0x1p14;

/// Of the size of the world: spheres nearer to each other than `near` are looked at closely; contacts may be
/// nearer than they look by `contact_error`, as corners within the band count for all that is near them.
static const double near = 0x1p-12, contact_error = 0x1p-30;

/// Two windows and the way between them.
typedef struct passage {
    const enf_shapes *shapes;
    const enf_window *one, *other; ///< planes go through the edges of one
    bool turns;                    ///< one turns counter-clockwise against the sight
    bool forward;                  ///< sight goes from one to other
    double gap;                    ///< the windows are at least this far apart; negative: no telling
} passage;

/// What a plane must leave over. A point of a window may be off by the tolerance, so a line may come through
/// the plane the wrong way, by that much on the way between the windows where both touch the plane, and go on
/// so to the end of the world: where windows touch each other at the plane, the plane says nothing.
static double find_slack(const passage *passage, const tangent *tangent) {
    const enf_shapes *shapes = passage->shapes;
    double distance = passage->gap;
    if (distance < shapes->extent * near) {
        distance = enf_contact_distance(passage->one, passage->other, tangent->normal,
                                        band_tolerances * shapes->tolerance);
        distance -= shapes->extent * contact_error;
    }
    if (!(distance > 0)) return HUGE_VAL;
    return shapes->tolerance * (tangent->tilt + 4 * shapes->extent / distance);
}

static void add_planes(enf_separators *separators, const passage *passage) {
    const enf_window *one = passage->one;
    for (int32_t i = 0; i < one->count && separators->count < ENF_SEPARATORS_MOST; i++) {
        int32_t next = i + 1 < one->count ? i + 1 : 0;
        const double *a = one->corners[passage->turns ? i : next],
                     *b = one->corners[passage->turns ? next : i];
        tangent tangent;
        if (!find_tangent(a, b, passage->other, passage->shapes->extent, &tangent)) continue;
        double behind = highest(one, tangent.normal), front = lowest(passage->other, tangent.normal);
        if (behind > front + passage->shapes->tolerance) continue;
        double slack = find_slack(passage, &tangent);
        if (slack > passage->shapes->extent) continue;
        enf_cut *cut = &separators->cuts[separators->count++];
        for (int axis = 0; axis < 3; axis++)
            cut->normal[axis] = passage->forward ? tangent.normal[axis] : -tangent.normal[axis];
        cut->least = (passage->forward ? front : -behind) - slack;
    }
}

static double find_gap(const enf_shapes *shapes, int32_t portal, int32_t other) {
    const enf_shape *one = &shapes->shapes[portal >> 1], *two = &shapes->shapes[other >> 1];
    double way[3];
    for (int axis = 0; axis < 3; axis++) way[axis] = one->centre[axis] - two->centre[axis];
    return sqrt(enf_dot(way, way)) - one->radius - two->radius;
}

void enf_separators_begin(enf_separators *separators, const enf_shapes *shapes, int32_t from_portal) {
    separators->count = 1;
    separators->cuts[0] = enf_shape_cut(shapes, from_portal);
}

void enf_separators_find(enf_separators *separators, const enf_shapes *shapes, const enf_window *from,
                         int32_t from_portal, const enf_window *to, int32_t to_portal) {
    enf_separators_begin(separators, shapes, from_portal);
    passage passage = {.shapes = shapes,
                       .one = from,
                       .other = to,
                       .turns = !(from_portal & 1),
                       .forward = true,
                       .gap = find_gap(shapes, from_portal, to_portal)};
    add_planes(separators, &passage);
    passage.one = to;
    passage.other = from;
    passage.turns = to_portal & 1;
    passage.forward = false;
    add_planes(separators, &passage);
}

/// False if some cut leaves nothing of the sphere. *needed receives the cuts that may take something.
static bool meets_sphere(const enf_separators *separators, const enf_shape *shape, uint64_t *needed) {
    *needed = 0;
    for (int32_t i = 0; i < separators->count; i++) {
        const enf_cut *cut = &separators->cuts[i];
        double height = enf_dot(cut->normal, shape->centre) - cut->least;
        if (height < -shape->radius) return false;
        if (height < shape->radius) *needed |= UINT64_C(1) << i;
    }
    return true;
}

enf_remains enf_separators_pass(const enf_separators *separators, const enf_shapes *shapes, int32_t portal,
                                enf_window *window) {
    uint64_t needed;
    if (!meets_sphere(separators, &shapes->shapes[portal >> 1], &needed)) return ENF_REMAINS_NOTHING;
    enf_shape_window(shapes, portal, window);
    enf_remains remains = ENF_REMAINS_WHOLE;
    for (; needed; needed &= needed - 1) {
        enf_remains now = enf_window_cut(window, &separators->cuts[__builtin_ctzll(needed)]);
        if (now == ENF_REMAINS_NOTHING) return now;
        if (now == ENF_REMAINS_PART) remains = now;
    }
    return remains;
}

bool enf_separators_meet(const enf_separators *separators, const double (*points)[3], int32_t count) {
    for (int32_t i = 0; i < separators->count; i++) {
        const enf_cut *cut = &separators->cuts[i];
        int32_t k = 0;
        while (k < count && enf_dot(cut->normal, points[k]) < cut->least) k++;
        if (k == count) return false;
    }
    return true;
}
