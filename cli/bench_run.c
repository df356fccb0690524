// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade bench run: what the runtime takes per question.
#include "cli/bench_run.h"

#include "cli/bench.h"
#include "cli/cli.h"

#include <stdio.h>
#include <string.h>

static const cli_command tables[] = {
    {"objects", "WORLD.enf ...: moving objects, and spheres through portals", cli_bench_run_objects},
    {"locate", "WORLD.enf ...: where points are, with and without a hint; steps", cli_bench_run_locate},
    {"sight", "WORLD.enf ...: lines of sight and rays, by portals passed", cli_bench_run_sight},
    {"view", "WORLD.enf ...: view traversal: time, tightness, and the check against rays",
     cli_bench_run_view},
    {"paths", "WORLD.enf ...: paths by table and by search, lines, near cells, sound", cli_bench_run_paths},
};

enum { TABLE_COUNT = sizeof tables / sizeof *tables };

static void print_usage(FILE *file) {
    fputs("usage: enfilade bench run NAME ...\n\n", file);
    for (int i = 0; i < TABLE_COUNT; i++) fprintf(file, "  %-10s %s\n", tables[i].name, tables[i].summary);
}

int cli_bench_run(int argc, char **argv) {
    if (argc > 0 && (strcmp(argv[0], "--help") == 0 || strcmp(argv[0], "-h") == 0)) {
        print_usage(stdout);
        return ENF_OK;
    }
    for (int i = 0; argc > 0 && i < TABLE_COUNT; i++)
        if (strcmp(tables[i].name, argv[0]) == 0) return tables[i].run(argc - 1, argv + 1);
    if (argc > 0)
        fprintf(stderr, "enfilade bench run: there is no table '%.100s'\n", argv[0]);
    else
        fputs("enfilade bench run: the name of a table is missing\n", stderr);
    print_usage(stderr);
    return ENF_BAD_USAGE;
}
