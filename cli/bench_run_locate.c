// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade bench run locate: nanoseconds per point: found by a search, with the hint of a point nearby, and
// as a step of a moving point. Every number is the least of several runs over the same points.
#include "base/timer.h"
#include "cli/bench_run.h"
#include "cli/bench_run_worlds.h"
#include "cli/random.h"
#include "enfilade/sight.h"

#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 4000, RUNS = 9, TRIES = 10000000, WALK = 32 };

typedef struct spot {
    double at[3], to[3]; ///< a step of a thousandth of the world's size, or less
    enf_place place;
} spot;

typedef struct bench {
    const enf_world *world;
    const enf_file_view *view;
    uint64_t seed;
    spot inside[POINTS], anywhere[POINTS]; ///< in cells; in the world's box
    int count;
} bench;

/// Points all over the box; those in cells until there are enough.
static void choose_spots(bench *b) {
    const enf_file_frame *frame = b->view->frame;
    double size = 0;
    for (int a = 0; a < 3; a++) size = fmax(size, frame->box_max[a] - frame->box_min[a]);
    for (int n = 0; n < TRIES && b->count < POINTS; n++) {
        spot spot;
        for (int a = 0; a < 3; a++) {
            spot.at[a] =
                frame->box_min[a] + cli_random_share(&b->seed) * (frame->box_max[a] - frame->box_min[a]);
            spot.to[a] = spot.at[a] + (cli_random_share(&b->seed) - 0.5) * 1e-3 * size;
        }
        spot.place = enf_world_locate(b->world, spot.at, -1);
        if (n < POINTS) b->anywhere[n] = spot;
        if (spot.place.cell >= 0) b->inside[b->count++] = spot;
    }
}

typedef enum question {
    SEARCH_INSIDE,
    SEARCH_ANYWHERE,
    HINTED_SAME,
    HINTED_NEAR,
    WALKED,
    STEP,
    QUESTIONS
} question;

/// In small steps, each with the hint of the one before.
static void walk(const bench *b, const spot *spot) {
    int32_t hint = spot->place.tetrahedron;
    for (int n = 0; n < WALK; n++) {
        double at[3];
        for (int a = 0; a < 3; a++) at[a] = spot->at[a] + (spot->to[a] - spot->at[a]) * n / WALK;
        enf_place place = enf_world_locate(b->world, at, hint);
        if (place.tetrahedron >= 0) hint = place.tetrahedron;
    }
}

static void ask(const bench *b, int i, question question) {
    const spot *spot = &b->inside[i];
    if (question == SEARCH_INSIDE) enf_world_locate(b->world, spot->at, -1);
    if (question == SEARCH_ANYWHERE) enf_world_locate(b->world, b->anywhere[i].at, -1);
    if (question == HINTED_SAME) enf_world_locate(b->world, spot->at, spot->place.tetrahedron);
    if (question == HINTED_NEAR) enf_world_locate(b->world, spot->to, spot->place.tetrahedron);
    if (question == WALKED) walk(b, spot);
    if (question != STEP) return;
    enf_step step = {.size = sizeof step, .place = spot->place};
    enf_stepped stepped;
    memcpy(step.from, spot->at, sizeof step.from);
    memcpy(step.to, spot->to, sizeof step.to);
    enf_world_follow(b->world, NULL, &step, &stepped, NULL);
}

/// Nanoseconds a question.
static double measure(const bench *b, question question) {
    double least = INFINITY;
    for (int run = 0; run < RUNS; run++) {
        double begin = enf_timer_now();
        for (int i = 0; i < b->count; i++) ask(b, i, question);
        least = fmin(least, enf_timer_now() - begin);
    }
    return least / b->count / (question == WALKED ? WALK : 1) * 1e9;
}

static enf_status measure_world(const cli_bench_subject *subject, void *user, enf_error *error) {
    (void)user;
    bench *b = calloc(1, sizeof *b);
    if (!b) return enf_fail_memory(error, "a table");
    b->world = subject->world;
    b->view = enf_world_file(subject->world);
    b->seed = 1;
    choose_spots(b);
    printf("%-24s %8d %8d %8d", subject->name, (int)b->view->cell_count, (int)b->view->tetrahedron_count,
           (int)b->view->fine_count);
    for (int question = 0; question < QUESTIONS && b->count; question++)
        printf(" %8.0f", measure(b, question));
    putchar('\n');
    free(b);
    return ENF_OK;
}

static void print_head(void *user) {
    (void)user;
    printf("%-24s %8s %8s %8s %8s %8s %8s %8s %8s %8s\n", "world", "cells", "tetra", "fine", "inside",
           "anywhere", "same", "near", "walked", "step");
}

int cli_bench_run_locate(int argc, char **argv) {
    cli_option options[] = {{0}};
    const cli_bench_table table = {
        .command = "enfilade bench run locate",
        .usage = "WORLD.enf ...",
        .summary =
            "Nanoseconds per point: in cells (inside) and all over the world's box (anywhere) without a\n"
            "hint; in cells with its own tetrahedron as the hint (same), a thousandth of the world's size\n"
            "away from where the hint is from (near), on that way in 32 steps, each with the hint of the\n"
            "one before (walked), and on it as one step of a moving point (step).",
        .options = options,
        .begin = print_head,
        .measure = measure_world};
    return cli_bench_run_worlds(&table, argc, argv);
}
