// SPDX-License-Identifier: GPL-3.0-or-later
// How time and memory grow with the world, and what a second thread gains. A machine that others share is
// faster at some times than at others, for seconds or minutes. So the sizes take turns, round after round,
// and in a round a small world is compiled again and again for as long as a large one takes: its median, like
// the large one's, is of fast and slow moments. Every compile is a process of its own. In turn they have the
// memory that they will take in their heap before the clocks start, and get it as they go: the first tells
// what the work costs, the second adds what the system takes for memory, which a host may give slowly. What
// threads gain is measured in one process, which splits the same world again and again, with one thread and
// with several.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // asprintf
#endif
#include "base/array.h"
#include "base/timer.h"
#include "build/write.h"
#include "cli/bench.h"
#include "cli/bench_child.h"
#include "cli/bench_folder.h"
#include "cli/bench_world.h"
#include "cli/cli.h"
#include "cli/heap.h"
#include "cli/job.h"

#include <fnmatch.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { CHILD_SECONDS = 7200, SETTINGS = 3 };
enum { POLYGON_BYTES = 2400 }; ///< about what a compile takes

/// The bars.
static const double exponent_most = 1.1, million = 1e6, million_seconds = 60, gain_least = 1.6;
static const double near_million = 0.95; ///< so much of a million polygons counts as one

/// The worlds, family by family, by size.
static const struct world {
    const char *family, *settings[SETTINGS];
    double polygons; ///< about
} worlds[] = {
    {"office", {"floors=1", "rooms=7", "detail=3"}, 1e4},
    {"office", {"floors=1", "rooms=20", "detail=3"}, 3e4},
    {"office", {"floors=2", "rooms=35", "detail=3"}, 1e5},
    {"office", {"floors=4", "rooms=54", "detail=3"}, 3e5},
    {"office", {"floors=9", "rooms=80", "detail=3"}, 1e6},
    {"caverns", {"floors=1", "rooms=3", "detail=2"}, 1e4},
    {"caverns", {"floors=1", "rooms=9", "detail=2"}, 3e4},
    {"caverns", {"floors=2", "rooms=14", "detail=2"}, 1e5},
    {"caverns", {"floors=3", "rooms=27", "detail=2"}, 3e5},
    {"caverns", {"floors=5", "rooms=52", "detail=2"}, 1e6},
};

enum { WORLD_COUNT = sizeof worlds / sizeof *worlds };

/// Columns of the table: counts, seconds of the processor and by the clock, and what is made of them.
enum {
    POLYGONS,
    TETRAHEDRA,
    FINE_CELLS,
    CELLS,
    READ,
    STAGE,
    WRITE = STAGE + ENF_STAGE_COUNT,
    TOTAL,
    PEAK,
    EXACT,
    CLOCK,
    MEASURED, ///< so many columns come from a compile
    FRESH = MEASURED,
    SPLIT_CLOCK,
    SPLIT_CLOCK_THREADS,
    SPLIT_GAIN,
    COLUMN_COUNT
};

static const struct column {
    const char *name;
    int digits; ///< after the point
} columns[COLUMN_COUNT] = {
    {"polygons", 0},    {"tetrahedra", 0}, {"fine_cells", 0},    {"cells", 0},         {"read_s", 3},
    {"clean_s", 3},     {"delaunay_s", 3}, {"split_s", 3},       {"connect_s", 3},     {"colour_s", 3},
    {"decimate_s", 3},  {"portals_s", 3},  {"write_s", 3},       {"total_s", 2},       {"peak_mb", 0},
    {"exact_share", 5}, {"clock_s", 2},    {"fresh_total_s", 2}, {"split_clock_s", 3}, {"split_clock_N_s", 3},
    {"split_gain", 2},
};

/// A process splits a world with one thread and with several: once to warm up, then so often.
enum { PAIRS_LEAST = 2, PAIRS_MOST = 64 };

/// What a child is told, and what it says.
typedef struct run {
    const char *world, *output;
    uint64_t touched; ///< bytes of the heap, before the clocks start
    int threads;      ///< of the second splits
    double seconds;   ///< to spend on splits
    double column[MEASURED];
    double pair[PAIRS_MOST][2]; ///< seconds by the clock of a split with one thread, with several
    int pair_count;
    enf_error error;
} run;

/// What all compiles of one world have said.
typedef struct series {
    double (*columns)[MEASURED]; ///< of each run
    size_t count, capacity;
} series;

typedef struct row {
    const struct world *world;
    char *file, *output; ///< the world, while it is there; what it is compiled to
    series touched, fresh;
    double (*pairs)[2];
    size_t pair_count, pair_capacity;
    double column[COLUMN_COUNT];
} row;

typedef struct table {
    int threads, runs;
    double largest, seconds;
    const char *pattern; ///< glob for families; null: all
    run *shared;
    row rows[WORLD_COUNT];
    int count;
} table;

// ---------------------------------------------------------------------------------------------- one run

static void take_columns(const cli_job *job, double *column) {
    const enf_build *build = &job->build;
    column[POLYGONS] = (double)build->soup.polygon_count;
    column[TETRAHEDRA] = build->complex.tetrahedron_count;
    column[FINE_CELLS] = build->complex.cell_count;
    column[CELLS] = build->cell_count;
    column[READ] = job->read.cpu_seconds;
    column[WRITE] = job->write.cpu_seconds;
    column[TOTAL] = column[READ] + column[WRITE];
    for (int i = 0; i < ENF_STAGE_COUNT; i++) {
        column[STAGE + i] = build->stages[i].cpu_seconds;
        column[TOTAL] += column[STAGE + i];
    }
    column[CLOCK] = job->seconds + job->write.seconds;
    column[PEAK] = (double)job->write.peak_bytes / 1e6;
    column[EXACT] = enf_complex_tier_share(&build->complex, ENF_TIER_EXACT);
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

static enf_status run_child(const table *table, const row *row, void (*work)(void *), uint64_t touched,
                            enf_error *error) {
    cli_child child;
    run *run = table->shared;
    memset(run, 0, sizeof *run);
    run->world = row->file;
    run->output = row->output;
    run->threads = table->threads;
    run->seconds = table->seconds;
    run->touched = touched;
    enf_status status = cli_child_run(work, run, CHILD_SECONDS, 0, &child, error);
    unlink(run->output);
    if (status) return status;
    if (child.signal) return enf_fail(error, ENF_NO_RESOURCES, "killed by signal %d", child.signal);
    if (run->error.status) *error = run->error;
    return run->error.status;
}

// ---------------------------------------------------------------------------------------------- one world

static enf_status add_compile(const table *table, const row *row, series *series, uint64_t touched,
                              enf_error *error) {
    if (!enf_array_reserve(series->columns, series->capacity, series->count + 1))
        return enf_fail_memory(error, "a run");
    enf_status status = run_child(table, row, compile_world, touched, error);
    if (!status)
        memcpy(series->columns[series->count++], table->shared->column, sizeof table->shared->column);
    return status;
}

static enf_status add_splits(const table *table, row *row, enf_error *error) {
    enf_status status = run_child(table, row, split_in_turns, 0, error);
    const size_t more = status ? 0 : (size_t)table->shared->pair_count;
    if (!enf_array_reserve(row->pairs, row->pair_capacity, row->pair_count + more))
        return enf_fail_memory(error, "splits");
    if (more > 0) memcpy(row->pairs + row->pair_count, table->shared->pair, more * sizeof *row->pairs);
    row->pair_count += more;
    return status;
}

/// A round of one world: compiles until `seconds` have passed, one of each kind at least.
static enf_status run_round(const table *table, row *row, enf_error *error) {
    const double started = enf_timer_now();
    enf_status status = ENF_OK;
    do {
        status =
            add_compile(table, row, &row->touched, (uint64_t)(row->world->polygons * POLYGON_BYTES), error);
        if (!status) status = add_compile(table, row, &row->fresh, 0, error);
    } while (!status && enf_timer_now() - started < table->seconds);
    if (!status && table->threads > 1) status = add_splits(table, row, error);
    return status;
}

static double find_median(const series *series, int column, double *values) {
    for (size_t i = 0; i < series->count; i++) values[i] = series->columns[i][column];
    return cli_median(values, series->count);
}

/// Of one clock of the pairs, or of their ratios.
static double find_pair_median(const row *row, int column, double *values) {
    for (size_t i = 0; i < row->pair_count; i++) {
        const double *pair = row->pairs[i];
        values[i] = column == SPLIT_GAIN ? pair[0] / pair[1] : pair[column == SPLIT_CLOCK_THREADS];
    }
    return row->pair_count > 0 ? cli_median(values, row->pair_count) : NAN;
}

static enf_status take_medians(row *row, enf_error *error) {
    double *values = enf_array_new(row->touched.count + row->pair_count, sizeof *values);
    if (!values) return enf_fail_memory(error, "a median");
    for (int c = 0; c < MEASURED; c++) row->column[c] = find_median(&row->touched, c, values);
    row->column[PEAK] = find_median(&row->fresh, PEAK, values);
    row->column[FRESH] = find_median(&row->fresh, TOTAL, values);
    for (int c = SPLIT_CLOCK; c <= SPLIT_GAIN; c++) row->column[c] = find_pair_median(row, c, values);
    free(values);
    return ENF_OK;
}

static enf_status make_row(row *row, const struct world *world, enf_error *error) {
    row->world = world;
    enf_status status = cli_world_make(world->family, world->settings, SETTINGS, &row->file, error);
    if (!status && asprintf(&row->output, "%s.enf", row->file) < 0) {
        row->output = NULL;
        status = enf_fail_memory(error, "a path");
    }
    return status;
}

static void free_row(row *row) {
    cli_world_remove(row->file);
    free(row->output);
    free(row->touched.columns);
    free(row->fresh.columns);
    free(row->pairs);
}

// ---------------------------------------------------------------------------------------------- printing

static void print_head(void) {
    fputs("world", stdout);
    for (int i = 0; i < COLUMN_COUNT; i++) printf(",%s", columns[i].name);
    putchar('\n');
    fflush(stdout);
}

static void print_row(const row *row) {
    fputs(row->world->family, stdout);
    for (int i = 0; i < SETTINGS; i++) printf(" %s", row->world->settings[i]);
    for (int i = 0; i < COLUMN_COUNT; i++) printf(",%.*f", columns[i].digits, row->column[i]);
    putchar('\n');
    fflush(stdout);
}

/// The slope of log time over log polygons, by least squares; NaN for fewer than two sizes.
static double fit_exponent(const row *rows, int count, int column) {
    double x = 0, y = 0, xx = 0, xy = 0;
    for (int i = 0; i < count; i++) {
        double u = log(rows[i].column[POLYGONS]), v = log(rows[i].column[column]);
        x += u, y += v, xx += u * u, xy += u * v;
    }
    return count < 2 ? NAN : (count * xy - x * y) / (count * xx - x * x);
}

static const char *verdict(bool met) {
    return met ? "met" : "MISSED";
}

/// The rows of one family against the bars.
static void judge_family(const table *table, const row *rows, int count) {
    const row *last = &rows[count - 1];
    const char *family = last->world->family;
    double work = fit_exponent(rows, count, TOTAL), all = fit_exponent(rows, count, FRESH);
    if (count < 2)
        printf("%s: one size alone has no exponent\n", family);
    else
        printf("%s: time grows like polygons to the power of %.3f, with what the system takes for memory "
               "%.3f (%d sizes, processor time of one thread); at most %.1f: %s\n",
               family, work, all, count, exponent_most,
               verdict(work <= exponent_most && all <= exponent_most));
    if (last->column[POLYGONS] >= near_million * million)
        printf(
            "%s: %.0f polygons take one core %.1f s (%.1f s with what the system takes for memory); at most "
            "%.0f s: %s\n",
            family, last->column[POLYGONS], last->column[TOTAL], last->column[FRESH], million_seconds,
            verdict(last->column[FRESH] <= million_seconds));
    if (table->threads == 1) return;
    printf("%s: splitting the largest is %.2f times as fast with %d threads as with one; at least %.1f with "
           "two: %s\n",
           family, last->column[SPLIT_GAIN], table->threads, gain_least,
           verdict(last->column[SPLIT_GAIN] >= gain_least));
}

static void judge(const table *table) {
    putchar('\n');
    for (int first = 0, end; first < table->count; first = end) {
        const char *family = table->rows[first].world->family;
        for (end = first; end < table->count && strcmp(table->rows[end].world->family, family) == 0;) end++;
        judge_family(table, table->rows + first, end - first);
    }
}

// ---------------------------------------------------------------------------------------------- the table

static bool is_wanted(const table *table, const struct world *world) {
    return world->polygons <= table->largest &&
           (!table->pattern || fnmatch(table->pattern, world->family, 0) == 0);
}

static enf_status make_worlds(table *table, enf_error *error) {
    enf_status status = ENF_OK;
    for (int i = 0; i < WORLD_COUNT && !status; i++)
        if (is_wanted(table, &worlds[i])) status = make_row(&table->rows[table->count++], &worlds[i], error);
    if (!status && table->count == 0)
        return enf_fail(
            error, ENF_BAD_USAGE,
            "no world is left; --worlds is a glob for office and caverns, --largest 10000 or more");
    return status;
}

static enf_status run_worlds(table *table, enf_error *error) {
    enf_status status = make_worlds(table, error);
    for (int round = 0; round < table->runs && !status; round++)
        for (int i = 0; i < table->count && !status; i++) status = run_round(table, &table->rows[i], error);
    if (!status) print_head();
    for (int i = 0; i < table->count && !status; i++) {
        status = take_medians(&table->rows[i], error);
        if (!status) print_row(&table->rows[i]);
    }
    return status;
}

static enf_status measure_growth(table *table, enf_error *error) {
    table->shared = cli_shared_new(sizeof *table->shared);
    enf_status status = table->shared ? run_worlds(table, error) : enf_fail_memory(error, "a row");
    if (!status) judge(table);
    for (int i = 0; i < table->count; i++) free_row(&table->rows[i]);
    if (table->shared) cli_shared_free(table->shared, sizeof *table->shared);
    return status;
}

int cli_bench_growth(int argc, char **argv) {
    table table = {.threads = 2, .runs = 3, .largest = million, .seconds = 5};
    cli_option options[] = {
        {"--threads", 0, CLI_COUNT, &table.threads, "N",
         "compare one thread with so many; default 2, 1 for none", NULL, false},
        {"--runs", 0, CLI_COUNT, &table.runs, "N", "so many rounds; default 3", NULL, false},
        {"--seconds", 0, CLI_LENGTH, &table.seconds, "S",
         "a round compiles each world again and again for so long; default 5", NULL, false},
        {"--largest", 0, CLI_LENGTH, &table.largest, "N", "only worlds of about N polygons or fewer", NULL,
         false},
        {"--worlds", 0, CLI_TEXT, &table.pattern, "GLOB", "only these: office, caverns", NULL, false},
        {0}};
    const cli_syntax syntax = {
        .command = "enfilade bench growth",
        .usage = "[--threads N] [--runs N] [--seconds S] [--largest N] [--worlds GLOB]",
        .summary =
            "Offices and caverns of about 10^4, 3*10^4, 10^5, 3*10^5 and 10^6 polygons, read, compiled and\n"
            "written on one thread: medians of all runs of all rounds. Stages and total_s are processor\n"
            "seconds; a process has its memory (up to 2 GiB) before they start, but for fresh_total_s\n"
            "and peak_mb. exact_share is of the predicates that only whole numbers could decide.\n"
            "clock_s goes by the clock, and so do split_clock_s and split_clock_N_s: the split stage with\n"
            "one thread and with several, in turn, in a process that has split the world before;\n"
            "split_gain is the median of the ratios of two in a row. CSV, at the end; then, in words, how\n"
            "time grows with the polygons, and whether the bars are met.",
        .options = options};
    cli_texts operands = {0};
    enf_error error = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0) {
        status = measure_growth(&table, &error) ? cli_fail(&error) : ENF_OK;
        if (cli_finish_output()) status = ENF_NO_RESOURCES;
    }
    free(operands.items);
    return status;
}
