// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/winding.h"

#include <math.h>
#include <string.h>

static const double least_area = 1e-12; ///< of the square of the size
static const double sixth_digits = 3;   ///< units of the sixth digit

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static bool is_same(const double a[3], const double b[3]) {
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

int32_t enf_winding_drop_doubles(double (*corners)[3], int32_t count) {
    int32_t kept = 0;
    for (int32_t i = 0; i < count; i++)
        if (kept == 0 || !is_same(corners[kept - 1], corners[i]))
            memmove(corners[kept++], corners[i], sizeof *corners);
    while (kept > 1 && is_same(corners[kept - 1], corners[0])) kept--;
    return kept;
}

double enf_winding_tolerance(const double (*corners)[3], int32_t count) {
    double largest = 0;
    for (int32_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) largest = fmax(largest, fabs(corners[i][a]));
    return largest > 0 ? sixth_digits * pow(10, floor(log10(largest)) - 5) : 0;
}

/// The largest difference from the first corner along an axis.
static double size_of(const double (*corners)[3], int32_t count) {
    double size = 0;
    for (int32_t i = 1; i < count; i++)
        for (int a = 0; a < 3; a++) size = fmax(size, fabs(corners[i][a] - corners[0][a]));
    return size;
}

/// The way from one corner to another, in units of the size: no product over- or underflows.
static void step(const double from[3], const double to[3], double size, double out[3]) {
    for (int a = 0; a < 3; a++) out[a] = (to[a] - from[a]) / size;
}

bool enf_winding_normal(const double (*corners)[3], int32_t count, double normal[3]) {
    double size = size_of(corners, count), sum[3] = {0, 0, 0};
    if (!(size > 0)) return false;
    for (int32_t i = 1; i + 1 < count; i++) {
        double u[3], v[3], area[3];
        step(corners[0], corners[i], size, u);
        step(corners[0], corners[i + 1], size, v);
        cross(u, v, area);
        for (int a = 0; a < 3; a++) sum[a] += area[a];
    }
    double length = sqrt(dot(sum, sum));
    if (!(length > least_area)) return false;
    for (int a = 0; a < 3; a++) normal[a] = sum[a] / length;
    return true;
}

/// The corner that is farthest from the plane through the middle, if it is too far; else -1.
static int32_t find_off_plane(const double (*corners)[3], int32_t count, const double normal[3]) {
    double mean = 0, farthest = enf_winding_tolerance(corners, count), heights[ENF_WINDING_CORNERS_MAX];
    int32_t found = -1;
    for (int32_t i = 0; i < count; i++) {
        double way[3];
        step(corners[0], corners[i], 1, way);
        heights[i] = dot(way, normal);
        mean += heights[i] / count;
    }
    for (int32_t i = 0; i < count; i++) {
        if (fabs(heights[i] - mean) <= farthest) continue;
        farthest = fabs(heights[i] - mean);
        found = i;
    }
    return found;
}

/// The first corner at which the outline turns the wrong way by more than the tolerance, or turns back; the
/// last if it goes round more than once; else -1.
static int32_t find_reflex(const double (*corners)[3], int32_t count, const double normal[3]) {
    double size = size_of(corners, count), tolerance = enf_winding_tolerance(corners, count) / size;
    double turned = 0;
    for (int32_t i = 0; i < count; i++) {
        double in[3], out[3], over[3], area[3];
        int32_t before = i ? i - 1 : count - 1, after = i + 1 < count ? i + 1 : 0;
        step(corners[before], corners[i], size, in);
        step(corners[i], corners[after], size, out);
        step(corners[before], corners[after], size, over);
        cross(in, out, area);
        double left = dot(area, normal), ahead = dot(in, out);
        // The corner lies -left / |over| outside of the line between its neighbours.
        if (left <= 0 && (ahead <= 0 || -left > tolerance * sqrt(dot(over, over)))) return i;
        turned += atan2(left, ahead);
    }
    const double round = 6.283185307179586;
    return turned < 1.5 * round ? -1 : count - 1;
}

enf_winding_fault enf_winding_judge(const double (*corners)[3], int32_t count, int32_t *corner) {
    double normal[3];
    *corner = 0;
    if (!enf_winding_normal(corners, count, normal)) return ENF_WINDING_NO_AREA;
    int32_t wrong = find_off_plane(corners, count, normal);
    if (wrong >= 0) {
        *corner = wrong;
        return ENF_WINDING_NOT_PLANAR;
    }
    wrong = find_reflex(corners, count, normal);
    if (wrong < 0) return ENF_WINDING_FINE;
    *corner = wrong;
    return ENF_WINDING_NOT_CONVEX;
}
