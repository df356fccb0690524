// SPDX-License-Identifier: GPL-3.0-or-later
// Rock or air at points. Differences of coordinates are divided by a power of two about the world's size, so
// nothing overflows from 1e-60 to 1e99, and each sum is off by less than 2^-44 of that size; points are asked
// for only where the distance to every face is more than 2^-36 of it: there the answer is that of exact
// arithmetic. Shells: solid angles (A. van Oosterom, J. Strackee, "The solid angle of a plane triangle",
// 1983).
#include "stress/stress_truth.h"

#include "format/locate.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

void enf_stress_disagree(enf_stress_verdict *verdict, const char *format, ...) {
    if (verdict->disagreements++ > 0) return;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(verdict->first, sizeof verdict->first, format, arguments);
    va_end(arguments);
}

static double size_of(const enf_file_view *view) {
    double size = 0;
    for (int a = 0; a < 3; a++) size = fmax(size, view->frame->box_max[a] - view->frame->box_min[a]);
    return size;
}

double enf_stress_margin(const enf_file_view *view) {
    const enf_file_frame *frame = view->frame;
    return 4 * (frame->weld + frame->plane_tolerance + frame->displacement_max) + 0x1p-36 * size_of(view) +
           (frame->locate_rounding + 4) * frame->step;
}

// ---------------------------------------------------------------------------------------------- vectors

/// (p - q) in units of 2^exponent.
static void subtract(const double p[3], const double q[3], int exponent, double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = ldexp(p[a] - q[a], -exponent);
}

static void cross(const double u[3], const double v[3], double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
}

static double dot(const double u[3], const double v[3]) {
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
}

static int exponent_of(const enf_file_view *view) {
    int exponent = 0;
    frexp(size_of(view), &exponent);
    return exponent;
}

// ---------------------------------------------------------------------------------------------- solids

static double distance_to_plane(const enf_stress_case *made, size_t plane, const double at[3], int exponent) {
    const double *points = made->soup.points, *a = points + 3 * (size_t)made->planes[plane][0];
    double u[3], v[3], w[3], normal[3];
    subtract(points + 3 * (size_t)made->planes[plane][1], a, exponent, u);
    subtract(points + 3 * (size_t)made->planes[plane][2], a, exponent, v);
    subtract(at, a, exponent, w);
    cross(u, v, normal);
    return dot(normal, w) / sqrt(dot(normal, normal));
}

/// +1 inside a solid, -1 outside all; 0 nearer than `margin` to a face.
static int solid_at(const enf_stress_case *made, const double at[3], double margin, int exponent) {
    int answer = -1;
    double near = ldexp(margin, -exponent);
    for (size_t s = 0; s < made->solid_count; s++) {
        size_t end = s + 1 < made->solid_count ? made->solid_plane[s + 1] : made->plane_count;
        double highest = -HUGE_VAL;
        for (size_t p = made->solid_plane[s]; p < end; p++)
            highest = fmax(highest, distance_to_plane(made, p, at, exponent));
        if (!(fabs(highest) >= near)) return 0;
        if (highest < 0) answer = 1;
    }
    return answer;
}

// ---------------------------------------------------------------------------------------------- shells

static double solid_angle(const double a[3], const double b[3], const double c[3]) {
    double n[3], la = sqrt(dot(a, a)), lb = sqrt(dot(b, b)), lc = sqrt(dot(c, c));
    cross(b, c, n);
    return 2 * atan2(dot(a, n), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

/// How often the polygons go around the point, positive where they face outwards: nearly whole.
static double winding_at(const enf_soup *soup, const double at[3], int exponent) {
    double sum = 0;
    for (size_t p = 0; p < soup->polygon_count; p++) {
        int64_t first = soup->polygon_corner[p], end = soup->polygon_corner[p + 1];
        for (int64_t k = first + 1; k + 1 < end; k++) {
            double corner[3][3];
            const int64_t ring[3] = {first, k, k + 1};
            for (int i = 0; i < 3; i++)
                subtract(soup->points + 3 * (size_t)soup->corner_point[ring[i]], at, exponent, corner[i]);
            sum += solid_angle(corner[0], corner[1], corner[2]);
        }
    }
    return sum / 12.566370614359172; // 4 pi
}

/// +1: the winding number is negative (air), -1: it is not; 0: nearer than about `margin` to a face.
static int shell_at(const enf_stress_case *made, const double at[3], double margin, int exponent) {
    static const int corner[5][3] = {{0, 0, 0}, {1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    double first = 0;
    for (int i = 0; i < 5; i++) {
        double moved[3];
        for (int a = 0; a < 3; a++) moved[a] = at[a] + 4 * margin * corner[i][a];
        double winding = winding_at(&made->soup, moved, exponent), whole = nearbyint(winding);
        if (!(fabs(winding - whole) < 1e-4) || (i > 0 && whole != first)) return 0;
        first = whole;
    }
    return first < 0 ? 1 : -1;
}

// ---------------------------------------------------------------------------------------------- asking

void enf_stress_pick_point(enf_stress_case *made, const double *points, const int32_t *ring, int32_t count,
                           double at[3]) {
    int32_t k = 1 + enf_stress_whole(made, count - 2);
    double s = enf_stress_uniform(made, 0, 1), t = enf_stress_uniform(made, 0, 1);
    if (s + t > 1) s = 1 - s, t = 1 - t;
    const double *a = points + 3 * (size_t)ring[0], *b = points + 3 * (size_t)ring[k],
                 *c = points + 3 * (size_t)ring[k + 1];
    for (int i = 0; i < 3; i++) at[i] = a[i] + s * (b[i] - a[i]) + t * (c[i] - a[i]);
}

/// Anywhere in and around the world, or close to a polygon.
static void choose_point(enf_stress_case *made, const enf_file_view *view, double margin, double at[3]) {
    const enf_soup *soup = &made->soup;
    double size = size_of(view);
    size_t p = (size_t)enf_stress_whole(made, (int)soup->polygon_count);
    int64_t first = soup->polygon_corner[p], count = soup->polygon_corner[p + 1] - first;
    if (count < 3 || enf_stress_whole(made, 2)) {
        for (int a = 0; a < 3; a++)
            at[a] = enf_stress_uniform(made, view->frame->box_min[a] - 0.05 * size,
                                       view->frame->box_max[a] + 0.05 * size);
        return;
    }
    enf_stress_pick_point(made, soup->points, soup->corner_point + first, (int32_t)count, at);
    double reach = size * enf_stress_magnitude(made, -9, -1);
    if (reach < 2 * margin) reach = 2 * margin;
    for (int a = 0; a < 3; a++) at[a] += enf_stress_uniform(made, -reach, reach);
}

void enf_stress_ask_points(enf_stress_case *made, const enf_file_view *view, int count,
                           enf_stress_verdict *verdict) {
    if (made->truth == ENF_STRESS_UNKNOWN || made->soup.polygon_count == 0) return;
    double margin = enf_stress_margin(view);
    int exponent = exponent_of(view);
    bool solids = made->truth == ENF_STRESS_SOLIDS;
    for (int i = 0; i < count; i++) {
        double at[3];
        choose_point(made, view, margin, at);
        int truth = solids ? solid_at(made, at, margin, exponent) : shell_at(made, at, margin, exponent);
        if (truth == 0) continue;
        if (enf_stress_near_edge(&made->soup, at, margin)) continue;
        verdict->points++;
        enf_place place = enf_view_locate(view, at, -1);
        enf_world_kind kind = solids ? ENF_WORLD_ROCK : ENF_WORLD_AIR;
        if ((place.kind == kind) == (truth > 0)) continue;
        enf_stress_disagree(verdict, "%.17g %.17g %.17g should be %s, but locate says kind %d (fine cell %d)",
                            at[0], at[1], at[2],
                            solids ? (truth > 0 ? "rock" : "no rock") : (truth > 0 ? "air" : "no air"),
                            (int)place.kind, (int)place.fine_cell);
    }
}
