// SPDX-License-Identifier: MIT
// Spheres and boxes against portals and triangles.
#ifndef ENF_RUN_SHAPE_H
#define ENF_RUN_SHAPE_H

#include "enfilade/query.h"

/// A convex polygon, counter-clockwise about its normal.
typedef struct enf_face {
    const double (*vertices)[3];
    int32_t count;     ///< at least 3
    double normal[3];  ///< of length 1; zero: unknown, the polygon has no area
    const double *cut; ///< null, or a plane: the polygon is what lies on its positive side
} enf_face;

/// Takes a caller's shape: what its kind has no use for becomes 0. ENF_BAD_USAGE if it is not valid.
enf_status enf_shape_take(enf_shape *shape, const enf_shape *given, enf_error *error);

/// Finite, and of no negative size, also what its kind has no use for.
bool enf_shape_is_valid(const enf_shape *shape);

/// The radius of a sphere about the centre that holds the shape.
double enf_shape_reach(const enf_shape *shape);

/// True if they have a point in common, or nearly: `slack` is a distance that still counts as none. Boxes may
/// be taken to meet polygons of more than 20 corners that they only come near, and polygons without area.
bool enf_shape_meets_face(const enf_shape *shape, const enf_face *face, double slack);

/// A shape of the same kind around matrix * shape (3 x 4, row by row).
enf_shape enf_shape_image(const enf_shape *shape, const double matrix[12]);

/// True if `inner` lies within `outer`, up to rounding.
bool enf_shape_holds(const enf_shape *outer, const enf_shape *inner);

#endif
