// SPDX-License-Identifier: GPL-3.0-or-later
// The revised simplex method with the inverse of a 7 by 7 basis kept up by elimination (Dantzig, "Linear
// Programming and Extensions", 1963). The largest violation enters; after many steps the first one does
// (Bland's rule), so it does not go round in circles.
#include "visibility_check/line_simplex.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { STEPS_BY_SIZE = 60, STEPS_MAX = 200 };

/// Columns are of length 1 or so: a violation below this is rounding.
static const double violation_least = 1e-12;
/// A pivot below this would spoil the inverse.
static const double pivot_least = 1e-11;

void enf_line_basis_begin(enf_line_basis *basis, const double column[ENF_LINE_ROWS]) {
    memset(basis, 0, sizeof *basis);
    for (int r = 0; r < 6; r++) {
        double sign = column[r] > 0 ? -1 : 1; // of the unit vector that makes up for the column's number
        basis->column[r] = sign > 0 ? -1 - r : -7 - r;
        basis->weight[r] = fabs(column[r]);
        basis->inverse[r][r] = sign;
        basis->inverse[r][6] = -sign * column[r];
    }
    basis->column[6] = 0;
    basis->weight[6] = 1;
    basis->inverse[6][6] = 1;
}

/// y = (costs of the basis) * inverse; x = -y[0..5], t = y[6].
static void make_point(enf_line_basis *basis) {
    double y[ENF_LINE_ROWS] = {0};
    for (int i = 0; i < ENF_LINE_ROWS; i++) {
        if (basis->column[i] >= 0) continue;
        for (int r = 0; r < ENF_LINE_ROWS; r++) y[r] += basis->inverse[i][r];
    }
    for (int r = 0; r < 6; r++) basis->point[r] = -y[r];
    basis->margin = 0;
    for (int i = 0; i < ENF_LINE_ROWS; i++)
        if (basis->column[i] < 0) basis->margin += basis->weight[i];
    basis->margin = fmax(basis->margin, 0);
}

/// t of the duals, which differs from the margin by rounding only.
static double dual_margin(const enf_line_basis *basis) {
    double t = 0;
    for (int i = 0; i < ENF_LINE_ROWS; i++)
        if (basis->column[i] < 0) t += basis->inverse[i][6];
    return t;
}

/// The column that enters; false at the optimum. Unit vectors are numbered as in enf_line_basis.
static bool choose_entering(const enf_line_basis *basis, const double (*columns)[ENF_LINE_ROWS],
                            int32_t count, bool first, int32_t *entering) {
    const double *x = basis->point;
    double t = dual_margin(basis), most = violation_least;
    bool found = false;
    for (int32_t k = 0; k < count; k++) {
        const double *e = columns[k];
        double violation =
            t * e[6] - (x[0] * e[0] + x[1] * e[1] + x[2] * e[2] + x[3] * e[3] + x[4] * e[4] + x[5] * e[5]);
        if (violation <= most) continue;
        most = violation;
        *entering = k;
        found = true;
        if (first) return true;
    }
    for (int r = 0; r < 6; r++) {
        double violation = fabs(x[r]) - 1;
        if (violation <= most) continue;
        most = violation;
        *entering = x[r] < 0 ? -1 - r : -7 - r;
        found = true;
        if (first) return true;
    }
    return found;
}

static void transform(const enf_line_basis *basis, const double (*columns)[ENF_LINE_ROWS], int32_t entering,
                      double out[ENF_LINE_ROWS]) {
    for (int i = 0; i < ENF_LINE_ROWS; i++) {
        const double *row = basis->inverse[i];
        if (entering >= 0) {
            out[i] = 0;
            for (int r = 0; r < ENF_LINE_ROWS; r++) out[i] += row[r] * columns[entering][r];
        } else {
            int unit = -1 - entering;
            out[i] = unit < 6 ? row[unit] : -row[unit - 6];
        }
    }
}

/// The row that leaves: the one whose weight comes down to 0 first; of several, the largest pivot.
static int choose_leaving(const enf_line_basis *basis, const double change[ENF_LINE_ROWS]) {
    int leaving = -1;
    double least = DBL_MAX;
    for (int i = 0; i < ENF_LINE_ROWS; i++) {
        if (change[i] <= pivot_least) continue;
        double ratio = basis->weight[i] / change[i];
        if (leaving >= 0 && ratio > least + 1e-14) continue;
        if (leaving >= 0 && ratio > least - 1e-14 && change[i] < change[leaving]) continue;
        least = ratio;
        leaving = i;
    }
    return leaving;
}

static void exchange(enf_line_basis *basis, int leaving, int32_t entering,
                     const double change[ENF_LINE_ROWS]) {
    double *pivot = basis->inverse[leaving], scale = 1 / change[leaving];
    double step = fmax(basis->weight[leaving] * scale, 0);
    for (int r = 0; r < ENF_LINE_ROWS; r++) pivot[r] *= scale;
    for (int i = 0; i < ENF_LINE_ROWS; i++) {
        if (i == leaving) continue;
        basis->weight[i] = fmax(basis->weight[i] - step * change[i], 0);
        for (int r = 0; r < ENF_LINE_ROWS; r++) basis->inverse[i][r] -= change[i] * pivot[r];
    }
    basis->weight[leaving] = step;
    basis->column[leaving] = entering;
}

bool enf_line_basis_solve(enf_line_basis *basis, const double (*columns)[ENF_LINE_ROWS], int32_t count,
                          double enough) {
    for (int step = 0; step < STEPS_MAX; step++) {
        make_point(basis);
        if (basis->margin <= enough) return true;
        int32_t entering;
        double change[ENF_LINE_ROWS];
        if (!choose_entering(basis, columns, count, step >= STEPS_BY_SIZE, &entering)) return true;
        transform(basis, columns, entering, change);
        int leaving = choose_leaving(basis, change);
        if (leaving < 0) return false;
        exchange(basis, leaving, entering, change);
    }
    return false;
}
