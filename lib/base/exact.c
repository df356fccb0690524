// SPDX-License-Identifier: MIT
// The filter is static analysis in the manner of J. R. Shewchuk, "Adaptive precision floating-point
// arithmetic and fast robust geometric predicates" (1997), first stage; the exact tier is plain integers.
#include "base/exact.h"

#include "base/narrow.h"
#ifdef __SIZEOF_INT128__
#include "base/parts.h"
#endif

#include <math.h>

#ifdef __SIZEOF_INT128__
static int sign_of_determinant(const int64_t u[3], const int64_t v[3], const int64_t w[3]) {
    enf_parts sum = {0, 0};
    enf_parts_add(&sum, w[0], enf_minor(u[1], u[2], v[1], v[2]));
    enf_parts_add(&sum, w[1], enf_minor(u[2], u[0], v[2], v[0]));
    enf_parts_add(&sum, w[2], enf_minor(u[0], u[1], v[0], v[1]));
    return enf_parts_sign(&sum);
}
#else
#define sign_of_determinant enf_narrow_determinant
#endif

int enf_points_orient_exactly(const double a[3], const double b[3], const double c[3], const double d[3]) {
    int64_t u[3], v[3], w[3];
    enf_points_subtract(b, a, u);
    enf_points_subtract(c, a, v);
    enf_points_subtract(d, a, w);
    return sign_of_determinant(u, v, w);
}

double enf_points_unit(const double *const *points, int count) {
    uint64_t bits = UINT64_C(1) << 53;
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) bits |= (uint64_t)(int64_t)points[i][k];
    }
    return (double)(bits & -bits);
}

int enf_points_orient_quickly(const double a[3], const double b[3], const double c[3], const double d[3]) {
    double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
    double wx = d[0] - a[0], wy = d[1] - a[1], wz = d[2] - a[2];
    double uy_vz = uy * vz, uz_vy = uz * vy, uz_vx = uz * vx, ux_vz = ux * vz, ux_vy = ux * vy,
           uy_vx = uy * vx;
    double determinant = wx * (uy_vz - uz_vy) + wy * (uz_vx - ux_vz) + wz * (ux_vy - uy_vx);
    if (fabs(determinant) > ENF_ORIENT_SURE) return determinant > 0 ? 1 : -1;
    double magnitude = fabs(wx) * (fabs(uy_vz) + fabs(uz_vy)) + fabs(wy) * (fabs(uz_vx) + fabs(ux_vz)) +
                       fabs(wz) * (fabs(ux_vy) + fabs(uy_vx));
    // Each term is a product of three rounded differences (3u), two rounded products (2u) and three rounded
    // sums (3u): 8u and a little; 10 * 2^-53 covers the rounding of `magnitude` as well.
    if (fabs(determinant) > 10 * 0x1p-53 * magnitude) return determinant > 0 ? 1 : -1;
    double unit = enf_points_unit((const double *const[]){a, b, c, d}, 4);
    // Few significant bits: nothing above was rounded, and 0 is 0.
    if (magnitude < 0x1p53 * unit * unit * unit) return determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
    return ENF_UNSURE;
}

int enf_points_orient_closely(const double a[3], const double b[3], const double c[3], const double d[3]) {
    int sign = enf_points_orient_quickly(a, b, c, d);
    return sign == ENF_UNSURE ? enf_points_orient_exactly(a, b, c, d) : sign;
}
