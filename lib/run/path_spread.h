// SPDX-License-Identifier: MIT
// Lengths from one gate (a portal next to a junction) to all others.
#ifndef ENF_RUN_PATH_SPREAD_H
#define ENF_RUN_PATH_SPREAD_H

#include "run/path_graph.h"
#include "run/path_heap.h"

typedef struct enf_path_spread {
    const enf_paths *paths;
    enf_path_heap heap;
    int64_t *cost; ///< per gate; ENF_PATH_NEVER: not reached
} enf_path_spread;

bool enf_path_spread_make(enf_path_spread *spread, const enf_paths *paths);
void enf_path_spread_free(enf_path_spread *spread);

/// Fills the costs.
void enf_path_spread_run(enf_path_spread *spread, int32_t start);

#endif
