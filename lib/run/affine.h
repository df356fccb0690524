// SPDX-License-Identifier: MIT
// Affine matrices, 3 x 4, row by row, as portals that transform have them.
#ifndef ENF_RUN_AFFINE_H
#define ENF_RUN_AFFINE_H

#include <stdbool.h>

/// matrix * point. The two may be the same place.
void enf_affine_point(const double matrix[12], const double point[3], double moved[3]);

/// The same for a direction, which is not moved.
void enf_affine_direction(const double matrix[12], const double direction[3], double turned[3]);

/// product = a * b
void enf_affine_multiply(double product[12], const double a[12], const double b[12]);

/// False if there is no finite one.
bool enf_affine_invert(double inverse[12], const double matrix[12]);

/// That of the linear part.
double enf_affine_determinant(const double matrix[12]);

#endif
