// SPDX-License-Identifier: MIT
#include "run/view_lens.h"

#include "run/affine.h"
#include "run/vector.h"

#include <string.h>

bool enf_lens_make(enf_view_lens *lens, const double eye[3], const double rows[3][3]) {
    memmove(lens->eye, eye, sizeof lens->eye);
    memmove(lens->rows, rows, sizeof lens->rows);
    for (int i = 0; i < 3; i++) {
        lens->gram[i] = enf_dot(lens->rows[i], lens->rows[i]);
        lens->gram[3 + i] = enf_dot(lens->rows[i == 2], lens->rows[1 + (i > 0)]);
    }
    double matrix[12] = {0};
    for (int i = 0; i < 3; i++) memcpy(matrix + 4 * i, lens->rows[i], sizeof lens->rows[i]);
    double determinant = enf_affine_determinant(matrix);
    return enf_are_finite(lens->eye, 3) && enf_are_finite(lens->gram, 6) && isfinite(determinant) &&
           determinant != 0;
}

bool enf_lens_pass(enf_view_lens *behind, const enf_view_lens *before, const double matrix[12],
                   const double inverse[12]) {
    double eye[3], rows[3][3];
    enf_affine_point(matrix, before->eye, eye);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            rows[i][j] = before->rows[i][0] * inverse[j] + before->rows[i][1] * inverse[4 + j] +
                         before->rows[i][2] * inverse[8 + j];
    return enf_lens_make(behind, eye, (const double(*)[3])rows);
}

static void make_unit(double v[3]) {
    double length = sqrt(enf_dot(v, v));
    for (int i = 0; i < 3; i++) v[i] /= length;
}

enf_camera enf_camera_look(const double eye[3], const double forward[3], const double up[3], double fov,
                           double aspect) {
    enf_camera camera = {.size = sizeof camera};
    double tangent = tan(fov / 2), axes[3][3],
           scales[3] = {tangent * aspect, tangent, 1}; // right, up, forward
    memcpy(axes[2], forward, sizeof axes[2]);
    make_unit(axes[2]);
    enf_cross(axes[2], up, axes[0]);
    make_unit(axes[0]);
    enf_cross(axes[0], axes[2], axes[1]);
    memcpy(camera.eye, eye, sizeof camera.eye);
    for (int i = 0; i < 4; i++) {
        double *row = camera.matrix + 4 * i;
        const int axis = i < 2 ? i : 2;
        for (int k = 0; k < 3; k++) row[k] = axes[axis][k] / scales[axis];
        row[3] = -enf_dot(row, eye);
    }
    camera.matrix[11] -= 1; // z / w goes from the near plane, at depth 1, to infinity
    return camera;
}
