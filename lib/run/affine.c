// SPDX-License-Identifier: MIT
#include "run/affine.h"

#include "run/vector.h"

void enf_affine_direction(const double matrix[12], const double direction[3], double turned[3]) {
    const double d[3] = {direction[0], direction[1], direction[2]};
    for (int a = 0; a < 3; a++) turned[a] = enf_dot(matrix + 4 * a, d);
}

void enf_affine_point(const double matrix[12], const double point[3], double moved[3]) {
    enf_affine_direction(matrix, point, moved);
    for (int a = 0; a < 3; a++) moved[a] += matrix[4 * a + 3];
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
    return enf_are_finite(inverse, 12);
}
