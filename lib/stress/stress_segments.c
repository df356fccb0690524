// SPDX-License-Identifier: GPL-3.0-or-later
// What lies between two points, in whole numbers (GMP), and which polygons of the input are there at all.
#include "stress/stress_truth.h"

#include "base/array.h"
#include "format/frame.h"
#include "format/locate.h"

#include <gmp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// ---------------------------------------------------------------------------------------------- orientation

typedef struct judge {
    mpz_t entry[9], term, sum;
} judge;

static void judge_open(judge *numbers) {
    for (int i = 0; i < 9; i++) mpz_init(numbers->entry[i]);
    mpz_inits(numbers->term, numbers->sum, NULL);
}

static void judge_close(judge *numbers) {
    for (int i = 0; i < 9; i++) mpz_clear(numbers->entry[i]);
    mpz_clears(numbers->term, numbers->sum, NULL);
}

/// Entries are differences of whole numbers up to 2^53.
static int orient_exactly(judge *numbers, const double *const point[4]) {
    for (int i = 0; i < 9; i++)
        mpz_set_si(numbers->entry[i], (long)point[1 + i / 3][i % 3] - (long)point[0][i % 3]);
    mpz_set_ui(numbers->sum, 0);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpz_mul(numbers->term, numbers->entry[3 + j], numbers->entry[6 + k]);
        mpz_submul(numbers->term, numbers->entry[3 + k], numbers->entry[6 + j]);
        mpz_addmul(numbers->sum, numbers->entry[i], numbers->term);
    }
    return mpz_sgn(numbers->sum);
}

/// Sign of det(b - a, c - a, d - a).
static int orient(judge *numbers, const double *a, const double *b, const double *c, const double *d) {
    const double *const point[4] = {a, b, c, d};
    double e[9], sum = 0, size = 0;
    for (int i = 0; i < 9; i++) e[i] = point[1 + i / 3][i % 3] - a[i % 3];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        sum += e[i] * (e[3 + j] * e[6 + k] - e[3 + k] * e[6 + j]);
        size += fabs(e[i]) * (fabs(e[3 + j] * e[6 + k]) + fabs(e[3 + k] * e[6 + j]));
    }
    if (fabs(sum) > 0x1p-48 * size) return sum > 0 ? 1 : -1;
    return orient_exactly(numbers, point);
}

// ---------------------------------------------------------------------------------------------- crossing

typedef enum meeting { APART, CROSSES, TOUCHES } meeting;

/// Does the open segment go through the inside of the convex polygon? TOUCHES: its boundary, or an end on its
/// plane.
static meeting meet(judge *numbers, const enf_file_view *view, int32_t polygon, const double p[3],
                    const double q[3]) {
    const int32_t *span = view->mesh_polygon_plane[polygon];
    const double *a = view->points[span[0]], *b = view->points[span[1]], *c = view->points[span[2]];
    int side_p = orient(numbers, a, b, c, p), side_q = orient(numbers, a, b, c, q);
    if (side_p == side_q && side_p != 0) return APART;
    int64_t first = view->mesh_polygon_corner[polygon],
            count = view->mesh_polygon_corner[polygon + 1] - first;
    const int32_t *ring = view->mesh_corners + first;
    bool left = true, right = true, strict = true;
    for (int64_t i = 0; i < count; i++) {
        int turn =
            orient(numbers, p, q, view->points[ring[i]], view->points[ring[i + 1 < count ? i + 1 : 0]]);
        left = left && turn >= 0;
        right = right && turn <= 0;
        strict = strict && turn != 0;
    }
    if (!left && !right) return APART;
    return strict && side_p * side_q < 0 ? CROSSES : TOUCHES;
}

/// *polygon: the first that crosses; APART, CROSSES if one crosses, TOUCHES if it is none of these.
static meeting meet_any(judge *numbers, const enf_file_view *view, const double p[3], const double q[3],
                        int32_t *polygon) {
    meeting worst = APART;
    for (int32_t m = 0; m < view->mesh_polygon_count; m++) {
        meeting found = meet(numbers, view, m, p, q);
        if (found == APART) continue;
        *polygon = m;
        worst = found;
        if (found == CROSSES) return CROSSES;
    }
    return worst;
}

// ---------------------------------------------------------------------------------------------- places

/// locate for a whole point in grid coordinates. False if it lies outside of the tetrahedron that was found
/// (by less than rounding), or in none: then nothing exact is known.
static bool locate_whole(judge *numbers, const enf_file_view *view, const double grid[3], enf_place *place) {
    *place = enf_view_locate_grid(view, grid, -1);
    if (place->fine_cell < 0) return false;
    const int32_t *corner = view->tetrahedra[place->tetrahedron];
    for (int k = 0; k < 4; k++) {
        const double *at[4];
        for (int i = 0; i < 4; i++) at[i] = i == k ? grid : view->points[corner[i]];
        if (orient(numbers, at[0], at[1], at[2], at[3]) < 0) return false;
    }
    return true;
}

static double round_whole(double x) {
    x = nearbyint(x);
    return fmax(-ENF_FILE_GRID_MAX, fmin(x, ENF_FILE_GRID_MAX));
}

/// A segment of any length: through a polygon, or anywhere.
static void choose_segment(enf_stress_case *made, const enf_file_view *view, double size, double p[3],
                           double q[3]) {
    double middle[3], reach = size * enf_stress_magnitude(made, -10, 0) / 10 + 2;
    int32_t m = enf_stress_whole(made, view->mesh_polygon_count);
    int64_t first = view->mesh_polygon_corner[m];
    if (enf_stress_whole(made, 4)) {
        enf_stress_pick_point(made, view->points[0], view->mesh_corners + first,
                              (int32_t)(view->mesh_polygon_corner[m + 1] - first), middle);
    } else {
        const double *a = view->points[enf_stress_whole(made, view->point_count)];
        const double *b = view->points[enf_stress_whole(made, view->point_count)];
        for (int i = 0; i < 3; i++) middle[i] = a[i] + enf_stress_uniform(made, 0, 1) * (b[i] - a[i]);
    }
    for (int i = 0; i < 3; i++) {
        double half = enf_stress_uniform(made, -reach, reach);
        p[i] = round_whole(middle[i] - half);
        q[i] = round_whole(middle[i] + half);
    }
}

static void judge_segment(judge *numbers, const enf_file_view *view, const double p[3], const double q[3],
                          enf_stress_verdict *verdict) {
    enf_place at[2];
    bool inside[2] = {locate_whole(numbers, view, p, &at[0]), locate_whole(numbers, view, q, &at[1])};
    if (!inside[0] || !inside[1]) return;
    int32_t polygon = -1;
    meeting found = meet_any(numbers, view, p, q, &polygon);
    verdict->segments++;
    if (found == CROSSES && at[0].fine_cell == at[1].fine_cell)
        enf_stress_disagree(verdict, "clean polygon %d goes between two points of fine cell %d", (int)polygon,
                            (int)at[0].fine_cell);
    // A sealed crack is narrower than the tolerances, yet wide enough for a segment.
    if (found == APART && at[0].region != at[1].region && view->provenance->sealed == 0)
        enf_stress_disagree(verdict,
                            "no polygon goes between fine cells %d and %d, but regions are %d and %d",
                            (int)at[0].fine_cell, (int)at[1].fine_cell, (int)at[0].region, (int)at[1].region);
}

void enf_stress_ask_segments(enf_stress_case *made, const enf_file_view *view, int count,
                             enf_stress_verdict *verdict) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int32_t i = 0; i < view->point_count; i++) {
        for (int a = 0; a < 3; a++) {
            low = fmin(low, view->points[i][a]);
            high = fmax(high, view->points[i][a]);
        }
    }
    judge numbers;
    judge_open(&numbers);
    for (int i = 0; i < count && view->mesh_polygon_count > 0; i++) {
        double p[3], q[3];
        choose_segment(made, view, high - low, p, q);
        judge_segment(&numbers, view, p, q, verdict);
    }
    judge_close(&numbers);
}

// ---------------------------------------------------------------------------------------------- surfaces

static double dot(const double u[3], const double v[3]) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

/// From the nearest point of a segment to a point.
static void leave_edge(const double at[3], const double p[3], const double q[3], double out[3]) {
    double d[3];
    for (int a = 0; a < 3; a++) d[a] = q[a] - p[a], out[a] = at[a] - p[a];
    double length = dot(d, d), share = length > 0 ? fmax(0, fmin(dot(d, out) / length, 1)) : 0;
    for (int a = 0; a < 3; a++) out[a] -= share * d[a];
}

bool enf_stress_near_edge(const enf_soup *soup, const double at[3], double reach) {
    for (size_t p = 0; p < soup->polygon_count; p++) {
        int64_t first = soup->polygon_corner[p], end = soup->polygon_corner[p + 1];
        for (int64_t k = first; k < end; k++) {
            double way[3];
            leave_edge(at, soup->points + 3 * (size_t)soup->corner_point[k],
                       soup->points + 3 * (size_t)soup->corner_point[k + 1 < end ? k + 1 : first], way);
            if (dot(way, way) <= reach * reach) return true;
        }
    }
    return false;
}

/// Distance from a point to a clean polygon, grid steps. The height above a sliver's plane is taken from the
/// nearest edge: its normal is hardly better than half a double.
static double distance_to_polygon(const enf_file_view *view, int32_t polygon, const double at[3]) {
    int64_t first = view->mesh_polygon_corner[polygon],
            count = view->mesh_polygon_corner[polygon + 1] - first;
    const int32_t *ring = view->mesh_corners + first;
    const double *a = view->points[ring[0]];
    double normal[3] = {0, 0, 0}, foot[3] = {0, 0, 0}, nearest = HUGE_VAL;
    for (int64_t i = 1; i + 1 < count; i++) {
        const double *b = view->points[ring[i]], *c = view->points[ring[i + 1]];
        for (int k = 0; k < 3; k++) {
            int u = (k + 1) % 3, v = (k + 2) % 3;
            normal[k] += (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
        }
    }
    double length = sqrt(dot(normal, normal));
    bool inside = length > 0;
    for (int64_t i = 0; i < count; i++) {
        const double *p = view->points[ring[i]], *q = view->points[ring[(i + 1) % count]];
        double d[3], w[3], n[3];
        leave_edge(at, p, q, w);
        if (sqrt(dot(w, w)) < nearest) nearest = sqrt(dot(w, w)), memcpy(foot, w, sizeof foot);
        for (int k = 0; k < 3; k++) d[k] = q[k] - p[k], w[k] = at[k] - p[k];
        for (int k = 0; k < 3; k++) n[k] = d[(k + 1) % 3] * w[(k + 2) % 3] - d[(k + 2) % 3] * w[(k + 1) % 3];
        inside = inside && dot(n, normal) >= 0;
    }
    return inside ? fmin(nearest, fabs(dot(normal, foot)) / length) : nearest;
}

static bool is_near_mesh(const enf_file_view *view, const double at[3], double reach) {
    for (int32_t m = 0; m < view->mesh_polygon_count; m++)
        if (distance_to_polygon(view, m, at) <= reach) return true;
    return false;
}

/// How far a corner of a polygon is from the plane through its first three: by so much two ways of cutting it
/// into triangles differ. Grid steps, rounded.
static double unevenness(const enf_soup *soup, int64_t first, int64_t count, double step) {
    double corner[16][3], normal[3] = {0, 0, 0}, most = 0;
    for (int64_t i = 0; i < count && i < 16; i++)
        for (int a = 0; a < 3; a++)
            corner[i][a] = soup->points[3 * (size_t)soup->corner_point[first + i] + (size_t)a] / step;
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        normal[k] = (corner[1][u] - corner[0][u]) * (corner[2][v] - corner[0][v]) -
                    (corner[1][v] - corner[0][v]) * (corner[2][u] - corner[0][u]);
    }
    for (int64_t i = 3; i < count && i < 16; i++) {
        double w[3];
        for (int a = 0; a < 3; a++) w[a] = corner[i][a] - corner[0][a];
        most = fmax(most, fabs(dot(normal, w)) / sqrt(dot(normal, normal)));
    }
    return isfinite(most) ? most : HUGE_VAL;
}

/// Do all corners lie within `reach` grid steps of the line through two of them?
static bool is_needle(const enf_soup *soup, int64_t first, int64_t count, double step, double reach) {
    double longest = 0, way[3] = {0, 0, 0}, from[3], to[3] = {0, 0, 0};
    const double *points = soup->points;
    for (int a = 0; a < 3; a++) from[a] = points[3 * (size_t)soup->corner_point[first] + (size_t)a] / step;
    for (int pass = 0; pass < 2; pass++) {
        for (int64_t i = 1; i < count; i++) {
            double at[3];
            for (int a = 0; a < 3; a++)
                at[a] = points[3 * (size_t)soup->corner_point[first + i] + (size_t)a] / step;
            for (int a = 0; a < 3; a++) way[a] = at[a] - from[a];
            if (pass == 1) leave_edge(at, from, to, way);
            double length = sqrt(dot(way, way));
            if (pass == 1 && length > reach) return false;
            if (pass == 1 || length <= longest) continue;
            longest = length;
            memcpy(to, at, sizeof to);
        }
    }
    return true;
}

void enf_stress_ask_surfaces(enf_stress_case *made, const enf_file_view *view, int count,
                             enf_stress_verdict *verdict) {
    const enf_soup *soup = &made->soup;
    const enf_file_frame *frame = view->frame;
    bool *rejected = enf_array_zeroed(soup->polygon_count, sizeof *rejected);
    for (size_t i = 0; rejected && i < soup->rejected_count; i++) {
        const enf_rejected *line = &soup->rejected[i];
        if (line->polygon >= 0 && line->reason != ENF_REJECT_DUPLICATE) rejected[line->polygon] = true;
    }
    for (int i = 0; rejected && i < count && soup->polygon_count > 0; i++) {
        size_t p = (size_t)enf_stress_whole(made, (int)soup->polygon_count);
        int64_t first = soup->polygon_corner[p], corners = soup->polygon_corner[p + 1] - first;
        if (rejected[p] || corners < 3) continue;
        double world[3], grid[3];
        enf_stress_pick_point(made, soup->points, soup->corner_point + first, (int32_t)corners, world);
        enf_view_to_grid(view, world, grid);
        double reach =
            enf_stress_margin(view) / frame->step + 4 * unevenness(soup, first, corners, frame->step);
        if (is_needle(soup, first, corners, frame->step, reach)) continue; // all of it is an edge
        verdict->surfaces++;
        if (!is_near_mesh(view, grid, reach))
            enf_stress_disagree(verdict, "no clean polygon is near %.17g %.17g %.17g of input polygon %zu",
                                world[0], world[1], world[2], p);
    }
    free(rejected);
}
