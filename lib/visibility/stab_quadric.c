// SPDX-License-Identifier: GPL-3.0-or-later
// Does the open cone {x : <x, e> > 0 for all edges e} meet the quadric Q(x, x) = 0, in whole numbers?
//
// It does if Q takes both signs on the closed cone C. If Q is nowhere negative on C, it is nowhere 0 inside:
// such a point would be a minimum, Q x = 0, but Q is regular. So, with the sign of Q inside known at one
// point, what is asked is whether Q falls below 0 (from here on: with that sign turned to +) anywhere in C,
// touching or not. If so, its minimum on a slice {<x, l> = 1} is a point inside some face, critical on the
// face's span L = {x : <x, s> = 0 for s in T}, T independent sides. If Q were singular on L, the minimum
// could be moved along the kernel to a smaller face. So all that can be minima are, for T of 2 to 5 sides,
// the unique critical points Q x = l + sum of mu s; fewer than 2 sides leave Q, of signature (3, 3), two
// falling directions on the slice. Five sides: the rays. Four: between two rays. Two and three: the formulas
// below.
//
// Sides are added one by one, as long as Q falls below 0 in the cone of those so far, at a point outside C.
#include "visibility/stab_quadric.h"

#include "visibility/exact_double.h"

#include <math.h>
#include <string.h>

/// Q(a, b), a and b as doubles, times the sign: 1 if it is surely > 0, else 0.
static bool surely_positive(const double a[ENF_PLUECKER], const double b[ENF_PLUECKER], int sign) {
    double sum = 0, size = 0;
    for (int i = 0; i < ENF_PLUECKER; i++) {
        double term = a[i] * b[(i + 3) % ENF_PLUECKER];
        sum += term;
        size += fabs(term);
    }
    return sign * sum > 0x1p-48 * size && sign * sum > 0x1p-900 && size < HUGE_VAL;
}

/// out = sign * Q(a, b)
static void set_form(mpz_t out, mpz_t *a, mpz_t *b, int sign) {
    mpz_mul(out, a[0], b[3]);
    for (int i = 1; i < ENF_PLUECKER; i++) mpz_addmul(out, a[i], b[(i + 3) % ENF_PLUECKER]);
    if (sign < 0) mpz_neg(out, out);
}

// ---------------------------------------------------------------------------------------------- rays and
// edges

static bool ray_falls(enf_quadric *q) {
    for (int32_t i = 0; i < q->cone.ray_count; i++) {
        enf_cone_ray *ray = &q->cone.rays[i];
        if (surely_positive(ray->about, ray->about, q->sign)) continue;
        set_form(q->a, ray->at, ray->at, q->sign);
        if (mpz_sgn(q->a) >= 0) continue;
        for (int k = 0; k < ENF_PLUECKER; k++) mpz_set(q->witness[k], ray->at[k]);
        return true;
    }
    return false;
}

/// a, c >= 0 and b < 0 are the forms of r and s and of both. The least is at -b r + a s, or, if a = 0,
/// anything far enough towards r.
static void set_least(enf_quadric *q, mpz_t *r, mpz_t *s) {
    if (mpz_sgn(q->a) > 0) {
        mpz_neg(q->b, q->b);
    } else {
        mpz_add_ui(q->b, q->c, 1);
        mpz_set_ui(q->a, 1);
    }
    for (int k = 0; k < ENF_PLUECKER; k++) {
        mpz_mul(q->witness[k], q->b, r[k]);
        mpz_addmul(q->witness[k], q->a, s[k]);
    }
}

/// Also tells whether the form of any two rays is below 0. If not, it is not below 0 anywhere.
static bool edge_falls(enf_quadric *q, bool *mixed) {
    *mixed = false;
    for (int32_t i = 0; i < q->cone.ray_count; i++) {
        for (int32_t j = 0; j < i; j++) {
            enf_cone_ray *r = &q->cone.rays[i], *s = &q->cone.rays[j];
            if (surely_positive(r->about, s->about, q->sign)) continue;
            set_form(q->b, r->at, s->at, q->sign);
            if (mpz_sgn(q->b) >= 0) continue;
            *mixed = true;
            set_form(q->a, r->at, r->at, q->sign);
            set_form(q->c, s->at, s->at, q->sign);
            mpz_mul(q->d, q->a, q->c);
            mpz_submul(q->d, q->b, q->b);
            if (mpz_sgn(q->d) >= 0) continue;
            set_least(q, r->at, s->at);
            return true;
        }
    }
    return false;
}

// ---------------------------------------------------------------------------------------------- larger faces

/// How many rays lie in all of the sides? A face of k dimensions has k or more.
static int32_t rays_in(const enf_quadric *q, const int32_t *side, int count) {
    int32_t rays = 0;
    for (int32_t i = 0; i < q->cone.ray_count; i++) {
        bool tight = true;
        for (int k = 0; k < count; k++) tight &= q->cone.rays[i].tight[side[k] / 64] >> side[k] % 64 & 1;
        rays += tight;
    }
    return rays;
}

/// With Gram's matrix G of the sides T under Q's inverse, which is Q, g the same with l, and Q swapping
/// halves: x = swap(det G l - sum of (adj G g) s). Three sides if `count` is 3, two otherwise.
static void set_critical(enf_quadric *q, const int32_t *side, int count) {
    for (int i = 0; i < count; i++) {
        set_form(q->g[i], q->cone.sides[side[i]], q->slice, 1);
        for (int j = 0; j < count; j++)
            set_form(q->gram[i][j], q->cone.sides[side[i]], q->cone.sides[side[j]], 1);
    }
    for (int i = 0; i < count; i++) mpz_set_ui(q->mu[i], 0);
    mpz_set_ui(q->determinant, 0);
    for (int i = 0; i < count; i++) {
        for (int j = 0; j < count; j++) {
            if (count == 2) { // the adjugate of ((a, b), (b, c)) is ((c, -b), (-b, a))
                mpz_set(q->a, q->gram[1 - j][1 - i]);
                if (i != j) mpz_neg(q->a, q->a);
            } else {
                const int r = (j + 1) % 3, s = (j + 2) % 3, c = (i + 1) % 3, d = (i + 2) % 3;
                mpz_mul(q->a, q->gram[r][c], q->gram[s][d]);
                mpz_submul(q->a, q->gram[r][d], q->gram[s][c]);
            }
            mpz_addmul(q->mu[i], q->a, q->g[j]);
            if (i == 0) mpz_addmul(q->determinant, q->a, q->gram[j][0]);
        }
    }
    for (int k = 0; k < ENF_PLUECKER; k++) {
        const int half = (k + 3) % ENF_PLUECKER;
        mpz_mul(q->witness[k], q->determinant, q->slice[half]);
        for (int i = 0; i < count; i++) mpz_submul(q->witness[k], q->mu[i], q->cone.sides[side[i]][half]);
    }
}

/// Is Q below 0 at the critical point, and the point, or its opposite, in the cone?
static bool critical_falls(enf_quadric *q, const int32_t *side, int count) {
    if (rays_in(q, side, count) < ENF_PLUECKER - count) return false;
    set_critical(q, side, count);
    if (mpz_sgn(q->determinant) == 0) return false;
    set_form(q->a, q->witness, q->witness, q->sign);
    if (mpz_sgn(q->a) >= 0) return false;
    enf_whole_dot(q->a, q->witness, q->slice);
    for (int k = 0; mpz_sgn(q->a) < 0 && k < ENF_PLUECKER; k++) mpz_neg(q->witness[k], q->witness[k]);
    for (int32_t i = 0; i < q->cone.side_count; i++) {
        enf_whole_dot(q->a, q->witness, q->cone.sides[i]);
        if (mpz_sgn(q->a) < 0) return false;
    }
    enf_whole_shorten(q->witness);
    return true;
}

static bool face_falls(enf_quadric *q) {
    const int32_t sides = q->cone.side_count;
    for (int k = 0; k < ENF_PLUECKER; k++) {
        mpz_set_ui(q->slice[k], 0);
        for (int32_t i = 0; i < sides; i++) mpz_add(q->slice[k], q->slice[k], q->cone.sides[i][k]);
    }
    for (int32_t i = 0; i < sides; i++) {
        for (int32_t j = 0; j < i; j++) {
            const int32_t two[2] = {i, j};
            if (rays_in(q, two, 2) < ENF_PLUECKER - 3) continue;
            if (critical_falls(q, two, 2)) return true;
            for (int32_t k = 0; k < j; k++) {
                const int32_t three[3] = {i, j, k};
                if (critical_falls(q, three, 3)) return true;
            }
        }
    }
    return false;
}

bool enf_quadric_falls(enf_quadric *q) {
    bool mixed;
    q->steps = 1;
    if (ray_falls(q)) return true;
    q->steps = 2;
    if (edge_falls(q, &mixed)) return true;
    q->steps = 3;
    return mixed && face_falls(q);
}

// ---------------------------------------------------------------------------------------------- scratch

static void each_number(enf_quadric *q, void (*act)(mpz_ptr)) {
    mpz_ptr const single[5] = {q->a, q->b, q->c, q->d, q->determinant};
    for (int i = 0; i < 5; i++) act(single[i]);
    for (int k = 0; k < ENF_PLUECKER; k++) {
        act(q->witness[k]);
        act(q->slice[k]);
        for (int i = 0; i < ENF_PLUECKER; i++) act(q->completing[k][i]);
        for (int i = 0; i < ENF_PLUECKER; i++) act(q->echelon[k][i]);
    }
    for (int i = 0; i < 3; i++) {
        act(q->g[i]);
        act(q->mu[i]);
        for (int j = 0; j < 3; j++) act(q->gram[i][j]);
    }
}

void enf_quadric_init(enf_quadric *q) {
    enf_cone_init(&q->cone);
    each_number(q, mpz_init);
}

void enf_quadric_free(enf_quadric *q) {
    each_number(q, mpz_clear);
    enf_cone_free(&q->cone);
}
