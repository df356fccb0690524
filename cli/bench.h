// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef ENF_CLI_BENCH_H
#define ENF_CLI_BENCH_H

#include "enfilade/base.h"

/// The worlds of the thesis (4.3): sizes, and for each heuristic how far it can go with every room on its
/// own.
int cli_bench_thesis(int argc, char **argv);

/// Compiles every level in a folder, each in a process of its own; a row each.
int cli_bench_levels(int argc, char **argv);
int cli_bench_memory(int argc, char **argv);

/// Soup to coloured cells of every level in a folder, against the Delaunay triangulation of the same vertices
/// alone.
int cli_bench_cells(int argc, char **argv);

/// Solid or air in every level of a folder, against the union of its brushes.
int cli_bench_solid(int argc, char **argv);
/// Every level in a folder as tools leave it: rotated, rounded; compared with itself.
int cli_bench_recovery(int argc, char **argv);
/// Offices and caverns of growing size, each compiled in a process of its own; a row each, then the
/// exponents.
int cli_bench_growth(int argc, char **argv);
/// Named soups that others choke on, each in a process of its own; a row each.
int cli_bench_soups(int argc, char **argv);
/// Families of random soups, each run in a process of its own; a row per family, and one per failure.
int cli_bench_stability(int argc, char **argv);
/// The rungs of visibility on every portal file in a folder: run time against error.
int cli_bench_visibility(int argc, char **argv);
int cli_bench_worlds(int argc, char **argv);
/// What the runtime takes per question: tables of its own (cli/bench_run.h).
int cli_bench_run(int argc, char **argv);

#endif
