// SPDX-License-Identifier: MIT
#ifndef ENF_RUN_PATH_PULL_H
#define ENF_RUN_PATH_PULL_H

#include "run/instance.h"
#include "run/path_graph.h"

/// A line through portals: its points, from the start on; for a portal that transforms there are two.
typedef struct enf_path_line {
    const enf_paths *paths;
    const enf_instance *instance;
    const int32_t *portals;
    int32_t portal_count;
    double (*points)[3]; ///< room for all
    double tolerance;    ///< a share of the length
    int32_t sweeps_max;
} enf_path_line;

/// How many points a line has.
int32_t enf_path_line_size(const enf_path_line *line);

/// Pulls the line tight, from middle to middle at first. Returns the sweeps that it took.
int32_t enf_path_line_pull(const enf_path_line *line, const double from[3], const double to[3]);

/// Without the jumps of portals that transform.
double enf_path_line_length(const enf_path_line *line);

#endif
