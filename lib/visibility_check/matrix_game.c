// SPDX-License-Identifier: GPL-3.0-or-later
// The simplex method on the full tableau: raise all numbers above 0, then maximise the sum of w where each
// row's sum of w times numbers is at most 1 (Dantzig, "Linear Programming and Extensions", 1963, ch. 13).
#include "visibility_check/matrix_game.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS_BY_SIZE = 60, STEPS_MAX = 300 };

static const double gain_least = 1e-12, pivot_least = 1e-11;

typedef struct game_table {
    double *row[ENF_GAME_ROWS + 1]; ///< the last one: gains
    int32_t width;                  ///< columns, slacks, right side
    int32_t basis[ENF_GAME_ROWS];
} game_table;

static void fill(game_table *table, const double (*columns)[ENF_GAME_ROWS], int32_t count, double raise) {
    for (int r = 0; r < ENF_GAME_ROWS; r++) {
        double *row = table->row[r];
        for (int32_t k = 0; k < count; k++) row[k] = columns[k][r] + raise;
        for (int s = 0; s < ENF_GAME_ROWS; s++) row[count + s] = r == s;
        row[table->width - 1] = 1;
        table->basis[r] = count + r;
    }
    double *gain = table->row[ENF_GAME_ROWS];
    memset(gain, 0, (size_t)table->width * sizeof *gain);
    for (int32_t k = 0; k < count; k++) gain[k] = 1;
}

static int32_t choose_column(const game_table *table, bool first) {
    const double *gain = table->row[ENF_GAME_ROWS];
    int32_t chosen = -1;
    double most = gain_least;
    for (int32_t k = 0; k < table->width - 1; k++) {
        if (gain[k] <= most) continue;
        most = gain[k];
        chosen = k;
        if (first) break;
    }
    return chosen;
}

static int choose_row(const game_table *table, int32_t column) {
    int chosen = -1;
    double least = INFINITY;
    for (int r = 0; r < ENF_GAME_ROWS; r++) {
        if (table->row[r][column] <= pivot_least) continue;
        double ratio = table->row[r][table->width - 1] / table->row[r][column];
        bool better = ratio < least || (ratio == least && table->basis[r] < table->basis[chosen]);
        if (chosen >= 0 && !better) continue;
        least = ratio;
        chosen = r;
    }
    return chosen;
}

static void pivot(game_table *table, int row, int32_t column) {
    double *from = table->row[row], scale = 1 / from[column];
    for (int32_t k = 0; k < table->width; k++) from[k] *= scale;
    for (int r = 0; r <= ENF_GAME_ROWS; r++) {
        if (r == row) continue;
        double *to = table->row[r], factor = to[column];
        for (int32_t k = 0; k < table->width; k++) to[k] -= factor * from[k];
        to[column] = 0;
    }
    table->basis[row] = column;
}

static bool read_solution(enf_matrix_game *game, const game_table *table, int32_t count, double raise) {
    const double *gain = table->row[ENF_GAME_ROWS];
    double sum = -gain[table->width - 1];
    if (!(sum > 0)) return false;
    memset(game->column_weight, 0, (size_t)count * sizeof *game->column_weight);
    for (int r = 0; r < ENF_GAME_ROWS; r++) {
        game->row_weight[r] = fmax(-gain[count + r] / sum, 0);
        if (table->basis[r] < count)
            game->column_weight[table->basis[r]] = fmax(table->row[r][table->width - 1] / sum, 0);
    }
    game->value = 1 / sum - raise;
    return true;
}

bool enf_matrix_game_solve(enf_matrix_game *game, const double (*columns)[ENF_GAME_ROWS], int32_t count) {
    game_table table = {.width = count + ENF_GAME_ROWS + 1};
    if (!enf_array_reserve(game->tableau, game->capacity, (size_t)table.width * (ENF_GAME_ROWS + 1)) ||
        !enf_array_reserve(game->column_weight, game->column_capacity, (size_t)count))
        return false;
    for (int r = 0; r <= ENF_GAME_ROWS; r++) table.row[r] = game->tableau + (ptrdiff_t)r * table.width;
    double raise = 0;
    for (int32_t k = 0; k < count; k++)
        for (int r = 0; r < ENF_GAME_ROWS; r++) raise = fmax(raise, -columns[k][r]);
    raise += 1;
    fill(&table, columns, count, raise);
    for (int step = 0; step < STEPS_MAX; step++) {
        int32_t column = choose_column(&table, step >= STEPS_BY_SIZE);
        if (column < 0) return read_solution(game, &table, count, raise);
        int row = choose_row(&table, column);
        if (row < 0) return false;
        pivot(&table, row, column);
    }
    return false;
}

void enf_matrix_game_free(enf_matrix_game *game) {
    free(game->tableau);
    free(game->column_weight);
    memset(game, 0, sizeof *game);
}
