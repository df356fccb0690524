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

enf_camera enf_camera_look(const double eye[3], const double forward[3], const double up[3], double fov,
                           double aspect) {
    enf_camera camera = {.size = sizeof camera};
    double f[3], r[3], u[3];
    double length = sqrt(enf_dot(forward, forward)), tangent = tan(fov / 2);
    for (int i = 0; i < 3; i++) f[i] = forward[i] / length;
    for (int i = 0; i < 3; i++) r[i] = f[(i + 1) % 3] * up[(i + 2) % 3] - f[(i + 2) % 3] * up[(i + 1) % 3];
    length = sqrt(enf_dot(r, r));
    for (int i = 0; i < 3; i++) r[i] /= length;
    for (int i = 0; i < 3; i++) u[i] = r[(i + 1) % 3] * f[(i + 2) % 3] - r[(i + 2) % 3] * f[(i + 1) % 3];
    for (int i = 0; i < 3; i++) {
        camera.eye[i] = eye[i];
        camera.matrix[i] = r[i] / (tangent * aspect);
        camera.matrix[4 + i] = u[i] / tangent;
        camera.matrix[8 + i] = camera.matrix[12 + i] = f[i];
    }
    for (int i = 0; i < 4; i++) camera.matrix[4 * i + 3] = -enf_dot(camera.matrix + 4 * i, eye);
    camera.matrix[11] -= 1; // z / w goes from the near plane, at depth 1, to infinity
    return camera;
}
