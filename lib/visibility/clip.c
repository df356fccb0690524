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
        some |= (height < reach) & bits;
    }
    *needed = (uint64_t)((some[0] | some[1]) | (some[2] | some[3]));
    return !((nothing[0] | nothing[1]) | (nothing[2] | nothing[3]));
}

enum { CORNERS_MOST = 64 }; ///< of windows that are cut: sets of corners are 64-bit words

/// That many bits, 1 to 64.
ENF_PART_OF_WIDE uint64_t first_bits(int32_t count) {
    return ~UINT64_C(0) >> (64 - count);
}

/// How high the corners lie above a cut. Which are in front?
ENF_PART_OF_WIDE uint64_t find_heights(const enf_outline *outline, const enf_cut *cut, double *heights) {
    uint64_t inside = 0;
    for (int32_t i = 0; i < outline->count; i += ENF_FOUR) {
        const enf_four x = enf_four_load(outline->at[0] + i), y = enf_four_load(outline->at[1] + i),
                       z = enf_four_load(outline->at[2] + i);
        const enf_four height = cut->normal[0] * x + cut->normal[1] * y + cut->normal[2] * z - cut->least;
        enf_four_store(heights + i, height);
        inside |= (uint64_t)enf_four_bits(height >= 0) << i;
    }
    return inside & first_bits(outline->count);
}

/// Puts the point of the edge from corner i to the next that is in the cut's plane.
ENF_PART_OF_WIDE void put_crossing(enf_window *window, int32_t at, const enf_outline *outline, int32_t i,
                                   double height, double next_height) {
    const double share = height / (height - next_height);
    for (int axis = 0; axis < 3; axis++) {
        const double a = outline->at[axis][i], b = outline->at[axis][i + 1];
        window->at[axis][at] = a + share * (b - a);
    }
}

/// Copies corners, and up to three more that are of no use.
ENF_PART_OF_WIDE void put_corners(enf_window *window, int32_t at, const enf_outline *outline, int32_t first,
                                  int32_t count) {
    for (int32_t i = 0; i < count; i += ENF_FOUR)
        for (int axis = 0; axis < 3; axis++)
            enf_four_store(window->at[axis] + at + i, enf_four_load(outline->at[axis] + first + i));
}

/// Keeps a run of corners, from after one edge that crosses the cut up to another.
ENF_PART_OF_WIDE void keep_run(enf_window *window, const enf_outline *outline, const double *heights,
                               int32_t in, int32_t out) {
    const int32_t count = outline->count, first = in + 1 < count ? in + 1 : 0;
    int32_t made;
    if (first <= out) {
        put_corners(window, 0, outline, first, made = out + 1 - first);
    } else {
        put_corners(window, 0, outline, first, count - first);
        put_corners(window, count - first, outline, 0, out + 1);
        made = count - first + out + 1;
    }
    put_crossing(window, made++, outline, out, heights[out], heights[out + 1 < count ? out + 1 : 0]);
    put_crossing(window, made++, outline, in, heights[in], heights[first]);
    window->count = made;
}

/// Keeps the corners in front, and where edges cross the cut, of an outline that rounding has bent.
static void keep_all(enf_window *window, const enf_outline *outline, const double *heights, uint64_t inside) {
    int32_t made = 0;
    for (int32_t i = 0; i < outline->count; i++) {
        const int32_t next = i + 1 < outline->count ? i + 1 : 0;
        const bool is_in = inside >> i & 1;
        if (is_in)
            for (int axis = 0; axis < 3; axis++) window->at[axis][made] = outline->at[axis][i];
        made += is_in;
        if (is_in != (inside >> next & 1))
            put_crossing(window, made++, outline, i, heights[i], heights[next]);
    }
    window->count = made;
}

/// Cuts a piece off an outline, and says what is left. Only a part is put into the window.
ENF_PART_OF_WIDE enf_remains cut_off(enf_window *window, const enf_outline *outline, const enf_cut *cut) {
    double heights[CORNERS_MOST + ENF_OUTLINE_MORE];
    if (outline->count > CORNERS_MOST) return ENF_REMAINS_WHOLE;
    const uint64_t all = first_bits(outline->count), inside = find_heights(outline, cut, heights);
    if (inside == all) return ENF_REMAINS_WHOLE;
    if (!inside) return ENF_REMAINS_NOTHING;
    const uint64_t next = inside >> 1 | (inside & 1) << (outline->count - 1), in = next & ~inside,
                   out = inside & ~next;
    if (!(in & (in - 1)))
        keep_run(window, outline, heights, __builtin_ctzll(in), __builtin_ctzll(out));
    else
        keep_all(window, outline, heights, inside);
    for (int axis = 0; axis < 3; axis++) enf_outline_close(window->at[axis], window->count);
    return ENF_REMAINS_PART;
}

/// Cuts after each other, from one of two windows into the other.
ENF_WIDE_TOO enf_remains enf_separators_cut(const enf_separators *separators, const enf_shapes *shapes,
                                            int32_t portal, enf_window *window) {
    uint64_t needed;
    if (!meets_box(separators, &shapes->shapes[portal >> 1], &needed)) return ENF_REMAINS_NOTHING;
    enf_outline left = enf_shape_outline(shapes, portal >> 1);
    enf_window spare, *next = window;
    for (; needed; needed &= needed - 1) {
        const int i = __builtin_ctzll(needed);
        const enf_cut cut = {{separators->normal[0][i], separators->normal[1][i], separators->normal[2][i]},
                             separators->least[i]};
        const enf_remains now = cut_off(next, &left, &cut);
        if (now == ENF_REMAINS_NOTHING) return now;
        if (now == ENF_REMAINS_WHOLE) continue;
        left = enf_window_outline(next);
        next = next == window ? &spare : window;
    }
    if (left.at[0] == window->at[0]) return ENF_REMAINS_PART;
    if (left.at[0] != spare.at[0]) return ENF_REMAINS_WHOLE;
    enf_window_take(window, &left);
    return ENF_REMAINS_PART;
}

enf_remains enf_separators_pass(const enf_separators *separators, const enf_shapes *shapes, int32_t portal,
                                enf_window *window) {
    const enf_remains remains = enf_separators_cut(separators, shapes, portal, window);
    if (remains == ENF_REMAINS_WHOLE) enf_shape_window(shapes, portal, window);
    return remains;
}
