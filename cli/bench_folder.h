// SPDX-License-Identifier: GPL-3.0-or-later
// The levels of a folder, one after the other, each in a process of its own: one level's memory does not
// count for the next, and one that crashes is a row, not the end of the table.
#ifndef ENF_CLI_BENCH_FOLDER_H
#define ENF_CLI_BENCH_FOLDER_H

#include "enfilade/base.h"

typedef struct cli_folder {
    const char *path;
    const char *pattern;        ///< glob for the levels' names without their endings; null: all
    const char *const *endings; ///< of levels' names, ended by a null; null: those of polygon files
    void *user;
    /// In the child: works on the level and fills `row`. Returns the exit status; says itself what went
    /// wrong.
    int (*work)(void *user, const char *path, const char *name, void *row);
    size_t row_size; ///< plain bytes that come back from the child; 0: none
    /// In the parent, after a child that ended with ENF_OK; null: the child prints.
    void (*print)(void *user, const char *name, const void *row);
    void (*print_head)(void *user); ///< before the first level
} cli_folder;

/// The option --levels; cli/options.h has the type.
#define CLI_LEVELS_OPTION(folder)                                           \
    {                                                                       \
        "--levels", 0, CLI_TEXT, &(folder).pattern, "GLOB",                 \
            "only levels whose name (less its ending) matches", NULL, false \
    }

/// Returns the worst exit status.
int cli_folder_visit(const cli_folder *folder);

/// Prints the error of a level, with its path, to standard error; returns its exit status.
int cli_folder_fail(const char *path, const enf_error *error);

/// The middle value (the lower of two); sorts the values.
double cli_median(double *values, size_t count);

#endif
