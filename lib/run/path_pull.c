// SPDX-License-Identifier: MIT
// The shortest line through a row of convex portals, by moving one point at a time. A point's exact best
// place between its neighbours is a matter of a few additions (portal_shape.h), but where several points lie
// on an edge that their portals share, none can move alone. So the first sweeps shorten the sum of sqrt(d^2 +
// s^2) over the steps d instead, with s shrinking: that is smooth, and points drag each other along.
#include "run/path_pull.h"

#include "run/affine.h"
#include "run/portal_shape.h"
#include "run/vector.h"

#include <string.h>

enum { SMOOTH_SWEEPS = 12, KNOT_MAX = 16, KNOT_SWEEPS = 8, KNOT_TRIES = 256 };
#define SHRINKING 0.6      // of s, per sweep
#define KNOT_SIZE 0.05     // of the mean step
#define LEAST_GAIN 0x1p-40 // of a length, or moving a knot is rounding

/// The matrix of a portal, or null.
static const double *matrix_of(const enf_path_line *line, int32_t portal) {
    const int32_t *list;
    if (enf_instance_transforms(line->instance, &list) == 0) return NULL;
    return enf_instance_passage(line->instance, line->paths->view, portal).matrix;
}

/// Solves m * point = moved.
static void transform_back(const double m[12], const double moved[3], double point[3]) {
    double column[4][3], across[3][3];
    for (int a = 0; a < 3; a++)
        for (int k = 0; k < 4; k++) column[k][a] = k < 3 ? m[4 * a + k] : moved[a] - m[4 * a + 3];
    for (int k = 0; k < 3; k++) enf_cross(column[(k + 1) % 3], column[(k + 2) % 3], across[k]);
    double volume = enf_dot(column[0], across[0]);
    for (int k = 0; k < 3; k++) point[k] = enf_dot(across[k], column[3]) / volume;
}

int32_t enf_path_line_size(const enf_path_line *line) {
    int32_t count = 2 + line->portal_count;
    for (int32_t i = 0; i < line->portal_count; i++) count += matrix_of(line, line->portals[i]) != NULL;
    return count;
}

double enf_path_line_length(const enf_path_line *line) {
    double length = 0;
    int32_t at = 0;
    for (int32_t i = 0; i <= line->portal_count; i++) {
        length += enf_distance(line->points[at], line->points[at + 1]);
        if (i < line->portal_count) at += 1 + (matrix_of(line, line->portals[i]) != NULL);
    }
    return length;
}

/// Moves a point to the mean of its neighbours, weighted by nearness.
static bool find_smooth(const enf_path_line *line, int32_t portal, const double at[3], const double a[3],
                        const double b[3], double smooth, double best[3]) {
    double da = enf_distance(at, a), db = enf_distance(at, b), mean[3];
    double wa = 1 / sqrt(da * da + smooth * smooth), wb = 1 / sqrt(db * db + smooth * smooth);
    enf_between(a, b, wb / (wa + wb), mean);
    return enf_portal_nearest(line->paths->view, portal, mean, best);
}

/// Moves the point of a portal; returns how far. smooth = 0: to the exact place.
static double move_point(const enf_path_line *line, int32_t at, int32_t portal, const double *matrix,
                         double smooth) {
    double behind[3], best[3], *point = line->points[at];
    memcpy(behind, line->points[at + (matrix ? 2 : 1)], sizeof behind);
    if (matrix) transform_back(matrix, behind, behind);
    const double *before = line->points[at - 1];
    bool found = smooth > 0 ? find_smooth(line, portal, point, before, behind, smooth, best)
                            : enf_portal_between(line->paths->view, portal, before, behind, best);
    if (!found || !enf_are_finite(best, 3)) return 0;
    double moved = enf_distance(point, best);
    memcpy(point, best, sizeof best);
    if (matrix) enf_affine_point(matrix, point, line->points[at + 1]);
    return moved;
}

/// Moves all points in turn, forward or backward; returns how far the farthest went.
static double sweep(const enf_path_line *line, int32_t size, bool backward, double smooth) {
    double farthest = 0;
    int32_t at = backward ? size - 1 : 1;
    for (int32_t n = 0; n < line->portal_count; n++) {
        int32_t portal = line->portals[backward ? line->portal_count - 1 - n : n];
        const double *matrix = matrix_of(line, portal);
        if (backward) at -= matrix ? 2 : 1;
        farthest = fmax(farthest, move_point(line, at, portal, matrix, smooth));
        if (!backward) at += matrix ? 2 : 1;
    }
    return farthest;
}

static void begin(const enf_path_line *line, const double from[3], const double to[3]) {
    int32_t at = 0;
    memcpy(line->points[at++], from, sizeof *line->points);
    for (int32_t i = 0; i < line->portal_count; i++) {
        const double *matrix = matrix_of(line, line->portals[i]);
        const double *place = enf_path_place(line->paths, line->portals[i]);
        for (int a = 0; a < 3; a++) line->points[at][a] = place[a] / line->paths->unit;
        at++;
        if (matrix) enf_affine_point(matrix, line->points[at - 1], line->points[at]);
        if (matrix) at++;
    }
    memcpy(line->points[at], to, sizeof *line->points);
}

// ---------------------------------------------------------------------------------------------- knots

/// Points of the line next to each other in the same place: `first` is a point's number, `portal` that of its
/// portal in the line's list.
typedef struct knot {
    int32_t first, portal, count;
} knot;

static double length_of(double (*points)[3], int32_t steps) {
    double length = 0;
    for (int32_t i = 0; i < steps; i++) length += enf_distance(points[i], points[i + 1]);
    return length;
}

/// Moves all points of a knot next to a point, if that makes the line shorter.
static bool move_knot(const enf_path_line *line, const knot *k, const double to[3]) {
    double(*points)[3] = line->points + k->first, kept[KNOT_MAX][3];
    double length = length_of(points - 1, k->count + 1);
    for (int32_t i = 0; i < k->count; i++) memcpy(kept[i], points[i], sizeof *kept);
    bool good = true;
    for (int32_t i = 0; i < k->count; i++)
        good = good && enf_portal_nearest(line->paths->view, line->portals[k->portal + i], to, points[i]);
    good = good && length_of(points - 1, k->count + 1) < length * (1 - LEAST_GAIN);
    for (int32_t i = 0; !good && i < k->count; i++) memcpy(points[i], kept[i], sizeof *kept);
    return good;
}

/// Tries the best points of the edges of a polygon that a knot lies on; not more than *tries.
static bool loosen_from(const enf_path_line *line, const knot *k, int32_t member,
                        const enf_file_portal_polygon *polygon, double near, int *tries) {
    const double(*corner)[3] = line->paths->view->portal_vertices + polygon->vertex_first;
    const double *before = line->points[k->first - 1], *behind = line->points[k->first + k->count];
    bool moved = false;
    for (int32_t i = 0, last = polygon->vertex_count - 1; i < polygon->vertex_count; last = i++) {
        if (*tries == 0) break;
        const double *at = line->points[k->first + member];
        double best[3], foot[3];
        enf_edge_between(corner[last], corner[i], at, at, foot);
        if (!(enf_distance(at, foot) <= near)) continue;
        enf_edge_between(corner[last], corner[i], before, behind, best);
        moved = move_knot(line, k, best) || moved;
        --*tries;
    }
    return moved;
}

static bool loosen_knot(const enf_path_line *line, const knot *k, double near) {
    const enf_file_view *view = line->paths->view;
    int tries = KNOT_TRIES;
    bool moved = false;
    for (int32_t i = 0; i < k->count; i++) {
        const enf_file_portal *portal = &view->portals[line->portals[k->portal + i]];
        for (int32_t n = 0; n < portal->polygon_count && tries > 0; n++)
            moved =
                loosen_from(line, k, i, &view->portal_polygons[portal->polygon_first + n], near, &tries) ||
                moved;
    }
    return moved;
}

/// Loosens all knots: rows of points each of which is near the one before.
static bool loosen_knots(const enf_path_line *line, double near) {
    knot k = {.first = 1, .portal = 0, .count = 1};
    bool moved = false;
    while (k.portal < line->portal_count) {
        bool jumps = matrix_of(line, line->portals[k.portal]) != NULL;
        for (k.count = 1; !jumps && k.count < KNOT_MAX && k.portal + k.count < line->portal_count;
             k.count++) {
            const double(*at)[3] = (const double(*)[3])line->points + k.first + k.count;
            if (!(enf_distance(at[-1], at[0]) <= near) || matrix_of(line, line->portals[k.portal + k.count]))
                break;
        }
        if (k.count > 1) moved = loosen_knot(line, &k, near) || moved;
        k.first += k.count + jumps;
        k.portal += k.count;
    }
    return moved;
}

int32_t enf_path_line_pull(const enf_path_line *line, const double from[3], const double to[3]) {
    begin(line, from, to);
    int32_t size = enf_path_line_size(line), sweeps = 0;
    double length = enf_path_line_length(line), smooth = length / (line->portal_count + 1);
    const double near = KNOT_SIZE * smooth;
    if (line->portal_count == 0) return 0;
    for (int32_t n = 0; line->portal_count > 1 && n < SMOOTH_SWEEPS && sweeps < line->sweeps_max; n++) {
        sweep(line, size, sweeps++ % 2, smooth);
        smooth *= SHRINKING;
    }
    while (sweeps < line->sweeps_max) {
        bool still = !(sweep(line, size, sweeps++ % 2, 0) > line->tolerance * length);
        bool loosened = (still || sweeps % KNOT_SWEEPS == 0) && loosen_knots(line, near);
        if (still && !loosened) break;
    }
    return sweeps;
}
