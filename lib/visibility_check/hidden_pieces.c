// SPDX-License-Identifier: GPL-3.0-or-later
// A line through points a of one triangle and b of another is on the inner side of an edge if a bilinear form
// of their barycentric coordinates is positive. Over a piece (a triangle within each) the form lies between
// its values at the nine pairs of corners. If weights of edges make the sum of their forms <= 0 at all nine,
// no line of the piece passes all edges; that is verified with whole numbers.
#include "visibility_check/hidden_pieces.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    STACK = 4 * ENF_PIECE_BITS + 2,
    DECISIONS = 64 ///< by whole numbers alone, for a pair of triangles
};

/// Games are of numbers of size 1 or so. A value nearer to 0 may be rounding.
static const double value_least = 1e-9;
/// A line that passes edges by this passes them.
static const double side_least = 1e-12;

typedef struct task {
    enf_hidden_pieces *work;
    enf_piece_task here;
    double size; ///< the longest distance, to bring numbers to 1 or so
} task;

static const double *corner_of(const task *task, int side, int k) {
    return task->work->graph->corners[task->here.triangle[side][k]];
}

static void edge_ends(const task *task, int32_t k, const double *end[2]) {
    int32_t edge = task->here.edges[k], corner[2] = {edge >> 1, task->here.corner_next[edge >> 1]};
    for (int e = 0; e < 2; e++) end[e ^ (edge & 1)] = task->work->graph->corners[corner[e]];
}

static double distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                (a[2] - b[2]) * (a[2] - b[2]));
}

static double side(const double from[3], const double to[3], const double a[3], const double b[3]) {
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        sum +=
            (to[i] - from[i]) * ((a[j] - from[j]) * (b[k] - from[k]) - (a[k] - from[k]) * (b[j] - from[j]));
    }
    return sum;
}

static bool make_products(const task *task) {
    enf_hidden_pieces *work = task->work;
    size_t forms = (size_t)enf_piece_forms(&task->here);
    if (!enf_array_reserve(work->product, work->product_capacity, forms) ||
        !enf_array_reserve(work->column, work->column_capacity, forms) ||
        !enf_array_reserve(work->scale, work->scale_capacity, forms) ||
        !enf_hidden_exact_begin(work->exact, &task->here))
        return false;
    for (int32_t k = 0; k < task->here.edge_count; k++) {
        const double *end[2];
        edge_ends(task, k, end);
        double scale = 1 / (task->size * task->size * distance(end[0], end[1]));
        work->scale[k] = scale;
        for (int p = 0; p < 3; p++)
            for (int q = 0; q < 3; q++)
                work->product[k][3 * p + q] =
                    scale * side(corner_of(task, 0, p), corner_of(task, 1, q), end[0], end[1]);
    }
    for (int32_t k = 0; k < task->here.side_count; k++) {
        enf_hidden_exact_values(work->exact, k, work->product[task->here.edge_count + k]);
        work->scale[task->here.edge_count + k] = 1;
    }
    return true;
}

/// The nine values of every form at the corners of a piece.
static void make_columns(const task *task, const enf_piece *piece) {
    double u[2][3][3];
    for (int s = 0; s < 2; s++)
        for (int i = 0; i < 3; i++)
            for (int p = 0; p < 3; p++) u[s][i][p] = (double)piece->corner[s][i][p] / ENF_PIECE_ONE;
    for (int32_t k = 0; k < enf_piece_forms(&task->here); k++) {
        const double *d = task->work->product[k];
        double *column = task->work->column[k], half[3][3];
        for (int i = 0; i < 3; i++)
            for (int q = 0; q < 3; q++)
                half[i][q] = u[0][i][0] * d[q] + u[0][i][1] * d[3 + q] + u[0][i][2] * d[6 + q];
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                column[3 * i + j] =
                    half[i][0] * u[1][j][0] + half[i][1] * u[1][j][1] + half[i][2] * u[1][j][2];
    }
}

// ---------------------------------------------------------------------------------------------- pieces

static void set_line(const task *task, const double share[2][3]) {
    enf_hidden_pieces *work = task->work;
    work->is_rounded = false;
    for (int i = 0; i < 3; i++) {
        work->from[i] = work->to[i] = 0;
        for (int p = 0; p < 3; p++) {
            work->from[i] += share[0][p] * corner_of(task, 0, p)[i];
            work->to[i] += share[1][p] * corner_of(task, 1, p)[i];
        }
    }
}

static bool passes_sides(const task *task, const double share[2][3]) {
    for (int32_t k = task->here.edge_count; k < enf_piece_forms(&task->here); k++) {
        double sum = 0;
        for (int p = 0; p < 3; p++)
            for (int q = 0; q < 3; q++) sum += task->work->product[k][3 * p + q] * share[0][p] * share[1][q];
        if (!(sum > side_least)) return false;
    }
    return true;
}

/// The line that the row player's weights name: does it pass all edges and sides, clearly?
static bool try_line(const task *task, const enf_piece *piece) {
    enf_hidden_pieces *work = task->work;
    double share[2][3] = {{0}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int p = 0; p < 3; p++) {
                share[0][p] += work->game.row_weight[3 * i + j] * piece->corner[0][i][p] / ENF_PIECE_ONE;
                share[1][p] += work->game.row_weight[3 * i + j] * piece->corner[1][j][p] / ENF_PIECE_ONE;
            }
    set_line(task, (const double(*)[3])share);
    for (int32_t k = 0; k < task->here.edge_count; k++) {
        const double *end[2];
        edge_ends(task, k, end);
        double least = side_least * task->size * task->size * distance(end[0], end[1]);
        if (!(side(work->from, work->to, end[0], end[1]) > least)) return false;
    }
    return passes_sides(task, (const double(*)[3])share);
}

static void point_of(const task *task, int s, const int32_t share[3], double point[3]) {
    for (int i = 0; i < 3; i++) {
        point[i] = 0;
        for (int p = 0; p < 3; p++) point[i] += (double)share[p] / ENF_PIECE_ONE * corner_of(task, s, p)[i];
    }
}

/// Halves the longest edge that may still be halved. False if none may.
static bool halve(const task *task, const enf_piece *whole, enf_piece half[2]) {
    double longest = 0;
    int side_found = -1, edge_found = 0;
    for (int s = 0; s < 2; s++) {
        double point[3][3];
        if (whole->halved[s] >= ENF_PIECE_BITS) continue;
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
        for (int p = 0; p < 3; p++) // exact: every halving takes one of the bits
            half[h].corner[side_found][moved][p] =
                (whole->corner[side_found][moved][p] + whole->corner[side_found][kept][p]) / 2;
    }
    return true;
}

/// HIDDEN, SEEN, or OPEN if the piece must be halved.
static enf_pieces_answer ask_piece(const task *task, const enf_piece *piece, int *decisions) {
    enf_hidden_pieces *work = task->work;
    double share[2][3];
    work->pieces++;
    make_columns(task, piece);
    if (!enf_matrix_game_solve(&work->game, (const double(*)[9])work->column, enf_piece_forms(&task->here)))
        work->game.value = 0;
    else if (work->game.value <= value_least &&
             enf_hidden_exact_proves(work->exact, piece, work->game.column_weight, work->scale))
        return ENF_PIECES_HIDDEN;
    else if (try_line(task, piece))
        return ENF_PIECES_SEEN;
    if (fabs(work->game.value) > value_least || (*decisions)++ >= DECISIONS) return ENF_PIECES_OPEN;
    int decided = enf_hidden_exact_decide(work->exact, piece, share);
    if (decided < 0) set_line(task, (const double(*)[3])share);
    work->is_rounded = decided < 0;
    return decided > 0 ? ENF_PIECES_HIDDEN : decided < 0 ? ENF_PIECES_SEEN : ENF_PIECES_OPEN;
}

static enf_pieces_answer ask_triangles(const task *task) {
    enf_hidden_pieces *work = task->work;
    static const enf_piece whole = {
        .corner = {{{ENF_PIECE_ONE, 0, 0}, {0, ENF_PIECE_ONE, 0}, {0, 0, ENF_PIECE_ONE}},
                   {{ENF_PIECE_ONE, 0, 0}, {0, ENF_PIECE_ONE, 0}, {0, 0, ENF_PIECE_ONE}}}};
    enf_piece stack[STACK] = {whole};
    int depth = 1, decisions = 0;
    if (!make_products(task)) return ENF_PIECES_OPEN;
    for (int32_t count = 0; depth > 0; count++) {
        if (count >= work->limit) return ENF_PIECES_OPEN;
        const enf_piece piece = stack[--depth];
        enf_pieces_answer answer = ask_piece(task, &piece, &decisions);
        if (answer == ENF_PIECES_SEEN) return answer;
        if (answer == ENF_PIECES_HIDDEN) continue;
        if (depth + 2 > STACK || !halve(task, &piece, &stack[depth])) return ENF_PIECES_OPEN;
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
    if (!work->exact) work->exact = enf_hidden_exact_make(work->graph);
    if (!work->exact) return ENF_PIECES_OPEN;
    for (int32_t a = offset[first] + 1; a + 1 < offset[first + 1]; a++)
        for (int32_t b = offset[last] + 1; b + 1 < offset[last + 1]; b++) {
            task task = {.work = work,
                         .here = {.graph = work->graph,
                                  .triangle = {{offset[first], a, a + 1}, {offset[last], b, b + 1}},
                                  .edges = edges,
                                  .corner_next = corner_next,
                                  .edge_count = edge_count,
                                  .sides = work->sides,
                                  .side_count = work->side_count}};
            for (int p = 0; p < 3; p++)
                for (int q = 0; q < 3; q++)
                    task.size = fmax(task.size, distance(corner_of(&task, 0, p), corner_of(&task, 1, q)));
            enf_pieces_answer part = ask_triangles(&task);
            if (part == ENF_PIECES_SEEN) return part;
            if (part == ENF_PIECES_OPEN) answer = part;
        }
    return answer;
}

void enf_hidden_pieces_line(const enf_hidden_pieces *work, mpq_t from[3], mpq_t to[3]) {
    for (int i = 0; i < 3; i++) {
        mpq_set_d(from[i], work->from[i]);
        mpq_set_d(to[i], work->to[i]);
    }
    if (work->is_rounded) enf_hidden_exact_line(work->exact, from, to);
}

void enf_hidden_pieces_free(enf_hidden_pieces *work) {
    enf_matrix_game_free(&work->game);
    enf_hidden_exact_free(work->exact);
    free(work->product);
    free(work->column);
    free(work->scale);
    memset(work, 0, sizeof *work);
}
