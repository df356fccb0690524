// SPDX-License-Identifier: GPL-3.0-or-later
// Lines between doubles next to one that is not: both points may be taken anywhere along the line, and each
// coordinate may be rounded up or down.
#include "visibility/stab_fine.h"

#include <math.h>

enum { FREE = 4, WAYS = 1 << FREE };

/// What coordinates can become: the nearest double first, then the one on the other side.
static void find_choices(const enf_fine *fine, const enf_stabber *stabber, double choice[FREE][2]) {
    mpf_t exact, rest;
    mpf_init2(exact, fine->bits);
    mpf_init2(rest, fine->bits);
    for (int index = 0; index < FREE; index++) {
        enf_fine_coordinate(fine, stabber, index / 2, (fine->axis + 1 + index % 2) % 3, exact);
        const double inner = mpf_get_d(exact); // cut off
        choice[index][0] = choice[index][1] = inner;
        if (!isfinite(inner)) continue;
        mpf_set_d(rest, inner);
        mpf_sub(rest, exact, rest);
        const double other = nextafter(inner, mpf_sgn(rest) < 0 ? -HUGE_VAL : HUGE_VAL);
        const bool nearer = fabs(mpf_get_d(rest)) * 2 > fabs(other - inner);
        choice[index][0] = nearer ? other : inner;
        choice[index][1] = nearer ? inner : other;
    }
    mpf_clear(exact);
    mpf_clear(rest);
}

static bool is_finite(const enf_line *line) {
    bool finite = true;
    for (int i = 0; i < 3; i++) finite = finite && isfinite(line->from[i]) && isfinite(line->to[i]);
    return finite;
}

/// All ways to round the points where they are.
static bool round_here(const enf_fine *fine, const enf_stabber *stabber, enf_line *line) {
    double choice[FREE][2];
    find_choices(fine, stabber, choice);
    line->from[fine->axis] = fine->plane[0];
    line->to[fine->axis] = fine->plane[1];
    for (int way = 0; way < WAYS; way++) {
        for (int index = 0; index < FREE; index++) {
            double *point = index < 2 ? line->from : line->to;
            point[(fine->axis + 1 + index % 2) % 3] = choice[index][way >> index & 1];
        }
        if (is_finite(line) && enf_stabber_passes(stabber, line)) return true;
    }
    return false;
}

/// The point of the line in this plane, as the point at one end.
static void set_point(enf_fine *fine, const enf_fine *line, int end, double plane) {
    fine->plane[end] = plane;
    mpf_set_d(fine->sum, plane);
    mpf_set_d(fine->term, line->plane[0]);
    mpf_sub(fine->sum, fine->sum, fine->term);
    mpf_set_d(fine->term, line->plane[1]);
    mpf_set_d(fine->x[0], line->plane[0]);
    mpf_sub(fine->term, fine->term, fine->x[0]);
    mpf_div(fine->sum, fine->sum, fine->term); // the share of the way
    for (int i = 0; i < 3; i++) {
        mpf_sub(fine->term, line->at[1][i], line->at[0][i]);
        mpf_mul(fine->term, fine->term, fine->sum);
        mpf_add(fine->at[end][i], line->at[0][i], fine->term);
    }
}

bool enf_fine_round(const enf_fine *line, const enf_stabber *stabber, enf_line *rounded) {
    static const double share[] = {0, 1.0 / 8, 1.0 / 4, 3.0 / 8, -1.0 / 8, -1.0 / 4, -1.0 / 2, -1};
    enum { SHARES = sizeof share / sizeof *share };
    const double way = line->plane[1] - line->plane[0]; // all may be infinite or 0 where doubles end
    enf_fine fine;
    bool passes = false;
    enf_fine_init(&fine, line->bits);
    fine.axis = line->axis;
    for (int k = 0; !passes && way != 0 && k < SHARES * SHARES; k++) {
        const double from = line->plane[0] + share[k / SHARES] * way,
                     to = line->plane[1] - share[k % SHARES] * way;
        if (!isfinite(from) || !isfinite(to)) continue;
        set_point(&fine, line, 0, from);
        set_point(&fine, line, 1, to);
        passes = round_here(&fine, stabber, rounded);
    }
    enf_fine_clear(&fine);
    return passes;
}
