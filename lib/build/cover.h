// SPDX-License-Identifier: GPL-3.0-or-later
// Covers: the share of every polygon on every facet.
#ifndef ENF_BUILD_COVER_H
#define ENF_BUILD_COVER_H

#include "build/arrangement.h"
#include "build/loop.h"

typedef struct enf_cover {
    int32_t facet, polygon;
    int32_t loop; ///< in enf_covers.loops; -1: the whole facet
    int32_t side; ///< as complex.cover_side
} enf_cover;

typedef struct enf_covers {
    enf_cover *covers;
    size_t count, capacity;
    enf_loops loops;
    uint8_t *covered; ///< per facet: has a cover
} enf_covers;

/// Finds them. The pool's geometry must be the subdivision's; it receives the vertices that only covers have.
bool enf_covers_find(enf_covers *covers, const enf_arrangement *arrangement, const enf_crew *crew,
                     enf_pool *pool, bool *stopped);
void enf_covers_free(enf_covers *covers);

/// A facet's outline in the pool, without corners on straight lines.
enf_loop enf_facet_loop(const enf_subdivision *subdivision, int32_t facet, enf_pool *pool);

#endif
