// SPDX-License-Identifier: GPL-3.0-or-later
// What traversal needs of each opening, made once and read by all threads: plane, outline, sphere.
#ifndef ENF_VISIBILITY_SHAPES_H
#define ENF_VISIBILITY_SHAPES_H

#include "visibility/portal_graph.h"
#include "visibility/window.h"

typedef struct enf_shape {
    double normal[3], offset;  ///< the plane of portal 2k, normal of length 1
    double centre[3], radius;  ///< a sphere around the corners
    double low[3], high[3];    ///< the box of its corners
    double middle[3], half[3]; ///< the same, and a bit: from its middle, this far along each axis
    int32_t flat_axis;         ///< all corners have the same coordinate along this axis; -1: no such axis
    int32_t first, count;      ///< of its corners in corners; they are those of the outline
    int32_t axes[2];           ///< seen along the third axis (from its far end) it turns counter-clockwise
} enf_shape;

typedef struct enf_shapes {
    const enf_portal_graph *graph; ///< not owned
    enf_shape *shapes;             ///< per opening
    double (*corners)[3]; ///< of outlines: the windings, or a rectangle around one with over 64; four more
    double *outlines;     ///< the same as outlines, three times count + ENF_OUTLINE_MORE a piece

    // World units, both.
    double tolerance; ///< of windows and planes: 2^-42 of the largest coordinate, and how far windings are
                      ///< from planar; a power of two times that of a world of another scale
    double extent;    ///< no two corners are farther apart
} enf_shapes;

/// False without memory; free it in any case.
bool enf_shapes_make(enf_shapes *shapes, const enf_portal_graph *graph);
void enf_shapes_free(enf_shapes *shapes);

static inline const double (*enf_shape_corners(const enf_shapes *shapes, int32_t opening))[3] {
    return (const double(*)[3])shapes->corners + shapes->shapes[opening].first;
}

static inline enf_outline enf_shape_outline(const enf_shapes *shapes, int32_t opening) {
    const size_t first = (size_t)shapes->shapes[opening].first, count = (size_t)shapes->shapes[opening].count,
                 places = count + ENF_OUTLINE_MORE;
    const double *x = shapes->outlines + 3 * (first + ENF_OUTLINE_MORE * (size_t)opening);
    return (enf_outline){(int32_t)count, {x, x + places, x + 2 * places}};
}

/// The whole outline of a directed portal's opening as a window.
static inline void enf_shape_window(const enf_shapes *shapes, int32_t portal, enf_window *window) {
    const enf_outline outline = enf_shape_outline(shapes, portal >> 1);
    enf_window_take(window, &outline);
}

/// The height of a point above the plane of a directed portal: positive beyond it.
static inline double enf_shape_height(const enf_shapes *shapes, int32_t portal, const double point[3]) {
    const enf_shape *shape = &shapes->shapes[portal >> 1];
    double height = enf_dot(shape->normal, point) - shape->offset;
    return portal & 1 ? -height : height;
}

/// The cut that keeps what lies beyond a directed portal.
enf_cut enf_shape_cut(const enf_shapes *shapes, int32_t portal);

#endif
