// SPDX-License-Identifier: GPL-3.0-or-later
// Per axis:
//   1 planes   the coordinates of polygons that lie square to the axis, within the reach, are sorted and cut
//              into clusters at most two reaches wide; a cluster has one value, in reach of all its members
//   2 lattice  where polygons are torn (or turned), the coordinates may have been round numbers before: if
//   half
//              of them lie on one lattice (a power of two as step, any offset), as closely as the tears
//              suggest, values that lie on it take the lattice's
//   3 move     members take their plane's value; so do other coordinates in reach of it; those in reach of no
//              plane may still take the lattice's
// Coordinates without such evidence stay: a world of slopes is not touched, and neither is a clean one.
#include "build/flatten.h"

#include "base/array.h"
#include "build/turn.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double thickness = 32;     ///< a flat polygon is wider than this many reaches
static const double lattice_width = 32; ///< steps of a lattice per width of its points: few hit it by chance
static const double least_noise = 0x1p-44; ///< of the largest coordinate, after a turn

typedef struct plane {
    double low, high, value; ///< members, and what they become
} plane;

typedef struct flattener {
    double *points;
    size_t count;
    double reach, noise;
    unsigned char *flat; ///< per point: bit a: a corner of a polygon that is square to axis a
    double *values;      ///< scratch
    plane *planes;
    size_t plane_count;
    double step, offset, width; ///< the lattice of the axis at hand, or step 0
} flattener;

static int compare_doubles(const void *left, const void *right) {
    double a = *(const double *)left, b = *(const double *)right;
    return (a > b) - (a < b);
}

// ---- evidence

static void mark_polygon(flattener *f, const enf_frame_rings *rings, int32_t polygon) {
    const enf_soup *soup = rings->soup;
    int64_t first = soup->polygon_corner[polygon], end = soup->polygon_corner[polygon + 1];
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY}, extent[3];
    for (int64_t i = first; i < end; i++) {
        const double *p = &f->points[3 * (size_t)rings->place_of[soup->corner_point[i]]];
        for (int a = 0; a < 3; a++) {
            low[a] = fmin(low[a], p[a]);
            high[a] = fmax(high[a], p[a]);
        }
    }
    for (int a = 0; a < 3; a++) extent[a] = high[a] - low[a];
    for (int a = 0; a < 3; a++) {
        if (!(extent[a] <= 2 * f->reach)) continue;
        if (!(fmin(extent[(a + 1) % 3], extent[(a + 2) % 3]) >= thickness * f->reach)) continue;
        f->noise = fmax(f->noise, extent[a]);
        for (int64_t i = first; i < end; i++)
            f->flat[rings->place_of[soup->corner_point[i]]] |= (unsigned char)(1 << a);
    }
}

// ---- 1: planes

/// values[0 .. count) sorted: one cluster. Its value is the mean, as far as all members can reach it.
static plane make_plane(const double *values, size_t count, double reach) {
    plane out = {values[0], values[count - 1], values[0]};
    if (out.low == out.high) return out;
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += values[i] - out.low;
    out.value = fmin(fmax(out.low + sum / (double)count, out.high - reach), out.low + reach);
    return out;
}

static void find_planes(flattener *f, int axis) {
    size_t count = 0;
    f->plane_count = 0;
    for (size_t i = 0; i < f->count; i++)
        if (f->flat[i] >> axis & 1) f->values[count++] = f->points[3 * i + (size_t)axis];
    qsort(f->values, count, sizeof *f->values, compare_doubles);
    for (size_t first = 0, end; first < count; first = end) {
        for (end = first + 1; end < count && f->values[end] - f->values[first] <= 2 * f->reach;) end++;
        f->planes[f->plane_count++] = make_plane(f->values + first, end - first, f->reach);
    }
}

// ---- 2: lattice

/// The offset in [0, step) on which most coordinates lie within `width`, and how many do. Sorts f->values.
static size_t find_offset(flattener *f, int axis) {
    for (size_t i = 0; i < f->count; i++) {
        double x = f->points[3 * i + (size_t)axis];
        f->values[i] = x - floor(x / f->step) * f->step;
    }
    qsort(f->values, f->count, sizeof *f->values, compare_doubles);
    size_t best = 0, best_first = 0, end = 0;
    for (size_t first = 0; first < f->count; first++) { // [first, end) in a window around the circle
        if (end < first) end = first;
        while (end < first + f->count &&
               f->values[end % f->count] + (end >= f->count ? f->step : 0) - f->values[first] <= 2 * f->width)
            end++;
        if (end - first > best) best = end - first, best_first = first;
    }
    // The middle of the window's members, as a number with few digits; 0 if it may be 0.
    size_t last = best_first + best - 1;
    double low = f->values[best_first], high = f->values[last % f->count] + (last >= f->count ? f->step : 0);
    double unit = enf_power_of_two_above(f->width) / 8, middle = low + (high - low) / 2;
    f->offset = nearbyint(middle / unit) * unit;
    if (high <= f->width || low >= f->step - f->width ||
        (low >= f->step - f->width && high <= f->step + f->width))
        f->offset = 0;
    return best;
}

static void find_lattice(flattener *f, int axis) {
    double noise = f->noise;
    for (size_t i = 0; i < f->plane_count; i++) noise = fmax(noise, f->planes[i].high - f->planes[i].low);
    f->step = 0;
    if (!(noise > 0)) return;
    f->width = fmin(f->reach, 2 * noise);
    f->step = enf_power_of_two_above(lattice_width * f->width);
    if (2 * find_offset(f, axis) < f->count) f->step = 0;
}

/// The lattice's value if that is near enough to x, else x.
static double on_lattice(const flattener *f, double x) {
    if (!(f->step > 0)) return x;
    double nearest = nearbyint((x - f->offset) / f->step) * f->step + f->offset;
    return fabs(nearest - x) <= f->width ? nearest : x;
}

// ---- 3: move

/// The plane whose value is nearest to x, or null if there is no plane.
static const plane *nearest_plane(const flattener *f, double x) {
    size_t low = 0, high = f->plane_count;
    if (high == 0) return NULL;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (f->planes[middle].value <= x)
            low = middle;
        else
            high = middle;
    }
    const plane *below = &f->planes[low], *above = low + 1 < f->plane_count ? below + 1 : below;
    return fabs(x - above->value) < fabs(x - below->value) ? above : below;
}

/// The plane that x is a member of; there is one.
static const plane *plane_of(const flattener *f, double x) {
    size_t low = 0, high = f->plane_count;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (f->planes[middle].low <= x)
            low = middle;
        else
            high = middle;
    }
    return &f->planes[low];
}

static double moved(const flattener *f, double x, bool is_member) {
    if (is_member) return plane_of(f, x)->value;
    const plane *near = nearest_plane(f, x);
    return near && fabs(x - near->value) <= f->reach ? near->value : on_lattice(f, x);
}

static void move_axis(flattener *f, int axis, enf_flattening *result) {
    find_planes(f, axis);
    find_lattice(f, axis);
    for (size_t i = 0; i < f->plane_count; i++) {
        plane *at = &f->planes[i];
        double value = on_lattice(f, at->value);
        if (fabs(value - at->low) <= f->reach && fabs(value - at->high) <= f->reach) at->value = value;
    }
    for (size_t i = 0; i < f->count; i++) {
        double *x = &f->points[3 * i + (size_t)axis];
        double value = moved(f, *x, f->flat[i] >> axis & 1);
        result->moved = result->moved || value != *x;
        *x = value;
    }
    result->planes += (int64_t)f->plane_count;
    result->lattice[axis] = f->step;
}

enf_status enf_flatten(double *points, size_t count, const enf_frame_rings *rings, double reach, bool turned,
                       enf_flattening *result, enf_error *error) {
    *result = (enf_flattening){0};
    if (!(reach > 0) || count == 0) return ENF_OK;
    flattener f = {.points = points, .count = count, .reach = reach};
    f.flat = enf_array_zeroed(count, sizeof *f.flat);
    f.values = enf_array_new(count, sizeof *f.values);
    f.planes = enf_array_new(count, sizeof *f.planes);
    enf_status status = f.flat && f.values && f.planes ? ENF_OK : enf_fail_memory(error, "the planes");
    for (size_t k = 0; k < rings->polygon_count && status == ENF_OK; k++)
        mark_polygon(&f, rings, rings->polygons[k]);
    double largest = 0;
    for (size_t i = 0; i < 3 * count && turned; i++) largest = fmax(largest, fabs(points[i]));
    f.noise = fmax(f.noise, least_noise * largest);
    result->noise = f.noise;
    for (int axis = 0; axis < 3 && status == ENF_OK; axis++) move_axis(&f, axis, result);
    free(f.flat);
    free(f.values);
    free(f.planes);
    return status;
}
