// SPDX-License-Identifier: MIT
// The portals on a segment, and chains of them from cell to cell.
#ifndef ENF_RUN_CROSSINGS_H
#define ENF_RUN_CROSSINGS_H

#include "run/segment.h"

#define ENF_CROSSINGS_MAX 192

typedef struct enf_crossing {
    double share;   ///< of the segment
    int32_t portal; ///< the one that leads on
    bool touches;   ///< an end of the segment lies on it: it counts where that end's cell says so
} enf_crossing;

typedef struct enf_crossings {
    double end; ///< of the segment: all crossings before it are listed
    int32_t count;
    enf_crossing list[ENF_CROSSINGS_MAX]; ///< by share
} enf_crossings;

/// The crossings from one share of the segment on to before another: all, or as many as there is room for,
/// the nearest ones.
void enf_crossings_find(enf_crossings *crossings, const enf_file_view *view, const enf_segment *segment,
                        double begin, double end);

/// Crossings in the order in which they lead from cell to cell.
typedef struct enf_chain {
    int32_t count, links[ENF_CROSSINGS_MAX]; ///< of the crossings
    int32_t cell;                            ///< where it ends
} enf_chain;

/// A chain from a cell on. With a `goal` >= 0: one that ends there, if there is one. False: it ends
/// elsewhere.
bool enf_chain_find(enf_chain *chain, const enf_crossings *crossings, const enf_file_view *view, int32_t cell,
                    int32_t goal);

#endif
