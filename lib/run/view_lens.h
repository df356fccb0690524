// SPDX-License-Identifier: MIT
// Where the eye is and how it looks, in the world or in what a portal that transforms makes of it.
#ifndef ENF_RUN_VIEW_LENS_H
#define ENF_RUN_VIEW_LENS_H

#include "enfilade/view.h"

/// clip (x, y, w) = rows * (point - eye)
typedef struct enf_view_lens {
    double eye[3];
    double rows[3][3];
    double gram[6]; ///< products of rows: xx, yy, ww, xy, xw, yw
} enf_view_lens;

/// False if it is not finite or flat.
bool enf_lens_make(enf_view_lens *lens, const double eye[3], const double rows[3][3]);

/// The lens behind a portal: `matrix` carries points before it to points behind it, `inverse` back.
bool enf_lens_pass(enf_view_lens *behind, const enf_view_lens *before, const double matrix[12],
                   const double inverse[12]);

static inline void enf_lens_project(const enf_view_lens *lens, const double point[3], double clip[3]) {
    double x = point[0] - lens->eye[0], y = point[1] - lens->eye[1], z = point[2] - lens->eye[2];
    for (int i = 0; i < 3; i++) clip[i] = lens->rows[i][0] * x + lens->rows[i][1] * y + lens->rows[i][2] * z;
}

#endif
