// SPDX-License-Identifier: GPL-3.0-or-later
// Beams from bodies: whose bodies in the cells of a portal graph may see each other.
#ifndef ENF_VISIBILITY_BODY_CAST_H
#define ENF_VISIBILITY_BODY_CAST_H

#include "visibility/air_order.h"
#include "visibility/bits.h"
#include "visibility/bodies.h"
#include "visibility/shapes.h"
#include "visibility/work.h"

typedef struct enf_body_cast {
    const enf_shapes *shapes;
    const enf_bodies *bodies;
    const enf_air_order *order; ///< of the cells; null: there is none
    bool by_facing;             ///< all owners see all that faces them; no beams are cast

    // Made; free them in any case.
    enf_bits met; ///< bit j of row i: the beams of owner i, or of all in its source (sources.h), meet a body
                  ///< of owner j, and the other way round
    int64_t visits;
    int32_t owners_budgeted; ///< whose turn came too late: those see all that faces them
} enf_body_cast;

enf_status enf_body_cast_run(enf_body_cast *cast, enf_workplace *place, enf_error *error);

#endif
