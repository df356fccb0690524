// SPDX-License-Identifier: MIT
#ifndef ENF_RUN_VECTOR_H
#define ENF_RUN_VECTOR_H

#include <math.h>
#include <stdbool.h>

static inline double enf_dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void enf_subtract(const double a[3], const double b[3], double difference[3]) {
    for (int i = 0; i < 3; i++) difference[i] = a[i] - b[i];
}

static inline void enf_cross(const double a[3], const double b[3], double product[3]) {
    product[0] = a[1] * b[2] - a[2] * b[1];
    product[1] = a[2] * b[0] - a[0] * b[2];
    product[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double enf_distance(const double a[3], const double b[3]) {
    double d[3];
    enf_subtract(a, b, d);
    return sqrt(enf_dot(d, d));
}

/// a + share * (b - a)
static inline void enf_between(const double a[3], const double b[3], double share, double point[3]) {
    for (int i = 0; i < 3; i++) point[i] = a[i] + share * (b[i] - a[i]);
}

static inline bool enf_are_finite(const double *numbers, int count) {
    for (int i = 0; i < count; i++)
        if (!isfinite(numbers[i])) return false;
    return true;
}

#endif
