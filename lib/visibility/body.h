// SPDX-License-Identifier: GPL-3.0-or-later
// A convex body that sight lines come from: corners and edges of its hull, made ready for separating planes.
#ifndef ENF_VISIBILITY_BODY_H
#define ENF_VISIBILITY_BODY_H

#include "visibility/window.h"

enum {
    ENF_BODY_CORNERS = 64, ///< a body that has more becomes the box around it
    ENF_BODY_EDGES = 3 * ENF_BODY_CORNERS,
    ENF_BODY_FACES = 64
};

typedef struct enf_body {
    enf_outline corners;       ///< in any order, closed as outlines are
    double middle[3], half[3]; ///< the box around them

    /// The edges where it has an angle; coordinates by axis, up to the next four.
    int32_t edge_count;
    double from[3][ENF_BODY_EDGES], along[3][ENF_BODY_EDGES]; ///< an end, and the way to the other
    double left[3][ENF_BODY_EDGES],
        right[3][ENF_BODY_EDGES]; ///< square to the edge into the two faces, of length 1: all of the body
                                  ///< lies in the wedge between them

    int32_t face_count; ///< 0: they, or the edges, are too many, and they are not known
    double normal[3][ENF_BODY_FACES], offset[ENF_BODY_FACES]; ///< up to the next four; of length 1

    /// Bit by bit, the edges that have some of four faces to the left, and to the right, for all sets of
    /// these.
    uint64_t edges[2][ENF_BODY_FACES / 4][16];
    double at[3][ENF_BODY_CORNERS + ENF_OUTLINE_MORE];
} enf_body;

/// Makes the body of some points: their hull, or, where rounding or the number of its corners makes that
/// doubtful, the box around them. Corners within the tolerance of the hull of others are left out. `count` is
/// at least 1.
void enf_body_make(enf_body *body, const double (*points)[3], int32_t count, double tolerance);

#endif
