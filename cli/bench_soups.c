// SPDX-License-Identifier: GPL-3.0-or-later
// The soups that others choke on.
#include "cli/bench.h"
#include "cli/bench_child.h"
#include "cli/cli.h"
#include "cli/options.h"
#include "stress/stress_hard.h"
#include "stress/stress_run.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BOUND_POLYGONS = 600, CHECK_TIMES = 5, POINTS = 200, RUNS_MAX = 99 };

typedef struct settings {
    const char *name; ///< of the only soup, or null
    double limit, weld, megabytes;
    int runs;
} settings;

/// What a child is told, and what it says.
typedef struct row {
    const enf_stress_hard *soup;
    double limit;
    double weld;       ///< < 0: the soup's
    int64_t crossings; ///< -1: not counted
    size_t polygons, counted;
    enf_stress_result result;
} row;

static double limit_of_child; ///< set in the child alone, which has one soup and one thread

static void allow_check(void) {
    cli_child_extend(CHECK_TIMES * limit_of_child);
}

static void count_crossings(void *shared) {
    row *row = shared;
    enf_stress_case made;
    enf_error error = {0};
    if (!enf_stress_hard_make(&made, row->soup, &error)) {
        row->polygons = made.soup.polygon_count;
        row->crossings = enf_stress_count_crossings(&made, BOUND_POLYGONS, row->soup->stretch, &row->counted);
    }
    enf_stress_case_free(&made);
}

static void compile_soup(void *shared) {
    row *row = shared;
    limit_of_child = row->limit;
    const enf_stress_options harness = {.compiled = allow_check, .points = POINTS, .yardstick = true};
    enf_stress_case made;
    enf_error error = {0};
    if (enf_stress_hard_make(&made, row->soup, &error)) {
        row->result.outcome = ENF_STRESS_HARNESS;
        snprintf(row->result.reason, sizeof row->result.reason, "%.300s", error.text);
    } else {
        const enf_build_options options = {
            .clean = {.weld = row->weld >= 0 ? row->weld : made.weld, .plane_tolerance = -1},
            .keep = ENF_KEEP_ALL,
            .threads = 1};
        enf_stress_compile(&made, &options, &harness, &row->result);
    }
    enf_stress_case_free(&made);
}

// ---------------------------------------------------------------------------------------------- printing

static void print_head(void) {
    printf("%-18s %8s %8s %8s %6s %7s %8s %9s %9s %9s  %-20s %6s  %s\n", "soup", "Delaunay", "cells s",
           "all s", "MB", "polys", "tets", "fine", "at least", "about", "peer", "faster", "outcome");
}

/// The bound is of the first polygons; all of them, taken at random, have so many more triples.
static void print_bound(const row *row) {
    if (row->crossings < 0) {
        printf(" %9s %9s", "-", "-");
        return;
    }
    double share = row->counted > 0 ? fmax((double)row->polygons / (double)row->counted, 1) : 1;
    printf(" %9" PRId64 " %9.2g", row->crossings, (double)row->crossings * share * share * share);
}

/// True if the row is as it should be.
static bool print_outcome(const row *row, const cli_child *child) {
    const enf_stress_result *result = &row->result;
    bool compiled = result->seconds > 0;
    if (child->timed_out && !compiled)
        printf("stopped after %.0f s in stage '%s'\n", row->limit, result->stage ? result->stage : "-");
    else if (child->timed_out)
        printf("check was stopped after %.0f s\n", CHECK_TIMES * row->limit);
    else if (child->signal)
        printf("CRASHED in stage '%s', signal %d\n", result->stage ? result->stage : "-", child->signal);
    else if (result->outcome == ENF_STRESS_FINE)
        printf("check holds; %" PRId32 " points, %" PRId32 " segments agree%s", result->verdict.points,
               result->verdict.segments, result->rejected > 0 ? "" : "\n");
    else if (result->outcome == ENF_STRESS_REFUSED)
        printf("refused: %s\n", result->reason);
    else
        printf("%s: %s\n", result->outcome == ENF_STRESS_BROKEN ? "BROKEN" : "WRONG", result->reason);
    bool fine = !child->signal && result->outcome == ENF_STRESS_FINE;
    if (fine && result->rejected > 0) printf("; %" PRId64 " polygons rejected\n", result->rejected);
    return fine || (!child->signal && result->outcome == ENF_STRESS_REFUSED && row->soup->peer_seconds == 0);
}

static bool print_row(const row *row, const cli_child *child) {
    const enf_stress_result *result = &row->result;
    bool compiled = result->seconds > 0;
    double seconds = compiled ? result->seconds : child->cpu_seconds;
    printf("%-18s %8.4f %8.2f %8.2f %6.0f %7" PRId32 " %8" PRId32 " %9" PRId32, row->soup->name,
           result->delaunay_seconds, result->cell_seconds, seconds,
           (double)(compiled ? result->peak_bytes : child->peak_bytes) / 1e6, result->polygons,
           result->tetrahedra, result->fine_cells);
    print_bound(row);
    printf("  %-20s ", row->soup->peer);
    if (compiled && row->soup->peer_seconds > 0) // the peer stops at cells, too
        printf("%5.1fx  ", row->soup->peer_seconds / result->cell_seconds);
    else
        printf("%6s  ", "-");
    bool fine = print_outcome(row, child);
    fflush(stdout);
    return fine;
}

// ---------------------------------------------------------------------------------------------- running

/// What came of a soup once.
typedef struct outcome {
    enf_stress_result result;
    cli_child child;
} outcome;

/// Time to cells, or all of it where it did not get that far.
static double seconds_of(const outcome *outcome) {
    return outcome->result.seconds > 0 ? outcome->result.cell_seconds : outcome->child.cpu_seconds;
}

static int compare_outcomes(const void *a, const void *b) {
    double x = seconds_of(a), y = seconds_of(b);
    return (x > y) - (x < y);
}

static bool is_fine(const outcome *outcome) {
    return !outcome->child.signal && outcome->result.outcome == ENF_STRESS_FINE;
}

/// Several times; the row is of the median time to cells, or of the first run that was not fine.
static enf_status run_soup(row *row, const settings *settings, bool *fine, enf_error *error) {
    outcome outcomes[RUNS_MAX];
    row->crossings = -1;
    enf_status status = ENF_OK;
    int runs = 0;
    if (row->soup->is_generic) status = cli_child_run(count_crossings, row, 60, 0, &outcomes[0].child, error);
    while (!status && runs < settings->runs) {
        memset(&row->result, 0, sizeof row->result);
        status = cli_child_run(compile_soup, row, row->limit, (uint64_t)(settings->megabytes * 1e6),
                               &outcomes[runs].child, error);
        outcomes[runs++].result = row->result;
        if (!is_fine(&outcomes[runs - 1])) break;
    }
    if (status) return status;
    const outcome *shown = &outcomes[runs - 1];
    if (is_fine(shown)) {
        qsort(outcomes, (size_t)runs, sizeof *outcomes, compare_outcomes);
        shown = &outcomes[runs / 2];
    }
    row->result = shown->result;
    *fine = print_row(row, &shown->child);
    return ENF_OK;
}

static int run_soups(const settings *settings) {
    const char *name = settings->name;
    enf_error error = {0};
    enf_status status = ENF_OK;
    bool found = false, all_fine = true;
    row *row = cli_shared_new(sizeof *row);
    if (!row) {
        enf_fail_memory(&error, "a row");
        return cli_fail(&error);
    }
    print_head();
    const enf_stress_hard *soup;
    for (int i = 0; !status && (soup = enf_stress_hard_find(i)); i++) {
        if (name && strcmp(name, soup->name) != 0) continue;
        bool fine = false;
        memset(row, 0, sizeof *row);
        row->soup = soup, row->limit = settings->limit, row->weld = settings->weld;
        found = true;
        status = run_soup(row, settings, &fine, &error);
        all_fine = all_fine && fine;
    }
    cli_shared_free(row, sizeof *row);
    if (!status && !found)
        status =
            enf_fail(&error, ENF_BAD_USAGE, "there is no soup '%.100s'; leave --soup out to see all", name);
    if (status) return cli_fail(&error);
    if (cli_finish_output()) return ENF_NO_RESOURCES;
    return all_fine ? ENF_OK : ENF_CHECK_FAILED;
}

int cli_bench_soups(int argc, char **argv) {
    settings settings = {.limit = 60, .weld = -1, .megabytes = 4096, .runs = 1};
    cli_option options[] = {
        {"--soup", 0, CLI_TEXT, &settings.name, "NAME", "only this one", NULL, false},
        {"--limit", 0, CLI_LENGTH, &settings.limit, "SECONDS",
         "CPU seconds for each; default 60 (and five times as long for check)", NULL, false},
        {"--memory", 0, CLI_LENGTH, &settings.megabytes, "MB", "address space for each; default 4096; 0: any",
         NULL, false},
        {"--weld", 0, CLI_LENGTH, &settings.weld, "D", "instead of the default weld distance", NULL, false},
        {"--runs", 0, CLI_COUNT, &settings.runs, "N", "of each, of which the median is shown; default 1",
         NULL, false},
        {0}};
    const cli_syntax syntax = {
        .command = "enfilade bench soups",
        .usage = "[--soup NAME] [--limit SECONDS] [--memory MB] [--weld D] [--runs N]",
        .summary =
            "Soups that others choke on, made anew: CPU seconds (clean to colour, and all), peak memory, "
            "tetrahedra, fine cells, and\n"
            "what check and the oracles say. \"Delaunay\": CGAL's triangulation of the same vertices alone.\n"
            "\"at least\": crossings of three polygons (of the first 600),\n"
            "each of which takes a cell of its own if nothing is welded; \"about\": the same for all "
            "polygons.",
        .options = options};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status >= 0) return status;
    settings.limit = fmax(settings.limit, 1);
    if (settings.runs < 1 || settings.runs > RUNS_MAX)
        return cli_misuse(&syntax, "--runs: 1 to %d", RUNS_MAX);
    return run_soups(&settings);
}
