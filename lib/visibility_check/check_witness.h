// SPDX-License-Identifier: GPL-3.0-or-later
// Check: does a line lead from one cell to another? Decided exactly, by arithmetic that shares nothing with
// the solver.
#ifndef ENF_VISIBILITY_CHECK_WITNESS_H
#define ENF_VISIBILITY_CHECK_WITNESS_H

#include "visibility/portal_graph.h"

/// The line through two points is to lead from cell[0] to cell[1], in this direction or against it. Where on
/// the line the points are does not matter.
typedef struct enf_witness {
    int32_t cell[2];
    double from[3], to[3];
    char *decimals; ///< not null: the same six numbers, `x y z x y z`, that are meant as they stand there
} enf_witness;

typedef enum enf_witness_fault {
    ENF_WITNESS_HOLDS = 0,
    ENF_WITNESS_NO_CELL, ///< a cell's number is out of range
    ENF_WITNESS_NO_LINE, ///< the two points are one, or not finite, or the decimals are not six numbers
    ENF_WITNESS_STUCK,   ///< the line does not come to the other cell
} enf_witness_fault;

/// Where a walk ended: `steps` portals were passed; `cell` was entered last.
typedef struct enf_witness_outcome {
    enf_witness_fault fault;
    int32_t cell;
    int32_t steps;
    bool forked; ///< the line passes two portals out of one cell: its portals overlap, by rounding as a rule
} enf_witness_outcome;

typedef struct enf_witness_checker {
    const enf_portal_graph *graph;
    void *numbers;   ///< scratch of the exact arithmetic
    int32_t *passed; ///< of each portal: the last walk that passed it
    int32_t *queue;  ///< the portals of a walk
    int32_t walks;
    uint64_t sides_near, sides_exact; ///< sides decided by doubles, and by whole numbers
} enf_witness_checker;

/// The graph must outlive the checker. False without memory.
bool enf_witness_checker_make(enf_witness_checker *checker, const enf_portal_graph *graph);
void enf_witness_checker_free(enf_witness_checker *checker);

/// Walks the line from cell[0] through the portals that it passes strictly, one after the other, until it
/// comes to cell[1]; if that fails, the same against the line. The outcome is that of the walk that came
/// further.
enf_witness_outcome enf_witness_check(enf_witness_checker *checker, const enf_witness *witness);

/// "the line passes no portal out of cell 5, after 3 portals" and the like, for messages.
void enf_witness_describe(enf_witness_outcome outcome, char *text, size_t size);

#endif
