// SPDX-License-Identifier: GPL-3.0-or-later
// On which side of an edge does a line pass? The sign of a 3 by 3 determinant: by doubles with Shewchuk's
// error bound ("Adaptive precision floating-point arithmetic", 1997), else by whole numbers of any size.
// Lines in decimals: by whole numbers only.
#include "visibility_check/check_witness.h"

#include "base/array.h"
#include "visibility/decimal.h"
#include "visibility_check/whole_number.h"
#include "visibility_check/witness_order.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { VECTORS = 3 }; // from the line's first point to: the edge's ends, the line's second point

/// Relative to the sum of the terms' magnitudes: (7 + 56 u) u with u = 2^-53.
static const double side_error = 7.78e-16;
/// Below this, products may have lost digits by underflow.
static const double side_least = 1e-250;

typedef struct witness_numbers {
    mpz_t origin[3];
    mpz_t vector[VECTORS][3];
    mpz_t sum, product;
    mpz_t end[2][3], common; ///< of a line in decimals: the points are end / common
} witness_numbers;

/// A line on its way from -> to.
typedef struct witness_line {
    const double *from, *to;
    bool is_long, turned; ///< it is the line of the numbers' ends; from the second to the first
} witness_line;

static void each_number(witness_numbers *numbers, void (*act)(mpz_ptr)) {
    act(numbers->sum);
    act(numbers->product);
    act(numbers->common);
    for (int i = 0; i < 3; i++) {
        act(numbers->origin[i]);
        act(numbers->end[0][i]);
        act(numbers->end[1][i]);
        for (int k = 0; k < VECTORS; k++) act(numbers->vector[k][i]);
    }
}

bool enf_witness_checker_make(enf_witness_checker *checker, const enf_portal_graph *graph) {
    *checker = (enf_witness_checker){.graph = graph};
    witness_numbers *numbers = malloc(sizeof *numbers);
    if (!numbers) return false;
    each_number(numbers, mpz_init);
    checker->numbers = numbers;
    size_t portals = 2 * (size_t)graph->opening_count;
    checker->passed = enf_array_zeroed(portals, sizeof *checker->passed);
    checker->queue = enf_array_new(portals, sizeof *checker->queue);
    return checker->passed && checker->queue;
}

void enf_witness_checker_free(enf_witness_checker *checker) {
    witness_numbers *numbers = checker->numbers;
    if (!numbers) return;
    each_number(numbers, mpz_clear);
    free(numbers);
    free(checker->passed);
    free(checker->queue);
    *checker = (enf_witness_checker){.graph = NULL};
}

// ---------------------------------------------------------------------------------------------- sides

static void multiply_add(witness_numbers *numbers, int i, int j, int k, int sign) {
    mpz_mul(numbers->product, numbers->vector[0][i], numbers->vector[1][j]);
    mpz_mul(numbers->product, numbers->product, numbers->vector[2][k]);
    if (sign > 0)
        mpz_add(numbers->sum, numbers->sum, numbers->product);
    else
        mpz_sub(numbers->sum, numbers->sum, numbers->product);
}

/// The vectors in whole multiples of a power of two.
static void set_vectors(witness_numbers *numbers, const double *point[4]) {
    int unit = DBL_MAX_EXP;
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++) {
            int bit = enf_last_bit(point[k][i]);
            if (bit < unit) unit = bit;
        }
    for (int i = 0; i < 3; i++) {
        enf_set_whole(numbers->origin[i], point[0][i], unit);
        for (int k = 0; k < VECTORS; k++) {
            enf_set_whole(numbers->vector[k][i], point[k + 1][i], unit);
            mpz_sub(numbers->vector[k][i], numbers->vector[k][i], numbers->origin[i]);
        }
    }
}

/// The vectors of a line in decimals, in such multiples over the common denominator.
static void set_long_vectors(witness_numbers *numbers, const double *point[4], bool turned) {
    int unit = 0;
    for (int k = 1; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            int bit = enf_last_bit(point[k][i]);
            if (bit < unit) unit = bit;
        }
    for (int i = 0; i < 3; i++) {
        mpz_mul_2exp(numbers->origin[i], numbers->end[turned][i], (mp_bitcnt_t)-unit);
        mpz_mul_2exp(numbers->vector[2][i], numbers->end[!turned][i], (mp_bitcnt_t)-unit);
        for (int k = 0; k < 2; k++) {
            enf_set_whole(numbers->vector[k][i], point[k + 1][i], unit);
            mpz_mul(numbers->vector[k][i], numbers->vector[k][i], numbers->common);
        }
        for (int k = 0; k < VECTORS; k++)
            mpz_sub(numbers->vector[k][i], numbers->vector[k][i], numbers->origin[i]);
    }
}

/// The sign of the vectors' determinant.
static int side_exact(enf_witness_checker *checker) {
    witness_numbers *numbers = checker->numbers;
    mpz_set_ui(numbers->sum, 0);
    for (int i = 0; i < 3; i++) {
        multiply_add(numbers, i, (i + 1) % 3, (i + 2) % 3, 1);
        multiply_add(numbers, i, (i + 2) % 3, (i + 1) % 3, -1);
    }
    checker->sides_exact++;
    return mpz_sgn(numbers->sum);
}

/// 1: the line from -> to sees the edge a -> b turn counter-clockwise around it, seen from ahead; -1:
/// clockwise; 0: they meet, or are parallel.
static int side(enf_witness_checker *checker, const witness_line *line, const double a[3],
                const double b[3]) {
    const double *from = line->from, *to = line->to, *point[4] = {from, a, b, to};
    double u[3], v[3], d[3], sum = 0, size = 0;
    for (int i = 0; i < 3; i++) {
        u[i] = a[i] - from[i];
        v[i] = b[i] - from[i];
        d[i] = to[i] - from[i];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double left = u[j] * v[k], right = u[k] * v[j];
        sum += d[i] * (left - right);
        size += fabs(d[i]) * (fabs(left) + fabs(right));
    }
    if (!line->is_long && size > side_least && size < DBL_MAX && fabs(sum) > side_error * size) {
        checker->sides_near++;
        return sum > 0 ? 1 : -1;
    }
    if (line->is_long)
        set_long_vectors(checker->numbers, point, line->turned);
    else
        set_vectors(checker->numbers, point);
    return side_exact(checker);
}

// ---------------------------------------------------------------------------------------------- order

/// Does the line come to the one portal before the other? By doubles if that is clear.
static bool in_order(enf_witness_checker *checker, int32_t first, int32_t second, const witness_line *line) {
    if (!line->is_long && enf_witness_surely_in_order(checker->graph, line->from, line->to, first, second))
        return true;
    witness_numbers *numbers = checker->numbers;
    mpq_t end[2][3];
    for (int e = 0; e < 2; e++)
        for (int i = 0; i < 3; i++) {
            mpq_init(end[e][i]);
            if (line->is_long) {
                mpz_set(mpq_numref(end[e][i]), numbers->end[line->turned ? !e : e][i]);
                mpz_set(mpq_denref(end[e][i]), numbers->common);
                mpq_canonicalize(end[e][i]);
            } else {
                mpq_set_d(end[e][i], e ? line->to[i] : line->from[i]);
            }
        }
    bool good = enf_witness_in_order(checker->graph, end[0], end[1], first, second);
    for (int e = 0; e < 2; e++)
        for (int i = 0; i < 3; i++) mpq_clear(end[e][i]);
    return good;
}

// ---------------------------------------------------------------------------------------------- walk

static bool passes(enf_witness_checker *checker, int32_t portal, const witness_line *line) {
    const enf_portal_graph *graph = checker->graph;
    int32_t first = graph->opening_corner[portal >> 1], end = graph->opening_corner[(portal >> 1) + 1];
    int wanted = portal & 1 ? -1 : 1;
    for (int32_t at = end - 1, next = first; next < end; at = next++)
        if (side(checker, line, graph->corners[at], graph->corners[next]) != wanted) return false;
    return true;
}

/// Queues the portals out of a cell, entered by a portal or, for -1, the first one, that the line comes to
/// next; returns the queue's new length. Each portal is queued once.
static int32_t go_on(enf_witness_checker *checker, int32_t cell, int32_t by, const witness_line *line,
                     int32_t count, enf_witness_outcome *outcome) {
    const enf_portal_graph *graph = checker->graph;
    int32_t before = outcome->steps;
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++) {
        int32_t portal = graph->cell_portals[k];
        if (!passes(checker, portal, line)) continue;
        if (by >= 0 && !in_order(checker, by, portal, line)) continue;
        outcome->steps++;
        if (checker->passed[portal] == checker->walks) continue;
        checker->passed[portal] = checker->walks;
        checker->queue[count++] = portal;
    }
    outcome->forked |= outcome->steps > before + 1;
    return count;
}

static enf_witness_outcome walk(enf_witness_checker *checker, const int32_t cell[2],
                                const witness_line *line) {
    enf_witness_outcome outcome = {.fault = ENF_WITNESS_STUCK, .cell = cell[0]};
    if (cell[0] == cell[1]) outcome.fault = ENF_WITNESS_HOLDS;
    if (!outcome.fault) return outcome;
    checker->walks++;
    int32_t count = go_on(checker, cell[0], -1, line, 0, &outcome);
    for (int32_t at = 0; at < count && outcome.fault; at++) {
        outcome.cell = enf_portal_to(checker->graph, checker->queue[at]);
        if (outcome.cell == cell[1])
            outcome.fault = ENF_WITNESS_HOLDS;
        else
            count = go_on(checker, outcome.cell, checker->queue[at], line, count, &outcome);
    }
    return outcome;
}

/// The ends in whole numbers over a common denominator. False if the text is not six numbers, or the ends are
/// one.
static bool read_ends(witness_numbers *numbers, const char *text) {
    mpq_t number[6];
    bool good = true, differ = false;
    int digits;
    for (int k = 0; k < 6; k++) mpq_init(number[k]);
    for (int k = 0; good && k < 6; k++) good = enf_decimal_read(number[k], &text, &digits);
    mpz_set_ui(numbers->common, 1);
    for (int k = 0; k < 6; k++) mpz_lcm(numbers->common, numbers->common, mpq_denref(number[k]));
    for (int k = 0; k < 6; k++) {
        mpz_ptr end = numbers->end[k / 3][k % 3];
        mpz_divexact(end, numbers->common, mpq_denref(number[k]));
        mpz_mul(end, end, mpq_numref(number[k]));
        differ = differ || (k >= 3 && mpz_cmp(end, numbers->end[0][k - 3]) != 0);
    }
    for (int k = 0; k < 6; k++) mpq_clear(number[k]);
    return good && differ && *text == '\0';
}

static enf_witness_fault check_words(const enf_portal_graph *graph, const enf_witness *witness) {
    bool differ = false;
    for (int i = 0; i < 3; i++) {
        if (!isfinite(witness->from[i]) || !isfinite(witness->to[i])) return ENF_WITNESS_NO_LINE;
        differ = differ || witness->from[i] != witness->to[i];
    }
    for (int i = 0; i < 2; i++)
        if (witness->cell[i] < 0 || witness->cell[i] >= graph->cell_count) return ENF_WITNESS_NO_CELL;
    return differ || witness->decimals ? ENF_WITNESS_HOLDS : ENF_WITNESS_NO_LINE;
}

enf_witness_outcome enf_witness_check(enf_witness_checker *checker, const enf_witness *witness) {
    enf_witness_outcome outcome = {.fault = check_words(checker->graph, witness), .cell = witness->cell[0]};
    if (!outcome.fault && witness->decimals && !read_ends(checker->numbers, witness->decimals))
        outcome.fault = ENF_WITNESS_NO_LINE;
    if (outcome.fault) return outcome;
    const bool is_long = witness->decimals != NULL;
    const witness_line there = {witness->from, witness->to, is_long, false};
    outcome = walk(checker, witness->cell, &there);
    if (outcome.fault == ENF_WITNESS_HOLDS) return outcome;
    const witness_line turned = {witness->to, witness->from, is_long, true};
    enf_witness_outcome back = walk(checker, witness->cell, &turned);
    bool further = back.fault == ENF_WITNESS_HOLDS || back.steps > outcome.steps;
    return further ? back : outcome;
}

void enf_witness_describe(enf_witness_outcome outcome, char *text, size_t size) {
    static const char *const words[] = {
        [ENF_WITNESS_HOLDS] = "the line arrives in cell",
        [ENF_WITNESS_NO_CELL] = "there is no such cell; from cell",
        [ENF_WITNESS_NO_LINE] = "the two points are no line; from cell",
        [ENF_WITNESS_STUCK] = "the line passes no portal out of cell",
    };
    snprintf(text, size, "%s %d, after %d portals", words[outcome.fault], (int)outcome.cell,
             (int)outcome.steps);
}
