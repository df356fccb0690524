// SPDX-License-Identifier: GPL-3.0-or-later
// What the commands share. Every command takes the words after its name and returns the exit status.
#ifndef ENF_CLI_H
#define ENF_CLI_H

#include "enfilade/base.h"

typedef struct cli_command {
    const char *name, *summary;
    int (*run)(int argc, char **argv);
} cli_command;

int cli_compile(int argc, char **argv);
int cli_info(int argc, char **argv);
int cli_check(int argc, char **argv);
int cli_locate(int argc, char **argv);
int cli_sight(int argc, char **argv);
int cli_pvs(int argc, char **argv);
int cli_export(int argc, char **argv);
int cli_gen(int argc, char **argv);
int cli_bench(int argc, char **argv);

/// Prints the error to standard error and returns its exit status.
int cli_fail(const enf_error *error);

/// Flushes standard output: the exit status, with a message when it could not be written.
int cli_finish_output(void);

#endif
