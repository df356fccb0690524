// SPDX-License-Identifier: GPL-3.0-or-later
// Is there a point of line space on the inner side of every edge? The linear program of a portal sequence,
// for the sampler and the checker of hidden pairs, in doubles. Nothing is decided here: what follows from a
// result is verified exactly elsewhere.
#ifndef ENF_VISIBILITY_CHECK_LINE_SIMPLEX_H
#define ENF_VISIBILITY_CHECK_LINE_SIMPLEX_H

#include "enfilade/base.h"

enum { ENF_LINE_ROWS = 7 };

/// The program: the largest t for which a point x with |x_r| <= 1 has <x, e> >= t for every column e; its
/// dual: the combination sum of w_k e_k with the least 1-norm, w >= 0, sum of w_k = 1. Columns are the first
/// six numbers, of an edge; the seventh is 1, or 0 for one that only asks <x, e> >= 0. The basis is the
/// dual's; it stays feasible when columns are added, so a search goes on from its parent's.
typedef struct enf_line_basis {
    int32_t column[ENF_LINE_ROWS]; ///< >= 0: a column; -1 - r, -7 - r: plus or minus the unit vector r
    double weight[ENF_LINE_ROWS];  ///< w of each, >= 0
    double inverse[ENF_LINE_ROWS][ENF_LINE_ROWS];
    double point[6]; ///< x
    double margin;   ///< t; 0: no point is strictly inside
} enf_line_basis;

/// The basis for column 0, whose seventh number must be 1.
void enf_line_basis_begin(enf_line_basis *basis, const double column[ENF_LINE_ROWS]);

/// Goes on to the optimum over columns[0 .. count - 1]. Stops early, with the margin so far (an upper
/// bound), when it is at most `enough`. False if it does not end (rounding); the margin is an upper bound
/// all the same.
bool enf_line_basis_solve(enf_line_basis *basis, const double (*columns)[ENF_LINE_ROWS], int32_t count,
                          double enough);

#endif
