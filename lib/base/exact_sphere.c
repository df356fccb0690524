// SPDX-License-Identifier: MIT
// The predicates that only the builder asks. It needs whole numbers of 128 bits.
#include "base/exact.h"

#include "base/narrow.h"
#include "base/parts.h"
#include "base/sphere.h"

bool enf_points_collinear(const double a[3], const double b[3], const double c[3]) {
    int64_t u[3], v[3];
    enf_points_subtract(b, a, u);
    enf_points_subtract(c, a, v);
    return enf_minor(u[1], u[2], v[1], v[2]) == 0 && enf_minor(u[2], u[0], v[2], v[0]) == 0 &&
           enf_minor(u[0], u[1], v[0], v[1]) == 0;
}

enum { SUM_LIMBS = 5 };

/// sum += factor * lift, modulo 2^320, in two's complement; |factor| < 2^191.
static void add_lifted(uint64_t sum[SUM_LIMBS], const enf_parts *factor, enf_uint128 lift) {
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
static enf_parts volume_of(const int64_t z[3], const enf_int128 minor[3], bool negative) {
    enf_parts sum = {0, 0};
    for (int i = 0; i < 3; i++) enf_parts_add(&sum, negative ? -z[i] : z[i], minor[i]);
    return sum;
}

/// Rows a, b, c, d of the matrix (x, y, z, x^2 + y^2 + z^2) of the corners as seen from the point.
int enf_corners_side_of_sphere_exactly(const double *const corner[4], const double point[3]) {
    int64_t v[4][3];
    for (int i = 0; i < 4; i++) enf_points_subtract(corner[i], point, v[i]);
    enf_int128 near[4], across[2]; // of x and y: of rows (i, i + 1), and of (i, i + 2)
    for (int i = 0; i < 4; i++) near[i] = enf_minor(v[i][0], v[i][1], v[(i + 1) % 4][0], v[(i + 1) % 4][1]);
    for (int i = 0; i < 2; i++) across[i] = enf_minor(v[i][0], v[i][1], v[i + 2][0], v[i + 2][1]);
    uint64_t sum[SUM_LIMBS] = {0};
    for (int i = 0; i < 4; i++) { // along the last column: the signs alternate
        const int b = (i + 1) % 4, c = (i + 2) % 4, d = (i + 3) % 4;
        const int64_t z[3] = {v[b][2], v[c][2], v[d][2]};
        const enf_int128 minor[3] = {near[c], b < 2 ? -across[b] : across[b - 2], near[b]};
        const enf_parts volume = volume_of(z, minor, i % 2);
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
