// SPDX-License-Identifier: MIT
#include "format/locate_point.h"

#include "base/exact.h"

#include <math.h>

#define BRANCHES_MAX \
    64 // cut planes of one tetrahedron that go through the point; more are not followed twice

/// A determinant of four points of the finer grid is not off by more (base/exact.c).
#define SURE 0x1p115

const int enf_face_corner[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};

static void load_point(const enf_locating *point, int32_t other, double out[3]) {
    const double *from = point->view->points[other], scale = point->view->frame->locate_scale;
    for (int a = 0; a < 3; a++) out[a] = from[a] * scale;
}

static double larger(double a, double b) {
    return a > b ? a : b;
}

/// How the point lies to the plane through three others, by the volume that they span as seen from it if that
/// leaves no doubt.
static int side_of(const enf_locating *point, const int32_t through[3], double volume) {
    if (fabs(volume) > SURE) return volume < 0 ? 1 : -1;
    double a[3], b[3], c[3];
    load_point(point, through[0], a);
    load_point(point, through[1], b);
    load_point(point, through[2], c);
    return enf_points_orient(a, b, c, point->at);
}

/// The volumes that the faces span with the point, negative inside. Rounded.
static inline void find_volumes(const enf_locating *point, int32_t tetrahedron, double volume[4]) {
    const int32_t *corners = point->view->tetrahedra[tetrahedron];
    double at[4][3], one[3], other[3];
    enf_locating_relative(point, corners[0], at[0]);
    enf_locating_relative(point, corners[1], at[1]);
    enf_locating_relative(point, corners[2], at[2]);
    enf_locating_relative(point, corners[3], at[3]);
    enf_locating_cross(at[2], at[3], one);
    enf_locating_cross(at[0], at[1], other);
    volume[0] = -enf_locating_dot(at[1], one);
    volume[1] = enf_locating_dot(at[0], one);
    volume[2] = -enf_locating_dot(at[3], other);
    volume[3] = enf_locating_dot(at[2], other);
}

static int side_of_face(const enf_locating *point, int32_t tetrahedron, int face, double volume) {
    const int32_t *corners = point->view->tetrahedra[tetrahedron];
    const int *pick = enf_face_corner[face];
    return side_of(point, (const int32_t[3]){corners[pick[0]], corners[pick[1]], corners[pick[2]]}, volume);
}

int enf_locating_side(const enf_locating *point, int32_t tetrahedron, int known, int first, int *away) {
    double volume[4];
    find_volumes(point, tetrahedron, volume);
    if (larger(larger(volume[0], volume[1]), larger(volume[2], volume[3])) < -SURE) return 1;
    int least = 1;
    for (int i = 0; i < 4; i++) {
        int face = (first + i) % 4;
        if (known >> face & 1) continue;
        int side = side_of_face(point, tetrahedron, face, volume[face]);
        if (side < 0) {
            *away = face;
            return -1;
        }
        if (side < least) least = side;
    }
    return least;
}

/// The corner of the tetrahedron that the point is; -1: none.
static int corner_at(const enf_locating *point, int32_t tetrahedron) {
    for (int k = 0; k < 4; k++) {
        double at[3];
        enf_locating_relative(point, point->view->tetrahedra[tetrahedron][k], at);
        if (at[0] == 0 && at[1] == 0 && at[2] == 0) return k;
    }
    return -1;
}

int enf_locating_faces(const enf_locating *point, int32_t tetrahedron) {
    double volume[4];
    int faces = 0, corner = corner_at(point, tetrahedron);
    if (corner >= 0) return 15 & ~(1 << corner);
    find_volumes(point, tetrahedron, volume);
    for (int face = 0; face < 4; face++) {
        int side = side_of_face(point, tetrahedron, face, volume[face]);
        if (side < 0) return -1;
        if (side == 0) faces |= 1 << face;
    }
    return faces;
}

/// Of a plane through two points and parallel to an axis.
static int axis_plane_side(const enf_locating *point, const int32_t through[3]) {
    const int axis = -1 - through[2];
    double a[3], b[3], c[3];
    // One step of the finer grid along the axis, or against it at the very edge of the range.
    load_point(point, through[0], a);
    load_point(point, through[1], b);
    for (int i = 0; i < 3; i++) c[i] = a[i];
    double step = a[axis] < 0 ? 1 : -1;
    c[axis] += step;
    return enf_points_orient(a, b, c, point->at) * (int)step;
}

static int plane_side(const enf_locating *point, const int32_t through[3], double volume) {
    return through[2] < 0 ? axis_plane_side(point, through) : side_of(point, through, volume);
}

/// The volume that a plane's points span with the point, if there are three of them.
static inline double plane_volume(const enf_locating *point, const int32_t through[3]) {
    double a[3], b[3], c[3], across[3];
    if (through[2] < 0) return 0;
    enf_locating_relative(point, through[0], a);
    enf_locating_relative(point, through[1], b);
    enf_locating_relative(point, through[2], c);
    enf_locating_cross(b, c, across);
    return enf_locating_dot(a, across);
}

/// Cells before discarded space, then the lower number; then the lower tetrahedron.
static void consider(enf_locating *point, int32_t tetrahedron, int32_t fine) {
    const int32_t *cell = point->view->fine_cell;
    int32_t best = point->best;
    if (fine == best) {
        if (tetrahedron < point->best_tetrahedron) point->best_tetrahedron = tetrahedron;
        return;
    }
    if (best < 0 || (cell[fine] >= 0) > (cell[best] >= 0) ||
        ((cell[fine] >= 0) == (cell[best] >= 0) && fine < best)) {
        point->best = fine;
        point->best_tetrahedron = tetrahedron;
    }
}

void enf_locating_descend(enf_locating *point, int32_t tetrahedron) {
    const enf_file_view *view = point->view;
    int32_t waiting[BRANCHES_MAX];
    int count = 0;
    waiting[count++] = view->tetrahedron_root[tetrahedron];
    while (count > 0) {
        int32_t node = waiting[--count];
        while (node >= 0) {
            const int32_t *child = view->node_child[node], *through = view->planes[view->node_plane[node]];
            const double volume = plane_volume(point, through);
            if (volume < -SURE) { // branches: what is guessed need not be waited for
                node = child[1];
            } else if (volume > SURE) {
                node = child[0];
            } else {
                int side = plane_side(point, through, volume);
                if (side == 0 && count < BRANCHES_MAX) waiting[count++] = child[0];
                node = child[side >= 0];
            }
        }
        consider(point, tetrahedron, -1 - node);
    }
}
