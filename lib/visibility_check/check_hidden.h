// SPDX-License-Identifier: GPL-3.0-or-later
// Check: are the pairs of cells that a visible set leaves out really hidden? By portal sequences, linear
// programs and exact certificates, sharing nothing with the solver. Slow is fine.
#ifndef ENF_VISIBILITY_CHECK_HIDDEN_H
#define ENF_VISIBILITY_CHECK_HIDDEN_H

#include "visibility/portal_graph.h"

/// Why it is enough to look at few sequences. Suppose pairs that are claimed hidden can see each other, and
/// of all lines that say so take one with the fewest portals, from i to j. Every shorter stretch of its cells
/// joins two cells that see each other by fewer portals, and so are claimed visible. Hence it is enough to
/// rule out, for each claimed hidden pair i, j, the sequences along which every other pair of cells is
/// claimed visible. What comes out: if none of the pairs listed in `open` can see each other, then no pair
/// that is claimed hidden can.
typedef struct enf_hidden_pair {
    int32_t cell[2]; ///< ascending
    bool seen;       ///< proved: they see each other
    bool verified; ///< and enf_witness_check agrees: from -> to leads from one to the other; if it does not,
                   ///< the slit is too thin for points of doubles
    double from[3], to[3];
} enf_hidden_pair;

typedef struct enf_hidden_report {
    uint64_t claimed;      ///< pairs i < j that are claimed hidden
    bool ended;            ///< false: the time was up
    uint64_t left;         ///< of them, not looked at because of that
    enf_hidden_pair *open; ///< those that could not be confirmed; enf_hidden_report_free frees it
    size_t open_count, open_capacity;
    uint64_t sequences;   ///< portals stepped through
    uint64_t programs;    ///< linear programs solved
    uint64_t proofs;      ///< certificates verified; the same one counts once
    uint64_t unproved;    ///< certificates that rounding had made up
    uint64_t asked;       ///< whole sequences that no certificate rules out, cut in pieces
    uint64_t asked_early; ///< beginnings of sequences, the same
    uint64_t pieces;
    double seconds; ///< of processor time
} enf_hidden_report;

typedef struct enf_hidden_options {
    double seconds;       ///< of processor time at most; 0: no limit
    const uint64_t *only; ///< rows like those of `visible`: look at these pairs alone; null: at all
    int32_t piece_limit;  ///< for a sequence and a pair of triangles; 0: 3000
    void (*progress)(void *user, int32_t cells_done, int32_t cells);
    void *user;
} enf_hidden_options;

/// `visible`: a row of `row_words` words for each cell, bit j of row i set if i is claimed to see j; a pair
/// counts as claimed hidden if neither row has it. ENF_OK: the report is filled, whatever it says.
/// ENF_NO_RESOURCES: no memory.
enf_status enf_check_hidden(const enf_portal_graph *graph, const uint64_t *visible, size_t row_words,
                            const enf_hidden_options *options, enf_hidden_report *report, enf_error *error);

void enf_hidden_report_free(enf_hidden_report *report);

#endif
