// SPDX-License-Identifier: GPL-3.0-or-later
// Does a line stab a portal sequence, that is, pass all its portals? Decided exactly, in two senses: by the
// linear relaxation (S. J. Teller and C. H. Sequin, "Visibility preprocessing for interactive walkthroughs",
// 1991), where any x in R^6 with <x, e> > 0 for all edges will do, line or not; and by real lines, which are
// those x that lie on the Pluecker quadric. Between convex cells the order along the line comes by itself;
// where cells are convex only up to rounding, it is asked for in a third sense.
#ifndef ENF_VISIBILITY_STAB_H
#define ENF_VISIBILITY_STAB_H

#include "visibility/line_order.h"
#include "visibility/pluecker.h"

typedef enum enf_stab_answer {
    ENF_STAB_HIDDEN,  ///< nothing stabs the sequence
    ENF_STAB_VISIBLE, ///< a real line does
    ENF_STAB_OPEN,    ///< the relaxation has a solution; whether a line does was not decided
} enf_stab_answer;

typedef struct enf_stab {
    enf_stab_answer answer;
    bool has_line; ///< a line between doubles, if VISIBLE
    enf_line line; ///< if has_line: enf_line_passes says yes for all portals

    /// If VISIBLE without a line between doubles: one between points in more digits, `x y z x y z`, as exact
    /// decimals; it passes all portals. Owned by the stabber, until its next call. Null otherwise.
    const char *long_line;
} enf_stab;

enum { ENF_STAB_SIZES = 8 };

typedef struct enf_stab_counts {
    int64_t calls, hints;   ///< calls; those that the hint answered
    int64_t zero_by_double; ///< hidden: 0 is in a hull, shown by doubles
    int64_t zero_by_small;  ///< the same, shown by whole numbers of 64 bits
    int64_t zero_by_whole;  ///< the same, shown by whole numbers of any size
    int64_t programs;       ///< linear programs in whole numbers
    int64_t pivots;         ///< of these
    int64_t searched;       ///< lines that took a search
    int64_t quadrics;       ///< decisions about the cone and the quadric in whole numbers
    int64_t quadrics_hidden;
    int64_t undecided;             ///< of those, cones of more than 512 sides, taken for visible
    int64_t lines_fine;            ///< lines between doubles that were found from a line in more digits
    int64_t lines_long;            ///< lines in more digits than doubles have
    int64_t lines_missing;         ///< visible, but no line was found: only if undecided
    int64_t orders;                ///< sequences of which a line was found that is not in order
    int64_t orders_hidden;         ///< of those, hidden: no line is in order
    int64_t orders_open;           ///< of those, not decided
    int64_t sizes[ENF_STAB_SIZES]; ///< programs of fewer than 8, 16, 32, ... edges; the last: or more
} enf_stab_counts;

/// Scratch memory and counters of one thread.
typedef struct enf_stabber enf_stabber;

/// Null without memory. The edges are shared and must stay.
enf_stabber *enf_stabber_new(const enf_pluecker *pluecker);
void enf_stabber_free(enf_stabber *stabber);
const enf_stab_counts *enf_stabber_counts(const enf_stabber *stabber);

/// The linear relaxation alone: HIDDEN, or OPEN, or VISIBLE if a line turned up on the way. A sequence has 1
/// or more directed portals. The hint may be null: a line to try first, whose last portals are the least
/// sure.
enf_status enf_stab_lp(enf_stabber *stabber, const int32_t *sequence, int32_t count, const enf_line *hint,
                       enf_stab *stab, enf_error *error);

/// Real lines: HIDDEN, or VISIBLE with a line.
enf_status enf_stab_exact(enf_stabber *stabber, const int32_t *sequence, int32_t count, const enf_line *hint,
                          enf_stab *stab, enf_error *error);

/// Real lines that come to the portals in order, as line_order.h says: HIDDEN, VISIBLE with a line, or OPEN.
/// The shapes are of the same graph.
enf_status enf_stab_in_order(enf_stabber *stabber, const enf_shapes *shapes, const int32_t *sequence,
                             int32_t count, const enf_line *hint, enf_stab *stab, enf_error *error);

#endif
