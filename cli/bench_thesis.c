// SPDX-License-Identifier: GPL-3.0-or-later
// How far can decimation go before two spawn points share a cell?
#include "cli/bench.h"
#include "cli/bench_world.h"
#include "cli/cli.h"
#include "cli/job.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const char *const worlds[] = {"four-rooms", "four-rooms-tessellated", "four-rooms-distorted",
                                     "cavern"};
enum { WORLD_COUNT = sizeof worlds / sizeof *worlds };

/// How far a heuristic can go.
typedef struct reach {
    int64_t cells;     ///< the fewest at which every spawn point has a cell of its own; -1: never
    double done, next; ///< weight of the last collapse that was fine, and of the first that was not
} reach;

/// Does every spawn point have a cell of its own?
static bool are_apart(const enf_build *build) {
    const enf_regions *regions = &build->regions;
    for (int32_t i = 0; i < regions->spawn_count; i++) {
        int32_t cell = regions->spawn_cell[i] < 0 ? -1 : build->cell_of[regions->spawn_cell[i]];
        if (cell < 0) return false;
        for (int32_t k = 0; k < i; k++)
            if (build->cell_of[regions->spawn_cell[k]] == cell) return false;
    }
    return true;
}

/// Compiles down to so many cells.
static enf_status compile_to(cli_job *job, const cli_texts *inputs, cli_settings settings, int64_t cells,
                             enf_error *error) {
    char stop[40];
    snprintf(stop, sizeof stop, "cells=%" PRId64, cells);
    settings.stop = stop;
    enf_status status = cli_job_prepare(job, &settings, error);
    if (!status) status = cli_job_run(job, inputs, NULL, error);
    job->settings = NULL; // it ends with this call
    return status;
}

/// The fewest cells that keep the spawn points apart: cells only ever grow together, so it can be searched
/// for by halving.
static enf_status find_reach(const cli_texts *inputs, cli_settings settings, int64_t most, reach *out,
                             enf_error *error) {
    *out = (reach){.cells = -1};
    int64_t low = 1, high = most; // below low: not apart
    while (low <= high) {
        int64_t middle = low + (high - low) / 2;
        cli_job job = {0};
        enf_status status = compile_to(&job, inputs, settings, middle, error);
        bool apart = !status && are_apart(&job.build);
        if (apart) {
            const enf_decimation *decimation = &job.build.decimation;
            *out = (reach){.cells = job.build.cell_count, .next = decimation->next_weight};
            for (size_t i = 0; i < decimation->collapse_count; i++)
                out->done = fmax(out->done, decimation->collapses[i].weight);
            high = middle - 1;
        } else {
            low = middle + 1;
        }
        cli_job_free(&job);
        if (status) return status;
    }
    return ENF_OK;
}

static void print_reach(const reach *reach, int32_t rooms) {
    if (reach->cells < 0)
        printf(" %7s %9s %9s", "never", "", "");
    else
        printf(" %6" PRId64 "%c %9.4g %9.4g", reach->cells, reach->cells <= rooms ? '+' : ' ', reach->done,
               reach->next);
}

/// Sizes as compiled, and how many cells more the cuts make of the tetrahedra if none are joined, as in the
/// thesis.
static enf_status print_sizes(const char *name, const cli_job *job, const cli_texts *inputs,
                              cli_settings settings, enf_error *error) {
    cli_counts counts = cli_job_count(job);
    const enf_complex *complex = &job->build.complex;
    cli_job plain = {0};
    settings.plain_cells = true;
    enf_status status = compile_to(&plain, inputs, settings, 1, error);
    int32_t pieces = plain.build.complex.cell_count;
    cli_job_free(&plain);
    if (status) return status;
    printf("%-24s %6" PRId32 " %6" PRId32 " %+6.1f %% %6" PRId32 " %6" PRId64 " %6" PRId64 " %5" PRId32, name,
           complex->tetrahedron_count, complex->tetrahedra_cut,
           100.0 * (pieces - complex->tetrahedron_count) / complex->tetrahedron_count, complex->cell_count,
           counts.fine_discarded, counts.fine_active, job->build.regions.spawn_count);
    return ENF_OK;
}

static enf_status run_world(const char *name, const char *const *gen_settings, size_t gen_count,
                            cli_settings settings, enf_error *error) {
    char *path = NULL;
    enf_status status = cli_world_make(name, gen_settings, gen_count, &path, error);
    cli_texts inputs = {0};
    if (!status && !cli_texts_add(&inputs, path)) status = enf_fail_memory(error, "a list");
    for (int heuristic = 0; !status && heuristic < ENF_HEURISTIC_COUNT; heuristic++) {
        cli_job job = {0};
        reach reached = {0};
        settings.heuristic = heuristic;
        status = compile_to(&job, &inputs, settings, 1, error);
        int64_t most = job.build.cell_count + (int64_t)job.build.decimation.collapse_count;
        if (!status && heuristic == 0) status = print_sizes(name, &job, &inputs, settings, error);
        if (!status) status = find_reach(&inputs, settings, most, &reached, error);
        if (!status) print_reach(&reached, job.build.regions.spawn_count);
        cli_job_free(&job);
    }
    if (!status) putchar('\n');
    free(inputs.items);
    cli_world_remove(path);
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
