// SPDX-License-Identifier: GPL-3.0-or-later
// The visible sets of compiled worlds: their time against that of the rest of the compile, and what they
// claim against what lines through the fine cells show.
#include "base/timer.h"
#include "build/gen.h"
#include "build/write.h"
#include "cli/bench.h"
#include "cli/bench_folder.h"
#include "cli/bench_pairs.h"
#include "cli/bench_world.h"
#include "cli/cli.h"
#include "cli/job.h"
#include "visibility/world_lines.h"
#include "visibility/world_pvs.h"
#include "visibility/world_views.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { TRIES = 8, VIEWS = 25, RUNS_MOST = 15 };

typedef struct request {
    cli_settings settings;
    int method, runs;
    double lines; ///< at most so many
    int pairs;    ///< of those not seen then, so many are decided
} request;

typedef struct row {
    int32_t cells;
    double rest, pvs;                     ///< seconds by the clock
    int64_t claimed, seen, missed, lines; ///< pairs i < j; lines
    int64_t last;                         ///< pairs that the last whole round found; -1: there was none
    cli_pair_sample sample;
} row;

static int64_t count_missed(const enf_pvs *seen, const enf_pvs *claimed) {
    int64_t count = 0;
    for (int32_t i = 0; i < seen->cell_count; i++)
        for (int32_t j = i + 1; j < seen->cell_count; j++)
            count += enf_pvs_get(seen, i, j) && !enf_pvs_get(claimed, i, j);
    return count;
}

static int64_t count_pairs(const enf_pvs *pvs) {
    return (enf_pvs_pairs(pvs) - pvs->cell_count) / 2;
}

/// When a round finds no more than this of what is seen, no more are thrown.
static const double saturated = 2e-4;

/// Throws lines at what has not been seen yet, round after round; most of them from views.
static enf_status throw_lines(const request *request, const enf_file_view *view, const enf_pvs *claimed,
                              row *row, enf_error *error) {
    enf_world_lines lines = {0};
    enf_world_air air;
    const int64_t most = (int64_t)request->lines;
    enf_status status = enf_world_air_make(&air, view, false, request->settings.threads, error);
    if (!status) status = enf_world_lines_make(&lines, view, 1, error);
    for (int32_t i = 0; !status && i < view->portal_count; i++) // neighbours count as seen
        enf_pvs_set(&lines.seen, view->portals[i].from, view->portals[i].to);
    row->last = -1;
    for (bool goes_on = true; !status && goes_on && lines.count < most;) {
        const int64_t before = count_pairs(&lines.seen);
        bool good = true;
        enf_world_lines_aim(&lines, claimed, TRIES, most);
        enf_world_views_aim(&lines, &air, claimed, VIEWS, most, &good);
        if (!good) status = enf_fail_memory(error, "the views");
        const int64_t now = count_pairs(&lines.seen);
        if (lines.count < most) row->last = now - before;
        goes_on = (double)(now - before) > saturated * (double)now;
    }
    if (!status) {
        row->lines = lines.count;
        row->seen = count_pairs(&lines.seen);
        if (request->pairs > 0)
            status = cli_pairs_sample(&lines, &air, claimed, request->pairs, &row->sample, error);
    }
    if (!status) {
        row->missed = count_missed(&lines.seen, claimed);
    }
    enf_world_lines_free(&lines);
    enf_world_air_free(&air);
    return status;
}

/// An image owns no more than so many arrays: those that have come since are dropped.
static void drop_new(enf_build_image *image, const enf_build_image *before) {
    while (image->owned_count > before->owned_count) free(image->owned[--image->owned_count]);
    image->view = before->view;
}

static enf_status find_sets(const request *request, enf_build_image *image, row *row, enf_error *error) {
    const enf_visibility_options options = {.method = (enf_method)request->method,
                                            .threads = request->settings.threads};
    const enf_build_image before = *image;
    double seconds[RUNS_MOST];
    enf_status status = ENF_OK;
    for (int run = 0; run < request->runs && !status; run++) {
        enf_visibility visibility;
        double started = enf_timer_now();
        status = enf_world_pvs_add(image, &options, NULL, &visibility, error);
        seconds[run] = enf_timer_now() - started;
        if (!status && run + 1 == request->runs) {
            row->claimed = count_pairs(&visibility.pvs);
            status = throw_lines(request, &image->view, &visibility.pvs, row, error);
        }
        enf_visibility_free(&visibility);
        drop_new(image, &before);
    }
    row->pvs = status ? 0 : cli_median(seconds, (size_t)request->runs);
    return status;
}

/// Reads and compiles; the median of several runs is the time. The last image is left.
static enf_status compile(const request *request, const char *path, enf_build_image *image, row *row,
                          enf_error *error) {
    double seconds[RUNS_MOST];
    cli_texts inputs = {0};
    enf_status status = cli_texts_add(&inputs, path) ? ENF_OK : enf_fail_memory(error, "a list");
    for (int run = 0; run < request->runs && !status; run++) {
        cli_job job = {0};
        status = cli_job_prepare(&job, &request->settings, error);
        if (!status) status = cli_job_run(&job, &inputs, NULL, error);
        double started = enf_timer_now();
        if (!status) status = enf_build_write(&job.build, job.options_json, "/dev/null", error);
        seconds[run] = job.seconds + enf_timer_now() - started;
        if (!status && run + 1 == request->runs) {
            status = enf_build_image_make(image, &job.build, job.options_json, error);
            if (!status) row->cells = image->view.cell_count;
            if (!status) status = find_sets(request, image, row, error);
            enf_build_image_free(image);
        }
        cli_job_free(&job);
    }
    row->rest = status ? 0 : cli_median(seconds, (size_t)request->runs);
    free(inputs.items);
    return status;
}

static void print_head(void *user) {
    const request *request = user;
    printf("%-24s %6s %8s %8s %6s %9s %9s %7s %7s %9s %7s", "world", "cells", "rest s", "pvs s", "ratio",
           "pairs", "seen", "excess", "missed", "lines", "last");
    if (request->pairs > 0) printf(" %7s %7s %7s %7s %7s", "sample", "hidden", "open", "about", "at most");
    printf("\n");
}

static double percent(double part, double whole) {
    return whole > 0 ? 100 * part / whole : 0;
}

static void print_row(void *user, const char *name, const void *data) {
    const request *request = user;
    const row *row = data;
    printf("%-24s %6" PRId32 " %8.3f %8.3f %6.2f %9" PRId64 " %9" PRId64 " %6.1f%% %7" PRId64 " %9" PRId64,
           name, row->cells, row->rest, row->pvs, row->pvs / row->rest, row->claimed, row->seen,
           percent((double)(row->claimed - row->seen), (double)row->seen), row->missed, row->lines);
    if (row->last < 0)
        printf(" %7s", "-");
    else
        printf(" %6.2f%%", percent((double)row->last, (double)row->seen));
    if (request->pairs > 0) {
        const cli_pair_sample *sample = &row->sample;
        double about, most;
        cli_pairs_estimate(sample, &about, &most);
        printf(" %7d %7d %7d %6.1f%% %6.1f%%", sample->decided, sample->hidden, sample->open,
               percent(about, (double)row->claimed - about), percent(most, (double)row->claimed - most));
    }
    printf("\n");
    fflush(stdout);
}

static int work(void *user, const char *path, const char *name, void *result) {
    enf_error error = {0};
    enf_build_image image;
    (void)name; // the path says it
    enf_status status = compile(user, path, &image, result, &error);
    return status ? cli_folder_fail(path, &error) : ENF_OK;
}

/// The worlds that `gen` makes, with their own settings.
static int visit_generated(request *request) {
    int status = ENF_OK;
    const char *name;
    print_head(request);
    for (size_t i = 0; (name = enf_gen_list(i, NULL)) != NULL; i++) {
        char *path = NULL;
        enf_error error = {0};
        row row = {0};
        int now = (int)cli_world_make(name, NULL, 0, &path, &error);
        if (now)
            fprintf(stderr, "%s\n", error.text);
        else
            now = work(request, path, name, &row);
        if (!now) print_row(request, name, &row);
        if (now) status = now;
        cli_world_remove(path);
    }
    return status;
}

int cli_bench_worlds(int argc, char **argv) {
    request request = {
        .settings = cli_settings_default(), .method = ENF_METHOD_HOURGLASS, .runs = 3, .lines = 1e7};
    cli_folder folder = {.user = &request,
                         .work = work,
                         .row_size = sizeof(row),
                         .print = print_row,
                         .print_head = print_head};
    cli_option options[] = {{"--method", 0, CLI_CHOICE, &request.method, "METHOD", "default hourglass",
                             cli_pvs_choices + CLI_PVS_METHOD, false},
                            {"--lines", 0, CLI_LENGTH, &request.lines, "N",
                             "at most so many lines a world; default 1e7", NULL, false},
                            {"--pairs", 0, CLI_COUNT, &request.pairs, "N",
                             "so many pairs that no line has seen are decided one by one; default none", NULL,
                             false},
                            {"--runs", 0, CLI_COUNT, &request.runs, "N",
                             "medians over so many runs, at most 15; default 3", NULL, false},
                            CLI_LEVELS_OPTION(folder),
                            CLI_SETTINGS_OPTIONS(request.settings),
                            {0}};
    const cli_syntax syntax = {
        .command = "enfilade bench worlds",
        .usage =
            "[DIR] [--method METHOD] [--lines N] [--pairs N] [--runs N] [--levels GLOB] [options of compile]",
        .summary =
            "The visible sets of each level in a folder, or of the built-in worlds: seconds by the clock of\n"
            "the rest of the compile and of the visible sets; pairs of cells that the sets claim, that "
            "lines\n"
            "have seen, and that were seen but not claimed (missed); excess: claimed, but not seen. Lines "
            "are\n"
            "thrown at pairs not yet seen, at random and from random points through what a view from there\n"
            "leaves open, round after round; last: what the last whole round still found, in shares of all\n"
            "that was seen. With --pairs, random ones of the pairs that are claimed and were not seen are\n"
            "decided, each by a search for a line along all ways from one cell to the other; hidden: there\n"
            "is none; open: the search did not come to an end. What they say of all such pairs makes the\n"
            "excess about so much (what is open taken for hidden), and, with 97.5 % confidence, at most so\n"
            "much.",
        .options = options,
        .operands_min = 0,
        .operands_max = 1,
        .operand = "the folder"};
    cli_texts operands = {0};
    int status = cli_parse(&syntax, argc, argv, &operands);
    if (status < 0) {
        if (request.runs > RUNS_MOST) request.runs = RUNS_MOST;
        if (operands.count > 0) folder.path = operands.items[0];
        status = folder.path ? cli_folder_visit(&folder) : visit_generated(&request);
        if (cli_finish_output()) status = ENF_NO_RESOURCES;
    }
    cli_settings_free(&request.settings);
    free(operands.items);
    return status;
}
