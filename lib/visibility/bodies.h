// SPDX-License-Identifier: GPL-3.0-or-later
// Parts: bodies in the cells of a portal graph. What is asked for is whose see each other, where the cells
// are only the way.
#ifndef ENF_VISIBILITY_BODIES_H
#define ENF_VISIBILITY_BODIES_H

#include "enfilade/base.h"

typedef struct enf_bodies {
    int32_t count;
    int32_t cell_count;    ///< of the graph
    int32_t owner_count;   ///< what bodies can be parts of; some may have none
    int32_t *cell_first;   ///< cell_count + 1 offsets: the bodies in each cell, which is convex
    int32_t *owner;        ///< what each is a part of; ascending within a cell, where each has one at most
    int32_t *corner_first; ///< count + 1 offsets into corners
    double (*corners)[3];  ///< the hull of a body's corners holds the body

    // Found from these.
    double (*middle)[3];  ///< count: of the box around each
    double (*half)[3];    ///< how far it reaches from there
    int32_t *owner_first; ///< owner_count + 1 offsets into cells
    int32_t *cells;       ///< the cells with bodies of each owner, ascending
    int32_t *whole_first; ///< owner_count + 1 offsets into wholes
    double (*wholes)[3];  ///< the corners of all bodies of each owner, each once
} enf_bodies;

/// Finds the rest, when the first part is there, on some threads. False without memory.
bool enf_bodies_finish(enf_bodies *bodies, int threads);

void enf_bodies_free(enf_bodies *bodies);

#endif
