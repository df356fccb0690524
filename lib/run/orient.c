// SPDX-License-Identifier: MIT
// A floating-point filter in the manner of J. R. Shewchuk, "Adaptive precision floating-point arithmetic and
// fast robust geometric predicates" (1997), first stage; where it cannot tell, schoolbook integers in 32-bit
// digits.
#include "run/orient.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>

#define DIGITS 6 // 192 bits; the sum of six products of three 54-bit numbers stays below 2^165

/// sum += or -= x * y * z, two's complement. |x|, |y|, |z| <= 2^54.
static void add_product(uint32_t sum[DIGITS], int64_t x, int64_t y, int64_t z, bool negate) {
    const int64_t factors[3] = {x, y, z};
    uint32_t product[DIGITS] = {1};
    for (int f = 0; f < 3; f++) {
        uint64_t magnitude = factors[f] < 0 ? -(uint64_t)factors[f] : (uint64_t)factors[f];
        uint32_t low = (uint32_t)magnitude, high = (uint32_t)(magnitude >> 32);
        negate ^= factors[f] < 0;
        uint64_t low_carry = 0, high_carry = 0;
        uint32_t below = 0; // the digit that `high` multiplies into this place
        for (int i = 0; i < DIGITS; i++) {
            uint64_t low_part = (uint64_t)product[i] * low + low_carry;
            uint64_t high_part = (uint64_t)below * high + (uint32_t)low_part + high_carry;
            below = product[i];
            product[i] = (uint32_t)high_part;
            low_carry = low_part >> 32;
            high_carry = high_part >> 32;
        }
    }
    uint64_t carry = negate ? 1 : 0;
    for (int i = 0; i < DIGITS; i++) {
        carry += (uint64_t)sum[i] + (negate ? ~product[i] : product[i]);
        sum[i] = (uint32_t)carry;
        carry >>= 32;
    }
}

static int orient_exactly(const double a[3], const double b[3], const double c[3], const double d[3]) {
    int64_t u[3], v[3], w[3];
    for (int i = 0; i < 3; i++) {
        u[i] = (int64_t)b[i] - (int64_t)a[i];
        v[i] = (int64_t)c[i] - (int64_t)a[i];
        w[i] = (int64_t)d[i] - (int64_t)a[i];
    }
    uint32_t sum[DIGITS] = {0};
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        add_product(sum, w[i], u[j], v[k], false);
        add_product(sum, w[i], u[k], v[j], true);
    }
    if (sum[DIGITS - 1] >> 31) return -1;
    for (int i = 0; i < DIGITS; i++) {
        if (sum[i]) return 1;
    }
    return 0;
}

/// The largest power of two, up to 2^53, that divides all coordinates.
static double common_unit(const double *const points[4]) {
    uint64_t bits = UINT64_C(1) << 53;
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++) bits |= (uint64_t)(int64_t)points[i][k];
    }
    return (double)(bits & -bits);
}

int enf_orient(const double a[3], const double b[3], const double c[3], const double d[3]) {
    double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
    double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
    double wx = d[0] - a[0], wy = d[1] - a[1], wz = d[2] - a[2];
    double x1 = uy * vz, x2 = uz * vy, y1 = uz * vx, y2 = ux * vz, z1 = ux * vy, z2 = uy * vx;
    double determinant = wx * (x1 - x2) + wy * (y1 - y2) + wz * (z1 - z2);
    double magnitude = fabs(wx) * (fabs(x1) + fabs(x2)) + fabs(wy) * (fabs(y1) + fabs(y2)) +
                       fabs(wz) * (fabs(z1) + fabs(z2));
    // Per term three rounded differences, two rounded products, three rounded sums: 8 units of 2^-53 and a
    // little; 10 covers the rounding of `magnitude` too.
    if (fabs(determinant) > 10 * 0x1p-53 * magnitude) return determinant > 0 ? 1 : -1;
    // Where coordinates have few significant bits nothing was rounded, and 0 is 0.
    double unit = common_unit((const double *const[]){a, b, c, d});
    if (magnitude < 0x1p53 * unit * unit * unit) return determinant > 0 ? 1 : determinant < 0 ? -1 : 0;
    return orient_exactly(a, b, c, d);
}
