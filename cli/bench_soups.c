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
#include <string.h>

enum { BOUND_POLYGONS = 600, CHECK_TIMES = 5, POINTS = 200 };

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

static enf_status run_soup(row *row, uint64_t bytes, bool *fine, enf_error *error) {
    cli_child child;
    row->crossings = -1;
    enf_status status = ENF_OK;
    if (row->soup->is_generic) status = cli_child_run(count_crossings, row, 60, 0, &child, error);
    if (!status) status = cli_child_run(compile_soup, row, row->limit, bytes, &child, error);
    if (!status) *fine = print_row(row, &child);
    return status;
}

static int run_soups(const char *name, double limit, double weld, double megabytes) {
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
        row->soup = soup, row->limit = limit, row->weld = weld;
        found = true;
        status = run_soup(row, (uint64_t)(megabytes * 1e6), &fine, &error);
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
    const char *name = NULL;
    double limit = 60, weld = -1, megabytes = 4096;
    cli_option options[] = {
        {"--soup", 0, CLI_TEXT, &name, "NAME", "only this one", NULL, false},
        {"--limit", 0, CLI_LENGTH, &limit, "SECONDS",
         "CPU seconds for each; default 60 (and five times as long for check)", NULL, false},
        {"--memory", 0, CLI_LENGTH, &megabytes, "MB", "address space for each; default 4096; 0: any", NULL,
         false},
        {"--weld", 0, CLI_LENGTH, &weld, "D", "instead of the default weld distance", NULL, false},
        {0}};
    const cli_syntax syntax = {
        .command = "enfilade bench soups",
        .usage = "[--soup NAME] [--limit SECONDS] [--memory MB] [--weld D]",
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
    if (status < 0) status = run_soups(name, fmax(limit, 1), weld, megabytes);
    return status;
}
