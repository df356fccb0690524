// SPDX-License-Identifier: GPL-3.0-or-later
// What beams come from: owners of bodies, some together. Beams from the hull of owners that lie close
// together meet all that beams from each would meet, and little more; and as two owners see each other only
// if beams of each meet a body of the other itself, little of that stays. (It saves a sixth to a quarter of
// the time, and adds one or two pairs in a hundred.)
#ifndef ENF_VISIBILITY_SOURCES_H
#define ENF_VISIBILITY_SOURCES_H

#include "visibility/bodies.h"

typedef struct enf_sources {
    int32_t count;
    int32_t *owner_first;  ///< count + 1 offsets into owners
    int32_t *owners;       ///< all that have bodies, each in one source
    int32_t *cell_first;   ///< count + 1 offsets into cells
    int32_t *cells;        ///< those with bodies of the source's owners, ascending
    int32_t *corner_first; ///< count + 1 offsets into corners
    double (*corners)[3];  ///< of all bodies of the source's owners
} enf_sources;

/// False without memory; free it in any case.
bool enf_sources_make(enf_sources *sources, const enf_bodies *bodies);

void enf_sources_free(enf_sources *sources);

#endif
