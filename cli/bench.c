// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade bench: tables that anybody can make again.
#include "cli/bench.h"

#include "cli/cli.h"

#include <stdio.h>
#include <string.h>

static const cli_command benches[] = {
    {"thesis", "the worlds of the thesis: cells, splits, rooms found", cli_bench_thesis},
    {"levels", "DIR: compile every level in a folder; a row each", cli_bench_levels},
    {"memory", "DIR: memory predicted and taken", cli_bench_memory},
    {"cells", "DIR: soup to coloured cells against the Delaunay triangulation alone", cli_bench_cells},
    {"solid", "DIR: solid or air against the union of the brushes", cli_bench_solid},
    {"recovery", "DIR: levels rotated and rounded, against themselves", cli_bench_recovery},
    {"growth", "offices and caverns up to a million polygons: time, memory, exponents", cli_bench_growth},
    {"soups", "soups that others choke on: time, memory, cells", cli_bench_soups},
    {"stability", "families of random soups: check, oracles, times", cli_bench_stability},
    {"visibility", "DIR: the rungs of visibility on portal files: run time against error",
     cli_bench_visibility},
    {"worlds", "[DIR]: the visible sets of compiled worlds: time and excess", cli_bench_worlds},
    {"run", "NAME ...: what the runtime takes per question", cli_bench_run},
};

enum { BENCH_COUNT = sizeof benches / sizeof *benches };

static void print_usage(FILE *file) {
    fputs("usage: enfilade bench NAME ...\n\n", file);
    for (int i = 0; i < BENCH_COUNT; i++) fprintf(file, "  %-10s %s\n", benches[i].name, benches[i].summary);
}

int cli_bench(int argc, char **argv) {
    if (argc > 0 && (strcmp(argv[0], "--help") == 0 || strcmp(argv[0], "-h") == 0)) {
        print_usage(stdout);
        return ENF_OK;
    }
    for (int i = 0; argc > 0 && i < BENCH_COUNT; i++)
        if (strcmp(benches[i].name, argv[0]) == 0) return benches[i].run(argc - 1, argv + 1);
    if (argc > 0)
        fprintf(stderr, "enfilade bench: there is no table '%.100s'\n", argv[0]);
    else
        fputs("enfilade bench: the name of a table is missing\n", stderr);
    print_usage(stderr);
    return ENF_BAD_USAGE;
}
