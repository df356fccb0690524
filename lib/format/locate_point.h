// SPDX-License-Identifier: MIT
// A point that is being located, and how it lies to single tetrahedra. All sides are exact.
#ifndef ENF_FORMAT_LOCATE_POINT_H
#define ENF_FORMAT_LOCATE_POINT_H

#include "enfilade/format.h"

typedef struct enf_locating {
    const enf_file_view *view;
    double at[3]; ///< whole numbers of the finer grid: grid coordinates times frame->locate_scale
    int32_t best; ///< fine cell, or -1
    int32_t best_tetrahedron;
} enf_locating;

/// The face opposite to corner k has these corners, which turn counter-clockwise seen from inside.
extern const int enf_face_corner[4][3];

/// A point of the world as seen from the one that is being located, on the finer grid.
static inline void enf_locating_relative(const enf_locating *point, int32_t other, double out[3]) {
    const double *from = point->view->points[other], scale = point->view->frame->locate_scale;
    out[0] = from[0] * scale - point->at[0];
    out[1] = from[1] * scale - point->at[1];
    out[2] = from[2] * scale - point->at[2];
}

static inline double enf_locating_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void enf_locating_cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/// +1 strictly inside the tetrahedron, 0 on its boundary, -1 outside. *away: a face that has the point
/// outside, the first one that is found from face `first` on. `known`: faces that count as having it inside,
/// a bit for each.
int enf_locating_side(const enf_locating *point, int32_t tetrahedron, int known, int first, int *away);

/// The faces whose planes hold the point, a bit for each; -1: it is outside.
int enf_locating_faces(const enf_locating *point, int32_t tetrahedron);

/// Considers every fine cell of the tetrahedron that touches the point.
void enf_locating_descend(enf_locating *point, int32_t tetrahedron);

/// Considers every fine cell around a point on the border of a tetrahedron. False: there are too many
/// tetrahedra around the point, and nothing was considered.
bool enf_locating_star(enf_locating *point, int32_t tetrahedron);

/// Considers every fine cell that touches the point; finds all by itself.
void enf_locating_search(enf_locating *point);

/// Is the point farther outside than rounding explains, for sure, where it is outside a face of the hull?
bool enf_locating_is_far(const enf_locating *point, int32_t tetrahedron, int face);

/// No tetrahedron holds the point, but it may lie outside the hull by rounding only: takes the nearest, if it
/// is near enough. Begins at one that is near. False: there are too many around.
bool enf_locating_nearest(enf_locating *point, int32_t tetrahedron);

/// The same; finds all by itself.
void enf_locating_search_nearest(enf_locating *point);

#endif
