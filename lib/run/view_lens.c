// SPDX-License-Identifier: MIT
#include "run/view_lens.h"

#include <math.h>
#include <string.h>

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

double enf_affine_determinant(const double m[12]) {
    return m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
           m[2] * (m[4] * m[9] - m[5] * m[8]);
}

void enf_affine_multiply(double product[12], const double a[12], const double b[12]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            product[4 * i + j] = a[4 * i] * b[j] + a[4 * i + 1] * b[4 + j] + a[4 * i + 2] * b[8 + j] +
                                 (j == 3 ? a[4 * i + 3] : 0);
}

static bool is_finite(const double *numbers, int count) {
    for (int i = 0; i < count; i++)
        if (!isfinite(numbers[i])) return false;
    return true;
}

bool enf_affine_invert(double inverse[12], const double m[12]) {
    double determinant = enf_affine_determinant(m);
    if (!(fabs(determinant) > 0)) return false;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int r = (j + 1) % 3, s = (j + 2) % 3, u = (i + 1) % 3, v = (i + 2) % 3;
            inverse[4 * i + j] = (m[4 * r + u] * m[4 * s + v] - m[4 * r + v] * m[4 * s + u]) / determinant;
        }
    for (int i = 0; i < 3; i++)
        inverse[4 * i + 3] =
            -(inverse[4 * i] * m[3] + inverse[4 * i + 1] * m[7] + inverse[4 * i + 2] * m[11]);
    return is_finite(inverse, 12);
}

bool enf_lens_make(enf_view_lens *lens, const double eye[3], const double rows[3][3]) {
    memmove(lens->eye, eye, sizeof lens->eye);
    memmove(lens->rows, rows, sizeof lens->rows);
    for (int i = 0; i < 3; i++) {
        lens->gram[i] = dot(lens->rows[i], lens->rows[i]);
        lens->gram[3 + i] = dot(lens->rows[i == 2], lens->rows[1 + (i > 0)]);
    }
    double matrix[12] = {0};
    for (int i = 0; i < 3; i++) memcpy(matrix + 4 * i, lens->rows[i], sizeof lens->rows[i]);
    double determinant = enf_affine_determinant(matrix);
    return is_finite(lens->eye, 3) && is_finite(lens->gram, 6) && isfinite(determinant) && determinant != 0;
}

bool enf_lens_pass(enf_view_lens *behind, const enf_view_lens *before, const double matrix[12],
                   const double inverse[12]) {
    double eye[3], rows[3][3];
    for (int i = 0; i < 3; i++) eye[i] = dot(matrix + 4 * i, before->eye) + matrix[4 * i + 3];
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
    double length = sqrt(dot(forward, forward)), tangent = tan(fov / 2);
    for (int i = 0; i < 3; i++) f[i] = forward[i] / length;
    for (int i = 0; i < 3; i++) r[i] = f[(i + 1) % 3] * up[(i + 2) % 3] - f[(i + 2) % 3] * up[(i + 1) % 3];
    length = sqrt(dot(r, r));
    for (int i = 0; i < 3; i++) r[i] /= length;
    for (int i = 0; i < 3; i++) u[i] = r[(i + 1) % 3] * f[(i + 2) % 3] - r[(i + 2) % 3] * f[(i + 1) % 3];
    for (int i = 0; i < 3; i++) {
        camera.eye[i] = eye[i];
        camera.matrix[i] = r[i] / (tangent * aspect);
        camera.matrix[4 + i] = u[i] / tangent;
        camera.matrix[8 + i] = camera.matrix[12 + i] = f[i];
    }
    for (int i = 0; i < 4; i++) camera.matrix[4 * i + 3] = -dot(camera.matrix + 4 * i, eye);
    camera.matrix[11] -= 1; // z / w goes from the near plane, at depth 1, to infinity
    return camera;
}
