// SPDX-License-Identifier: GPL-3.0-or-later
// How time and memory grow with the world, and what a second thread gains. Every run is a process of its own.
// A machine that others share is faster at some times than at others, for seconds or minutes. So the sizes
// take turns, round after round; in a round a small world is compiled again and again for as long as a large
// one takes, so that its median, like the large one's, is of fast and slow moments; and runs with one thread
// and with several alternate. The memory that a run will take is in its heap before the clocks start; what it
// takes is measured by one more run, without that.
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
    SPLIT_CLOCK,
    MEASURED, ///< so many columns come from a run with one thread; the next from one with several
    CLOCK_THREADS = MEASURED,
    SPLIT_CLOCK_THREADS,
    SPLIT_GAIN,
    COLUMN_COUNT
};

static const struct column {
    const char *name;
    int digits; ///< after the point
} columns[COLUMN_COUNT] = {
    {"polygons", 0},    {"tetrahedra", 0}, {"fine_cells", 0},    {"cells", 0},     {"read_s", 3},
    {"clean_s", 3},     {"delaunay_s", 3}, {"split_s", 3},       {"connect_s", 3}, {"colour_s", 3},
    {"decimate_s", 3},  {"portals_s", 3},  {"write_s", 3},       {"total_s", 2},   {"peak_mb", 0},
    {"exact_share", 5}, {"clock_s", 2},    {"split_clock_s", 3}, {"clock_N_s", 2}, {"split_clock_N_s", 3},
    {"split_gain", 2},
};

/// What a child is told, and what it says.
typedef struct run {
    const char *world, *output;
    int threads;
    uint64_t touched; ///< bytes of the heap, before the clocks start
    double column[MEASURED];
    enf_error error;
} run;

/// What all runs of one world with so many threads have said.
typedef struct series {
    double (*columns)[MEASURED]; ///< of each run
    size_t count, capacity;
} series;

typedef struct row {
    const struct world *world;
    char *file, *output; ///< the world, while it is there; what it is compiled to
    series one, several; ///< runs with one thread and with several
    double peak_mb;
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
    column[SPLIT_CLOCK] = build->stages[ENF_STAGE_SPLIT].seconds;
    column[PEAK] = (double)job->write.peak_bytes / 1e6;
    column[EXACT] = enf_complex_tier_share(&build->complex, ENF_TIER_EXACT);
}

/// In the child: what `enfilade compile` does.
static void compile_world(void *shared) {
    run *run = shared;
    cli_settings settings = cli_settings_default();
    settings.threads = run->threads;
    if (run->touched > 0) cli_heap_touch(run->touched);
    cli_job job = {0};
    cli_texts inputs = {0};
    enf_status status = cli_texts_add(&inputs, run->world) ? ENF_OK : enf_fail_memory(&run->error, "a list");
    if (!status) status = cli_job_prepare(&job, &settings, &run->error);
    if (!status) status = cli_job_run(&job, &inputs, NULL, &run->error);
    double started = enf_timer_now(), cpu_started = enf_timer_cpu();
    if (!status) status = enf_build_write(&job.build, job.options_json, run->output, &run->error);
    cli_stage_end(&job.write, started, cpu_started);
    if (!status) take_columns(&job, run->column);
    cli_job_free(&job);
    free(inputs.items);
    cli_settings_free(&settings);
}

static enf_status run_child(run *run, const row *row, int threads, uint64_t touched, enf_error *error) {
    cli_child child;
    memset(run, 0, sizeof *run);
    run->world = row->file;
    run->output = row->output;
    run->threads = threads;
    run->touched = touched;
    enf_status status = cli_child_run(compile_world, run, CHILD_SECONDS, 0, &child, error);
    unlink(run->output);
    if (status) return status;
    if (child.signal) return enf_fail(error, ENF_NO_RESOURCES, "killed by signal %d", child.signal);
    if (run->error.status) *error = run->error;
    return run->error.status;
}

// ---------------------------------------------------------------------------------------------- one world

static enf_status add_run(run *run, series *series, const row *row, int threads, enf_error *error) {
    if (!enf_array_reserve(series->columns, series->capacity, series->count + 1))
        return enf_fail_memory(error, "a run");
    uint64_t touched = (uint64_t)(row->world->polygons * POLYGON_BYTES);
    enf_status status = run_child(run, row, threads, touched, error);
    if (!status) memcpy(series->columns[series->count++], run->column, sizeof run->column);
    return status;
}

/// What a compile takes if nothing was in the heap before it.
static enf_status measure_peak(const table *table, row *row, enf_error *error) {
    enf_status status = run_child(table->shared, row, 1, 0, error);
    row->peak_mb = table->shared->column[PEAK];
    return status;
}

/// A round of one world: runs until `seconds` have passed, one at least.
static enf_status run_round(const table *table, row *row, enf_error *error) {
    enf_status status = row->one.count > 0 ? ENF_OK : measure_peak(table, row, error);
    if (status) return status;
    const double started = enf_timer_now();
    do {
        status = add_run(table->shared, &row->one, row, 1, error);
        if (!status && table->threads > 1)
            status = add_run(table->shared, &row->several, row, table->threads, error);
    } while (!status && enf_timer_now() - started < table->seconds);
    return status;
}

static bool find_median(const series *series, int column, double *median) {
    double *values = enf_array_new(series->count, sizeof *values);
    if (!values) return false;
    for (size_t i = 0; i < series->count; i++) values[i] = series->columns[i][column];
    *median = cli_median(values, series->count);
    free(values);
    return true;
}

static enf_status take_medians(const table *table, row *row, enf_error *error) {
    bool found = true;
    for (int c = 0; c < MEASURED; c++) found = found && find_median(&row->one, c, &row->column[c]);
    row->column[PEAK] = row->peak_mb;
    double *of_several = &row->column[CLOCK_THREADS];
    of_several[0] = of_several[1] = row->column[SPLIT_GAIN] = NAN;
    if (table->threads > 1) {
        found = found && find_median(&row->several, CLOCK, &of_several[0]) &&
                find_median(&row->several, SPLIT_CLOCK, &of_several[1]);
        row->column[SPLIT_GAIN] = row->column[SPLIT_CLOCK] / row->column[SPLIT_CLOCK_THREADS];
    }
    return found ? ENF_OK : enf_fail_memory(error, "a median");
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
    free(row->one.columns);
    free(row->several.columns);
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
static double fit_exponent(const row *rows, int count) {
    double x = 0, y = 0, xx = 0, xy = 0;
    for (int i = 0; i < count; i++) {
        double u = log(rows[i].column[POLYGONS]), v = log(rows[i].column[TOTAL]);
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
    double exponent = fit_exponent(rows, count);
    if (count < 2)
        printf("%s: one size alone has no exponent\n", family);
    else
        printf(
            "%s: time grows like polygons to the power of %.3f (%d sizes, processor time of one thread); at "
            "most %.1f: %s\n",
            family, exponent, count, exponent_most, verdict(exponent <= exponent_most));
    if (last->column[POLYGONS] >= near_million * million)
        printf("%s: %.0f polygons take one core %.1f s (%.1f s by the clock); at most %.0f s: %s\n", family,
               last->column[POLYGONS], last->column[TOTAL], last->column[CLOCK], million_seconds,
               verdict(last->column[TOTAL] <= million_seconds));
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
        status = take_medians(table, &table->rows[i], error);
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
            "written, on one thread and (columns with _N) on several: medians of all runs of all rounds.\n"
            "Stages and total_s are processor seconds of one thread, clock_s and split_clock_s go by the\n"
            "clock; a process has its memory (up to 2 GiB) before they start. exact_share is of the\n"
            "predicates that only whole numbers could decide. CSV, at the end;\n"
            "then, in words, how time grows with the polygons, and whether the bars are met.",
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
