// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench_run_worlds.h"

#include "cli/cli.h"
#include "cli/world.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int measure_world(const cli_bench_table *table, const char *path) {
    enf_world *world = NULL;
    int status = cli_open_world(&world, path);
    if (status) return status;
    const char *slash = strrchr(path, '/');
    const cli_bench_subject subject = {world, path, slash ? slash + 1 : path};
    enf_error error = {0};
    if (table->measure(&subject, table->user, &error)) status = cli_fail(&error);
    enf_world_close(world);
    fflush(stdout);
    return status;
}

int cli_bench_run_worlds(const cli_bench_table *table, int argc, char **argv) {
    const cli_syntax syntax = {.command = table->command,
                               .usage = table->usage,
                               .summary = table->summary,
                               .options = table->options,
                               .operands_min = 1,
                               .operands_max = INT_MAX,
                               .operand = "a world file"};
    cli_texts paths = {0};
    int status = cli_parse(&syntax, argc, argv, &paths);
    if (status < 0) {
        table->begin(table->user);
        fflush(stdout);
        status = ENF_OK;
        for (size_t i = 0; i < paths.count && !status && !ferror(stdout);
             i++) // who called says what is wrong
            status = measure_world(table, paths.items[i]);
    }
    free(paths.items);
    return status;
}
