// SPDX-License-Identifier: MIT
// Sizes, images and nesting of shapes.
#include "run/shape.h"

#include "run/vector.h"

#include <float.h>
#include <math.h>
#include <string.h>

#define ROUNDING \
    0x1p-40 // far above the rounding of a few dozen operations, far below any distance that counts

static bool is_size(double size) {
    return size >= 0 && size <= DBL_MAX;
}

bool enf_shape_is_valid(const enf_shape *shape) {
    const double *half = shape->half;
    return (unsigned)shape->kind <= ENF_SHAPE_BOX && enf_are_finite(shape->centre, 3) &&
           is_size(shape->radius) && is_size(half[0]) && is_size(half[1]) && is_size(half[2]);
}

enf_status enf_shape_take(enf_shape *shape, const enf_shape *given, enf_error *error) {
    *shape = *given;
    if (shape->kind != ENF_SHAPE_SPHERE) shape->radius = 0;
    if (shape->kind != ENF_SHAPE_BOX) memset(shape->half, 0, sizeof shape->half);
    if (enf_shape_is_valid(shape)) return ENF_OK;
    return enf_fail(error, ENF_BAD_USAGE, "a shape must be finite, and its size must not be negative");
}

double enf_shape_reach(const enf_shape *shape) {
    if (shape->kind == ENF_SHAPE_SPHERE) return shape->radius;
    const double *h = shape->half;
    return sqrt(h[0] * h[0] + h[1] * h[1] + h[2] * h[2]) * (1 + ROUNDING);
}

/// By how much the linear part makes a length longer at most: the root of a bound (S. Gerschgorin, 1931) of
/// the largest eigenvalue of its square. Exact for rotations, reflections and even scales.
static double largest_stretch(const double m[12]) {
    double most = 0;
    for (int i = 0; i < 3; i++) {
        double row = 0;
        for (int k = 0; k < 3; k++) row += fabs(m[i] * m[k] + m[4 + i] * m[4 + k] + m[8 + i] * m[8 + k]);
        most = fmax(most, row);
    }
    return sqrt(most) * (1 + ROUNDING);
}

enf_shape enf_shape_image(const enf_shape *shape, const double matrix[12]) {
    enf_shape image = {.kind = shape->kind};
    for (int a = 0; a < 3; a++) {
        const double *row = matrix + 4 * a, *c = shape->centre, *h = shape->half;
        image.centre[a] = row[0] * c[0] + row[1] * c[1] + row[2] * c[2] + row[3];
        if (shape->kind == ENF_SHAPE_BOX)
            image.half[a] =
                (fabs(row[0]) * h[0] + fabs(row[1]) * h[1] + fabs(row[2]) * h[2]) * (1 + ROUNDING);
    }
    if (shape->kind == ENF_SHAPE_SPHERE) image.radius = shape->radius * largest_stretch(matrix);
    return image;
}

bool enf_shape_holds(const enf_shape *outer, const enf_shape *inner) {
    double square = 0, size = fabs(outer->radius);
    bool holds = true;
    for (int a = 0; a < 3; a++) size = fmax(size, fmax(fabs(outer->centre[a]), outer->half[a]));
    double slack = size * 4 * ROUNDING;
    for (int a = 0; a < 3; a++) {
        double away = fabs(outer->centre[a] - inner->centre[a]);
        square += away * away;
        holds = holds && away + inner->half[a] <= outer->half[a] + slack;
    }
    return outer->kind == ENF_SHAPE_BOX ? holds : sqrt(square) + inner->radius <= outer->radius + slack;
}
