// SPDX-License-Identifier: GPL-3.0-or-later
// Clipping after I. E. Sutherland and G. W. Hodgman, "Reentrant polygon clipping" (1974): what separators
// leave of an opening. The box around it tells which cuts take something, four cuts at a time.
#include "base/four.h"
#include "visibility/separator.h"

/// False if some cut leaves nothing of the box around a shape. *needed receives the cuts that may take
/// something.
ENF_PART_OF_WIDE bool meets_box(const enf_separators *separators, const enf_shape *shape, uint64_t *needed) {
    enf_four_mask some = {0}, nothing = {0}, bits = {1, 2, 4, 8};
    for (int32_t i = 0; i < separators->count; i += ENF_FOUR, bits <<= ENF_FOUR) {
        const enf_four x = enf_four_load(separators->normal[0] + i),
                       y = enf_four_load(separators->normal[1] + i),
                       z = enf_four_load(separators->normal[2] + i);
        const enf_four height = shape->middle[0] * x + shape->middle[1] * y + shape->middle[2] * z -
                                enf_four_load(separators->least + i);
        const enf_four reach = shape->half[0] * enf_four_abs(x) + shape->half[1] * enf_four_abs(y) +
                               shape->half[2] * enf_four_abs(z);
        nothing |= height < -reach;
        some |= (height < reach - separators->spare) & bits;
    }
    *needed = (uint64_t)((some[0] | some[1]) | (some[2] | some[3]));
    return !((nothing[0] | nothing[1]) | (nothing[2] | nothing[3]));
}

enum { CORNERS_MOST = 64 }; ///< of polygons that are cut: sets of corners are 64-bit words

/// Corners while they are being cut: one by one, so that what was stored as one is loaded as one.
typedef struct polygon {
    int32_t count, stride; ///< doubles from corner to corner: 3 or 4
    const double *corners; ///< what is in fourth place means nothing
} polygon;

typedef double piece[CORNERS_MOST * 3 / 2 + ENF_FOUR][4];

/// That many bits, 1 to 64.
ENF_PART_OF_WIDE uint64_t first_bits(int32_t count) {
    return ~UINT64_C(0) >> (64 - count);
}

ENF_PART_OF_WIDE enf_four corner_of(const polygon *polygon, int32_t index) {
    return enf_four_load(polygon->corners + index * polygon->stride);
}

/// How high the corners lie above a cut, four at a time; what is above the count, up to the next four, means
/// nothing. Which are in front?
ENF_PART_OF_WIDE uint64_t find_heights(const polygon *polygon, const enf_cut *cut, double *heights) {
    uint64_t inside = 0;
    for (int32_t i = 0; i < polygon->count; i += ENF_FOUR) {
        enf_four at[ENF_FOUR], along[3];
        for (int k = 0; k < ENF_FOUR; k++) at[k] = corner_of(polygon, i + k);
        enf_four_turn(at, along);
        const enf_four height =
            along[0] * cut->normal[0] + along[1] * cut->normal[1] + along[2] * cut->normal[2] - cut->least;
        enf_four_store(heights + i, height);
        inside |= (uint64_t)enf_four_bits(height >= 0) << i;
    }
    return inside & first_bits(polygon->count);
}

/// The point of the edge between two corners that is in the cut's plane.
ENF_PART_OF_WIDE enf_four find_crossing(const polygon *polygon, const double *heights, int32_t i,
                                        int32_t next) {
    const enf_four a = corner_of(polygon, i), b = corner_of(polygon, next);
    return a + heights[i] / (heights[i] - heights[next]) * (b - a);
}

/// Keeps a run of corners, from after one edge that crosses the cut up to another. Returns how many there
/// are.
ENF_PART_OF_WIDE int32_t keep_run(piece piece, const polygon *polygon, const double *heights, int32_t in,
                                  int32_t out) {
    const int32_t count = polygon->count, first = in + 1 < count ? in + 1 : 0;
    int32_t made = 0;
    for (int32_t i = first;; i = i + 1 < count ? i + 1 : 0) {
        enf_four_store(piece[made++], corner_of(polygon, i));
        if (i == out) break;
    }
    enf_four_store(piece[made++], find_crossing(polygon, heights, out, out + 1 < count ? out + 1 : 0));
    enf_four_store(piece[made++], find_crossing(polygon, heights, in, first));
    return made;
}

/// The same for a polygon that rounding has bent: runs of corners.
static int32_t keep_runs(piece piece, const polygon *polygon, const double *heights, uint64_t inside) {
    int32_t made = 0;
    for (int32_t i = 0; i < polygon->count; i++) {
        const int32_t next = i + 1 < polygon->count ? i + 1 : 0;
        const bool is_in = inside >> i & 1;
        if (is_in) enf_four_store(piece[made++], corner_of(polygon, i));
        if (is_in != (inside >> next & 1))
            enf_four_store(piece[made++], find_crossing(polygon, heights, i, next));
    }
    return made;
}

/// Is no corner further behind than that? Cuts that touch an edge or a corner would only add corners.
static bool takes_little(const double *heights, int32_t count, double spare) {
    for (int32_t i = 0; i < count; i++)
        if (heights[i] < -spare) return false;
    return true;
}

/// Cuts a piece off the polygon, and says what is left; only a part is put into the piece, and becomes the
/// polygon.
ENF_PART_OF_WIDE enf_remains cut_off(polygon *polygon, piece piece, const enf_cut *cut, double spare) {
    double heights[CORNERS_MOST];
    if (polygon->count > CORNERS_MOST) return ENF_REMAINS_WHOLE;
    const uint64_t inside = find_heights(polygon, cut, heights);
    if (inside == first_bits(polygon->count)) return ENF_REMAINS_WHOLE;
    if (!inside) return ENF_REMAINS_NOTHING;
    if (spare > 0 && takes_little(heights, polygon->count, spare)) return ENF_REMAINS_WHOLE;
    const uint64_t next = inside >> 1 | (inside & 1) << (polygon->count - 1), in = next & ~inside,
                   out = inside & ~next;
    polygon->count = in & (in - 1)
                         ? keep_runs(piece, polygon, heights, inside)
                         : keep_run(piece, polygon, heights, __builtin_ctzll(in), __builtin_ctzll(out));
    polygon->stride = 4;
    polygon->corners = piece[0];
    return ENF_REMAINS_PART;
}

ENF_PART_OF_WIDE void make_window(enf_window *window, const polygon *polygon) {
    window->count = polygon->count;
    for (int axis = 0; axis < 3; axis++) {
        for (int32_t i = 0; i < polygon->count; i++)
            window->at[axis][i] = polygon->corners[i * polygon->stride + axis];
        enf_outline_close(window->at[axis], polygon->count);
    }
}

/// Cuts after each other, from one of two pieces into the other.
ENF_WIDE_TOO enf_remains enf_separators_cut(const enf_separators *separators, const enf_shapes *shapes,
                                            int32_t portal, enf_window *window) {
    const enf_shape *shape = &shapes->shapes[portal >> 1];
    uint64_t needed;
    if (!meets_box(separators, shape, &needed)) return ENF_REMAINS_NOTHING;
    polygon polygon = {shape->count, 3, shapes->corners[shape->first]};
    piece pieces[2];
    int cut_count = 0;
    for (; needed; needed &= needed - 1) {
        const int i = __builtin_ctzll(needed);
        const enf_cut cut = {{separators->normal[0][i], separators->normal[1][i], separators->normal[2][i]},
                             separators->least[i]};
        const enf_remains now = cut_off(&polygon, pieces[cut_count & 1], &cut, separators->spare);
        if (now == ENF_REMAINS_NOTHING) return now;
        cut_count += now == ENF_REMAINS_PART;
    }
    if (!cut_count) return ENF_REMAINS_WHOLE;
    make_window(window, &polygon);
    return ENF_REMAINS_PART;
}

enf_remains enf_separators_pass(const enf_separators *separators, const enf_shapes *shapes, int32_t portal,
                                enf_window *window) {
    const enf_remains remains = enf_separators_cut(separators, shapes, portal, window);
    if (remains == ENF_REMAINS_WHOLE) enf_shape_window(shapes, portal, window);
    return remains;
}
