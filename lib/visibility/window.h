// SPDX-License-Identifier: GPL-3.0-or-later
// Windows: the convex part of an opening that sight may pass.
//
// Windows are never too small. A window stands for everything within a tolerance of it (enf_shapes), which is
// many thousand times what rounding does to a corner; cuts leave that much, and what follows from it, over.
#ifndef ENF_VISIBILITY_WINDOW_H
#define ENF_VISIBILITY_WINDOW_H

#include "enfilade/base.h"

#include <string.h>

enum {
    ENF_WINDOW_MOST = 96, ///< corners; outlines of openings have at most 64
    ENF_OUTLINE_MORE = 4  ///< places after the last corner; there is room up to the next four
};

/// Corners of a convex polygon, wherever they are: coordinates along each axis by themselves, so that four
/// corners are looked at in one go. After the last come the first ENF_OUTLINE_MORE again (if there are fewer,
/// again and again), so that next corners need no case of their own, nor do fours that reach over the end.
typedef struct enf_outline {
    int32_t count;
    const double *at[3];
} enf_outline;

typedef struct enf_window {
    int32_t count;
    double at[3][ENF_WINDOW_MOST + ENF_OUTLINE_MORE]; ///< only count + ENF_OUTLINE_MORE are there
} enf_window;

/// Keeps what is in front: normal . x >= least.
typedef struct enf_cut {
    double normal[3], least; ///< the normal has length 1
} enf_cut;

static inline double enf_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline enf_outline enf_window_outline(const enf_window *window) {
    return (enf_outline){window->count, {window->at[0], window->at[1], window->at[2]}};
}

static inline void enf_outline_corner(const enf_outline *outline, int32_t index, double corner[3]) {
    for (int axis = 0; axis < 3; axis++) corner[axis] = outline->at[axis][index];
}

/// Repeats the first corners after the last, in the coordinates along one axis.
static inline void enf_outline_close(double *along, int32_t count) {
    for (int32_t i = 0; i < ENF_OUTLINE_MORE; i++) along[count + i] = along[i];
}

/// Copies the coordinates along one axis of an outline that is closed, to where there is room for as many.
static inline void enf_outline_copy(double *to, const double *from, int32_t count) {
    for (int32_t i = 0; i < count + ENF_OUTLINE_MORE; i += 4) memcpy(to + i, from + i, 4 * sizeof *to);
}

/// A window of these corners.
void enf_window_copy(enf_window *window, const double (*corners)[3], int32_t count);

void enf_window_take(enf_window *window, const enf_outline *outline);

/// The mean of the corners.
void enf_window_middle(const enf_window *window, double middle[3]);

#endif
