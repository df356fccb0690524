// SPDX-License-Identifier: GPL-3.0-or-later
// The weights are looked for by the simplex method with Bland's rule, on a tableau of whole numbers with one
// common denominator (Edmonds' integer pivoting): w >= 0 makes the sum of the forms <= 0 at the nine pairs of
// corners if sum of w can grow without end under that condition; if it can't, the dual solution is a weight
// for each pair of corners with which every form is positive.
#include "visibility_check/hidden_exact.h"

#include "base/array.h"
#include "visibility_check/whole_number.h"

#include <limits.h>
#include <math.h>
#include <stdlib.h>

enum { PAIRS = 9, ROWS = PAIRS + 1, STEPS_MAX = 400, MANTISSA = 40 };

/// Weights below this, of the largest, are rounding.
static const double weight_least = 0x1p-34;

typedef mpz_t form[PAIRS]; ///< values at the pairs of corners p, q, as [3 p + q]

struct enf_hidden_exact {
    const enf_piece_task *task;
    int unit;
    form *forms; ///< of each edge of the task; those with is_made
    bool *is_made;
    size_t form_count; ///< initialised
    long *exponent;    ///< of each side's form: it times 2^this is 1 or so
    size_t exponent_count;
    mpz_t *table; ///< ROWS by width
    size_t table_count;
    mpz_t point[4][3];
    form total;
    mpz_t product, denominator, share[2][3], height[2][2];
    mpq_t end[2][3]; ///< of the last line that passed
};

enf_hidden_exact *enf_hidden_exact_make(const enf_portal_graph *graph) {
    enf_hidden_exact *exact = calloc(1, sizeof *exact);
    if (!exact) return NULL;
    exact->unit = enf_last_bit_of_graph(graph);
    mpz_inits(exact->product, exact->denominator, NULL);
    for (int k = 0; k < PAIRS; k++) mpz_init(exact->total[k]);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 4; k++) mpz_init(exact->point[k][i]);
        for (int s = 0; s < 2; s++) {
            mpz_init(exact->share[s][i]);
            mpq_init(exact->end[s][i]);
        }
    }
    for (int k = 0; k < 4; k++) mpz_init(exact->height[k / 2][k % 2]);
    return exact;
}

void enf_hidden_exact_free(enf_hidden_exact *exact) {
    if (!exact) return;
    mpz_clears(exact->product, exact->denominator, NULL);
    for (int k = 0; k < PAIRS; k++) mpz_clear(exact->total[k]);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 4; k++) mpz_clear(exact->point[k][i]);
        for (int s = 0; s < 2; s++) {
            mpz_clear(exact->share[s][i]);
            mpq_clear(exact->end[s][i]);
        }
    }
    for (int k = 0; k < 4; k++) mpz_clear(exact->height[k / 2][k % 2]);
    for (size_t k = 0; k < exact->form_count; k++)
        for (int pair = 0; pair < PAIRS; pair++) mpz_clear(exact->forms[k][pair]);
    for (size_t k = 0; k < exact->table_count; k++) mpz_clear(exact->table[k]);
    free(exact->forms);
    free(exact->is_made);
    free(exact->exponent);
    free(exact->table);
    free(exact);
}

bool enf_hidden_exact_begin(enf_hidden_exact *exact, const enf_piece_task *task) {
    size_t wanted = (size_t)enf_piece_forms(task);
    if (!enf_array_reserve(exact->exponent, exact->exponent_count, (size_t)task->side_count)) return false;
    if (wanted > exact->form_count) {
        size_t forms = exact->form_count, flags = exact->form_count;
        if (!enf_array_reserve(exact->forms, forms, wanted) ||
            !enf_array_reserve(exact->is_made, flags, wanted))
            return false;
        for (; exact->form_count < wanted; exact->form_count++)
            for (int pair = 0; pair < PAIRS; pair++) mpz_init(exact->forms[exact->form_count][pair]);
    }
    for (size_t k = 0; k < wanted; k++) exact->is_made[k] = false;
    exact->task = task;
    return true;
}

// ---------------------------------------------------------------------------------------------- forms

/// out = the side of the edge point[1], point[2] on which the line point[0], point[3] passes. Points 1 to 3
/// are made relative to point 0.
static void make_side(enf_hidden_exact *exact, mpz_t out) {
    mpz_t(*v)[3] = exact->point;
    for (int k = 1; k < 4; k++)
        for (int i = 0; i < 3; i++) mpz_sub(v[k][i], v[k][i], v[0][i]);
    mpz_set_ui(out, 0);
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        mpz_mul(exact->product, v[1][j], v[2][k]);
        mpz_submul(exact->product, v[1][k], v[2][j]);
        mpz_addmul(out, exact->product, v[3][i]);
    }
}

static void set_point(enf_hidden_exact *exact, int k, int32_t corner) {
    for (int i = 0; i < 3; i++)
        enf_set_whole(exact->point[k][i], exact->task->graph->corners[corner][i], exact->unit);
}

static void make_edge_form(enf_hidden_exact *exact, int32_t from, int32_t to, mpz_t *values) {
    for (int pair = 0; pair < PAIRS; pair++) {
        set_point(exact, 0, exact->task->triangle[0][pair / 3]);
        set_point(exact, 1, from);
        set_point(exact, 2, to);
        set_point(exact, 3, exact->task->triangle[1][pair % 3]);
        make_side(exact, values[pair]);
    }
}

/// With f and g the heights above the planes of two triangles, the line from p to q comes to the first one at
/// f(p) / (f(p) - f(q)) of the way, to the other at g(p) / (g(p) - g(q)); where both rise, that is later if
/// f(p) g(q) - g(p) f(q) is above 0.
static void make_order_form(enf_hidden_exact *exact, const int32_t corner[6], mpz_t *values) {
    for (int pair = 0; pair < PAIRS; pair++) {
        for (int end = 0; end < 2; end++)
            for (int plane = 0; plane < 2; plane++) {
                for (int k = 0; k < 3; k++) set_point(exact, k, corner[3 * plane + k]);
                set_point(exact, 3, exact->task->triangle[end][end ? pair % 3 : pair / 3]);
                make_side(exact, exact->height[end][plane]);
            }
        mpz_mul(values[pair], exact->height[0][0], exact->height[1][1]);
        mpz_submul(values[pair], exact->height[0][1], exact->height[1][0]);
    }
}

/// The form of an edge or a side, made when it is first needed.
static mpz_t *form_of(enf_hidden_exact *exact, int32_t k) {
    const enf_piece_task *task = exact->task;
    if (exact->is_made[k]) return exact->forms[k];
    exact->is_made[k] = true;
    if (k < task->edge_count) {
        int32_t corner[2] = {task->edges[k] >> 1, task->corner_next[task->edges[k] >> 1]};
        int turned = task->edges[k] & 1;
        make_edge_form(exact, corner[turned], corner[!turned], exact->forms[k]);
        return exact->forms[k];
    }
    const enf_piece_side *side = &task->sides[k - task->edge_count];
    if (side->count == 2)
        make_edge_form(exact, side->corner[0], side->corner[1], exact->forms[k]);
    else
        make_order_form(exact, side->corner, exact->forms[k]);
    return exact->forms[k];
}

void enf_hidden_exact_values(enf_hidden_exact *exact, int32_t side, double values[9]) {
    mpz_t *form = form_of(exact, exact->task->edge_count + side);
    double part[PAIRS];
    long exponent[PAIRS], most = LONG_MIN;
    for (int pair = 0; pair < PAIRS; pair++) {
        part[pair] = mpz_get_d_2exp(&exponent[pair], form[pair]);
        if (part[pair] != 0 && exponent[pair] > most) most = exponent[pair];
    }
    exact->exponent[side] = most > LONG_MIN ? -most : 0;
    for (int pair = 0; pair < PAIRS; pair++) {
        bool counts = part[pair] != 0 && most - exponent[pair] < 1000;
        values[pair] = counts ? ldexp(part[pair], (int)(exponent[pair] - most)) : 0;
    }
}

/// out = the form at corners i and j of the piece.
static void at_corners(enf_hidden_exact *exact, const mpz_t *values, const enf_piece *piece, int pair,
                       mpz_t out) {
    const int32_t *u = piece->corner[0][pair / 3], *v = piece->corner[1][pair % 3];
    mpz_set_ui(out, 0);
    for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++) {
            mpz_mul_si(exact->product, values[3 * p + q], (int64_t)u[p] * v[q]);
            mpz_add(out, out, exact->product);
        }
}

/// *mantissa * 2^(what is returned), in units: what a weight multiplies the whole form with.
static long split_weight(const enf_hidden_exact *exact, int32_t k, double weight, double scale,
                         int64_t *mantissa) {
    int32_t edges = exact->task->edge_count;
    int exponent;
    double part = frexp(k < edges ? weight * scale : weight, &exponent);
    *mantissa = (int64_t)ldexp(part, MANTISSA);
    return exponent - MANTISSA + (k < edges ? 3 * (long)exact->unit : exact->exponent[k - edges]);
}

/// total = the sum of the forms times their weights, times a power of two.
static void add_forms(enf_hidden_exact *exact, const double *weights, const double *scales, double least) {
    long lowest = 0; // the exponent that total has so far
    bool some = false;
    for (int pair = 0; pair < PAIRS; pair++) mpz_set_ui(exact->total[pair], 0);
    for (int32_t k = 0; k < enf_piece_forms(exact->task); k++) {
        int64_t mantissa;
        if (!(weights[k] > least)) continue; // that is rounding
        long exponent = split_weight(exact, k, weights[k], scales[k], &mantissa);
        long down = some && exponent < lowest ? lowest - exponent : 0;
        if (!some || exponent < lowest) lowest = exponent;
        some = true;
        mpz_t *values = form_of(exact, k);
        for (int pair = 0; pair < PAIRS; pair++) {
            mpz_mul_2exp(exact->total[pair], exact->total[pair], (mp_bitcnt_t)down);
            mpz_mul_si(exact->product, values[pair], mantissa);
            mpz_mul_2exp(exact->product, exact->product, (mp_bitcnt_t)(exponent - lowest));
            mpz_add(exact->total[pair], exact->total[pair], exact->product);
        }
    }
}

bool enf_hidden_exact_proves(enf_hidden_exact *exact, const enf_piece *piece, const double *weights,
                             const double *scales) {
    double most = 0;
    for (int32_t k = 0; k < enf_piece_forms(exact->task); k++) {
        most = fmax(most, weights[k]);
        if (k < exact->task->edge_count && !isnormal(scales[k])) return false;
    }
    if (!(most > 0)) return false;
    add_forms(exact, weights, scales, most * weight_least);
    for (int pair = 0; pair < PAIRS; pair++) {
        at_corners(exact, (const mpz_t *)exact->total, piece, pair, exact->denominator);
        if (mpz_sgn(exact->denominator) > 0) return false;
    }
    return true;
}

// ---------------------------------------------------------------------------------------------- tableau

/// Columns: the edges and sides, then a slack for each row. Rows: the pairs of corners, then gains.
typedef struct table {
    mpz_t *entry;
    int32_t width;
    int32_t basis[PAIRS];
} table;

static bool make_table(enf_hidden_exact *exact, const enf_piece *piece, table *table) {
    int32_t edges = enf_piece_forms(exact->task);
    table->width = edges + PAIRS;
    size_t wanted = (size_t)table->width * ROWS, capacity = exact->table_count;
    if (!enf_array_reserve(exact->table, capacity, wanted)) return false;
    for (; exact->table_count < wanted; exact->table_count++) mpz_init(exact->table[exact->table_count]);
    table->entry = exact->table;
    for (int r = 0; r < ROWS; r++) {
        mpz_t *row = table->entry + (ptrdiff_t)r * table->width;
        for (int32_t k = 0; k < edges; k++) {
            if (r < PAIRS)
                at_corners(exact, (const mpz_t *)form_of(exact, k), piece, r, row[k]);
            else
                mpz_set_ui(row[k], 1);
        }
        for (int s = 0; s < PAIRS; s++) mpz_set_ui(row[edges + s], r == s);
        if (r < PAIRS) table->basis[r] = edges + r;
    }
    mpz_set_ui(exact->denominator, 1);
    return true;
}

static void pivot(enf_hidden_exact *exact, table *table, int row, int32_t column) {
    mpz_t *from = table->entry + (ptrdiff_t)row * table->width;
    for (int r = 0; r < ROWS; r++) {
        mpz_t *to = table->entry + (ptrdiff_t)r * table->width;
        if (r == row) continue;
        for (int32_t k = 0; k < table->width; k++) {
            if (k == column) continue;
            mpz_mul(to[k], to[k], from[column]);
            mpz_submul(to[k], to[column], from[k]);
            mpz_divexact(to[k], to[k], exact->denominator);
        }
        mpz_set_ui(to[column], 0);
    }
    mpz_set(exact->denominator, from[column]);
    table->basis[row] = column;
}

/// 1: the sum grows without end; 0: it does not; -1: too many steps.
static int run_table(enf_hidden_exact *exact, table *table) {
    const mpz_t *gain = (const mpz_t *)(table->entry + (ptrdiff_t)PAIRS * table->width);
    for (int step = 0; step < STEPS_MAX; step++) {
        int32_t column = 0;
        int leaving = -1;
        while (column < table->width && mpz_sgn(gain[column]) <= 0) column++;
        if (column == table->width) return 0;
        for (int r = 0; r < PAIRS; r++) {
            if (mpz_sgn(table->entry[(ptrdiff_t)r * table->width + column]) <= 0) continue;
            if (leaving < 0 || table->basis[r] < table->basis[leaving]) leaving = r;
        }
        if (leaving < 0) return 1;
        pivot(exact, table, leaving, column);
    }
    return -1;
}

/// The two points that the dual solution names: does the line through them pass all edges?
static bool dual_line_passes(enf_hidden_exact *exact, const enf_piece *piece, const table *table) {
    const mpz_t *gain = (const mpz_t *)(table->entry + (ptrdiff_t)PAIRS * table->width);
    for (int s = 0; s < 2; s++)
        for (int p = 0; p < 3; p++) mpz_set_ui(exact->share[s][p], 0);
    for (int pair = 0; pair < PAIRS; pair++)
        for (int p = 0; p < 3; p++) {
            mpz_srcptr weight = gain[enf_piece_forms(exact->task) + pair]; // <= 0
            mpz_submul_ui(exact->share[0][p], weight, (unsigned long)piece->corner[0][pair / 3][p]);
            mpz_submul_ui(exact->share[1][p], weight, (unsigned long)piece->corner[1][pair % 3][p]);
        }
    for (int32_t k = 0; k < enf_piece_forms(exact->task); k++) {
        mpz_t *values = form_of(exact, k);
        mpz_set_ui(exact->total[0], 0);
        for (int pair = 0; pair < PAIRS; pair++) {
            mpz_mul(exact->product, exact->share[0][pair / 3], exact->share[1][pair % 3]);
            mpz_addmul(exact->total[0], exact->product, values[pair]);
        }
        if (mpz_sgn(exact->total[0]) <= 0) return false;
    }
    return true;
}

static void round_shares(enf_hidden_exact *exact, double share[2][3]) {
    for (int s = 0; s < 2; s++) {
        mpq_t part;
        mpq_init(part);
        mpz_add(exact->product, exact->share[s][0], exact->share[s][1]);
        mpz_add(exact->product, exact->product, exact->share[s][2]);
        for (int p = 0; p < 3; p++) {
            mpq_set_num(part, exact->share[s][p]);
            mpq_set_den(part, exact->product);
            mpq_canonicalize(part);
            share[s][p] = mpq_get_d(part);
        }
        mpq_clear(part);
    }
}

/// The points of the two shares.
static void set_ends(enf_hidden_exact *exact) {
    mpq_t part, all;
    mpq_inits(part, all, NULL);
    for (int s = 0; s < 2; s++) {
        mpz_add(exact->product, exact->share[s][0], exact->share[s][1]);
        mpz_add(exact->product, exact->product, exact->share[s][2]);
        mpq_set_z(all, exact->product);
        for (int i = 0; i < 3; i++) {
            mpq_set_ui(exact->end[s][i], 0, 1);
            for (int p = 0; p < 3; p++) {
                mpq_t coordinate;
                mpq_init(coordinate);
                mpq_set_d(coordinate, exact->task->graph->corners[exact->task->triangle[s][p]][i]);
                mpq_set_z(part, exact->share[s][p]);
                mpq_mul(part, part, coordinate);
                mpq_add(exact->end[s][i], exact->end[s][i], part);
                mpq_clear(coordinate);
            }
            mpq_div(exact->end[s][i], exact->end[s][i], all);
        }
    }
    mpq_clears(part, all, NULL);
}

void enf_hidden_exact_line(const enf_hidden_exact *exact, mpq_t from[3], mpq_t to[3]) {
    for (int i = 0; i < 3; i++) {
        mpq_set(from[i], exact->end[0][i]);
        mpq_set(to[i], exact->end[1][i]);
    }
}

int enf_hidden_exact_decide(enf_hidden_exact *exact, const enf_piece *piece, double share[2][3]) {
    table table;
    if (!make_table(exact, piece, &table)) return 0;
    int answer = run_table(exact, &table);
    if (answer != 0) return answer > 0;
    if (!dual_line_passes(exact, piece, &table)) return 0;
    round_shares(exact, share);
    set_ends(exact);
    return -1;
}
