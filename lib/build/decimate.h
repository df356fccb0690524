// SPDX-License-Identifier: GPL-3.0-or-later
// Decimate: collapse the lightest portal again and again (the thesis, 4.1.4, 4.2.3, 4.3.2).
#ifndef ENF_BUILD_DECIMATE_H
#define ENF_BUILD_DECIMATE_H

#include "build/graph.h"

typedef enum enf_heuristic {
    ENF_HEURISTIC_ASPECT, ///< largest projected area of the two cells / area of all portals between them
    ENF_HEURISTIC_ASPECT_SCALED, ///< the same divided by the square root of that projected area
    ENF_HEURISTIC_COUNT
} enf_heuristic;

/// "aspect", "aspect-scaled"; -1 for an unknown name.
int enf_heuristic_find(const char *name);
const char *enf_heuristic_name(enf_heuristic heuristic);

typedef enum enf_stop_rule { ENF_STOP_AUTO, ENF_STOP_WEIGHT, ENF_STOP_CELLS } enf_stop_rule;

typedef struct enf_stop {
    enf_stop_rule rule;
    double weight; ///< ENF_STOP_WEIGHT: stop before the first collapse whose weight is >= this
    int64_t cells; ///< ENF_STOP_CELLS: stop when no more than this many cells are left (if the graph allows)
} enf_stop;

/// Reads "auto", "weight=W" or "cells=N". ENF_BAD_USAGE with words otherwise.
enf_status enf_stop_parse(const char *text, enf_stop *stop, enf_error *error);

typedef struct enf_collapse {
    int32_t kept, gone; ///< fine cell numbers that stand for the two cells (kept < gone)
    double weight;      ///< of the portal that was collapsed
} enf_collapse;

typedef struct enf_decimation {
    int32_t cell_count; ///< cells left
    int32_t *cell_of;   ///< for each cell of the graph, the number of the cell it went into, 0..cell_count-1;
                        ///< numbered by the smallest fine cell in each
    enf_collapse *collapses; ///< every collapse done, in order
    size_t collapse_count;
    double next_weight; ///< weight of the portal that would have gone next; infinity if none
    size_t evaluations; ///< exact weights computed (the report: work done and skipped)
} enf_decimation;

void enf_decimation_free(enf_decimation *decimation);

/// The lightest portal goes first. Where a graph has more than 65,536 portals and the stop rule is a weight
/// or `auto` by aspect, that is so within blocks of neighbouring portals only, up to three quarters of the
/// weight (with `auto` up to the first that it may stop at); what is heavier goes in strict order. The last
/// portals are as light, the order is the same for any number of threads, and memory is looked at block by
/// block.
///
/// Takes the graph: it is empty afterwards, whatever the outcome, so that its memory is free while cells
/// merge. `unit`: world units per graph unit. aspect-scaled is not scale free, so weights are always computed
/// and compared in world units. `progress` may be null; called now and then with 0..1; returning false
/// cancels (ENF_NO_RESOURCES, "cancelled").
enf_status enf_graph_decimate(enf_graph *graph, enf_heuristic heuristic, const enf_stop *stop, double unit,
                              bool (*progress)(void *user, double fraction), void *user, enf_decimation *out,
                              enf_error *error);

#endif
