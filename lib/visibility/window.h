// SPDX-License-Identifier: GPL-3.0-or-later
// Windows: the convex part of an opening that sight may pass, and planes that cut it down.
//
// Windows are never too small. A window stands for everything within a tolerance of it (enf_shapes), which is
// many thousand times what rounding does to a corner; cuts leave that much, and what follows from it, over.
#ifndef ENF_VISIBILITY_WINDOW_H
#define ENF_VISIBILITY_WINDOW_H

#include "enfilade/base.h"

enum { ENF_WINDOW_MOST = 96 }; ///< corners; outlines of openings have at most 64

typedef struct enf_window {
    int32_t count;
    double corners[ENF_WINDOW_MOST][3]; ///< only the first `count` are there, so copy with enf_window_copy
} enf_window;

/// Keeps what is in front: normal . x >= least.
typedef struct enf_cut {
    double normal[3], least; ///< the normal has length 1
} enf_cut;

static inline double enf_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

void enf_window_copy(enf_window *window, const double (*corners)[3], int32_t count);

typedef enum enf_remains { ENF_REMAINS_NOTHING, ENF_REMAINS_PART, ENF_REMAINS_WHOLE } enf_remains;

/// Cuts a piece off, and says what is left.
enf_remains enf_window_cut(enf_window *window, const enf_cut *cut);

/// The mean of the corners.
void enf_window_middle(const enf_window *window, double middle[3]);

#endif
