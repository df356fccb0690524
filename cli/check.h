// SPDX-License-Identifier: GPL-3.0-or-later
// What the two kinds of `enfilade check` share.
#ifndef ENF_CLI_CHECK_H
#define ENF_CLI_CHECK_H

#include "build/check.h"

/// What a portal file's check is asked for.
typedef struct cli_visible_check {
    const char *graph, *pvs, *witness; ///< paths; witness may be null
    bool hidden, as_json;
    double sample; ///< seconds
} cli_visible_check;

/// Prints the rows to standard output.
void cli_print_check(const enf_check_report *report, bool as_json);

/// Checks a visible set against its portal graph; returns the exit status.
int cli_check_visible(const cli_visible_check *request);

#endif
