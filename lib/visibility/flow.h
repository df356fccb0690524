// SPDX-License-Identifier: GPL-3.0-or-later
// The rungs `lp` and `exact`: portal sequences one by one, depth first, for the pairs of cells that cheaper
// means have left open.
//
// A branch ends where separating planes leave nothing, or where none of its portals can see any cell that is
// still asked for; when it comes to such a cell, the sequence is decided (stab.h). After portal flow as in
// S. J. Teller, C. H. Sequin, "Visibility preprocessing for interactive walkthroughs" (1991), and J.
// Carmack's vis (1996).
#ifndef ENF_VISIBILITY_FLOW_H
#define ENF_VISIBILITY_FLOW_H

#include "visibility/bits.h"
#include "visibility/shapes.h"
#include "visibility/stab.h"

/// Told of each cell that is seen: `count` portals lead to it, and the line of `stab`, if it has one, passes
/// them all, for real lines in order.
typedef void enf_flow_seen(void *user, int32_t from, int32_t to, const enf_stab *stab, int32_t count);

typedef struct enf_flow_options {
    const enf_shapes *shapes;
    const enf_bits *beams; ///< bit q of row p: portal p may see portal q; what is not there is hidden
    const enf_pluecker *pluecker;
    bool exact;      ///< real lines, in order; otherwise the linear relaxation
    double deadline; ///< on enf_timer_now's clock: what is not found by then stays open
    enf_flow_seen *seen;
    void *user;
} enf_flow_options;

/// Scratch memory of one thread.
typedef struct enf_flow enf_flow;

/// Null without memory. What the options point to is shared and must stay.
enf_flow *enf_flow_new(const enf_flow_options *options);
void enf_flow_free(enf_flow *flow);

/// Which of the `targets` (a row of bits, one for each cell) does the cell see? Those are cleared; the others
/// are hidden, unless it was too *late to tell.
enf_status enf_flow_settle(enf_flow *flow, int32_t cell, uint64_t *targets, bool *late, enf_error *error);

/// Portals looked at so far.
int64_t enf_flow_nodes(const enf_flow *flow);
const enf_stab_counts *enf_flow_stabs(const enf_flow *flow);

#endif
