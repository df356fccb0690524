// SPDX-License-Identifier: GPL-3.0-or-later
// The line at which the cone meets the quadric, in any number of bits: between the strict solution, where the
// form has one sign, and the witness, where it has the other.
#include "visibility/stab_fine.h"

#include "visibility/exact_double.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

static void each_number(enf_fine *fine, void (*act)(mpf_ptr, mp_bitcnt_t)) {
    for (int i = 0; i < 3; i++) {
        act(fine->at[0][i], fine->bits);
        act(fine->at[1][i], fine->bits);
    }
    for (int i = 0; i < ENF_PLUECKER; i++) act(fine->x[i], fine->bits);
    act(fine->term, fine->bits);
    act(fine->sum, fine->bits);
}

static void clear(mpf_ptr number, mp_bitcnt_t bits) {
    (void)bits;
    mpf_clear(number);
}

void enf_fine_init(enf_fine *fine, mp_bitcnt_t bits) {
    fine->bits = bits;
    each_number(fine, mpf_init2);
}

void enf_fine_clear(enf_fine *fine) {
    each_number(fine, clear);
}

void enf_fine_side(enf_fine *fine, mpz_t *edge, mpf_t out) {
    mpf_set_ui(out, 0);
    for (int i = 0; i < ENF_PLUECKER; i++) {
        mpf_set_z(fine->term, edge[i]);
        mpf_mul(fine->term, fine->term, fine->x[i]);
        mpf_add(out, out, fine->term);
    }
}

/// out = (a x b) on one axis
static void set_cross(enf_fine *fine, mpf_t out, mpf_t *a, mpf_t *b, int axis) {
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    mpf_mul(out, a[j], b[k]);
    mpf_mul(fine->term, a[k], b[j]);
    mpf_sub(out, out, fine->term);
}

void enf_fine_set_x(enf_fine *fine) {
    for (int i = 0; i < 3; i++) {
        mpf_sub(fine->x[i], fine->at[1][i], fine->at[0][i]);
        set_cross(fine, fine->x[3 + i], fine->at[0], fine->at[1], i);
    }
}

// ---------------------------------------------------------------------------------------------- x

/// out = sign * Q(a, b)
static void set_form(mpz_t out, mpz_t *a, mpz_t *b, int sign) {
    mpz_set_ui(out, 0);
    for (int i = 0; i < ENF_PLUECKER; i++) mpz_addmul(out, a[i], b[(i + 3) % ENF_PLUECKER]);
    if (sign < 0) mpz_neg(out, out);
}

/// *share = the s > 0 with a + 2 b s + c s^2 = 0, a > 0 > c the forms of the point and of the witness, b that
/// of both.
static void set_share(enf_fine *fine, enf_stabber *stabber, mpf_t share) {
    enf_quadric *q = &stabber->quadric;
    set_form(q->a, stabber->point, stabber->point, q->sign);
    set_form(q->b, stabber->point, q->witness, q->sign);
    set_form(q->c, q->witness, q->witness, q->sign);
    mpz_mul(q->d, q->b, q->b);
    mpz_submul(q->d, q->a, q->c);
    mpf_set_z(fine->sum, q->d);
    mpf_sqrt(fine->sum, fine->sum);
    mpf_set_z(fine->term, q->b);
    if (mpz_sgn(q->b) > 0) {
        mpf_add(share, fine->sum, fine->term);
        mpz_neg(q->c, q->c);
        mpf_set_z(fine->term, q->c);
        mpf_div(share, share, fine->term);
    } else {
        mpf_sub(fine->sum, fine->sum, fine->term);
        mpf_set_z(share, q->a);
        mpf_div(share, share, fine->sum);
    }
}

static void set_meeting(enf_fine *fine, enf_stabber *stabber) {
    enf_quadric *q = &stabber->quadric;
    mpf_t share;
    mpf_init2(share, fine->bits);
    if (q->sign != 0) set_share(fine, stabber, share);
    for (int i = 0; i < ENF_PLUECKER; i++) {
        mpf_set_z(fine->x[i], stabber->point[i]);
        if (q->sign == 0) continue;
        mpf_set_z(fine->term, q->witness[i]);
        mpf_mul(fine->term, fine->term, share);
        mpf_add(fine->x[i], fine->x[i], fine->term);
    }
    mpf_clear(share);
}

// ---------------------------------------------------------------------------------------------- points

static int longest_axis(enf_fine *fine) {
    int axis = 0;
    for (int i = 1; i < 3; i++) {
        mpf_abs(fine->sum, fine->x[axis]);
        mpf_abs(fine->term, fine->x[i]);
        if (mpf_cmp(fine->term, fine->sum) > 0) axis = i;
    }
    return axis;
}

static double clamp(double value) {
    return fmax(fmin(value, DBL_MAX), -DBL_MAX);
}

/// Through the middles of the first and the last portal, or so far apart as the sequence is large.
static void choose_planes(enf_fine *fine, const enf_stabber *stabber) {
    const enf_pluecker_opening *openings = stabber->pluecker->openings;
    const double way = mpf_sgn(fine->x[fine->axis]) < 0 ? -1 : 1;
    double reach = 0;
    for (int axis = 0; axis < 3; axis++) {
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (int32_t i = 0; i < stabber->count; i++) {
            low = fmin(low, openings[stabber->sequence[i] >> 1].low[axis]);
            high = fmax(high, openings[stabber->sequence[i] >> 1].high[axis]);
        }
        reach = fmax(reach, high - low);
    }
    fine->reach = clamp(reach);
    const double first = clamp(openings[stabber->sequence[0] >> 1].middle[fine->axis]);
    double last = openings[stabber->sequence[stabber->count - 1] >> 1].middle[fine->axis];
    if (!((last - first) * way > reach / 8)) last = first + way * reach;
    if (last == first) last = nextafter(first, way * HUGE_VAL);
    fine->plane[0] = first;
    fine->plane[1] = clamp(last);
}

void enf_fine_shift(mpf_t value, int shift) {
    if (shift >= 0)
        mpf_mul_2exp(value, value, (mp_bitcnt_t)shift);
    else
        mpf_div_2exp(value, value, (mp_bitcnt_t)-shift);
}

void enf_fine_coordinate(const enf_fine *fine, const enf_stabber *stabber, int end, int axis, mpf_t out) {
    mpf_t origin;
    mpf_init2(origin, fine->bits);
    mpf_set_d(origin, stabber->origin[axis]);
    mpf_set(out, fine->at[end][axis]);
    enf_fine_shift(out, stabber->unit);
    mpf_add(out, out, origin);
    if (axis == fine->axis) mpf_set_d(out, fine->plane[end]);
    mpf_clear(origin);
}

/// The point of x in the plane: the one nearest the origin, (direction x moment) / direction^2, and as far
/// along as it takes. The square is in `sum`.
static void set_point(enf_fine *fine, const enf_stabber *stabber, int end) {
    mpf_t *at = fine->at[end], *x = fine->x;
    mpf_t way;
    mpf_init2(way, fine->bits);
    for (int i = 0; i < 3; i++) {
        set_cross(fine, at[i], x, x + 3, i);
        mpf_div(at[i], at[i], fine->sum);
    }
    mpf_set_d(way, fine->plane[end]);
    mpf_set_d(fine->term, stabber->origin[fine->axis]);
    mpf_sub(way, way, fine->term);
    enf_fine_shift(way, -stabber->unit);
    mpf_set(fine->term, way);
    mpf_sub(way, way, at[fine->axis]);
    mpf_div(way, way, x[fine->axis]);
    mpf_set(at[fine->axis], fine->term);
    for (int i = 0; i < 3; i++) {
        if (i == fine->axis) continue;
        mpf_mul(fine->term, way, x[i]);
        mpf_add(at[i], at[i], fine->term);
    }
    mpf_clear(way);
}

void enf_fine_start(enf_fine *fine, enf_stabber *stabber) {
    set_meeting(fine, stabber);
    fine->axis = longest_axis(fine);
    choose_planes(fine, stabber);
    mpf_set_ui(fine->sum, 0);
    for (int i = 0; i < 3; i++) {
        mpf_mul(fine->term, fine->x[i], fine->x[i]);
        mpf_add(fine->sum, fine->sum, fine->term);
    }
    for (int end = 0; mpf_sgn(fine->sum) > 0 && end < 2; end++) set_point(fine, stabber, end);
    enf_fine_set_x(fine);
}
