// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of the runtime: one file each. Every one takes the words after its name and returns the exit
// status.
#ifndef ENF_CLI_BENCH_RUN_H
#define ENF_CLI_BENCH_RUN_H

/// Moving objects, and spheres through portals.
int cli_bench_run_objects(int argc, char **argv);

/// Points with and without a hint, and steps.
int cli_bench_run_locate(int argc, char **argv);

/// Lines of sight and rays, by the portals they pass.
int cli_bench_run_sight(int argc, char **argv);

/// View traversal: time against error; or, with --check, against rays.
int cli_bench_run_view(int argc, char **argv);

/// Paths, lines, cells near a point, and ways of sound.
int cli_bench_run_paths(int argc, char **argv);

#endif
