// SPDX-License-Identifier: GPL-3.0-or-later
// What a search for visible sets did: as JSON for scripts, as text for people.
#ifndef ENF_CLI_PVS_REPORT_H
#define ENF_CLI_PVS_REPORT_H

#include <stdio.h>

#include "visibility/visibility.h"

typedef struct cli_pvs_result {
    const char *input; ///< its name
    uint64_t input_hash;
    enf_portal_graph graph;                       ///< of a portal file
    struct enf_world *world;                      ///< of a world file; or null
    int32_t cell_count, portal_count, leaf_count; ///< of the input
    enf_visibility_options options;
    enf_visibility visibility;
    int processes;  ///< that worked on it
    double seconds; ///< in all, reading too
    uint64_t peak_bytes;
} cli_pvs_result;

/// True if the budget ran out before everything was decided.
bool cli_pvs_is_late(const cli_pvs_result *result);

/// The report (--report). Its keys are fixed: scripts rely on them.
void cli_pvs_report_json(const cli_pvs_result *result, FILE *out);

/// The line that every search ends with.
void cli_pvs_report_summary(const cli_pvs_result *result, const char *output, FILE *out);

/// How much was looked at (-v).
void cli_pvs_report_verbose(const cli_pvs_result *result, FILE *out);

#endif
