// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of the runtime: one file each. Every one takes the words after its name and returns the exit
// status.
#ifndef ENF_CLI_BENCH_RUN_H
#define ENF_CLI_BENCH_RUN_H

/// Paths, lines, cells near a point, and ways of sound.
int cli_bench_run_paths(int argc, char **argv);

#endif
