// SPDX-License-Identifier: GPL-3.0-or-later
// Settles the pairs of cells that beams have not ruled out and lines have not proved.
#ifndef ENF_VISIBILITY_SETTLE_H
#define ENF_VISIBILITY_SETTLE_H

#include "visibility/bits.h"
#include "visibility/shapes.h"
#include "visibility/sightings.h"
#include "visibility/stab.h"
#include "visibility/work.h"

typedef struct enf_settlement {
    const enf_shapes *shapes;
    const enf_pluecker *pluecker;
    const enf_bits *beams; ///< between portals
    const enf_bits *cells; ///< the same between cells: bit j of row i: cell i may see cell j
    bool exact;            ///< real lines; otherwise the linear relaxation

    int64_t pairs, nodes;   ///< pairs that were open; portals looked at
    int64_t pairs_budgeted; ///< of these, those whose turn came too late: they count as seen
    enf_stab_counts stabs;
} enf_settlement;

/// Adds what is seen to the sightings, one way.
enf_status enf_settle_run(enf_settlement *settlement, enf_sightings *sightings, enf_workplace *place,
                          enf_error *error);

#endif
