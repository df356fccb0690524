// SPDX-License-Identifier: GPL-3.0-or-later
// Is 0 in the hull of at most seven vectors? Then no x has a positive inner product with all of them, and
// nothing stabs the sequence.
#include "visibility/stab_parts.h"

#include <math.h>

// ---------------------------------------------------------------------------------------------- doubles

/// Gauss-Jordan with row pivoting: the inverse of a, which is lost.
static bool invert(double a[ENF_PLUECKER][ENF_PLUECKER], double inverse[ENF_PLUECKER][ENF_PLUECKER]) {
    for (int i = 0; i < ENF_PLUECKER; i++) {
        for (int j = 0; j < ENF_PLUECKER; j++) inverse[i][j] = i == j;
    }
    for (int c = 0; c < ENF_PLUECKER; c++) {
        int best = c;
        for (int i = c + 1; i < ENF_PLUECKER; i++) best = fabs(a[i][c]) > fabs(a[best][c]) ? i : best;
        if (!(fabs(a[best][c]) > 0)) return false;
        const double factor = 1 / a[best][c];
        for (int j = 0; j < ENF_PLUECKER; j++) {
            double of_a = a[best][j] * factor, of_inverse = inverse[best][j] * factor;
            a[best][j] = a[c][j];
            inverse[best][j] = inverse[c][j];
            a[c][j] = of_a;
            inverse[c][j] = of_inverse;
        }
        for (int i = 0; i < ENF_PLUECKER; i++) {
            const double times = a[i][c];
            if (i == c) continue;
            for (int j = 0; j < ENF_PLUECKER; j++) {
                a[i][j] -= times * a[c][j];
                inverse[i][j] -= times * inverse[c][j];
            }
        }
    }
    return true;
}

/// A lower bound of |a u| for unit vectors u; 0 if the inverse turns out badly. If |inverse a - 1| < 1/4,
/// then 3/4 |u| < |inverse a u| <= |inverse| |a u|; a third allows for the roundings of both.
static double least_stretch(double a[ENF_PLUECKER][ENF_PLUECKER]) {
    double copy[ENF_PLUECKER][ENF_PLUECKER], inverse[ENF_PLUECKER][ENF_PLUECKER], off = 0, size = 0;
    for (int i = 0; i < ENF_PLUECKER; i++) {
        for (int j = 0; j < ENF_PLUECKER; j++) copy[i][j] = a[i][j];
    }
    if (!invert(copy, inverse)) return 0;
    for (int i = 0; i < ENF_PLUECKER; i++) {
        for (int j = 0; j < ENF_PLUECKER; j++) {
            double entry = i == j ? -1 : 0;
            for (int k = 0; k < ENF_PLUECKER; k++) entry += inverse[i][k] * a[k][j];
            off += entry * entry;
            size += inverse[i][j] * inverse[i][j];
        }
    }
    // Beyond 2^20 the roundings of the product would not be small.
    return off < 1.0 / 64 && size < 0x1p40 ? 1 / (3 * sqrt(size)) : 0;
}

/// The hull of seven vectors holds a ball around 0 whose radius is above the error of the vectors: the true
/// ones hold 0 as well, as max <u, e> changes by no more than that error for any unit u. The radius: let w be
/// the least weight, r = sum of weight * e, and max <u, e> = h. Then no <u, e> is below -(|r| + h) / w, and
/// six of them together are no shorter than least_stretch: sqrt(6) (|r| + h) / w >= stretch.
bool enf_stabber_zero_by_double(const enf_stabber *stabber) {
    const enf_min_norm *hull = &stabber->hull;
    const size_t stride = (size_t)stabber->capacity;
    double vector[ENF_HULL_MAX][ENF_PLUECKER], rest[ENF_PLUECKER] = {0}, square = 0, least = 1;
    int heaviest = 0;
    if (hull->size != ENF_HULL_MAX || stabber->rough) return false;
    for (int n = 0; n < ENF_HULL_MAX; n++) {
        least = fmin(least, hull->weight[n]);
        heaviest = hull->weight[n] > hull->weight[heaviest] ? n : heaviest;
        for (int i = 0; i < ENF_PLUECKER; i++) {
            vector[n][i] = stabber->vectors[(size_t)i * stride + (size_t)hull->member[n]];
            rest[i] += hull->weight[n] * vector[n][i];
        }
    }
    for (int i = 0; i < ENF_PLUECKER; i++) {
        vector[heaviest][i] = vector[ENF_HULL_MAX - 1][i];
        square += rest[i] * rest[i];
    }
    return least_stretch(vector) * least / 2.5 - sqrt(square) > 4 * ENF_STAB_ERROR;
}

// ---------------------------------------------------------------------------------------------- whole
// numbers

typedef struct system {
    mpz_t entry[ENF_PLUECKER][ENF_HULL_MAX], divisor, term;
    int size, rank, pivot_of_row[ENF_PLUECKER];
} system;

/// Row i, but for the column itself, becomes (pivot * row i - entry * row r) / divisor: always whole.
static void clear_entry(system *s, int i, int r, int column) {
    mpz_ptr factor = s->term;
    mpz_set(factor, s->entry[i][column]);
    for (int j = 0; j < s->size; j++) {
        mpz_mul(s->entry[i][j], s->entry[i][j], s->entry[r][column]);
        mpz_submul(s->entry[i][j], factor, s->entry[r][j]);
        mpz_divexact(s->entry[i][j], s->entry[i][j], s->divisor);
    }
}

/// E. H. Bareiss, "Sylvester's identity and multistep integer-preserving Gaussian elimination" (1968), in
/// Jordan's form: the pivots all become `divisor`.
static void eliminate(system *s) {
    mpz_set_ui(s->divisor, 1);
    for (int column = 0; column < s->size && s->rank < ENF_PLUECKER; column++) {
        int row = s->rank;
        while (row < ENF_PLUECKER && mpz_sgn(s->entry[row][column]) == 0) row++;
        if (row == ENF_PLUECKER) continue;
        for (int j = 0; j < s->size; j++) mpz_swap(s->entry[row][j], s->entry[s->rank][j]);
        for (int i = 0; i < ENF_PLUECKER; i++) {
            if (i != s->rank) clear_entry(s, i, s->rank, column);
        }
        mpz_set(s->divisor, s->entry[s->rank][column]);
        s->pivot_of_row[s->rank++] = column;
    }
}

/// With one free column, the weights are `divisor` there and what cancels it in the others.
static bool weights_have_one_sign(const system *s) {
    int free_column = 0;
    while (free_column < s->rank && s->pivot_of_row[free_column] == free_column) free_column++;
    for (int i = 0; i < s->rank; i++) {
        if (mpz_sgn(s->entry[i][free_column]) * mpz_sgn(s->divisor) > 0) return false;
    }
    return true;
}

int enf_stabber_members(const enf_stabber *stabber, int32_t members[ENF_HULL_MAX]) {
    const enf_min_norm *hull = &stabber->hull;
    int count = 0;
    for (int n = 0; n < hull->size; n++) {
        if (hull->weight[n] > 1e-9) members[count++] = hull->member[n];
    }
    return count;
}

bool enf_stabber_zero_by_whole(const enf_stabber *stabber, const int32_t *members, int count) {
    system s = {.size = count};
    mpz_t vector[ENF_PLUECKER];
    if (count < 2) return false;
    mpz_inits(s.divisor, s.term, NULL);
    for (int i = 0; i < ENF_PLUECKER; i++) mpz_init(vector[i]);
    for (int n = 0; n < count; n++) {
        enf_stabber_whole_edge(stabber, members[n], vector);
        for (int i = 0; i < ENF_PLUECKER; i++) mpz_init_set(s.entry[i][n], vector[i]);
    }
    eliminate(&s);
    const bool zero = s.rank == count - 1 && weights_have_one_sign(&s);
    for (int i = 0; i < ENF_PLUECKER; i++) {
        for (int n = 0; n < count; n++) mpz_clear(s.entry[i][n]);
        mpz_clear(vector[i]);
    }
    mpz_clears(s.divisor, s.term, NULL);
    return zero;
}
