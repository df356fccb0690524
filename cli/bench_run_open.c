// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade bench run open: how long opening takes, lazily and whole, part by part. The file is in the
// system's cache, as it has been read before. Every number is the least of several runs.
#include "base/timer.h"
#include "cli/bench_run.h"
#include "cli/cli.h"
#include "cli/options.h"
#include "cli/world.h"
#include "enfilade/run.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { RUNS = 15, PARTS = 6 };

typedef struct file {
    const char *path;
    void *bytes; ///< a copy in memory, for times without the pages that mapping takes
    uint64_t size;
} file;

/// Seconds to open a world with some parts, as a mapping or in memory; infinite if it fails.
static double measure(const file *file, bool mapped, bool skip_checksums, uint32_t loads) {
    double least = INFINITY;
    enf_open_options options = {
        .size = sizeof options, .skip_checksums = skip_checksums, .mode = ENF_OPEN_LAZY};
    if (loads == ENF_LOAD_ALL) options.mode = ENF_OPEN_WHOLE;
    for (int run = 0; run < RUNS; run++) {
        enf_world *world = NULL;
        double begin = enf_timer_now();
        enf_status status =
            mapped ? enf_world_open_path(&world, file->path, &options, NULL)
                   : enf_world_open_memory(&world, file->bytes, (size_t)file->size, &options, NULL);
        if (!status) status = enf_world_load(world, loads, NULL);
        if (!status) least = fmin(least, enf_timer_now() - begin);
        enf_world_close(world);
    }
    return least;
}

/// Gigabytes (10^9) a second.
static double rate(const file *file, bool mapped, bool skip_checksums) {
    return (double)file->size / measure(file, mapped, skip_checksums, ENF_LOAD_ALL) * 1e-9;
}

static int bench_world(const char *path) {
    enf_world *world = NULL;
    int status = cli_open_world(&world, path);
    if (status) return status;
    const enf_file_view *view = enf_world_file(world);
    file file = {path, malloc(view->size), view->size};
    if (file.bytes) {
        memcpy(file.bytes, view->bytes, view->size);
        const char *name = strrchr(path, '/') ? strrchr(path, '/') + 1 : path;
        printf("%-24s %8.1f %8.3f %8.2f %8.2f %8.2f %8.2f", name, (double)file.size * 1e-6,
               measure(&file, true, false, 0) * 1e3, rate(&file, true, false), rate(&file, true, true),
               rate(&file, false, false), rate(&file, false, true));
        for (int part = 0; part < PARTS; part++)
            printf(" %8.2f", measure(&file, false, false, 1u << part) * 1e3);
        putchar('\n');
        fflush(stdout);
    } else {
        enf_error error = {0};
        status = cli_fail((enf_fail_memory(&error, "a table"), &error));
    }
    free(file.bytes);
    enf_world_close(world);
    return status;
}

int cli_bench_run_open(int argc, char **argv) {
    cli_option options[] = {{0}};
    const cli_syntax syntax = {
        .command = "enfilade bench run open",
        .usage = "WORLD.enf ...",
        .summary =
            "Megabytes; milliseconds to open lazily (lazy); gigabytes a second when all is checked, mapped\n"
            "and in memory, with checksums and without (counts and indices only); milliseconds to open\n"
            "in memory with one part, and with what that needs.",
        .options = options,
        .operands_min = 1,
        .operands_max = INT_MAX,
        .operand = "a world file"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0) {
        status = ENF_OK;
        printf("%-24s %8s %8s %8s %8s %8s %8s %8s %8s %8s %8s %8s %8s\n", "world", "MB", "lazy", "mapped",
               "-sums", "memory", "-sums", "cells", "location", "sight", "seen", "draw", "exact");
        for (int i = 0; i < (int)operands.count && !status; i++) status = bench_world(operands.items[i]);
    }
    free(operands.items);
    return status;
}
