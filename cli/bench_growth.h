// SPDX-License-Identifier: GPL-3.0-or-later
// How often and in which order worlds of growing size are compiled, and what is taken of that.
//
// A machine that others share is faster at some times than at others, for seconds or minutes. So the sizes of
// a family take turns, round after round, and in a round a small world is compiled again and again for as
// long as a large one takes: its median, like the large one's, is of fast and slow moments. Each round tells
// by itself how time grows, from times that were taken within minutes. Every compile is a process of its own.
// In turn they have the memory that they will take in their heap before the clocks start, and get it as they
// go: the first tells what the work costs, the second adds what the system takes for memory, which a host may
// give slowly. What threads gain is measured in one process, which splits the same world again and again,
// with one thread and with several.
#ifndef ENF_CLI_BENCH_GROWTH_H
#define ENF_CLI_BENCH_GROWTH_H

#include "build/build.h"

enum { CLI_GROWTH_SETTINGS = 3 };

typedef struct cli_growth_world {
    const char *family, *settings[CLI_GROWTH_SETTINGS];
    double polygons; ///< about
} cli_growth_world;

/// Columns of the table: counts, seconds of the processor and by the clock, and what is made of them.
enum {
    CLI_GROWTH_POLYGONS,
    CLI_GROWTH_TETRAHEDRA,
    CLI_GROWTH_FINE_CELLS,
    CLI_GROWTH_CELLS,
    CLI_GROWTH_READ,
    CLI_GROWTH_STAGE,
    CLI_GROWTH_WRITE = CLI_GROWTH_STAGE + ENF_STAGE_COUNT,
    CLI_GROWTH_TOTAL,
    CLI_GROWTH_PEAK,
    CLI_GROWTH_EXACT,
    CLI_GROWTH_CLOCK,
    CLI_GROWTH_MEASURED, ///< so many columns come from a compile
    CLI_GROWTH_FRESH = CLI_GROWTH_MEASURED,
    CLI_GROWTH_SPLIT_CLOCK,
    CLI_GROWTH_SPLIT_CLOCK_THREADS,
    CLI_GROWTH_SPLIT_GAIN,
    CLI_GROWTH_COLUMNS
};

/// What all compiles of one world have said.
typedef struct cli_growth_series {
    double (*columns)[CLI_GROWTH_MEASURED]; ///< of each run
    size_t count, capacity;
    double *totals; ///< of each round the median
} cli_growth_series;

typedef struct cli_growth_row {
    const cli_growth_world *world;
    char *file, *output; ///< the world, while it is there; what it is compiled to
    cli_growth_series touched, fresh;
    double (*pairs)[2];
    size_t pair_count, pair_capacity;
    double column[CLI_GROWTH_COLUMNS];
} cli_growth_row;

/// What the rows of a table have in common.
typedef struct cli_growth_plan {
    int threads, rounds;
    double seconds;                ///< of a round of a world, at least, and as many for its splits
    struct cli_growth_run *shared; ///< what processes are told, and say
} cli_growth_plan;

/// Free it in any case.
enf_status cli_growth_plan_make(cli_growth_plan *plan, enf_error *error);
void cli_growth_plan_free(cli_growth_plan *plan);

/// Makes the world's file. Free the row, of zeros before, in any case.
enf_status cli_growth_row_make(cli_growth_row *row, const cli_growth_world *world,
                               const cli_growth_plan *plan, enf_error *error);
void cli_growth_row_free(cli_growth_row *row);

/// A round, from 0, of one world: compiles it until the seconds have passed, once in each way at least, and
/// splits it.
enf_status cli_growth_round(const cli_growth_plan *plan, cli_growth_row *row, int round, enf_error *error);

/// Fills the row's columns.
enf_status cli_growth_medians(cli_growth_row *row, enf_error *error);

#endif
