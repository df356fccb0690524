// SPDX-License-Identifier: GPL-3.0-or-later
// What stabbing needs of each opening, made once from a portal graph and read by all threads.
//
// A line x through p and q has the six Pluecker coordinates (q - p, p x q); an edge from a to b acts on it as
// the vector e = (a x b, b - a): <x, e> = (q - p) . (a x b) + (b - a) . (p x q) is positive if x passes the
// edge on the left side of a winding that turns counter-clockwise against it (S. J. Teller, "Visibility
// Computations in Densely Occluded Polyhedral Environments", 1992).
#ifndef ENF_VISIBILITY_PLUECKER_H
#define ENF_VISIBILITY_PLUECKER_H

#include "visibility/portal_graph.h"

typedef struct enf_pluecker_edge {
    double from[3], to[3];
    double along[3];  ///< unit length, within 8 roundings
    int32_t small[3]; ///< a multiple of to - from, without common divisor, at most 2^24
    bool is_small;    ///< there is such
    int unit;         ///< from is a multiple of 2^unit
} enf_pluecker_edge;

typedef struct enf_pluecker_opening {
    double middle[3], normal[3]; ///< about
    double low[3], high[3];      ///< the box of its corners
    int unit;                    ///< the corners are multiples of 2^unit
    bool rough;                  ///< so large or small that doubles are not to be trusted
} enf_pluecker_opening;

typedef struct enf_pluecker {
    const enf_portal_graph *graph; ///< not owned
    int32_t *opening_edge;         ///< opening_count + 1 offsets into edges
    enf_pluecker_edge *edges;      ///< edges with two different ends only; all if an opening has no such
    enf_pluecker_opening *openings;
} enf_pluecker;

/// False without memory; free in any case. The graph must stay as it is.
bool enf_pluecker_make(enf_pluecker *pluecker, const enf_portal_graph *graph);

void enf_pluecker_free(enf_pluecker *pluecker);

#endif
