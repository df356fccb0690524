// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade bench memory: what was predicted of the peak, beside the peak; and the constants of
// build/memory_estimate.c that would have fitted best.
#include "base/memory.h"
#include "build/write.h"
#include "cli/bench.h"
#include "cli/bench_folder.h"
#include "cli/cli.h"
#include "cli/job.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct row {
    enf_memory_counts counts;
    uint64_t least, predicted, before, peak;
} row;

/// Relative least squares: sums of the normal equations for bytes per tetrahedron and per cut.
typedef struct table {
    cli_settings settings;
    double tt, tm, mm, ty, my;
    double lowest, highest; ///< predicted over measured
    int rows;
} table;

static void print_head(void *user) {
    (void)user;
    printf("%-20s %9s %9s %9s %9s %9s %9s %10s %10s\n", "world", "polygons", "tets", "missing", "least MB",
           "pred. MB", "peak MB", "least/peak", "pred./peak");
}

/// In the child: reads, compiles, writes to nowhere that stays.
static int compile_world(void *user, const char *path, const char *name, void *out) {
    (void)name;
    const table *table = user;
    row *result = out;
    enf_error error = {0};
    cli_job job = {0};
    cli_texts inputs = {0};
    enf_status status = cli_texts_add(&inputs, path) ? ENF_OK : enf_fail_memory(&error, "a list");
    if (!status) status = cli_job_prepare(&job, &table->settings, &error);
    result->before = enf_memory_resident();
    if (!status) status = cli_job_run(&job, &inputs, NULL, &error);
    if (!status) status = enf_build_write(&job.build, job.options_json, "/dev/null", &error);
    result->counts = job.build.counts;
    result->least = job.build.peak_bytes_least;
    result->predicted = job.build.peak_bytes_predicted;
    result->peak = enf_memory_peak();
    cli_job_free(&job);
    free(inputs.items);
    return status ? cli_folder_fail(path, &error) : ENF_OK;
}

static void print_row(void *user, const char *name, const void *in) {
    table *table = user;
    const row *row = in;
    double ratio = (double)row->predicted / (double)row->peak;
    printf("%-20s %9" PRIu64 " %9" PRIu64 " %9" PRIu64 " %9.1f %9.1f %9.1f %10.2f %10.2f\n", name,
           row->counts.polygons, row->counts.tetrahedra, row->counts.missing, (double)row->least / 1e6,
           (double)row->predicted / 1e6, (double)row->peak / 1e6, (double)row->least / (double)row->peak,
           ratio);
    double y = (double)row->peak, t = (double)row->counts.tetrahedra / y,
           m = enf_memory_cuts(&row->counts) / y;
    double rest = 1 - (double)row->before / y;
    table->tt += t * t;
    table->tm += t * m;
    table->mm += m * m;
    table->ty += t * rest;
    table->my += m * rest;
    table->lowest = table->rows == 0 ? ratio : fmin(table->lowest, ratio);
    table->highest = fmax(table->highest, ratio);
    table->rows++;
}

static void print_fit(const table *table) {
    if (table->rows == 0) return;
    printf("predicted over measured: %.2f to %.2f\n", table->lowest, table->highest);
    double determinant = table->tt * table->mm - table->tm * table->tm;
    if (!(determinant > 0)) return;
    printf("best fit: %.0f bytes per tetrahedron, %.0f per cut\n",
           (table->ty * table->mm - table->my * table->tm) / determinant,
           (table->my * table->tt - table->ty * table->tm) / determinant);
}

int cli_bench_memory(int argc, char **argv) {
    table table = {.settings = cli_settings_default()};
    cli_folder folder = {.user = &table,
                         .work = compile_world,
                         .row_size = sizeof(row),
                         .print = print_row,
                         .print_head = print_head};
    cli_option options[] = {CLI_LEVELS_OPTION(folder), CLI_SETTINGS_OPTIONS(table.settings), {0}};
    const cli_syntax syntax = {
        .command = "enfilade bench memory",
        .usage = "DIR [--levels GLOB] [options of compile]",
        .summary =
            "Compiles every world in a folder and compares the most memory that was taken with what was\n"
            "predicted: the least, before there are tetrahedra, and the estimate after that.",
        .options = options,
        .operands_min = 1,
        .operands_max = 1,
        .operand = "the folder"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0) {
        folder.path = operands.items[0];
        status = cli_folder_visit(&folder);
        print_fit(&table);
    }
    cli_settings_free(&table.settings);
    free(operands.items);
    return status;
}
