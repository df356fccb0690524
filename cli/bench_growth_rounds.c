// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // asprintf
#endif
#include "base/array.h"
#include "base/timer.h"
#include "build/write.h"
#include "cli/bench_child.h"
#include "cli/bench_folder.h"
#include "cli/bench_growth.h"
#include "cli/bench_world.h"
#include "cli/cli.h"
#include "cli/heap.h"
#include "cli/job.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { CHILD_SECONDS = 7200 };
enum { POLYGON_BYTES = 2400 }; ///< about what a compile takes

/// A process splits a world with one thread and with several: once to warm up, then so often.
enum { PAIRS_LEAST = 2, PAIRS_MOST = 64 };

/// What a child is told, and what it says.
typedef struct cli_growth_run {
    const char *world, *output;
    uint64_t touched; ///< bytes of the heap, before the clocks start
    int threads;      ///< of the second splits
    double seconds;   ///< to spend on splits
    double column[CLI_GROWTH_MEASURED];
    double pair[PAIRS_MOST][2]; ///< seconds by the clock of a split with one thread, with several
    int pair_count;
    enf_error error;
} run;

// ---------------------------------------------------------------------------------------------- one run

static void take_columns(const cli_job *job, double *column) {
    const enf_build *build = &job->build;
    column[CLI_GROWTH_POLYGONS] = (double)build->soup.polygon_count;
    column[CLI_GROWTH_TETRAHEDRA] = build->complex.tetrahedron_count;
    column[CLI_GROWTH_FINE_CELLS] = build->complex.cell_count;
    column[CLI_GROWTH_CELLS] = build->cell_count;
    column[CLI_GROWTH_READ] = job->read.cpu_seconds;
    column[CLI_GROWTH_WRITE] = job->write.cpu_seconds;
    column[CLI_GROWTH_TOTAL] = column[CLI_GROWTH_READ] + column[CLI_GROWTH_WRITE];
    for (int i = 0; i < ENF_STAGE_COUNT; i++) {
        column[CLI_GROWTH_STAGE + i] = build->stages[i].cpu_seconds;
        column[CLI_GROWTH_TOTAL] += column[CLI_GROWTH_STAGE + i];
    }
    column[CLI_GROWTH_CLOCK] = job->seconds + job->write.seconds;
    column[CLI_GROWTH_PEAK] = (double)job->write.peak_bytes / 1e6;
    column[CLI_GROWTH_EXACT] = enf_complex_tier_share(&build->complex, ENF_TIER_EXACT);
}

/// Reads the world and runs the first stages, all if `stages` is 0.
static enf_status run_stages(cli_job *job, const cli_settings *settings, const char *world, int stages,
                             enf_error *error) {
    cli_texts inputs = {0};
    enf_status status = cli_texts_add(&inputs, world) ? ENF_OK : enf_fail_memory(error, "a list");
    if (!status) status = cli_job_prepare(job, settings, error);
    job->options.stages = stages;
    if (!status) status = cli_job_run(job, &inputs, NULL, error);
    free(inputs.items);
    return status;
}

/// In a child: what `enfilade compile` does.
static void compile_world(void *shared) {
    run *run = shared;
    cli_settings settings = cli_settings_default();
    settings.threads = 1;
    if (run->touched > 0) cli_heap_touch(run->touched);
    cli_job job = {0};
    enf_status status = run_stages(&job, &settings, run->world, 0, &run->error);
    double started = enf_timer_now(), cpu_started = enf_timer_cpu();
    if (!status) status = enf_build_write(&job.build, job.options_json, run->output, &run->error);
    cli_stage_end(&job.write, started, cpu_started);
    if (!status) take_columns(&job, run->column);
    cli_job_free(&job);
    cli_settings_free(&settings);
}

static enf_status split_once(const run *run, int threads, double *seconds, enf_error *error) {
    cli_settings settings = cli_settings_default();
    settings.threads = threads;
    cli_job job = {0};
    enf_status status = run_stages(&job, &settings, run->world, ENF_STAGE_SPLIT + 1, error);
    *seconds = job.build.stages[ENF_STAGE_SPLIT].seconds;
    cli_job_free(&job);
    cli_settings_free(&settings);
    return status;
}

/// In a child.
static void split_in_turns(void *shared) {
    run *run = shared;
    enf_status status = ENF_OK;
    const double started = enf_timer_now();
    for (int i = -1; !status && i < PAIRS_MOST; i++) {
        if (i >= PAIRS_LEAST && enf_timer_now() - started > run->seconds) break;
        double *pair = run->pair[i < 0 ? 0 : i];
        status = split_once(run, 1, &pair[0], &run->error);
        if (!status) status = split_once(run, run->threads, &pair[1], &run->error);
        run->pair_count = i + 1;
    }
}

static enf_status run_child(const cli_growth_plan *plan, const cli_growth_row *row, void (*work)(void *),
                            uint64_t touched, enf_error *error) {
    cli_child child;
    run *run = plan->shared;
    memset(run, 0, sizeof *run);
    run->world = row->file;
    run->output = row->output;
    run->threads = plan->threads;
    run->seconds = plan->seconds;
    run->touched = touched;
    enf_status status = cli_child_run(work, run, CHILD_SECONDS, 0, &child, error);
    unlink(run->output);
    if (status) return status;
    if (child.signal) return enf_fail(error, ENF_NO_RESOURCES, "killed by signal %d", child.signal);
    if (run->error.status) *error = run->error;
    return run->error.status;
}

// ---------------------------------------------------------------------------------------------- one world

static enf_status add_compile(const cli_growth_plan *plan, const cli_growth_row *row,
                              cli_growth_series *series, uint64_t touched, enf_error *error) {
    if (!enf_array_reserve(series->columns, series->capacity, series->count + 1))
        return enf_fail_memory(error, "a run");
    enf_status status = run_child(plan, row, compile_world, touched, error);
    if (!status) memcpy(series->columns[series->count++], plan->shared->column, sizeof plan->shared->column);
    return status;
}

static enf_status add_splits(const cli_growth_plan *plan, cli_growth_row *row, enf_error *error) {
    enf_status status = run_child(plan, row, split_in_turns, 0, error);
    const size_t more = status ? 0 : (size_t)plan->shared->pair_count;
    if (!enf_array_reserve(row->pairs, row->pair_capacity, row->pair_count + more))
        return enf_fail_memory(error, "splits");
    if (more > 0) memcpy(row->pairs + row->pair_count, plan->shared->pair, more * sizeof *row->pairs);
    row->pair_count += more;
    return status;
}

/// Of the runs from `first` on.
static double find_median(const cli_growth_series *series, size_t first, int column, double *values) {
    for (size_t i = first; i < series->count; i++) values[i - first] = series->columns[i][column];
    return cli_median(values, series->count - first);
}

/// Takes the median of what a round has added.
static enf_status end_round(cli_growth_series *series, size_t first, int round, enf_error *error) {
    double *values = enf_array_new(series->count, sizeof *values);
    if (!values) return enf_fail_memory(error, "a median");
    series->totals[round] = find_median(series, first, CLI_GROWTH_TOTAL, values);
    free(values);
    return ENF_OK;
}

enf_status cli_growth_round(const cli_growth_plan *plan, cli_growth_row *row, int round, enf_error *error) {
    const double started = enf_timer_now();
    const size_t touched = row->touched.count, fresh = row->fresh.count;
    enf_status status = ENF_OK;
    do {
        status =
            add_compile(plan, row, &row->touched, (uint64_t)(row->world->polygons * POLYGON_BYTES), error);
        if (!status) status = add_compile(plan, row, &row->fresh, 0, error);
    } while (!status && enf_timer_now() - started < plan->seconds);
    if (!status) status = end_round(&row->touched, touched, round, error);
    if (!status) status = end_round(&row->fresh, fresh, round, error);
    if (!status && plan->threads > 1) status = add_splits(plan, row, error);
    return status;
}

/// Of one clock of the pairs, or of their ratios.
static double find_pair_median(const cli_growth_row *row, int column, double *values) {
    for (size_t i = 0; i < row->pair_count; i++) {
        const double *pair = row->pairs[i];
        values[i] = column == CLI_GROWTH_SPLIT_GAIN ? pair[0] / pair[1]
                                                    : pair[column == CLI_GROWTH_SPLIT_CLOCK_THREADS];
    }
    return row->pair_count > 0 ? cli_median(values, row->pair_count) : NAN;
}

enf_status cli_growth_medians(cli_growth_row *row, enf_error *error) {
    double *values = enf_array_new(row->touched.count + row->pair_count, sizeof *values);
    if (!values) return enf_fail_memory(error, "a median");
    for (int c = 0; c < CLI_GROWTH_MEASURED; c++) row->column[c] = find_median(&row->touched, 0, c, values);
    row->column[CLI_GROWTH_PEAK] = find_median(&row->fresh, 0, CLI_GROWTH_PEAK, values);
    row->column[CLI_GROWTH_FRESH] = find_median(&row->fresh, 0, CLI_GROWTH_TOTAL, values);
    for (int c = CLI_GROWTH_SPLIT_CLOCK; c <= CLI_GROWTH_SPLIT_GAIN; c++)
        row->column[c] = find_pair_median(row, c, values);
    free(values);
    return ENF_OK;
}

enf_status cli_growth_row_make(cli_growth_row *row, const cli_growth_world *world,
                               const cli_growth_plan *plan, enf_error *error) {
    const size_t rounds = (size_t)plan->rounds;
    row->world = world;
    row->touched.totals = enf_array_new(rounds, sizeof *row->touched.totals);
    row->fresh.totals = enf_array_new(rounds, sizeof *row->fresh.totals);
    if (!row->touched.totals || !row->fresh.totals) return enf_fail_memory(error, "rounds");
    enf_status status =
        cli_world_make(world->family, world->settings, CLI_GROWTH_SETTINGS, &row->file, error);
    if (!status && asprintf(&row->output, "%s.enf", row->file) < 0) {
        row->output = NULL;
        status = enf_fail_memory(error, "a path");
    }
    return status;
}

void cli_growth_row_free(cli_growth_row *row) {
    cli_world_remove(row->file);
    free(row->output);
    free(row->touched.columns);
    free(row->touched.totals);
    free(row->fresh.columns);
    free(row->fresh.totals);
    free(row->pairs);
}

enf_status cli_growth_plan_make(cli_growth_plan *plan, enf_error *error) {
    plan->shared = cli_shared_new(sizeof *plan->shared);
    return plan->shared ? ENF_OK : enf_fail_memory(error, "a run");
}

void cli_growth_plan_free(cli_growth_plan *plan) {
    if (plan->shared) cli_shared_free(plan->shared, sizeof *plan->shared);
    plan->shared = NULL;
}
