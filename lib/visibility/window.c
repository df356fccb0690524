// SPDX-License-Identifier: GPL-3.0-or-later
// Clipping after I. E. Sutherland and G. W. Hodgman, "Reentrant polygon clipping" (1974).
#include "visibility/window.h"

#include <string.h>

void enf_window_copy(enf_window *window, const double (*corners)[3], int32_t count) {
    window->count = count;
    memcpy(window->corners, corners, (size_t)count * sizeof *corners);
}

/// Where the edge from a to b crosses, given the heights of its ends, of which one is negative.
static void cross(const double a[3], const double b[3], double height_a, double height_b, double at[3]) {
    double share = height_a / (height_a - height_b);
    for (int axis = 0; axis < 3; axis++) at[axis] = a[axis] + share * (b[axis] - a[axis]);
}

enf_remains enf_window_cut(enf_window *window, const enf_cut *cut) {
    double heights[ENF_WINDOW_MOST];
    int32_t count = window->count, inside = 0;
    for (int32_t i = 0; i < count; i++) {
        heights[i] = enf_dot(cut->normal, window->corners[i]) - cut->least;
        inside += heights[i] >= 0;
    }
    if (inside == count || count == ENF_WINDOW_MOST) return ENF_REMAINS_WHOLE;
    if (inside == 0) return ENF_REMAINS_NOTHING;
    double left[ENF_WINDOW_MOST][3];
    int32_t made = 0;
    for (int32_t i = 0; i < count; i++) {
        int32_t next = i + 1 < count ? i + 1 : 0;
        bool is_in = heights[i] >= 0;
        if (is_in) memcpy(left[made++], window->corners[i], sizeof *left);
        if (is_in == (heights[next] >= 0)) continue;
        cross(window->corners[i], window->corners[next], heights[i], heights[next], left[made++]);
    }
    enf_window_copy(window, (const double(*)[3])left, made);
    return ENF_REMAINS_PART;
}

void enf_window_middle(const enf_window *window, double middle[3]) {
    for (int axis = 0; axis < 3; axis++) {
        double sum = 0;
        for (int32_t i = 0; i < window->count; i++) sum += window->corners[i][axis];
        middle[axis] = sum / window->count;
    }
}
