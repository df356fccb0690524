// SPDX-License-Identifier: GPL-3.0-or-later
// Tables with a row, or some, for each of the world files that are named.
#ifndef ENF_CLI_BENCH_RUN_WORLDS_H
#define ENF_CLI_BENCH_RUN_WORLDS_H

#include "cli/options.h"
#include "enfilade/run.h"

typedef struct cli_bench_subject {
    const enf_world *world;
    const char *path, *name; ///< the name is the end of the path
} cli_bench_subject;

typedef struct cli_bench_table {
    const char *command; ///< "enfilade bench run ..."
    const char *usage, *summary;
    cli_option *options;

    /// Called once, after the options were read: prints the head.
    void (*begin)(void *user);

    /// Prints the rows of a world; what goes wrong ends the table.
    enf_status (*measure)(const cli_bench_subject *subject, void *user, enf_error *error);
    void *user;
} cli_bench_table;

/// Reads the words, opens the worlds one after the other, and returns the exit status.
int cli_bench_run_worlds(const cli_bench_table *table, int argc, char **argv);

#endif
