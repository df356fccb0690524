// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/window.h"

void enf_window_copy(enf_window *window, const double (*corners)[3], int32_t count) {
    window->count = count;
    for (int axis = 0; axis < 3; axis++) {
        for (int32_t i = 0; i < count; i++) window->at[axis][i] = corners[i][axis];
        enf_outline_close(window->at[axis], count);
    }
}

void enf_window_take(enf_window *window, const enf_outline *outline) {
    window->count = outline->count;
    for (int axis = 0; axis < 3; axis++)
        enf_outline_copy(window->at[axis], outline->at[axis], outline->count);
}

void enf_window_middle(const enf_window *window, double middle[3]) {
    for (int axis = 0; axis < 3; axis++) {
        double sum = 0;
        for (int32_t i = 0; i < window->count; i++) sum += window->at[axis][i];
        middle[axis] = sum / window->count;
    }
}
