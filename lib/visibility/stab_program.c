// SPDX-License-Identifier: GPL-3.0-or-later
// The linear program in whole numbers: weights >= 0 with sum 1 whose combination of the edge vectors is 0, by
// the first phase of the revised simplex method. R. G. Bland, "New finite pivoting rules for the simplex
// method" (1977), ends it; J. Edmonds' integer pivoting (1967) keeps a common denominator instead of
// fractions.
#include "visibility/stab_parts.h"

#include <math.h>

enum { ROWS = ENF_PLUECKER + 1, RIGHT = ROWS, COLUMNS = ROWS + 1 };

/// The inverse of the basis and the right side, times `denominator` > 0.
typedef struct program {
    mpz_t entry[ROWS][COLUMNS], denominator;
    mpz_t price[COLUMNS]; ///< sum of the rows that still have their artificial variable
    mpz_t column[ROWS], term, other;
    int32_t basis[ROWS]; ///< a place in the order, or after all of them: an artificial variable
} program;

static void program_start(program *p, int32_t count) {
    mpz_inits(p->term, p->other, NULL);
    mpz_init_set_ui(p->denominator, 1);
    for (int i = 0; i < ROWS; i++) {
        for (int j = 0; j < COLUMNS; j++)
            mpz_init_set_ui(p->entry[i][j], i == j || (j == RIGHT && i == ROWS - 1));
        mpz_init(p->column[i]);
        p->basis[i] = count + i;
    }
    for (int j = 0; j < COLUMNS; j++) mpz_init(p->price[j]);
}

static void program_end(program *p) {
    for (int i = 0; i < ROWS; i++) {
        for (int j = 0; j < COLUMNS; j++) mpz_clear(p->entry[i][j]);
        mpz_clear(p->column[i]);
    }
    for (int j = 0; j < COLUMNS; j++) mpz_clear(p->price[j]);
    mpz_clears(p->term, p->other, p->denominator, NULL);
}

static void set_prices(program *p, int32_t count) {
    for (int j = 0; j < COLUMNS; j++) {
        mpz_set_ui(p->price[j], 0);
        for (int i = 0; i < ROWS; i++) {
            if (p->basis[i] >= count) mpz_add(p->price[j], p->price[j], p->entry[i][j]);
        }
    }
}

/// out = row . (vector, 1)
static void multiply_row(mpz_t out, mpz_t *row, mpz_t *vector) {
    mpz_set(out, row[ENF_PLUECKER]);
    for (int i = 0; i < ENF_PLUECKER; i++) mpz_addmul(out, row[i], vector[i]);
}

/// The row with the least right side / column among positive entries, the first variable among equals. There
/// is one, as the sum of the artificial variables cannot fall below 0.
static int leaving_row(program *p) {
    int best = -1;
    for (int i = 0; i < ROWS; i++) {
        if (mpz_sgn(p->column[i]) <= 0) continue;
        int order = -1;
        if (best >= 0) {
            mpz_mul(p->term, p->entry[i][RIGHT], p->column[best]);
            mpz_mul(p->other, p->entry[best][RIGHT], p->column[i]);
            order = mpz_cmp(p->term, p->other);
            if (order == 0) order = p->basis[i] < p->basis[best] ? -1 : 1;
        }
        if (order < 0) best = i;
    }
    return best;
}

static void pivot(program *p, int row) {
    for (int i = 0; i < ROWS; i++) {
        if (i == row) continue;
        for (int j = 0; j < COLUMNS; j++) {
            mpz_mul(p->entry[i][j], p->entry[i][j], p->column[row]);
            mpz_submul(p->entry[i][j], p->column[i], p->entry[row][j]);
            mpz_divexact(p->entry[i][j], p->entry[i][j], p->denominator);
        }
    }
    mpz_set(p->denominator, p->column[row]);
}

/// Is price . (vector, 1) surely not above 0? Each number is off by 2^-52 of itself, cut off.
static bool surely_stays_out(const double about[ROWS], mpz_t *vector) {
    double sum = about[ENF_PLUECKER], size = fabs(sum);
    for (int i = 0; i < ENF_PLUECKER; i++) {
        const double term = about[i] * mpz_get_d(vector[i]);
        sum += term;
        size += fabs(term);
    }
    return sum < -0x1p-48 * size && size < HUGE_VAL;
}

/// The first vector that would take something off what is left of the artificial variables; -1 if there is
/// none.
static int32_t entering(program *p, const enf_stabber *stabber) {
    double about[ROWS];
    for (int i = 0; i < ROWS; i++) about[i] = mpz_get_d(p->price[i]);
    for (int32_t k = 0; k < stabber->edge_count; k++) {
        mpz_t *vector = stabber->whole[stabber->order[k]];
        if (surely_stays_out(about, vector)) continue;
        multiply_row(p->term, p->price, vector);
        if (mpz_sgn(p->term) > 0) return k;
    }
    return -1;
}

bool enf_stabber_program(enf_stabber *stabber) {
    program p;
    int32_t k;
    program_start(&p, stabber->edge_count);
    set_prices(&p, stabber->edge_count);
    while ((k = entering(&p, stabber)) >= 0) {
        for (int i = 0; i < ROWS; i++)
            multiply_row(p.column[i], p.entry[i], stabber->whole[stabber->order[k]]);
        int row = leaving_row(&p);
        pivot(&p, row);
        p.basis[row] = k;
        set_prices(&p, stabber->edge_count);
        stabber->counts.pivots++;
    }
    // Above 0, what is left of the artificial variables: prices separate all vectors from 0.
    const bool zero = mpz_sgn(p.price[RIGHT]) == 0;
    if (!zero) {
        for (int i = 0; i < ENF_PLUECKER; i++) mpz_neg(stabber->point[i], p.price[i]);
        stabber->point_is_whole = true;
    }
    program_end(&p);
    return zero;
}
