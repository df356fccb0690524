// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory.h"
#include "base/timer.h"
#include "build/check.h"
#include "build/write.h"
#include "cli/bench.h"
#include "cli/bench_folder.h"
#include "cli/cli.h"
#include "cli/job.h"
#include "visibility/check_world_pvs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct verdict {
    bool asked, held;
    double seconds;
    char first[256]; ///< the first broken invariant
} verdict;

/// What `enfilade check` would say of the file.
static enf_status check_build(const cli_job *job, verdict *verdict, enf_error *error) {
    enf_build_image image;
    enf_status status = enf_build_image_make(&image, &job->build, job->options_json, error);
    if (status) return status;
    enf_check_report *report = calloc(1, sizeof *report);
    double started = enf_timer_now();
    status = report ? enf_world_check(&image.view, report, error) : enf_fail_memory(error, "the report");
    if (!status) status = enf_world_check_pvs(&image.view, report, error);
    verdict->seconds = enf_timer_now() - started;
    verdict->held = status == ENF_OK;
    if (status == ENF_CHECK_FAILED) {
        snprintf(verdict->first, sizeof verdict->first, "%.255s", report->first);
        status = ENF_OK;
    }
    free(report);
    enf_build_image_free(&image);
    return status;
}

static void print_head(void *user) {
    (void)user;
    printf("%-20s %7s %6s %7s %8s %6s %8s %7s %6s %7s %6s %4s %7s  %s\n", "level", "s", "MB", "polys", "tets",
           "ratio", "fine", "active", "region", "cells", "portal", "leak", "spawns", "check");
}

static void print_row(const char *name, const cli_job *job, double peak, const verdict *verdict) {
    const enf_build *build = &job->build;
    cli_counts counts = cli_job_count(job);
    printf("%-20s %7.2f %6.0f %7zu %8" PRId32 " %6.2f %8" PRId32 " %7" PRId64 " %6" PRId32 " %7" PRId32
           " %6" PRId32 " %4s %3" PRId64 "/%-3" PRId32 "  ",
           name, job->seconds, peak / 1e6, build->mesh.polygon_count, build->complex.tetrahedron_count,
           (double)build->complex.cell_count / build->complex.tetrahedron_count, build->complex.cell_count,
           counts.fine_active, build->regions.region_count, build->cell_count, build->portals.opening_count,
           build->regions.leak ? "LEAK" : "-", counts.spawns_in_cells, build->regions.spawn_count);
    if (verdict->held)
        printf("holds (%.2f s)\n", verdict->seconds);
    else
        printf("%s%s\n", verdict->asked ? "BROKEN: " : "-", verdict->first);
}

typedef struct request {
    cli_settings settings;
    bool check;
} request;

/// In the child: reads, compiles, writes to nowhere that stays.
static int compile_level(void *user, const char *path, const char *name, void *row) {
    (void)row; // the child prints
    const request *request = user;
    verdict verdict = {.asked = request->check};
    enf_error error = {0};
    cli_job job = {0};
    cli_texts inputs = {0};
    enf_status status = cli_texts_add(&inputs, path) ? ENF_OK : enf_fail_memory(&error, "a list");
    if (!status) status = cli_job_prepare(&job, &request->settings, &error);
    if (!status) status = cli_job_run(&job, &inputs, NULL, &error);
    double started = enf_timer_now();
    if (!status) status = enf_build_write(&job.build, job.options_json, "/dev/null", &error);
    job.seconds += enf_timer_now() - started;
    double peak = (double)enf_memory_peak();
    if (!status && request->check) status = check_build(&job, &verdict, &error);
    if (!status) print_row(name, &job, peak, &verdict);
    cli_job_free(&job);
    free(inputs.items);
    if (status) printf("%-20s %s\n", name, error.text);
    if (!status && request->check && !verdict.held) status = ENF_CHECK_FAILED;
    return cli_finish_output() ? ENF_NO_RESOURCES : (int)status;
}

int cli_bench_levels(int argc, char **argv) {
    request request = {.settings = cli_settings_default()};
    cli_folder folder = {.user = &request, .work = compile_level, .print_head = print_head};
    cli_option options[] = {
        {"--check", 0, CLI_FLAG, &request.check, NULL, "check every invariant of each result", NULL, false},
        CLI_LEVELS_OPTION(folder),
        CLI_SETTINGS_OPTIONS(request.settings),
        {0}};
    const cli_syntax syntax = {
        .command = "enfilade bench levels",
        .usage = "DIR [--check] [--levels GLOB] [options of compile]",
        .summary =
            "Compiles every level in a folder: seconds and peak memory of read to write, sizes, ratio of\n"
            "fine cells to tetrahedra, spawn points in kept cells.",
        .options = options,
        .operands_min = 1,
        .operands_max = 1,
        .operand = "the folder"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0) {
        folder.path = operands.items[0];
        status = cli_folder_visit(&folder);
    }
    cli_settings_free(&request.settings);
    free(operands.items);
    return status;
}
