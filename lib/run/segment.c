// SPDX-License-Identifier: MIT
// Sides of lines as in S. Woop, C. Benthin, I. Wald, "Watertight ray/triangle intersection" (2013): two
// polygons with a common edge get the same answer for it, so nothing slips between them. Exact predicates
// behind a filter make that true of corners and of planes, too.
#include "run/segment.h"

#include "base/exact.h"
#include "format/frame.h"
#include "format/round.h"

#include <math.h>

/// A determinant of points of the fine grid is not off by more (base/exact.c).
#define SURE 0x1p115
/// Of a distance to a plane, as a share of the way to the point of the plane that it was computed from.
#define PLANE_ROUNDING 0x1p-49

bool enf_fine_point(const enf_file_view *view, const double world[3], double fine[3]) {
    double grid[3];
    enf_view_to_grid(view, world, grid);
    for (int a = 0; a < 3; a++) {
        double scaled = grid[a] * view->frame->locate_scale;
        if (!(fabs(scaled) <= ENF_FILE_GRID_MAX)) return false;
        fine[a] = enf_round(scaled);
    }
    return true;
}

/// +1 in front of the barrier's plane, -1 behind, 0 on it. *height: rounded.
static int side_of_plane(const enf_file_barrier *barrier, const double (*vertices)[3], const double point[3],
                         double *height) {
    const double *n = barrier->normal, *origin = vertices[0];
    double x = point[0] - origin[0], y = point[1] - origin[1], z = point[2] - origin[2];
    *height = n[0] * x + n[1] * y + n[2] * z;
    if (fabs(*height) > PLANE_ROUNDING * (fabs(x) + fabs(y) + fabs(z))) return *height > 0 ? 1 : -1;
    return enf_points_orient(vertices[0], vertices[1], vertices[2], point);
}

static double share_of(double from_height, double to_height) {
    double height = fabs(from_height), whole = height + fabs(to_height);
    return whole > 0 ? height / whole : 0.5;
}

/// True if the line passes every edge on the same side, or touches it; not all of them, as rounding may leave
/// a polygon without area. `turn`: that side.
static bool passes_edges(const enf_segment *segment, const double (*vertices)[3], int32_t count, int turn) {
    const double *a = segment->from, *b = segment->to, *last = vertices[count - 1];
    double way[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double v[3] = {last[0] - a[0], last[1] - a[1], last[2] - a[2]};
    bool beside = false;
    for (int32_t k = 0; k < count; k++) {
        const double *next = vertices[k];
        double w[3] = {next[0] - a[0], next[1] - a[1], next[2] - a[2]};
        double volume = way[0] * (v[1] * w[2] - v[2] * w[1]) + way[1] * (v[2] * w[0] - v[0] * w[2]) +
                        way[2] * (v[0] * w[1] - v[1] * w[0]);
        if (fabs(volume) > SURE) {
            if ((volume > 0) != (turn > 0)) return false;
            beside = true;
        } else {
            int side = enf_points_orient(a, b, last, next) * turn;
            if (side < 0) return false;
            beside = beside || side > 0;
        }
        last = next;
        for (int i = 0; i < 3; i++) v[i] = w[i];
    }
    return beside;
}

bool enf_segment_passes(const enf_file_view *view, const enf_segment *segment,
                        const enf_file_barrier *barrier, double *share) {
    const double(*vertices)[3] = view->barrier_vertices + barrier->vertex_first;
    double from_height, to_height;
    int from = side_of_plane(barrier, vertices, segment->from, &from_height);
    if (from == 0) return false;
    int to = side_of_plane(barrier, vertices, segment->to, &to_height);
    if (from * to >= 0 || !passes_edges(segment, vertices, barrier->vertex_count, -from)) return false;
    if (share) *share = share_of(from_height, to_height);
    return true;
}

bool enf_segment_meets(const enf_file_view *view, const enf_segment *segment, const enf_file_barrier *barrier,
                       enf_meeting *meeting) {
    const double(*vertices)[3] = view->barrier_vertices + barrier->vertex_first;
    double from_height, to_height;
    int from = side_of_plane(barrier, vertices, segment->from, &from_height);
    int to = side_of_plane(barrier, vertices, segment->to, &to_height);
    if (from == to) return false;
    meeting->from_front = from > to;
    if (!passes_edges(segment, vertices, barrier->vertex_count, from > to ? -1 : 1)) return false;
    meeting->touches = from == 0 || to == 0;
    meeting->share = from == 0 ? 0 : to == 0 ? 1 : share_of(from_height, to_height);
    return true;
}
