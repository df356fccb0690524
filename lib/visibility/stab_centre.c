// SPDX-License-Identifier: GPL-3.0-or-later
// Away from the edges: the product of all sides grows, by Newton's method on the sum of their logarithms as
// if sides were linear in the four coordinates that are free. However thin what is open is, that product has
// no scale of its own.
#include "visibility/stab_fine.h"

#include "base/array.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

enum { FREE = 4, STEPS = 60, HALVINGS = 40, DOUBLINGS = 400 };
static const double enough = 1.01; ///< a step that multiplies the product by less is the last

typedef struct centring {
    enf_stabber *stabber;
    enf_fine *fine;
    mpf_t *sides, *tried; ///< edge_count
    mpf_t old[FREE], step[FREE], matrix[FREE][FREE + 1];
    mpf_t gradient[FREE], gain, best, length;
    mpf_t most; ///< coordinates beyond this do not grow
} centring;

/// One of the four: two of each point, those that are not on the planes' axis.
static mpf_t *variable(const centring *c, int index) {
    return &c->fine->at[index / 2][(c->fine->axis + 1 + index % 2) % 3];
}

// ---------------------------------------------------------------------------------------------- a step

/// The side as a function of one end is linear: end 0 has the slope (to x along) - moment, end 1 has
/// (along x from) + moment, for an edge (moment, along).
static void set_slope(centring *c, mpz_t *edge, int index) {
    enf_fine *fine = c->fine;
    const int end = index / 2, i = (fine->axis + 1 + index % 2) % 3, j = (i + 1) % 3, k = (i + 2) % 3;
    mpf_t *other = fine->at[1 - end];
    mpf_set_z(fine->term, edge[3 + k]);
    mpf_mul(c->gradient[index], other[j], fine->term);
    mpf_set_z(fine->term, edge[3 + j]);
    mpf_mul(fine->term, fine->term, other[k]);
    mpf_sub(c->gradient[index], c->gradient[index], fine->term);
    mpf_set_z(fine->term, edge[i]);
    mpf_sub(c->gradient[index], c->gradient[index], fine->term);
    if (end == 1) mpf_neg(c->gradient[index], c->gradient[index]);
}

/// The sum, over the edges, of g g^T and of g, g the side's gradient over the side.
static void set_matrix(centring *c) {
    for (int i = 0; i < FREE; i++) {
        for (int j = 0; j <= FREE; j++) mpf_set_ui(c->matrix[i][j], 0);
    }
    for (int32_t k = 0; k < c->stabber->edge_count; k++) {
        for (int i = 0; i < FREE; i++) {
            set_slope(c, c->stabber->whole[k], i);
            mpf_div(c->gradient[i], c->gradient[i], c->sides[k]);
            mpf_add(c->matrix[i][FREE], c->matrix[i][FREE], c->gradient[i]);
            for (int j = 0; j <= i; j++) {
                mpf_mul(c->fine->term, c->gradient[i], c->gradient[j]);
                mpf_add(c->matrix[i][j], c->matrix[i][j], c->fine->term);
            }
        }
    }
    for (int i = 0; i < FREE; i++) {
        for (int j = 0; j < i; j++) mpf_set(c->matrix[j][i], c->matrix[i][j]);
    }
}

/// The matrix has no negative directions; those in which it is 0, but for rounding, are left alone.
static void solve(centring *c) {
    bool used[FREE];
    for (int r = 0; r < FREE; r++) { // what counts as 0
        mpf_set(c->step[r], c->matrix[r][r]);
        mpf_div_2exp(c->step[r], c->step[r], c->fine->bits / 2);
    }
    for (int r = 0; r < FREE; r++) {
        used[r] = mpf_cmp(c->matrix[r][r], c->step[r]) > 0;
        for (int i = 0; used[r] && i < FREE; i++) {
            if (i == r) continue;
            mpf_div(c->length, c->matrix[i][r], c->matrix[r][r]);
            for (int j = 0; j <= FREE; j++) {
                mpf_mul(c->fine->term, c->length, c->matrix[r][j]);
                mpf_sub(c->matrix[i][j], c->matrix[i][j], c->fine->term);
            }
        }
    }
    for (int r = 0; r < FREE; r++) {
        mpf_set_ui(c->step[r], 0);
        if (used[r] && mpf_sgn(c->matrix[r][r]) > 0) mpf_div(c->step[r], c->matrix[r][FREE], c->matrix[r][r]);
    }
}

// ---------------------------------------------------------------------------------------------- how far

static bool set_sides(centring *c, mpf_t *sides) {
    enf_fine_set_x(c->fine);
    for (int32_t k = 0; k < c->stabber->edge_count; k++) {
        enf_fine_side(c->fine, c->stabber->whole[k], sides[k]);
        if (mpf_sgn(sides[k]) <= 0) return false;
    }
    return true;
}

/// Has the variable grown, beyond what the sequence can need?
static bool is_far(centring *c, int index) {
    mpf_abs(c->fine->term, *variable(c, index));
    if (mpf_cmp(c->fine->term, c->most) <= 0) return false;
    mpf_abs(c->fine->sum, c->old[index]);
    return mpf_cmp(c->fine->term, c->fine->sum) > 0;
}

/// Goes `length` times the step from the old place. Does the line pass, the product grown by more than
/// `best`? Then that is what `gain` says.
static bool try_length(centring *c) {
    bool far = false;
    for (int i = 0; i < FREE; i++) {
        mpf_mul(c->fine->term, c->length, c->step[i]);
        mpf_add(*variable(c, i), c->old[i], c->fine->term);
        far = far || is_far(c, i);
    }
    if (far || !set_sides(c, c->tried)) return false;
    mpf_set_ui(c->gain, 1);
    for (int32_t k = 0; k < c->stabber->edge_count; k++) {
        mpf_mul(c->gain, c->gain, c->tried[k]);
        mpf_div(c->gain, c->gain, c->sides[k]);
    }
    return mpf_cmp(c->gain, c->best) > 0;
}

/// Halves the step until it gains something, or doubles it while it gains more. The best gain is in `best`.
static bool take_step(centring *c) {
    int halvings = 0, doublings = 0;
    for (int i = 0; i < FREE; i++) mpf_set(c->old[i], *variable(c, i));
    mpf_set_ui(c->length, 1);
    mpf_set_ui(c->best, 1);
    while (!try_length(c)) {
        if (halvings++ == HALVINGS) return false;
        mpf_div_2exp(c->length, c->length, 1);
    }
    do {
        mpf_set(c->best, c->gain);
        mpf_mul_2exp(c->length, c->length, 1);
    } while (halvings == 0 && doublings++ < DOUBLINGS && try_length(c));
    mpf_div_2exp(c->length, c->length, 1);
    return true;
}

/// Back to the place from which the last steps started, or to where the last one that gained went.
static void go(centring *c, bool gained) {
    if (!gained) mpf_set_ui(c->length, 0);
    mpf_set_ui(c->best, 0);
    try_length(c);
    for (int32_t k = 0; k < c->stabber->edge_count; k++) mpf_swap(c->sides[k], c->tried[k]);
}

static void move(centring *c) {
    bool more = true;
    for (int i = 0; more && i < STEPS; i++) {
        set_matrix(c);
        solve(c);
        const bool gained = take_step(c);
        more = gained && mpf_cmp_d(c->best, enough) > 0;
        go(c, gained);
    }
}

// ---------------------------------------------------------------------------------------------- all

static void each_number(centring *c, void (*act)(mpf_ptr, mp_bitcnt_t)) {
    const mp_bitcnt_t bits = c->fine->bits;
    mpf_ptr const single[4] = {c->gain, c->best, c->length, c->most};
    for (int i = 0; i < 4; i++) act(single[i], bits);
    for (int i = 0; i < FREE; i++) {
        act(c->old[i], bits);
        act(c->step[i], bits);
        act(c->gradient[i], bits);
        for (int j = 0; j <= FREE; j++) act(c->matrix[i][j], bits);
    }
    for (int32_t k = 0; k < c->stabber->edge_count; k++) {
        act(c->sides[k], bits);
        act(c->tried[k], bits);
    }
}

static void clear(mpf_ptr number, mp_bitcnt_t bits) {
    (void)bits;
    mpf_clear(number);
}

bool enf_fine_centre(enf_fine *fine, enf_stabber *stabber, bool *passes) {
    const size_t count = (size_t)stabber->edge_count;
    centring c = {.stabber = stabber,
                  .fine = fine,
                  .sides = enf_array_new(count, sizeof *c.sides),
                  .tried = enf_array_new(count, sizeof *c.tried)};
    const bool done = c.sides && c.tried;
    if (done) {
        each_number(&c, mpf_init2);
        mpf_set_d(c.most, 4 * fmin(fine->reach, DBL_MAX / 4));
        enf_fine_shift(c.most, -stabber->unit);
        *passes = set_sides(&c, c.sides);
        if (*passes) move(&c);
        each_number(&c, clear);
    }
    free(c.sides);
    free(c.tried);
    return done;
}
