// SPDX-License-Identifier: MIT
// The filter is static analysis in the manner of J. R. Shewchuk, "Adaptive precision floating-point
// arithmetic and fast robust geometric predicates" (1997), first stage; the exact tier is plain integers.
#include "base/exact.h"

#include "base/limbs.h"
#include "base/sphere.h"

#include <math.h>

/// A whole number of up to 191 bits, 2^64 * high + low: products can be added up before anything is carried.
typedef struct parts {
    enf_int128 high, low;
} parts;

/// sum += a * b, |a| <= 2^54
static void add_product(parts *sum, int64_t a, enf_int128 b) {
    sum->high += (enf_int128)a * (int64_t)(b >> 64);
    sum->low += (enf_int128)a * (uint64_t)b;
}

static int sign_of_parts(const parts *value) {
    enf_int128 high = value->high + (value->low >> 64);
    return high < 0 ? -1 : high > 0 || (uint64_t)value->low;
}

static enf_int128 minor_of(int64_t a, int64_t b, int64_t c, int64_t d) {
    return (enf_int128)a * d - (enf_int128)b * c;
}

/// to - from
static void subtract_points(const double to[3], const double from[3], int64_t difference[3]) {
    for (int i = 0; i < 3; i++) difference[i] = (int64_t)to[i] - (int64_t)from[i];
}

int enf_points_orient_exactly(const double a[3], const double b[3], const double c[3], const double d[3]) {
    int64_t u[3], v[3], w[3];
    subtract_points(b, a, u);
    subtract_points(c, a, v);
    subtract_points(d, a, w);
    parts sum = {0, 0};
    add_product(&sum, w[0], minor_of(u[1], u[2], v[1], v[2]));
    add_product(&sum, w[1], minor_of(u[2], u[0], v[2], v[0]));
    add_product(&sum, w[2], minor_of(u[0], u[1], v[0], v[1]));
    return sign_of_parts(&sum);
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

bool enf_points_collinear(const double a[3], const double b[3], const double c[3]) {
    int64_t u[3], v[3];
    subtract_points(b, a, u);
    subtract_points(c, a, v);
    return minor_of(u[1], u[2], v[1], v[2]) == 0 && minor_of(u[2], u[0], v[2], v[0]) == 0 &&
           minor_of(u[0], u[1], v[0], v[1]) == 0;
}

// ---------------------------------------------------------------------------------------------- spheres

enum { SUM_LIMBS = 5 };

/// sum += factor * lift, modulo 2^320, in two's complement; |factor| < 2^191.
static void add_lifted(uint64_t sum[SUM_LIMBS], const parts *factor, enf_uint128 lift) {
    const enf_int128 upper = factor->high + (factor->low >> 64);
    const uint64_t limb[3] = {(uint64_t)factor->low, (uint64_t)upper, (uint64_t)(upper >> 64)};
    uint64_t product[SUM_LIMBS] = {0};
    for (int j = 0; j < 2; j++) {
        const uint64_t part = (uint64_t)(lift >> 64 * j);
        uint64_t carry = 0;
        for (int i = 0; i < 3; i++) {
            enf_uint128 value = (enf_uint128)limb[i] * part + product[i + j] + carry;
            product[i + j] = (uint64_t)value;
            carry = (uint64_t)(value >> 64);
        }
        product[3 + j] = carry;
    }
    if (upper < 0) { // the limbs say 2^192 more than the factor is
        enf_uint128 top = ((enf_uint128)product[4] << 64 | product[3]) - lift;
        product[3] = (uint64_t)top;
        product[4] = (uint64_t)(top >> 64);
    }
    uint64_t carry = 0;
    for (int i = 0; i < SUM_LIMBS; i++) {
        enf_uint128 value = (enf_uint128)sum[i] + product[i] + carry;
        sum[i] = (uint64_t)value;
        carry = (uint64_t)(value >> 64);
    }
}

static enf_uint128 lift_of(const int64_t v[3]) {
    enf_int128 lift = 0;
    for (int i = 0; i < 3; i++) lift += (enf_int128)v[i] * v[i];
    return (enf_uint128)lift;
}

/// z[0] * minor[0] + z[1] * minor[1] + z[2] * minor[2], all with their signs turned if `negative`.
static parts volume_of(const int64_t z[3], const enf_int128 minor[3], bool negative) {
    parts sum = {0, 0};
    for (int i = 0; i < 3; i++) add_product(&sum, negative ? -z[i] : z[i], minor[i]);
    return sum;
}

/// Rows a, b, c, d of the matrix (x, y, z, x^2 + y^2 + z^2) of the corners as seen from the point.
int enf_corners_side_of_sphere_exactly(const double *const corner[4], const double point[3]) {
    int64_t v[4][3];
    for (int i = 0; i < 4; i++) subtract_points(corner[i], point, v[i]);
    enf_int128 near[4], across[2]; // of x and y: of rows (i, i + 1), and of (i, i + 2)
    for (int i = 0; i < 4; i++) near[i] = minor_of(v[i][0], v[i][1], v[(i + 1) % 4][0], v[(i + 1) % 4][1]);
    for (int i = 0; i < 2; i++) across[i] = minor_of(v[i][0], v[i][1], v[i + 2][0], v[i + 2][1]);
    uint64_t sum[SUM_LIMBS] = {0};
    for (int i = 0; i < 4; i++) { // along the last column: the signs alternate
        const int b = (i + 1) % 4, c = (i + 2) % 4, d = (i + 3) % 4;
        const int64_t z[3] = {v[b][2], v[c][2], v[d][2]};
        const enf_int128 minor[3] = {near[c], b < 2 ? -across[b] : across[b - 2], near[b]};
        const parts volume = volume_of(z, minor, i % 2);
        add_lifted(sum, &volume, lift_of(v[i]));
    }
    if (sum[SUM_LIMBS - 1] >> 63) return -1;
    for (int i = 0; i < SUM_LIMBS; i++) {
        if (sum[i]) return 1;
    }
    return 0;
}

int enf_points_side_of_sphere(const double a[3], const double b[3], const double c[3], const double d[3],
                              const double point[3]) {
    const double *const corner[4] = {a, b, c, d};
    return enf_corners_side_of_sphere(corner, point);
}
