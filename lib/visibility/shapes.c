// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/shapes.h"

#include "base/array.h"
#include "visibility/winding.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double relative_tolerance = 0x1p-42;

/// A winding without an area has no plane: nothing is behind it, nothing is in front.
static void make_plane(enf_shape *shape, const double (*corners)[3], int32_t count) {
    for (int axis = 0; axis < 3; axis++) {
        double sum = 0;
        for (int32_t i = 0; i < count; i++) sum += corners[i][axis];
        shape->centre[axis] = sum / count;
    }
    if (!enf_winding_normal(corners, count, shape->normal)) memset(shape->normal, 0, sizeof shape->normal);
    shape->offset = enf_dot(shape->normal, shape->centre);
}

static void make_axes(enf_shape *shape) {
    const double *normal = shape->normal;
    int along = 0;
    for (int axis = 1; axis < 3; axis++)
        if (fabs(normal[axis]) > fabs(normal[along])) along = axis;
    int turned = normal[along] < 0;
    shape->axes[turned] = (along + 1) % 3;
    shape->axes[!turned] = (along + 2) % 3;
}

static void make_sphere(enf_shape *shape, const double (*corners)[3], int32_t count) {
    double square = 0;
    for (int32_t i = 0; i < count; i++) {
        double way[3];
        for (int axis = 0; axis < 3; axis++) way[axis] = corners[i][axis] - shape->centre[axis];
        square = fmax(square, enf_dot(way, way));
    }
    shape->radius = sqrt(square) * (1 + 0x1p-40);
}

/// The middle of the outline's box, and its size: a hair more than half, as heights of the two are rounded.
static void make_middle(enf_shape *shape, const double (*corners)[3], int32_t count) {
    for (int axis = 0; axis < 3; axis++) {
        double low = corners[0][axis], high = low;
        for (int32_t i = 1; i < count; i++) {
            low = fmin(low, corners[i][axis]);
            high = fmax(high, corners[i][axis]);
        }
        shape->middle[axis] = low / 2 + high / 2;
        shape->half[axis] = (high / 2 - low / 2) * (1 + 0x1p-40) + fabs(shape->middle[axis]) * 0x1p-46;
    }
}

static void make_box(enf_shape *shape, const double (*corners)[3], int32_t count) {
    shape->flat_axis = -1;
    for (int axis = 0; axis < 3; axis++) {
        shape->low[axis] = shape->high[axis] = corners[0][axis];
        for (int32_t i = 1; i < count; i++) {
            shape->low[axis] = fmin(shape->low[axis], corners[i][axis]);
            shape->high[axis] = fmax(shape->high[axis], corners[i][axis]);
        }
        if (shape->low[axis] == shape->high[axis]) shape->flat_axis = axis;
    }
}

/// The rectangle around the winding in its plane.
static void make_rectangle(const enf_shape *shape, const double (*corners)[3], int32_t count,
                           double rectangle[4][3]) {
    double along[3] = {0}, across[3], low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    const double *n = shape->normal;
    int u = shape->axes[0], v = shape->axes[1], w = 3 - u - v;
    double length = hypot(n[w], n[u]);
    along[u] = n[w] / length, along[w] = -n[u] / length;
    across[0] = n[1] * along[2] - n[2] * along[1];
    across[1] = n[2] * along[0] - n[0] * along[2];
    across[2] = n[0] * along[1] - n[1] * along[0];
    for (int32_t i = 0; i < count; i++) {
        double at[2] = {enf_dot(along, corners[i]), enf_dot(across, corners[i])};
        for (int a = 0; a < 2; a++) low[a] = fmin(low[a], at[a]), high[a] = fmax(high[a], at[a]);
    }
    for (int i = 0; i < 4; i++) {
        double a = i == 0 || i == 3 ? low[0] : high[0], b = i < 2 ? low[1] : high[1];
        for (int axis = 0; axis < 3; axis++)
            rectangle[i][axis] = shape->offset * n[axis] + a * along[axis] + b * across[axis];
    }
}

/// How far the corners are from the plane.
static double measure_bend(const enf_shape *shape, const double (*corners)[3], int32_t count) {
    double bend = 0;
    for (int32_t i = 0; i < count; i++)
        bend = fmax(bend, fabs(enf_dot(shape->normal, corners[i]) - shape->offset));
    return bend;
}

static void make_outline(enf_shapes *shapes, int32_t opening) {
    const double(*corners)[3] = enf_shape_corners(shapes, opening);
    const enf_outline outline = enf_shape_outline(shapes, opening);
    for (int axis = 0; axis < 3; axis++) {
        double *along = shapes->outlines + (outline.at[axis] - shapes->outlines);
        for (int32_t i = 0; i < outline.count; i++) along[i] = corners[i][axis];
        enf_outline_close(along, outline.count);
    }
}

static void make_shape(enf_shapes *shapes, int32_t opening, int32_t *first, double *bend) {
    const enf_portal_graph *graph = shapes->graph;
    enf_shape *shape = &shapes->shapes[opening];
    const double(*corners)[3] = (const double(*)[3])graph->corners + graph->opening_corner[opening];
    int32_t count = graph->opening_corner[opening + 1] - graph->opening_corner[opening];
    make_plane(shape, corners, count);
    make_axes(shape);
    make_box(shape, corners, count);
    *bend = fmax(*bend, measure_bend(shape, corners, count));
    shape->first = *first;
    shape->count = count;
    if (count <= ENF_WINDING_CORNERS_MAX) {
        memcpy(shapes->corners + *first, corners, (size_t)count * sizeof *corners);
    } else {
        shape->count = 4;
        make_rectangle(shape, corners, count, shapes->corners + *first);
    }
    *first += shape->count;
    make_sphere(shape, enf_shape_corners(shapes, opening), shape->count);
    make_middle(shape, enf_shape_corners(shapes, opening), shape->count);
    make_outline(shapes, opening);
}

/// The least power of two that no coordinate exceeds.
static double measure_size(const enf_portal_graph *graph) {
    double largest = 0;
    for (int32_t i = 0; i < graph->opening_corner[graph->opening_count]; i++)
        for (int axis = 0; axis < 3; axis++) largest = fmax(largest, fabs(graph->corners[i][axis]));
    int exponent;
    frexp(largest, &exponent);
    return largest > 0 ? ldexp(1, exponent) : 1;
}

bool enf_shapes_make(enf_shapes *shapes, const enf_portal_graph *graph) {
    size_t corners = (size_t)graph->opening_corner[graph->opening_count];
    *shapes = (enf_shapes){.graph = graph};
    shapes->shapes = enf_array_zeroed((size_t)graph->opening_count, sizeof *shapes->shapes);
    shapes->corners = enf_array_zeroed(corners + ENF_OUTLINE_MORE, sizeof *shapes->corners);
    shapes->outlines = enf_array_zeroed(corners + ENF_OUTLINE_MORE * ((size_t)graph->opening_count + 1),
                                        3 * sizeof *shapes->outlines);
    if (!shapes->shapes || !shapes->corners || !shapes->outlines) return false;
    double size = measure_size(graph), bend = 0;
    int32_t first = 0;
    for (int32_t k = 0; k < graph->opening_count; k++) make_shape(shapes, k, &first, &bend);
    shapes->tolerance = size * relative_tolerance + 4 * bend;
    shapes->extent = 4 * size;
    return true;
}

void enf_shapes_free(enf_shapes *shapes) {
    free(shapes->shapes);
    free(shapes->corners);
    free(shapes->outlines);
    memset(shapes, 0, sizeof *shapes);
}

enf_cut enf_shape_cut(const enf_shapes *shapes, int32_t portal) {
    const enf_shape *shape = &shapes->shapes[portal >> 1];
    double sign = portal & 1 ? -1 : 1;
    return (enf_cut){.normal = {sign * shape->normal[0], sign * shape->normal[1], sign * shape->normal[2]},
                     .least = sign * shape->offset - shapes->tolerance};
}
