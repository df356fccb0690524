// SPDX-License-Identifier: MIT
// The filter is static analysis in the manner of J. R. Shewchuk, "Adaptive precision floating-point
// arithmetic and fast robust geometric predicates" (1997), first stage; the exact tier is plain integers.
#include "base/exact.h"

#include "base/wide.h"

#include <math.h>

/// Whatever the points, a determinant is not off by more: its magnitude below is at most 6 * 2^162.
#define SURE 0x1p115

static int orient_exactly(const double a[3], const double b[3], const double c[3], const double d[3]) {
    int64_t u[3], v[3], w[3];
    for (int i = 0; i < 3; i++) {
        int64_t origin = (int64_t)a[i];
        u[i] = (int64_t)b[i] - origin;
        v[i] = (int64_t)c[i] - origin;
        w[i] = (int64_t)d[i] - origin;
    }
    enf_wide sum = {0}, minor, factor;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        enf_wide_set(&minor, (enf_int128)u[j] * v[k] - (enf_int128)u[k] * v[j]);
        enf_wide_set(&factor, w[i]);
        enf_wide_add_product(&sum, &minor, &factor);
    }
    return sum.sign;
}

double enf_points_unit(const double *const *points, int count) {
    uint64_t bits = UINT64_C(1) << 53;
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) bits |= (uint64_t)(int64_t)points[i][k];
    }
    return (double)(bits & -bits);
}

int enf_points_orient(const double a[3], const double b[3], const double c[3], const double d[3]) {
    double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
    double wx = d[0] - a[0], wy = d[1] - a[1], wz = d[2] - a[2];
    double uy_vz = uy * vz, uz_vy = uz * vy, uz_vx = uz * vx, ux_vz = ux * vz, ux_vy = ux * vy,
           uy_vx = uy * vx;
    double determinant = wx * (uy_vz - uz_vy) + wy * (uz_vx - ux_vz) + wz * (ux_vy - uy_vx);
    if (fabs(determinant) > SURE) return determinant > 0 ? 1 : -1;
    double magnitude = fabs(wx) * (fabs(uy_vz) + fabs(uz_vy)) + fabs(wy) * (fabs(uz_vx) + fabs(ux_vz)) +
                       fabs(wz) * (fabs(ux_vy) + fabs(uy_vx));
    // Each term is a product of three rounded differences (3u), two rounded products (2u) and three rounded
    // sums (3u): 8u and a little; 10 * 2^-53 covers the rounding of `magnitude` as well.
    if (fabs(determinant) > 10 * 0x1p-53 * magnitude) return determinant > 0 ? 1 : -1;
    double unit = enf_points_unit((const double *const[]){a, b, c, d}, 4);
    // Few significant bits: nothing above was rounded, and 0 is 0.
    if (magnitude < 0x1p53 * unit * unit * unit) return determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
    return orient_exactly(a, b, c, d);
}
