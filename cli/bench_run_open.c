// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade bench run open: how long opening takes, lazily and whole, part by part. The file is in the
// system's cache, as it has been read before. Every number is the least of several runs.
#include "base/timer.h"
#include "cli/bench_run.h"
#include "cli/bench_run_worlds.h"
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

static enf_status measure_world(const cli_bench_subject *subject, void *user, enf_error *error) {
    (void)user;
    const enf_file_view *view = enf_world_file(subject->world);
    file file = {subject->path, malloc(view->size), view->size};
    if (!file.bytes) return enf_fail_memory(error, "a table");
    memcpy(file.bytes, view->bytes, view->size);
    printf("%-24s %8.1f %8.3f %8.2f %8.2f %8.2f %8.2f", subject->name, (double)file.size * 1e-6,
           measure(&file, true, false, 0) * 1e3, rate(&file, true, false), rate(&file, true, true),
           rate(&file, false, false), rate(&file, false, true));
    for (int part = 0; part < PARTS; part++) printf(" %8.2f", measure(&file, false, false, 1u << part) * 1e3);
    putchar('\n');
    free(file.bytes);
    return ENF_OK;
}

static void print_head(void *user) {
    (void)user;
    printf("%-24s %8s %8s %8s %8s %8s %8s %8s %8s %8s %8s %8s %8s\n", "world", "MB", "lazy", "mapped",
           "-sums", "memory", "-sums", "cells", "location", "sight", "seen", "draw", "exact");
}

int cli_bench_run_open(int argc, char **argv) {
    cli_option options[] = {{0}};
    const cli_bench_table table = {
        .command = "enfilade bench run open",
        .usage = "WORLD.enf ...",
        .summary =
            "Megabytes; milliseconds to open lazily (lazy); gigabytes a second when all is checked, mapped\n"
            "and in memory, with checksums and without (counts and indices only); milliseconds to open\n"
            "in memory with one part, and with what that needs.",
        .options = options,
        .begin = print_head,
        .measure = measure_world};
    return cli_bench_run_worlds(&table, argc, argv);
}
