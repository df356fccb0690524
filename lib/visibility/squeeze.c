// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/squeeze.h"

#include "base/array.h"
#include "base/hash.h"
#include "visibility/view_cone.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    ROUNDS = 4, ///< there and back, at most, before something is halved
    TRIES = 4,  ///< lines, then
    DEPTH_MOST = 60
};

/// Squeezed to less than this share of its length, a solid is worth another round.
static const double worth = 0.8;

/// Added to each of the random weights, so that they are not all 0.
static const double least_weight = 1e-9;

/// Of the size of the world: smaller solids are not halved, as separators leave about that much over.
static const double tiny = 0x1p-19;

/// A row of windows between two solids.
typedef struct row {
    enf_solid ends[2];
    int32_t count;
    const int32_t *portals;
    enf_window windows[];
} row;

static double next_share(enf_squeeze *squeeze) {
    squeeze->seed = enf_hash_mix(squeeze->seed + UINT64_C(0x9e3779b97f4a7c15));
    return (double)(squeeze->seed >> 11) * 0x1p-53;
}

bool enf_squeeze_window(enf_window *window, const enf_separators *cuts) {
    double heights[ENF_WINDOW_MOST + 1];
    for (int32_t c = 0; c < cuts->count; c++) {
        int32_t in = 0, made = 0;
        enf_window left;
        for (int32_t i = 0; i < window->count; i++) {
            heights[i] = -cuts->least[c];
            for (int axis = 0; axis < 3; axis++) heights[i] += cuts->normal[axis][c] * window->at[axis][i];
            in += heights[i] >= 0;
        }
        if (in == 0) return false;
        if (in == window->count || window->count + 2 > ENF_WINDOW_MOST) continue;
        heights[window->count] = heights[0];
        for (int32_t i = 0; i < window->count && made + 2 < ENF_WINDOW_MOST; i++) {
            const bool is_in = heights[i] >= 0;
            if (is_in) {
                for (int axis = 0; axis < 3; axis++) left.at[axis][made] = window->at[axis][i];
                made++;
            }
            if (is_in == (heights[i + 1] >= 0)) continue;
            const double share = heights[i] / (heights[i] - heights[i + 1]);
            for (int axis = 0; axis < 3; axis++) // windows are closed
                left.at[axis][made] =
                    window->at[axis][i] + share * (window->at[axis][i + 1] - window->at[axis][i]);
            made++;
        }
        if (made < 3) continue; // cannot be: some corner is in, and two edges are cut
        for (int axis = 0; axis < 3; axis++) enf_outline_close(left.at[axis], made);
        left.count = made;
        const enf_outline outline = enf_window_outline(&left);
        enf_window_take(window, &outline);
    }
    return true;
}

// ---------------------------------------------------------------------------------------------- squeezing

/// The separators between an end and a window, seen from there.
static void separate(enf_squeeze *squeeze, const row *row, int end, const enf_body *body, int32_t window,
                     enf_separators *separators) {
    const enf_outline outline = enf_window_outline(&row->windows[window]);
    squeeze->steps--;
    enf_separators_from_body(separators, squeeze->shapes, body, &outline, row->portals[window] ^ end);
}

/// From one end through all windows to the other. False if nothing is left of something.
static bool squeeze_towards(enf_squeeze *squeeze, row *row, int end) {
    const int32_t step = end ? -1 : 1, last = end ? 0 : row->count - 1;
    enf_body body;
    enf_separators separators;
    enf_body_make(&body, (const double(*)[3])row->ends[end].corners, row->ends[end].count,
                  squeeze->shapes->tolerance / 8);
    for (int32_t i = end ? row->count - 1 : 0;; i += step) {
        separate(squeeze, row, end, &body, i, &separators);
        if (i == last) break;
        if (!enf_squeeze_window(&row->windows[i + step], &separators)) return false;
    }
    return enf_solid_cut_all(&row->ends[!end], &separators);
}

// ---------------------------------------------------------------------------------------------- lines

/// What of the other end can be seen from a point through all windows. False: nothing.
static bool look(const row *row, const double eye[3], int end, enf_solid *visible) {
    *visible = row->ends[!end];
    for (int32_t i = 0; i < row->count; i++) {
        enf_separators cone;
        enf_view_cone_find(&cone, eye, &row->windows[i], row->portals[i] ^ end);
        if (!enf_solid_cut_all(visible, &cone)) return false;
    }
    return true;
}

static void mix_corners(enf_squeeze *squeeze, const enf_solid *solid, double point[3]) {
    double sum = 0;
    memset(point, 0, 3 * sizeof *point);
    for (int32_t i = 0; i < solid->count; i++) {
        const double weight = pow(next_share(squeeze), 4) + least_weight;
        sum += weight;
        for (int axis = 0; axis < 3; axis++) point[axis] += weight * solid->corners[i][axis];
    }
    for (int axis = 0; axis < 3; axis++) point[axis] /= sum;
}

/// Looks from one end to the other, and from the middle of what is seen back: the line between the middles of
/// both is the better for it. HIDDEN: no line.
static enf_squeeze_answer find_line(enf_squeeze *squeeze, const row *row) {
    for (int k = 0; k < TRIES; k++) {
        const int end = k & 1;
        enf_solid there, back;
        enf_line line;
        double *points[2] = {line.from, line.to};
        if (k < 2)
            enf_solid_middle(&row->ends[end], points[end]);
        else
            mix_corners(squeeze, &row->ends[end], points[end]);
        if (!look(row, points[end], end, &there)) continue;
        enf_solid_middle(&there, points[!end]);
        if (squeeze->try_line(squeeze->user, &line)) return ENF_SQUEEZE_SEEN;
        if (!look(row, points[!end], !end, &back)) continue;
        enf_solid_middle(&back, points[end]);
        if (squeeze->try_line(squeeze->user, &line)) return ENF_SQUEEZE_SEEN;
        if (squeeze->is_rough) return ENF_SQUEEZE_OPEN;
    }
    return ENF_SQUEEZE_HIDDEN;
}

// ---------------------------------------------------------------------------------------------- halving

/// A copy; null without memory.
static row *copy_row(const row *old) {
    row *copy = malloc(sizeof *copy + (size_t)old->count * sizeof *copy->windows);
    if (!copy) return NULL;
    memcpy(copy, old, sizeof *copy);
    for (int32_t i = 0; i < old->count; i++) {
        const enf_outline outline = enf_window_outline(&old->windows[i]);
        enf_window_take(&copy->windows[i], &outline);
    }
    return copy;
}

static enf_status settle(enf_squeeze *squeeze, row *row, int depth, enf_squeeze_answer *answer,
                         enf_error *error);

// NOLINTNEXTLINE(misc-no-recursion): DEPTH_MOST at most
static enf_status halve(enf_squeeze *squeeze, row *row, int depth, enf_squeeze_answer *answer,
                        enf_error *error) {
    int axes[2];
    double middles[2], extents[2];
    for (int end = 0; end < 2; end++)
        extents[end] = enf_solid_extent(&row->ends[end], &axes[end], &middles[end]);
    const int end = extents[1] > extents[0];
    *answer = ENF_SQUEEZE_OPEN;
    if (squeeze->steps <= 0) return ENF_OK;
    if (depth == DEPTH_MOST || extents[end] < squeeze->shapes->extent * tiny) {
        squeeze->is_tiny = true;
        return ENF_OK;
    }
    bool is_open = false;
    for (int side = 0; side < 2; side++) {
        struct row *half = copy_row(row);
        if (!half) return enf_fail_memory(error, "the windows");
        const double sign = side ? 1 : -1;
        enf_cut cut = {.least = sign * middles[end]};
        cut.normal[axes[end]] = sign;
        enf_status status = ENF_OK;
        *answer = ENF_SQUEEZE_HIDDEN;
        if (enf_solid_cut(&half->ends[end], &cut)) status = settle(squeeze, half, depth + 1, answer, error);
        free(half);
        if (status || *answer == ENF_SQUEEZE_SEEN) return status;
        is_open = is_open || *answer == ENF_SQUEEZE_OPEN;
        if (is_open && squeeze->is_rough) return ENF_OK;
    }
    *answer = is_open ? ENF_SQUEEZE_OPEN : ENF_SQUEEZE_HIDDEN;
    return ENF_OK;
}

// NOLINTNEXTLINE(misc-no-recursion): DEPTH_MOST at most
static enf_status settle(enf_squeeze *squeeze, row *row, int depth, enf_squeeze_answer *answer,
                         enf_error *error) {
    *answer = ENF_SQUEEZE_HIDDEN;
    for (int round = 0; round < ROUNDS && row->count > 0; round++) {
        double before[2], middle;
        int axis;
        for (int end = 0; end < 2; end++) before[end] = enf_solid_extent(&row->ends[end], &axis, &middle);
        if (!squeeze_towards(squeeze, row, 1) || !squeeze_towards(squeeze, row, 0)) return ENF_OK;
        bool goes_on = false;
        for (int end = 0; end < 2; end++)
            goes_on = goes_on || enf_solid_extent(&row->ends[end], &axis, &middle) < worth * before[end];
        if (!goes_on) break;
    }
    *answer = find_line(squeeze, row);
    if (*answer != ENF_SQUEEZE_HIDDEN) return ENF_OK;
    return halve(squeeze, row, depth, answer, error);
}

enf_status enf_squeeze_run(enf_squeeze *squeeze, const enf_solid *from, const int32_t *portals,
                           const enf_window *windows, int32_t count, const enf_solid *to,
                           enf_squeeze_answer *answer, enf_error *error) {
    row *row = malloc(sizeof *row + (size_t)count * sizeof *row->windows);
    if (!row) return enf_fail_memory(error, "the windows");
    row->ends[0] = *from;
    row->ends[1] = *to;
    row->count = count;
    row->portals = portals;
    for (int32_t i = 0; i < count; i++) {
        const enf_outline outline = enf_window_outline(&windows[i]);
        enf_window_take(&row->windows[i], &outline);
    }
    enf_status status = settle(squeeze, row, 0, answer, error);
    free(row);
    return status;
}
