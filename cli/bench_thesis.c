// SPDX-License-Identifier: GPL-3.0-or-later
// Plays the recorded collapses back: a stop is good as long as no two spawn points share a cell.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // asprintf, mkstemps
#endif
#include "base/array.h"
#include "build/gen.h"
#include "cli/bench.h"
#include "cli/cli.h"
#include "cli/job.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static const char *const worlds[] = {"four-rooms", "four-rooms-tessellated", "four-rooms-distorted",
                                     "cavern"};
enum { WORLD_COUNT = sizeof worlds / sizeof *worlds };

/// How far a heuristic can go.
typedef struct reach {
    int64_t cells;     ///< the fewest at which every spawn point has a cell of its own; -1: never
    double done, next; ///< weight of the last collapse that was fine, and of the first that was not
} reach;

static int32_t find(int32_t *parent, int32_t cell) {
    while (parent[cell] != cell) {
        parent[cell] = parent[parent[cell]];
        cell = parent[cell];
    }
    return cell;
}

static bool are_apart(int32_t *parent, const int32_t *spawns, int32_t count) {
    for (int32_t i = 0; i < count; i++) {
        if (spawns[i] < 0) return false;
        for (int32_t k = 0; k < i; k++)
            if (find(parent, spawns[i]) == find(parent, spawns[k])) return false;
    }
    return true;
}

static enf_status play(const enf_build *build, reach *out, enf_error *error) {
    const enf_regions *regions = &build->regions;
    int32_t cells = build->complex.cell_count, nodes = 0;
    int32_t *node = enf_array_new((size_t)cells, sizeof *node),
            *parent = enf_array_new((size_t)cells, sizeof *parent);
    int32_t *spawns = enf_array_new((size_t)regions->spawn_count, sizeof *spawns);
    enf_status status = node && parent && spawns ? ENF_OK : enf_fail_memory(error, "the replay");
    *out = (reach){.cells = -1, .next = INFINITY};
    if (!status) {
        for (int32_t i = 0; i < cells; i++) node[i] = build->cell_of[i] >= 0 ? nodes++ : -1;
        for (int32_t i = 0; i < nodes; i++) parent[i] = i;
        for (int32_t i = 0; i < regions->spawn_count; i++)
            spawns[i] = regions->spawn_cell[i] < 0 ? -1 : node[regions->spawn_cell[i]];
        size_t done = 0, all = build->decimation.collapse_count;
        const enf_collapse *collapses = build->decimation.collapses;
        while (are_apart(parent, spawns, regions->spawn_count)) {
            out->cells = nodes - (int64_t)done;
            if (done) out->done = fmax(out->done, collapses[done - 1].weight);
            if (done == all) break;
            out->next = collapses[done].weight;
            parent[find(parent, collapses[done].gone)] = find(parent, collapses[done].kept);
            done++;
        }
    }
    free(node);
    free(parent);
    free(spawns);
    return status;
}

/// Writes the world to a temporary file; its path is the caller's to free and unlink.
static enf_status make_world(const char *name, const char *const *settings, size_t count, char **path,
                             enf_error *error) {
    const char *folder = getenv("TMPDIR");
    if (asprintf(path, "%s/enfilade-XXXXXX.obj", folder ? folder : "/tmp") < 0) {
        *path = NULL;
        return enf_fail_memory(error, "a path");
    }
    int descriptor = mkstemps(*path, 4);
    FILE *file = descriptor < 0 ? NULL : fdopen(descriptor, "w");
    if (!file) {
        if (descriptor >= 0) close(descriptor);
        return enf_fail(error, ENF_NO_RESOURCES, "%s: can't be written; set TMPDIR to a folder that can",
                        *path);
    }
    enf_status status = enf_gen_write(name, settings, count, file, error);
    if (fclose(file) != 0 && !status)
        status = enf_fail(error, ENF_NO_RESOURCES, "%s: can't be written", *path);
    return status;
}

static void print_reach(const reach *reach, int32_t rooms) {
    if (reach->cells < 0)
        printf(" %7s %9s %9s", "never", "", "");
    else
        printf(" %6" PRId64 "%c %9.4g %9.4g", reach->cells, reach->cells <= rooms ? '+' : ' ', reach->done,
               reach->next);
}

static enf_status run_world(const char *name, const char *const *gen_settings, size_t gen_count,
                            cli_settings settings, enf_error *error) {
    char *path = NULL;
    enf_status status = make_world(name, gen_settings, gen_count, &path, error);
    cli_texts inputs = {0};
    if (!status && !cli_texts_add(&inputs, path)) status = enf_fail_memory(error, "a list");
    settings.stop = "cells=1";
    for (int heuristic = 0; !status && heuristic < ENF_HEURISTIC_COUNT; heuristic++) {
        cli_job job = {0};
        settings.heuristic = heuristic;
        status = cli_job_prepare(&job, &settings, error);
        if (!status) status = cli_job_run(&job, &inputs, NULL, error);
        reach reached = {0};
        if (!status) status = play(&job.build, &reached, error);
        if (!status && heuristic == 0) {
            cli_counts counts = cli_job_count(&job);
            const enf_complex *complex = &job.build.complex;
            printf("%-24s %6" PRId32 " %6" PRId32 " %+6.1f %% %6" PRId32 " %6" PRId64 " %6" PRId64
                   " %5" PRId32,
                   name, complex->tetrahedron_count, complex->tetrahedra_cut,
                   100.0 * (complex->cell_count - complex->tetrahedron_count) / complex->tetrahedron_count,
                   complex->cell_count, counts.fine_discarded, counts.fine_active,
                   job.build.regions.spawn_count);
        }
        if (!status) print_reach(&reached, job.build.regions.spawn_count);
        cli_job_free(&job);
    }
    if (!status) putchar('\n');
    free(inputs.items);
    if (path) unlink(path);
    free(path);
    return status;
}

static void print_head(void) {
    puts("Per heuristic: the fewest cells at which every spawn point still has a cell of its own (+: no more "
         "cells than\n"
         "rooms), the largest weight collapsed until then, and the weight of the collapse that joins two "
         "rooms.\n");
    printf("%-24s %6s %6s %8s %6s %6s %6s %5s", "world", "tets", "cut", "split", "fine", "gone", "active",
           "rooms");
    for (int i = 0; i < ENF_HEURISTIC_COUNT; i++) printf(" %27s", enf_heuristic_name((enf_heuristic)i));
    printf("\n%74s", "");
    for (int i = 0; i < ENF_HEURISTIC_COUNT; i++) printf(" %7s %9s %9s", "cells", "done", "next");
    putchar('\n');
}

int cli_bench_thesis(int argc, char **argv) {
    cli_settings settings = cli_settings_default();
    cli_option options[] = {CLI_SETTINGS_OPTIONS(settings), {0}};
    const cli_syntax syntax = {.command = "enfilade bench thesis",
                               .usage = "[key=value]... [options of compile]",
                               .summary =
                                   "The worlds of the thesis; key=value are settings of `enfilade gen`.",
                               .options = options,
                               .operands_max = 16,
                               .operand = "a setting"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0) {
        enf_error error = {0};
        enf_status failed = ENF_OK;
        print_head();
        for (int i = 0; !failed && i < WORLD_COUNT; i++)
            failed = run_world(worlds[i], operands.items, operands.count, settings, &error);
        status = failed ? cli_fail(&error) : ENF_OK;
    }
    cli_settings_free(&settings);
    free(operands.items);
    return status;
}
