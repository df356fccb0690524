// SPDX-License-Identifier: GPL-3.0-or-later
// Matrix games with nine rows, in doubles: what the checker of hidden pairs asks about a piece of line space.
#ifndef ENF_VISIBILITY_CHECK_MATRIX_GAME_H
#define ENF_VISIBILITY_CHECK_MATRIX_GAME_H

#include "enfilade/base.h"

enum { ENF_GAME_ROWS = 9 };

/// The row player chooses weights of rows, to make the least column large; the column player weights of
/// columns, to make the largest row small. Both get value.
typedef struct enf_matrix_game {
    double *tableau; ///< scratch
    size_t capacity;
    double *column_weight; ///< of each column; they add up to 1
    size_t column_capacity;
    double row_weight[ENF_GAME_ROWS]; ///< add up to 1
    double value;
} enf_matrix_game;

/// columns[k][r]: numbers of size 1 or so, count >= 1. False without memory, or if rounding keeps it from
/// ending.
bool enf_matrix_game_solve(enf_matrix_game *game, const double (*columns)[ENF_GAME_ROWS], int32_t count);

void enf_matrix_game_free(enf_matrix_game *game);

#endif
