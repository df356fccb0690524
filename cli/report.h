// SPDX-License-Identifier: GPL-3.0-or-later
// What a compilation did: as JSON for scripts, as text for people.
#ifndef ENF_CLI_REPORT_H
#define ENF_CLI_REPORT_H

#include <stdio.h>

#include "cli/job.h"

/// The report (--report). Its keys are fixed: scripts rely on them.
void cli_report_json(const cli_job *job, FILE *out);

/// The two or three lines that every compilation ends with.
void cli_report_summary(const cli_job *job, const char *output, FILE *out);

/// What each stage did and what it skipped, and every rejected polygon (-v).
void cli_report_verbose(const cli_job *job, FILE *out);

#endif
