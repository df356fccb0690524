// SPDX-License-Identifier: MIT
#ifndef ENF_RUN_PATH_FINDER_H
#define ENF_RUN_PATH_FINDER_H

#include "run/path_search.h"

/// A step of a search for several ways: a portal, and the step behind it on the way to the listener.
typedef struct enf_path_trace {
    int64_t cost;   ///< from the portal's point, where it was passed, to the listener
    int32_t portal; ///< -1: the source
    int32_t behind; ///< step; -1: none, the listener
} enf_path_trace;

struct enf_path_finder {
    const enf_paths *paths;
    enf_path_search search;
    enf_path_trace *traces;
    enf_path_heap open; ///< of traces
    int32_t trace_max;
    double (*points)[3];  ///< room for the line of a way
    uint32_t *cell_stamp; ///< per cell: the search that listed it
    uint32_t cell_now;
};

/// The cell of a point: as given, or searched for; -1: none. ENF_BAD_USAGE for one that the world does not
/// have, or a point that is not finite. The point may be null if the cell is given.
enf_status enf_path_find_cell(const enf_paths *paths, int32_t given, const double *point, int32_t *cell,
                              enf_error *error);

/// The same, as an end of a path.
enf_status enf_path_find_goal(const enf_paths *paths, int32_t given, const double *point, enf_path_goal *goal,
                              enf_error *error);

#endif
