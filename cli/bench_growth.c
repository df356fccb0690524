// SPDX-License-Identifier: GPL-3.0-or-later
// How time and memory grow with the world, and what a second thread gains: the table, and what it says of the
// bars.
#include "cli/bench_growth.h"
#include "base/array.h"
#include "cli/bench.h"
#include "cli/bench_folder.h"
#include "cli/cli.h"
#include "cli/exponent.h"
#include "cli/options.h"

#include <fnmatch.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROUNDS_DEFAULT = 5 };

/// The bars.
static const double exponent_most = 1.1, million = 1e6, million_seconds = 60, gain_least = 1.6;
static const double near_million = 0.95; ///< so much of a million polygons counts as one

/// The worlds, family by family, by size.
static const cli_growth_world worlds[] = {
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

static const struct column {
    const char *name;
    int digits; ///< after the point
} columns[CLI_GROWTH_COLUMNS] = {
    {"polygons", 0},    {"tetrahedra", 0}, {"fine_cells", 0},    {"cells", 0},         {"read_s", 3},
    {"clean_s", 3},     {"delaunay_s", 3}, {"split_s", 3},       {"connect_s", 3},     {"colour_s", 3},
    {"decimate_s", 3},  {"portals_s", 3},  {"write_s", 3},       {"total_s", 2},       {"peak_mb", 0},
    {"exact_share", 5}, {"clock_s", 2},    {"fresh_total_s", 2}, {"split_clock_s", 3}, {"split_clock_N_s", 3},
    {"split_gain", 2},
};

typedef struct table {
    cli_growth_plan plan;
    double largest;
    const char *pattern; ///< glob for families; null: all
    cli_growth_row rows[WORLD_COUNT];
    int count;
} table;

// ---------------------------------------------------------------------------------------------- printing

static void print_head(void) {
    fputs("world", stdout);
    for (int i = 0; i < CLI_GROWTH_COLUMNS; i++) printf(",%s", columns[i].name);
    putchar('\n');
    fflush(stdout);
}

static void print_row(const cli_growth_row *row) {
    fputs(row->world->family, stdout);
    for (int i = 0; i < CLI_GROWTH_SETTINGS; i++) printf(" %s", row->world->settings[i]);
    for (int i = 0; i < CLI_GROWTH_COLUMNS; i++) printf(",%.*f", columns[i].digits, row->column[i]);
    putchar('\n');
    fflush(stdout);
}

/// The exponents of all rounds, sorted: of time without what the system takes for memory, or with it.
static void fit_rounds(const cli_growth_row *rows, int count, int rounds, bool is_fresh, double *exponents) {
    double sizes[WORLD_COUNT], costs[WORLD_COUNT];
    for (int round = 0; round < rounds; round++) {
        for (int i = 0; i < count; i++) {
            sizes[i] = rows[i].column[CLI_GROWTH_POLYGONS];
            costs[i] = (is_fresh ? &rows[i].fresh : &rows[i].touched)->totals[round];
        }
        exponents[round] = cli_exponent_fit(sizes, costs, (size_t)count);
    }
    cli_median(exponents, (size_t)rounds); // sorts them
}

static const char *verdict(bool met) {
    return met ? "met" : "MISSED";
}

/// How time grows. False without memory.
static bool judge_exponent(const cli_growth_row *rows, int count, int rounds) {
    const char *family = rows->world->family;
    double *exponents = enf_array_new((size_t)rounds, sizeof *exponents);
    for (int is_fresh = 0; exponents && is_fresh < 2; is_fresh++) {
        fit_rounds(rows, count, rounds, is_fresh, exponents);
        const double median = cli_median(exponents, (size_t)rounds);
        printf("%s: time%s grows like polygons to the power of %.3f (%d sizes, processor time of one thread; "
               "rounds: %d, from %.3f to %.3f); at most %.1f: %s\n",
               family, is_fresh ? ", with what the system takes for memory," : "", median, count, rounds,
               exponents[0], exponents[rounds - 1], exponent_most, verdict(median <= exponent_most));
    }
    const bool good = exponents;
    free(exponents);
    return good;
}

/// The rows of one family against the bars. False without memory.
static bool judge_family(const table *table, const cli_growth_row *rows, int count) {
    const cli_growth_row *last = &rows[count - 1];
    const char *family = last->world->family;
    if (count < 2)
        printf("%s: one size alone has no exponent\n", family);
    else if (!judge_exponent(rows, count, table->plan.rounds))
        return false;
    if (last->column[CLI_GROWTH_POLYGONS] >= near_million * million)
        printf(
            "%s: %.0f polygons take one core %.1f s (%.1f s with what the system takes for memory); at most "
            "%.0f s: %s\n",
            family, last->column[CLI_GROWTH_POLYGONS], last->column[CLI_GROWTH_TOTAL],
            last->column[CLI_GROWTH_FRESH], million_seconds,
            verdict(last->column[CLI_GROWTH_FRESH] <= million_seconds));
    if (table->plan.threads == 1) return true;
    printf("%s: splitting the largest is %.2f times as fast with %d threads as with one; at least %.1f with "
           "two: %s\n",
           family, last->column[CLI_GROWTH_SPLIT_GAIN], table->plan.threads, gain_least,
           verdict(last->column[CLI_GROWTH_SPLIT_GAIN] >= gain_least));
    return true;
}

static enf_status judge(const table *table, enf_error *error) {
    bool good = true;
    putchar('\n');
    for (int first = 0, end; good && first < table->count; first = end) {
        const char *family = table->rows[first].world->family;
        for (end = first; end < table->count && strcmp(table->rows[end].world->family, family) == 0;) end++;
        good = judge_family(table, table->rows + first, end - first);
    }
    return good ? ENF_OK : enf_fail_memory(error, "exponents");
}

// ---------------------------------------------------------------------------------------------- the table

static bool is_wanted(const table *table, const cli_growth_world *world) {
    return world->polygons <= table->largest &&
           (!table->pattern || fnmatch(table->pattern, world->family, 0) == 0);
}

static enf_status make_worlds(table *table, enf_error *error) {
    enf_status status = ENF_OK;
    for (int i = 0; i < WORLD_COUNT && !status; i++)
        if (is_wanted(table, &worlds[i]))
            status = cli_growth_row_make(&table->rows[table->count++], &worlds[i], &table->plan, error);
    if (!status && table->count == 0)
        return enf_fail(
            error, ENF_BAD_USAGE,
            "no world is left; --worlds is a glob for office and caverns, --largest 10000 or more");
    return status;
}

static enf_status run_worlds(table *table, enf_error *error) {
    enf_status status = make_worlds(table, error);
    for (int round = 0; round < table->plan.rounds && !status; round++)
        for (int i = 0; i < table->count && !status; i++)
            status = cli_growth_round(&table->plan, &table->rows[i], round, error);
    if (!status) print_head();
    for (int i = 0; i < table->count && !status; i++) {
        status = cli_growth_medians(&table->rows[i], error);
        if (!status) print_row(&table->rows[i]);
    }
    return status;
}

static enf_status measure_growth(table *table, enf_error *error) {
    enf_status status = cli_growth_plan_make(&table->plan, error);
    if (!status) status = run_worlds(table, error);
    if (!status) status = judge(table, error);
    for (int i = 0; i < table->count; i++) cli_growth_row_free(&table->rows[i]);
    cli_growth_plan_free(&table->plan);
    return status;
}

int cli_bench_growth(int argc, char **argv) {
    table table = {.plan = {.threads = 2, .rounds = ROUNDS_DEFAULT, .seconds = 5}, .largest = million};
    cli_option options[] = {
        {"--threads", 0, CLI_COUNT, &table.plan.threads, "N",
         "compare one thread with so many; default 2, 1 for none", NULL, false},
        {"--runs", 0, CLI_COUNT, &table.plan.rounds, "N", "so many rounds; default 5", NULL, false},
        {"--seconds", 0, CLI_LENGTH, &table.plan.seconds, "S",
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
            "time grows with the polygons (the median of the rounds' exponents), and whether the bars are\n"
            "met.",
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
