// SPDX-License-Identifier: GPL-3.0-or-later
// Beams from all portals, and sight lines along their middles: what may be seen, and most of what is.
#ifndef ENF_VISIBILITY_CAST_H
#define ENF_VISIBILITY_CAST_H

#include "visibility/bits.h"
#include "visibility/sight.h"
#include "visibility/sightings.h"
#include "visibility/work.h"

typedef struct enf_cast {
    const enf_sight *sight;
    const enf_bits *facing;

    // Made; free them in any case.
    enf_bits beams; ///< bit q of row p: portal p may see portal q; symmetric as enf_facing_find's
    int64_t visits, lines;
    int32_t cells_budgeted; ///< cells with portals whose turn came too late: those keep what faces them
} enf_cast;

/// Casts everything. What lines prove is added to the sightings, if there are any.
enf_status enf_cast_run(enf_cast *cast, enf_sightings *sightings, enf_workplace *place, enf_error *error);

#endif
