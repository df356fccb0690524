// SPDX-License-Identifier: GPL-3.0-or-later
// The contour of a piece of surface: of the edges that its outlines run along, those that don't cancel.
//
// The table is as large as the surface at hand needs, so that a small one stays in the nearest cache, and is
// empty again by a new stamp, not by clearing.
#ifndef ENF_BUILD_CONTOUR_H
#define ENF_BUILD_CONTOUR_H

#include "enfilade/base.h"

typedef struct enf_contour_slot {
    int32_t from, to; ///< the ends, from < to
    int32_t times;    ///< how often the outlines run it, less how often they run it backwards
    uint32_t stamp;   ///< of the contour that uses the slot
} enf_contour_slot;

/// Working memory, kept between calls; start from {0}.
typedef struct enf_contour {
    enf_contour_slot *slots; ///< open addressing, linear probing, at most half full
    size_t slot_capacity;
    size_t mask; ///< slots in use - 1; a power of two - 1
    uint32_t stamp;
    uint32_t *filled; ///< the slots in use
    size_t filled_count, filled_capacity;
} enf_contour;

void enf_contour_free(enf_contour *contour);

/// Starts a new contour of at most so many edges. Returns false when there is no memory.
bool enf_contour_start(enf_contour *contour, size_t edges);

/// Runs the edge from a to b so many times.
void enf_contour_run(enf_contour *contour, int32_t a, int32_t b, int32_t times);

#endif
