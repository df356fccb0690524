// SPDX-License-Identifier: GPL-3.0-or-later
// Beams from bodies through all portal sequences at once, cell by cell (beams.h has those from portals).
//
// Cells are looked at in the order in which lines come to them from the middle of the body, as far as there
// is such an order. So most are come to once, when all is known of what beams reach of the portals into them;
// where these lie in one plane, side by side, their windows are put together first.
#ifndef ENF_VISIBILITY_BODY_BEAMS_H
#define ENF_VISIBILITY_BODY_BEAMS_H

#include "visibility/air_order.h"
#include "visibility/bodies.h"
#include "visibility/follows.h"
#include "visibility/shapes.h"
#include "visibility/sources.h"

/// What beams go by; shared by all threads.
typedef struct enf_body_ways {
    const enf_shapes *shapes;
    const enf_bodies *bodies;
    enf_sources sources;        ///< of beams
    const enf_air_order *order; ///< of the cells; null: nearer ones first
    enf_follows follows;        ///< portals that can come right after each other
    int32_t *coplanar;          ///< rings of portals (coplanar.h)
} enf_body_ways;

/// Finds what is not given. False without memory; free it in any case.
bool enf_body_ways_make(enf_body_ways *ways, const enf_shapes *shapes, const enf_bodies *bodies,
                        const enf_air_order *order);
void enf_body_ways_free(enf_body_ways *ways);

/// Scratch memory of one thread.
typedef struct enf_body_beams enf_body_beams;

/// Null without memory. The ways must stay.
enf_body_beams *enf_body_beams_new(const enf_body_ways *ways);
void enf_body_beams_free(enf_body_beams *beams);

/// Casts the beams of all bodies of a source at once, as of their hull, through all portals of their cells.
/// In *met, a row of bits that was zero, those owners are set whose bodies the beams meet, and those with
/// bodies in the same cells.
void enf_body_beams_cast(enf_body_beams *beams, int32_t source, uint64_t *met);

/// The same without beams: through all portals that have some of the source's bodies behind them.
void enf_body_beams_face(enf_body_beams *beams, int32_t source, uint64_t *met);

/// How many windows were looked at so far, by all casts.
int64_t enf_body_beams_visits(const enf_body_beams *beams);

#endif
