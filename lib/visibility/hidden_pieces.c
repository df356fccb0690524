// SPDX-License-Identifier: GPL-3.0-or-later
// A line through points a of one triangle and b of another is on the inner side of an edge if a bilinear form
// of their barycentric coordinates is positive. Over a piece (a triangle within each) the form lies between
// its values at the nine pairs of corners. If weights of edges make the sum of their forms <= 0 at all nine,
// no line of the piece passes all edges; that is verified with whole numbers.
#include "visibility/hidden_pieces.h"

#include "base/array.h"

#include <float.h>
#include <gmp.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HALVINGS = 20, ONE = 1 << HALVINGS, STACK = 2 * HALVINGS * 3 + 2, WEIGHT_BITS = 40 };

/// corner[0]: barycentric coordinates of the corners in the first portal's triangle; [1]: in the last one's.
typedef struct piece {
    int32_t corner[2][3][3]; ///< each adds up to ONE
    int8_t halved[2];        ///< how often
} piece;

typedef struct task {
    enf_hidden_pieces *work;
    int32_t triangle[2][3]; ///< corners of the graph
    const int32_t *edges, *corner_next;
    int32_t edge_count;
    double size; ///< the longest distance, to bring numbers to 1 or so
} task;

static const double *corner_of(const task *task, int side, int k) {
    return task->work->graph->corners[task->triangle[side][k]];
}

static void edge_ends(const task *task, int32_t k, const double *end[2]) {
    int32_t edge = task->edges[k], corner[2] = {edge >> 1, task->corner_next[edge >> 1]};
    for (int e = 0; e < 2; e++) end[e ^ (edge & 1)] = task->work->graph->corners[corner[e]];
}

static double distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static double side(const double from[3], const double to[3], const double a[3], const double b[3]) {
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        sum += (to[i] - from[i]) * ((a[j] - from[j]) * (b[k] - from[k]) - (a[k] - from[k]) * (b[j] - from[j]));
    }
    return sum;
}

static bool make_products(const task *task) {
    enf_hidden_pieces *work = task->work;
    if (!enf_array_reserve(work->product, work->product_capacity, (size_t)task->edge_count) ||
        !enf_array_reserve(work->column, work->column_capacity, (size_t)task->edge_count))
        return false;
    for (int32_t k = 0; k < task->edge_count; k++) {
        const double *end[2];
        edge_ends(task, k, end);
        double scale = 1 / (task->size * task->size * distance(end[0], end[1]));
        for (int p = 0; p < 3; p++)
            for (int q = 0; q < 3; q++)
                work->product[k][3 * p + q] =
                    scale * side(corner_of(task, 0, p), corner_of(task, 1, q), end[0], end[1]);
    }
    return true;
}

/// The nine values of every form at the corners of a piece.
static void make_columns(const task *task, const piece *piece) {
    double u[2][3][3];
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < 3; i++)
            for (int p = 0; p < 3; p++) u[s][i][p] = (double)piece->corner[s][i][p] / ONE;
    for (int32_t k = 0; k < task->edge_count; k++) {
        const double *d = task->work->product[k];
        double *column = task->work->column[k], half[3][3];
        for (int i = 0; i < 3; i++)
            for (int q = 0; q < 3; q++)
                half[i][q] = u[0][i][0] * d[q] + u[0][i][1] * d[3 + q] + u[0][i][2] * d[6 + q];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                column[3 * i + j] = half[i][0] * u[1][j][0] + half[i][1] * u[1][j][1] + half[i][2] * u[1][j][2];
    }
}

// ---------------------------------------------------------------------------------------------- proof

static void set_point(mpq_t out[3], const double point[3]) {
    for (int i = 0; i < 3; i++) mpq_set_d(out[i], point[i]);
}

typedef struct exact_side {
    mpq_t point[4][3];
    mpq_t product, sum;
} exact_side;

/// sum = the side of the edge a b on which the line passes, as the 3 by 3 determinant.
static void exact_side_of(exact_side *exact, const double from[3], const double to[3], const double a[3],
                          const double b[3]) {
    mpq_t(*v)[3] = exact->point;
    set_point(v[0], from);
    set_point(v[1], a);
    set_point(v[2], b);
    set_point(v[3], to);
    for (int k = 1; k < 4; k++)
        for (int i = 0; i < 3; i++) mpq_sub(v[k][i], v[k][i], v[0][i]);
    mpq_set_ui(exact->sum, 0, 1);
    for (int term = 0; term < 6; term++) {
        int i = term % 3, j = (i + (term < 3 ? 1 : 2)) % 3, k = 3 - i - j;
        mpq_mul(exact->product, v[1][i], v[2][j]);
        mpq_mul(exact->product, exact->product, v[3][k]);
        if (term < 3)
            mpq_add(exact->sum, exact->sum, exact->product);
        else
            mpq_sub(exact->sum, exact->sum, exact->product);
    }
}

/// total[3 p + q] += weight * the form of edge k at corner p of the first and q of the last triangle.
static void add_edge(const task *task, exact_side *exact, int32_t k, double weight, mpq_t total[9]) {
    const double *end[2];
    mpq_t factor;
    edge_ends(task, k, end);
    mpq_init(factor);
    mpq_set_d(factor, weight);
    for (int p = 0; p < 3; p++)
        for (int q = 0; q < 3; q++) {
            exact_side_of(exact, corner_of(task, 0, p), corner_of(task, 1, q), end[0], end[1]);
            mpq_mul(exact->sum, exact->sum, factor);
            mpq_add(total[3 * p + q], total[3 * p + q], exact->sum);
        }
    mpq_clear(factor);
}

/// Is the total form <= 0 at all nine pairs of corners of the piece?
static bool is_nowhere_positive(const piece *piece, exact_side *exact, mpq_t total[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            mpq_set_ui(exact->sum, 0, 1);
            for (int p = 0; p < 3; p++)
                for (int q = 0; q < 3; q++) {
                    mpq_set_d(exact->product, (double)piece->corner[0][i][p] * piece->corner[1][j][q]);
                    mpq_mul(exact->product, exact->product, total[3 * p + q]);
                    mpq_add(exact->sum, exact->sum, exact->product);
                }
            if (mpq_sgn(exact->sum) > 0) return false;
        }
    return true;
}

/// Do the weights of the game prove the piece empty? Weights that are rounding only are left out.
static bool is_proved(const task *task, const piece *piece) {
    exact_side exact;
    mpq_t total[9];
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++) mpq_init(exact.point[k][i]);
    mpq_inits(exact.product, exact.sum, NULL);
    for (int k = 0; k < 9; k++) mpq_init(total[k]);
    for (int32_t k = 0; k < task->edge_count; k++) {
        const double *end[2];
        double weight = task->work->game.column_weight[k];
        if (weight < 1e-10) continue;
        edge_ends(task, k, end);
        add_edge(task, &exact, k, weight / distance(end[0], end[1]), total);
    }
    bool proved = is_nowhere_positive(piece, &exact, total);
    for (int k = 0; k < 9; k++) mpq_clear(total[k]);
    mpq_clears(exact.product, exact.sum, NULL);
    for (int k = 0; k < 4; k++)
        for (int i = 0; i < 3; i++) mpq_clear(exact.point[k][i]);
    return proved;
}

// ---------------------------------------------------------------------------------------------- pieces

/// The line that the row player's weights name: does it pass all edges?
static bool try_line(const task *task, const piece *piece) {
    enf_hidden_pieces *work = task->work;
    double share[2][3] = {{0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int p = 0; p < 3; p++) {
                share[0][p] += work->game.row_weight[3 * i + j] * piece->corner[0][i][p] / ONE;
                share[1][p] += work->game.row_weight[3 * i + j] * piece->corner[1][j][p] / ONE;
            }
    for (int i = 0; i < 3; i++) {
        work->from[i] = work->to[i] = 0;
        for (int p = 0; p < 3; p++) {
            work->from[i] += share[0][p] * corner_of(task, 0, p)[i];
            work->to[i] += share[1][p] * corner_of(task, 1, p)[i];
        }
    }
    for (int32_t k = 0; k < task->edge_count; k++) {
        const double *end[2];
        edge_ends(task, k, end);
        if (!(side(work->from, work->to, end[0], end[1]) > 0)) return false;
    }
    return true;
}

static void point_of(const task *task, int s, const int32_t share[3], double point[3]) {
    for (int i = 0; i < 3; i++) {
        point[i] = 0;
        for (int p = 0; p < 3; p++) point[i] += (double)share[p] / ONE * corner_of(task, s, p)[i];
    }
}

/// Halves the longest edge that may still be halved. False if none may.
static bool halve(const task *task, const piece *whole, piece half[2]) {
    double longest = 0;
    int side_found = -1, edge_found = 0;
    for (int s = 0; s < 2; s++) {
        double point[3][3];
        if (whole->halved[s] >= HALVINGS) continue;
        for (int i = 0; i < 3; i++) point_of(task, s, whole->corner[s][i], point[i]);
        for (int i = 0; i < 3; i++) {
            double length = distance(point[i], point[(i + 1) % 3]);
            if (length <= longest) continue;
            longest = length;
            side_found = s;
            edge_found = i;
        }
    }
    if (side_found < 0) return false;
    for (int h = 0; h < 2; h++) {
        int moved = h ? (edge_found + 1) % 3 : edge_found, kept = h ? edge_found : (edge_found + 1) % 3;
        half[h] = *whole;
        half[h].halved[side_found]++;
        for (int p = 0; p < 3; p++) // exact: every halving takes one of the HALVINGS bits
            half[h].corner[side_found][moved][p] =
                (whole->corner[side_found][moved][p] + whole->corner[side_found][kept][p]) / 2;
    }
    return true;
}

static enf_pieces_answer ask_triangles(const task *task) {
    enf_hidden_pieces *work = task->work;
    piece stack[STACK] = {{.corner = {{{ONE, 0, 0}, {0, ONE, 0}, {0, 0, ONE}}, {{ONE, 0, 0}, {0, ONE, 0}, {0, 0, ONE}}}}};
    int depth = 1;
    if (!make_products(task)) return ENF_PIECES_OPEN;
    for (int32_t count = 0; depth > 0; count++) {
        if (count >= work->limit) return ENF_PIECES_OPEN;
        const piece here = stack[--depth];
        work->pieces++;
        make_columns(task, &here);
        if (!enf_matrix_game_solve(&work->game, (const double(*)[9])work->column, task->edge_count))
            return ENF_PIECES_OPEN;
        if (work->game.value <= 1e-10 && is_proved(task, &here)) continue;
        if (try_line(task, &here)) return ENF_PIECES_SEEN;
        if (depth + 2 > STACK || !halve(task, &here, &stack[depth])) return ENF_PIECES_OPEN;
        depth += 2;
    }
    return ENF_PIECES_HIDDEN;
}

enf_pieces_answer enf_hidden_pieces_ask(enf_hidden_pieces *work, int32_t first, int32_t last,
                                        const int32_t *edges, const int32_t *corner_next,
                                        int32_t edge_count) {
    const int32_t *offset = work->graph->opening_corner;
    enf_pieces_answer answer = ENF_PIECES_HIDDEN;
    if (first == last) return ENF_PIECES_OPEN; // lines between its points lie in it
    for (int32_t a = offset[first] + 1; a + 1 < offset[first + 1]; a++)
        for (int32_t b = offset[last] + 1; b + 1 < offset[last + 1]; b++) {
            task task = {.work = work,
                         .triangle = {{offset[first], a, a + 1}, {offset[last], b, b + 1}},
                         .edges = edges,
                         .corner_next = corner_next,
                         .edge_count = edge_count};
            for (int p = 0; p < 3; p++)
                for (int q = 0; q < 3; q++)
                    task.size = fmax(task.size, distance(corner_of(&task, 0, p), corner_of(&task, 1, q)));
            enf_pieces_answer part = ask_triangles(&task);
            if (part == ENF_PIECES_SEEN) return part;
            if (part == ENF_PIECES_OPEN) answer = part;
        }
    return answer;
}

void enf_hidden_pieces_free(enf_hidden_pieces *work) {
    enf_matrix_game_free(&work->game);
    free(work->product);
    free(work->column);
    memset(work, 0, sizeof *work);
}
