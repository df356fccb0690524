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

/// A point's height above the barrier's plane, rounded. *error: at most so far off.
static double height_of(const enf_file_barrier *barrier, const double origin[3], const double point[3],
                        double *error) {
    const double *n = barrier->normal;
    double x = point[0] - origin[0], y = point[1] - origin[1], z = point[2] - origin[2];
    *error = PLANE_ROUNDING * (fabs(x) + fabs(y) + fabs(z));
    return n[0] * x + n[1] * y + n[2] * z;
}

/// +1 in front of the barrier's plane, -1 behind, 0 on it.
static int side_of_plane(double height, double error, const double (*vertices)[3], const double point[3]) {
    if (fabs(height) > error) return height > 0 ? 1 : -1;
    return enf_points_orient(vertices[0], vertices[1], vertices[2], point);
}

static double share_of(double from_height, double to_height) {
    double height = fabs(from_height), whole = height + fabs(to_height);
    return whole > 0 ? height / whole : 0.5;
}

/// Of the volumes that the segment spans with the edges, negative where it passes on the wrong side, the
/// least. `turn`: +1 or -1, the right side. All edges in any case: what a branch saves here, its
/// misprediction costs.
static double least_volume(const enf_segment *segment, const double (*vertices)[3], int32_t count,
                           double turn) {
    const double *a = segment->from, *b = segment->to, *last = vertices[count - 1];
    double way[3] = {(b[0] - a[0]) * turn, (b[1] - a[1]) * turn, (b[2] - a[2]) * turn};
    double v[3] = {last[0] - a[0], last[1] - a[1], last[2] - a[2]}, least = INFINITY;
    for (int32_t k = 0; k < count; k++) {
        const double *next = vertices[k];
        double w[3] = {next[0] - a[0], next[1] - a[1], next[2] - a[2]};
        double volume = way[0] * (v[1] * w[2] - v[2] * w[1]) + way[1] * (v[2] * w[0] - v[0] * w[2]) +
                        way[2] * (v[0] * w[1] - v[1] * w[0]);
        least = volume < least ? volume : least;
        v[0] = w[0];
        v[1] = w[1];
        v[2] = w[2];
    }
    return least;
}

/// The same for the edges' exact sides. True if the line passes every edge on the same side, or touches it;
/// not all of them, as rounding may leave a polygon without area.
static bool passes_edges_exactly(const enf_segment *segment, const double (*vertices)[3], int32_t count,
                                 int turn) {
    const double *last = vertices[count - 1];
    bool beside = false;
    for (int32_t k = 0; k < count; k++) {
        int side = enf_points_orient(segment->from, segment->to, last, vertices[k]) * turn;
        if (side < 0) return false;
        beside = beside || side > 0;
        last = vertices[k];
    }
    return beside;
}

static bool passes_edges(const enf_segment *segment, const double (*vertices)[3], int32_t count, int turn) {
    double least = least_volume(segment, vertices, count, turn);
    if (fabs(least) > SURE) return least > 0;
    return passes_edges_exactly(segment, vertices, count, turn);
}

/// How a segment lies to a barrier's plane.
typedef struct sides {
    double from_height, to_height; ///< rounded
    int from, to;                  ///< +1 in front, -1 behind, 0 on it
} sides;

/// False if both ends are beside the plane, on the same side for sure.
static bool find_sides(const enf_segment *segment, const enf_file_barrier *barrier,
                       const double (*vertices)[3], sides *sides) {
    double from_error, to_error;
    double from = height_of(barrier, vertices[0], segment->from, &from_error);
    double to = height_of(barrier, vertices[0], segment->to, &to_error);
    if ((fabs(from) > from_error) & (fabs(to) > to_error) & ((from > 0) == (to > 0))) return false;
    sides->from_height = from;
    sides->to_height = to;
    sides->from = side_of_plane(from, from_error, vertices, segment->from);
    sides->to = side_of_plane(to, to_error, vertices, segment->to);
    return true;
}

bool enf_segment_passes(const enf_file_view *view, const enf_segment *segment,
                        const enf_file_barrier *barrier, double *share) {
    const double(*vertices)[3] = view->barrier_vertices + barrier->vertex_first;
    sides sides;
    if (!find_sides(segment, barrier, vertices, &sides) || sides.from * sides.to >= 0) return false;
    if (!passes_edges(segment, vertices, barrier->vertex_count, -sides.from)) return false;
    if (share) *share = share_of(sides.from_height, sides.to_height);
    return true;
}

bool enf_segment_meets(const enf_file_view *view, const enf_segment *segment, const enf_file_barrier *barrier,
                       enf_meeting *meeting) {
    const double(*vertices)[3] = view->barrier_vertices + barrier->vertex_first;
    sides sides;
    if (!find_sides(segment, barrier, vertices, &sides) || sides.from == sides.to) return false;
    meeting->from_front = sides.from > sides.to;
    if (!passes_edges(segment, vertices, barrier->vertex_count, meeting->from_front ? -1 : 1)) return false;
    meeting->touches = sides.from == 0 || sides.to == 0;
    meeting->share = sides.from == 0 ? 0 : sides.to == 0 ? 1 : share_of(sides.from_height, sides.to_height);
    return true;
}
