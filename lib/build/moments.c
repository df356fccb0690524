// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/moments.h"

#include <math.h>

/// Bounds give way by so much for the rounding of volumes, and spreads grow by so much of their sum: that is
/// more than sums over a hundred thousand cells err by, and keeps flat bodies from bounds made of rounding.
#define BOUND_SLACK 0x1p-20
#define SPREAD_SLACK 0x1p-30

/// Second moments of a tetrahedron with one corner at the origin: V / 20 times the sum of the products of its
/// corners with themselves and of their sum with itself.
void enf_moments_add_cone(enf_moments *sums, const double origin[3], const double *const corners[3],
                          double sign) {
    double at[3][3], all[3], determinant = 0;
    for (int k = 0; k < 3; ++k) {
        for (int i = 0; i < 3; ++i) at[i][k] = corners[i][k] - origin[k];
        all[k] = at[0][k] + at[1][k] + at[2][k];
    }
    for (int k = 0; k < 3; ++k) {
        int x = (k + 1) % 3, y = (k + 2) % 3;
        determinant += at[0][k] * (at[1][x] * at[2][y] - at[1][y] * at[2][x]);
    }
    double volume = sign * determinant / 6;
    sums->volume += volume;
    for (int k = 0; k < 3; ++k) {
        int x = (k + 1) % 3, y = (k + 2) % 3;
        double same = all[k] * all[k], mixed = all[x] * all[y];
        for (int i = 0; i < 3; ++i) {
            same += at[i][k] * at[i][k];
            mixed += at[i][x] * at[i][y];
        }
        sums->center[k] += volume / 4 * all[k];
        sums->spread[k] += volume / 20 * same;
        sums->spread[3 + k] += volume / 20 * mixed;
    }
}

/// Adds the moments of the mass at a distance from the centre.
static void shift(double spread[6], double mass, const double away[3]) {
    for (int k = 0; k < 3; ++k) {
        spread[k] += mass * away[k] * away[k];
        spread[3 + k] += mass * away[(k + 1) % 3] * away[(k + 2) % 3];
    }
}

void enf_moments_finish(enf_moments *sums, const double origin[3]) {
    if (!(sums->volume > 0)) {
        *sums = (enf_moments){.center = {origin[0], origin[1], origin[2]}};
        return;
    }
    for (int k = 0; k < 3; ++k) sums->center[k] /= sums->volume;
    shift(sums->spread, -sums->volume, sums->center);
    for (int k = 0; k < 3; ++k) {
        sums->spread[k] = sums->spread[k] > 0 ? sums->spread[k] : 0;
        sums->center[k] += origin[k];
    }
}

void enf_moments_join(enf_moments *moments, const enf_moments *other) {
    double volume = moments->volume + other->volume, away[3];
    if (!(other->volume > 0)) return;
    for (int k = 0; k < 3; ++k) {
        away[k] = other->center[k] - moments->center[k];
        moments->center[k] += away[k] * (other->volume / volume);
    }
    for (int k = 0; k < 6; ++k) moments->spread[k] += other->spread[k];
    shift(moments->spread, moments->volume * other->volume / volume, away);
    moments->volume = volume;
}

/// n . S^-1 n for the matrix of the spread, by its factors L D L^T (L with ones on the diagonal); that is
/// right for a matrix that differs by rounding only, which the slack makes up for. 0 if it is not positive
/// definite.
static double solve(const double spread[6], const double n[3]) {
    double slack = (spread[0] + spread[1] + spread[2]) * SPREAD_SLACK;
    double xx = spread[0] + slack, yy = spread[1] + slack, zz = spread[2] + slack;
    double yz = spread[3], zx = spread[4], xy = spread[5];
    if (!(xx > 0)) return 0;
    double yx_factor = xy / xx, zx_factor = zx / xx;
    double y_rest = yy - yx_factor * xy;
    if (!(y_rest > 0)) return 0;
    double mixed = yz - zx_factor * xy, zy_factor = mixed / y_rest;
    double z_rest = zz - zx_factor * zx - zy_factor * mixed;
    if (!(z_rest > 0)) return 0;
    double y = n[1] - yx_factor * n[0], z = n[2] - zx_factor * n[0] - zy_factor * y;
    return n[0] * n[0] / xx + y * y / y_rest + z * z / z_rest;
}

double enf_moments_silhouette_bound(const enf_moments *moments, const double direction[3]) {
    double volume = moments->volume, form = solve(moments->spread, direction);
    double area = volume * sqrt(volume * form / 12) * (1 - BOUND_SLACK);
    return area > 0 && area < INFINITY ? area : 0;
}
