// SPDX-License-Identifier: GPL-3.0-or-later
// Per axis:
//   1 planes   the coordinates of polygons that lie square to the axis, within the reach, are sorted and cut
//              into clusters at most two reaches wide; a cluster has one value, in reach of all its members
//   2 lattice  where polygons are torn (or turned), the coordinates may have been round numbers before: if
//   half
//              of them lie on one lattice, as closely as the tears suggest, values that lie on it take the
//              lattice's. Its step is a power of two (with any offset), or that divided by a power of five:
//              decimal fractions, in any unit that a power of two makes of them
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
static const double lattice_width = 64; ///< steps of a lattice per width of its points: few hit it by chance
static const double least_noise = 0x1p-51; ///< of the largest coordinate, after a turn

enum { DIVISORS = 6 }; // 1, 5, 25, ...

typedef struct plane {
    double low, high, value; ///< members, and what they become
} plane;

typedef struct flattener {
    double *points;
    size_t count;
    double reach, noise;
    unsigned char *flat; ///< per point: bit a: a corner of a polygon that is square to axis a
    double *widths;      ///< of the polygons that are square to an axis
    size_t width_count;
    double *values; ///< scratch
    plane *planes;
    size_t plane_count;
    double step, divisor, offset, width; ///< the lattice of the axis at hand (step / divisor), or step 0
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
        f->widths[f->width_count++] = extent[a];
        for (int64_t i = first; i < end; i++)
            f->flat[rings->place_of[soup->corner_point[i]]] |= (unsigned char)(1 << a);
    }
}

/// Nine in ten polygons are torn by less; four times that, so that nothing torn is missed. A few may be flat
/// by chance, and their width says nothing.
static double measure_noise(flattener *f) {
    if (f->width_count == 0) return 0;
    qsort(f->widths, f->width_count, sizeof *f->widths, compare_doubles);
    return 4 * f->widths[(f->width_count * 9 - 1) / 10];
}

// ---- 1: planes

/// The lowest binary digit of x that is not 0: the larger, the rounder the number.
static double lowest_digit(double x) {
    int exponent;
    double mantissa = frexp(fabs(x), &exponent);
    int64_t digits = (int64_t)ldexp(mantissa, 53);
    return digits ? ldexp((double)(digits & -digits), exponent - 53) : INFINITY;
}

/// values[0 .. count) sorted: one cluster. Its value is the mean, as far as all members can reach it; where
/// hardly anything is torn, the roundest member that they can reach.
static plane make_plane(const flattener *f, const double *values, size_t count) {
    plane out = {values[0], values[count - 1], values[0]};
    if (out.low == out.high) return out;
    double sum = 0, roundest = 0;
    for (size_t i = 0; i < count; i++) sum += values[i] - out.low;
    out.value = fmin(fmax(out.low + sum / (double)count, out.high - f->reach), out.low + f->reach);
    for (size_t i = 0; i < count && f->noise == 0; i++) {
        double digit = lowest_digit(values[i]);
        if (values[i] < out.high - f->reach || values[i] > out.low + f->reach || digit <= roundest) continue;
        roundest = digit;
        out.value = values[i];
    }
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
        f->planes[f->plane_count++] = make_plane(f, f->values + first, end - first);
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

/// The point of the lattice that is nearest to x.
static double nearest_of_lattice(const flattener *f, double x) {
    return nearbyint((x - f->offset) * f->divisor / f->step) * f->step / f->divisor + f->offset;
}

/// The lattice's value if that is near enough to x, else x.
static double on_lattice(const flattener *f, double x) {
    if (!(f->step > 0)) return x;
    double nearest = nearest_of_lattice(f, x);
    return fabs(nearest - x) <= f->width ? nearest : x;
}

/// How many coordinates lie on the lattice.
static size_t count_hits(flattener *f, int axis) {
    size_t hits = 0;
    for (size_t i = 0; i < f->count; i++) {
        double x = f->points[3 * i + (size_t)axis];
        hits += fabs(nearest_of_lattice(f, x) - x) <= f->width;
    }
    return hits;
}

/// The best lattice whose points are `width` wide, or step 0. A finer fraction must explain at least half of
/// what the simpler one leaves.
static void try_width(flattener *f, int axis, double width) {
    double divisor = 1, offset = 0, least = lattice_width * width, chosen = 1;
    size_t misses = 0;
    f->width = width;
    for (int d = 0; d < DIVISORS; d++, divisor *= 5) {
        f->divisor = divisor;
        f->offset = 0;
        f->step = enf_power_of_two_above(least * divisor);
        size_t left = f->count - (d ? count_hits(f, axis) : find_offset(f, axis));
        if (d && 2 * left > misses) continue;
        if (d && misses == 0) break;
        offset = f->offset;
        chosen = divisor;
        misses = left;
    }
    f->divisor = chosen;
    f->offset = offset;
    f->step = 2 * misses > f->count ? 0 : enf_power_of_two_above(least * chosen);
}

/// The turn, too, may be off by a little, more than single polygons show: wider points follow narrow ones.
static void find_lattice(flattener *f, int axis) {
    f->step = 0;
    if (!(f->noise > 0)) return;
    for (double width = fmin(f->reach, f->noise); f->step == 0; width = fmin(f->reach, 16 * width)) {
        try_width(f, axis, width);
        if (width == f->reach) break;
    }
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
    f.widths = enf_array_new(rings->polygon_count, 3 * sizeof *f.widths);
    enf_status status =
        f.flat && f.values && f.planes && f.widths ? ENF_OK : enf_fail_memory(error, "the planes");
    for (size_t k = 0; k < rings->polygon_count && status == ENF_OK; k++)
        mark_polygon(&f, rings, rings->polygons[k]);
    double largest = 0;
    for (size_t i = 0; i < 3 * count && turned; i++) largest = fmax(largest, fabs(points[i]));
    f.noise = fmax(measure_noise(&f), least_noise * largest);
    result->noise = f.noise;
    for (int axis = 0; axis < 3 && status == ENF_OK; axis++) move_axis(&f, axis, result);
    free(f.flat);
    free(f.values);
    free(f.planes);
    free(f.widths);
    return status;
}
