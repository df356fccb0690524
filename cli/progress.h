// SPDX-License-Identifier: GPL-3.0-or-later
// The progress bar, and Ctrl-C as a polite request.
#ifndef ENF_CLI_PROGRESS_H
#define ENF_CLI_PROGRESS_H

#include "enfilade/base.h"

typedef enum cli_progress_mode {
    CLI_PROGRESS_AUTO,
    CLI_PROGRESS_ALWAYS,
    CLI_PROGRESS_NEVER
} cli_progress_mode;
extern const char *const cli_progress_modes[];

typedef struct cli_progress {
    cli_progress_mode mode;
    bool terminal;         ///< standard error is one: a bar that is redrawn; otherwise a line per stage
    double started, drawn; ///< seconds
    bool visible;          ///< a bar stands on the terminal's last line
    const char *stage;     ///< the one last drawn
    const char *timed;     ///< the one that the two below are of
    double stage_started;  ///< seconds
    double stage_first;    ///< the fraction that it began with: what an earlier run has done
} cli_progress;

/// Starts the clock; from now on the first SIGINT or SIGTERM makes cli_progress_report return false, the
/// second kills. The bar has the time since the start, and what is left of the stage at its speed so far, if
/// fractions are of its work. Auto: a bar if standard error is a terminal and the job has lasted a second.
void cli_progress_start(cli_progress *progress, cli_progress_mode mode);

/// An enf_progress; `user` is the cli_progress.
bool cli_progress_report(void *user, const char *stage, double fraction);

/// Removes the bar.
void cli_progress_stop(cli_progress *progress);

/// True after SIGINT or SIGTERM.
bool cli_was_interrupted(void);

#endif
