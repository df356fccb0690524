// SPDX-License-Identifier: GPL-3.0-or-later
// The cone of a sequence against the quadric: sides are added while the form falls below 0 at points outside
// the sequence's cone. If the edges span fewer than six dimensions, the cone is cut into pointed ones by the
// signs of coordinates that complete the edges to a basis.
#include "visibility/exact_double.h"
#include "visibility/stab_parts.h"
#include "visibility/stab_quadric.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Exact coordinates are (direction, moment) with corners in units; the doubles' are scaled: what the
/// direction is to be multiplied with, as a power of two.
static int direction_shift(const enf_stabber *stabber) {
    return ilogb(stabber->scale) + stabber->unit;
}

/// point = hull.x, times a power of two.
static void set_point(enf_stabber *stabber) {
    int64_t mantissa[ENF_PLUECKER];
    int unit[ENF_PLUECKER], least = ENF_NO_UNIT;
    for (int i = 0; i < ENF_PLUECKER; i++) {
        unit[i] = enf_double_split(stabber->hull.x[i], &mantissa[i]);
        if (unit[i] != ENF_NO_UNIT && i < 3) unit[i] += direction_shift(stabber);
        least = unit[i] < least ? unit[i] : least;
    }
    for (int i = 0; i < ENF_PLUECKER; i++) {
        mpz_set_si(stabber->point[i], mantissa[i]);
        if (mantissa[i]) mpz_mul_2exp(stabber->point[i], stabber->point[i], (mp_bitcnt_t)(unit[i] - least));
    }
}

/// The same backwards, of unit length: false if doubles cannot hold it.
static bool unset_point(const enf_stabber *stabber, mpz_t *point, double x[ENF_PLUECKER]) {
    double part[ENF_PLUECKER], square = 0;
    long exponent[ENF_PLUECKER], most = LONG_MIN;
    for (int i = 0; i < ENF_PLUECKER; i++) {
        part[i] = mpz_get_d_2exp(&exponent[i], point[i]);
        if (i < 3) exponent[i] -= direction_shift(stabber);
        if (part[i] != 0 && exponent[i] > most) most = exponent[i];
    }
    for (int i = 0; i < ENF_PLUECKER; i++) {
        const long down = exponent[i] - most;
        x[i] = part[i] != 0 && down > -1000 ? ldexp(part[i], (int)down) : 0;
        square += x[i] * x[i];
    }
    for (int i = 0; i < ENF_PLUECKER; i++) x[i] /= sqrt(square);
    return square > 0;
}

static void set_vector(mpz_t *out, mpz_t *in) {
    for (int i = 0; i < ENF_PLUECKER; i++) mpz_set(out[i], in[i]);
}

/// Reduces the vector by `rank` others; if something is left, that is one more.
static bool is_independent(enf_quadric *q, int rank, mpz_t *vector) {
    mpz_t *rest = q->echelon[rank];
    set_vector(rest, vector);
    for (int r = 0; r < rank; r++) {
        int pivot = 0;
        while (mpz_sgn(q->echelon[r][pivot]) == 0) pivot++;
        mpz_set(q->a, rest[pivot]);
        for (int i = 0; i < ENF_PLUECKER; i++) {
            mpz_mul(rest[i], rest[i], q->echelon[r][pivot]);
            mpz_submul(rest[i], q->a, q->echelon[r][i]);
        }
    }
    enf_whole_shorten(rest);
    int nonzero = 0;
    for (int i = 0; i < ENF_PLUECKER; i++) nonzero += mpz_sgn(rest[i]) != 0;
    return nonzero > 0;
}

/// Six independent vectors, edges first; returns how many of them are edges.
static int choose_basis(enf_stabber *stabber, enf_quadric *q, mpz_t *basis[ENF_PLUECKER]) {
    int rank = 0;
    for (int32_t k = 0; k < stabber->edge_count && rank < ENF_PLUECKER; k++) {
        mpz_t *edge = stabber->whole[stabber->order[k]];
        if (is_independent(q, rank, edge)) basis[rank++] = edge;
    }
    const int edges = rank;
    for (int i = 0; i < ENF_PLUECKER && rank < ENF_PLUECKER; i++) {
        for (int k = 0; k < ENF_PLUECKER; k++) mpz_set_ui(q->completing[rank][k], i == k);
        if (!is_independent(q, rank, q->completing[rank])) continue;
        basis[rank] = q->completing[rank];
        rank++;
    }
    return edges;
}

/// The edge that the witness violates most, relative to the edge's size; -1 if none.
static int32_t most_violated(enf_stabber *stabber, enf_quadric *q) {
    int32_t worst = -1;
    double least = 0;
    for (int32_t k = 0; k < stabber->edge_count; k++) {
        mpz_t *edge = stabber->whole[k];
        enf_whole_dot(q->a, q->witness, edge);
        if (mpz_sgn(q->a) >= 0) continue;
        double size = 0, value = mpz_get_d(q->a);
        for (int i = 0; i < 3; i++) size += fabs(mpz_get_d(edge[3 + i]));
        if (worst >= 0 && !(value / size < least)) continue;
        worst = k;
        least = value / size;
    }
    return worst;
}

typedef enum outcome { MEETS, MISSES, TOO_MANY_SIDES, NO_MEMORY } outcome;

static outcome decide_pointed(enf_stabber *stabber, enf_quadric *q, mpz_t *const basis[ENF_PLUECKER]) {
    if (!enf_cone_start(&q->cone, basis)) return NO_MEMORY;
    while (enf_quadric_falls(q)) {
        const int32_t side = most_violated(stabber, q);
        if (side < 0) return MEETS;
        if (q->cone.side_count == ENF_CONE_SIDES) return TOO_MANY_SIDES;
        if (!enf_cone_cut(&q->cone, stabber->whole[side])) return NO_MEMORY;
    }
    return MISSES;
}

static outcome decide(enf_stabber *stabber, enf_quadric *q) {
    mpz_t *basis[ENF_PLUECKER];
    const int edges = choose_basis(stabber, q, basis);
    for (int signs = 0; signs < 1 << (ENF_PLUECKER - edges); signs++) {
        for (int i = edges; i < ENF_PLUECKER; i++) {
            const bool negative = signs >> (i - edges) & 1;
            for (int k = 0; k < ENF_PLUECKER; k++) {
                mpz_abs(basis[i][k], basis[i][k]);
                if (negative) mpz_neg(basis[i][k], basis[i][k]);
            }
        }
        outcome found = decide_pointed(stabber, q, basis);
        if (found != MISSES) return found;
    }
    return MISSES;
}

/// hull.x = where the form is 0 between the point (+) and the witness (-), about.
static void set_meeting(enf_stabber *stabber, enf_quadric *q) {
    double x[ENF_PLUECKER], y[ENF_PLUECKER], a = 0, b = 0, c = 0;
    if (!unset_point(stabber, stabber->point, x) || !unset_point(stabber, q->witness, y)) return;
    for (int i = 0; i < ENF_PLUECKER; i++) {
        a += q->sign * x[i] * x[(i + 3) % ENF_PLUECKER];
        b += q->sign * x[i] * y[(i + 3) % ENF_PLUECKER];
        c += q->sign * y[i] * y[(i + 3) % ENF_PLUECKER];
    }
    // a + 2 b s + c s^2 = 0, a > 0 > c, s > 0; but these are rounded
    const double root = sqrt(fmax(b * b - a * c, 0));
    double s = b > 0 ? (b + root) / -c : a / (root - b);
    if (!(a > 0)) s = 0;
    if (!(c < 0)) s = HUGE_VAL;
    for (int i = 0; i < ENF_PLUECKER; i++) stabber->hull.x[i] = s < 1 ? x[i] + s * y[i] : x[i] / s + y[i];
}

enf_status enf_stabber_quadric(enf_stabber *stabber, bool *meets, enf_error *error) {
    if (!enf_stabber_order(stabber) || !enf_stabber_whole_edges(stabber))
        return enf_fail_memory(error, "a portal sequence's edges");
    enf_quadric *q = &stabber->quadric;
    if (!stabber->point_is_whole) set_point(stabber);
    mpz_mul(q->a, stabber->point[0], stabber->point[3]);
    for (int i = 1; i < 3; i++) mpz_addmul(q->a, stabber->point[i], stabber->point[3 + i]);
    q->sign = mpz_sgn(q->a);
    *meets = stabber->has_meeting = true;
    if (q->sign == 0) {
        unset_point(stabber, stabber->point, stabber->hull.x);
        return ENF_OK;
    }
    const outcome found = decide(stabber, q);
    if (found == NO_MEMORY) return enf_fail_memory(error, "a portal sequence's cone");
    if (found == TOO_MANY_SIDES) stabber->counts.undecided++;
    if (found == MEETS) set_meeting(stabber, q);
    *meets = found != MISSES;
    stabber->has_meeting = found == MEETS;
    return ENF_OK;
}
