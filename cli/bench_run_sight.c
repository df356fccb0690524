// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade bench run sight: nanoseconds per line of sight and per ray, by the portals that they pass. Every
// number is the least of several runs over the same lines, as other work on the machine only adds to it.
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

enum { CLASSES = 10, LINES = 1000, RUNS = 9, TRIES = 400000, PORTALS = 256 };

/// Portals passed, at least; the last class is the lines that a wall stops.
static const int32_t class_least[CLASSES] = {0, 1, 2, 3, 5, 8, 10, 13, 20, INT32_MAX};

typedef struct line {
    enf_sight_query query;
    enf_place from, to;
    double direction[3];
} line;

typedef struct bench {
    const enf_world *world;
    const enf_file_view *view;
    enf_instance *doors; ///< an eighth of them were shut and are open again
    enf_instance *ajar;  ///< an eighth of them are partly open, so far that they let everything through
    uint64_t seed;
    line lines[CLASSES][LINES];
    int count[CLASSES];
} bench;

/// A point in a random cell, if it is in one.
static enf_place choose_point(bench *b, double point[3]) {
    const enf_file_cell *box = &b->view->cells[(int32_t)(cli_random_share(&b->seed) * b->view->cell_count)];
    for (int a = 0; a < 3; a++)
        point[a] = box->box_min[a] + cli_random_share(&b->seed) * (box->box_max[a] - box->box_min[a]);
    return enf_world_locate(b->world, point, -1);
}

/// Towards another cell's point, most of the way to the first wall, or all the way.
static void choose_line(bench *b) {
    line line = {.query = {.size = sizeof line.query}};
    enf_sight_query *query = &line.query;
    enf_sight sight;
    double length = 0, share = cli_random_share(&b->seed);
    line.from = choose_point(b, query->from);
    line.to = choose_point(b, query->to);
    if (line.from.cell < 0 || line.to.cell < 0) return;
    for (int a = 0; a < 3; a++) {
        line.direction[a] = query->to[a] - query->from[a];
        length += line.direction[a] * line.direction[a];
    }
    enf_ray ray = {.size = sizeof ray, .place = &line.from, .length = sqrt(length)};
    enf_ray_hit hit;
    for (int a = 0; a < 3; a++) {
        ray.origin[a] = query->from[a];
        ray.direction[a] = line.direction[a];
    }
    if (enf_ray_cast(b->world, NULL, &ray, &hit, NULL)) return;
    bool stopped = b->count[CLASSES - 1] < LINES && share < 0.1;
    for (int a = 0; a < 3 && !stopped; a++)
        query->to[a] = query->from[a] + (hit.point[a] - query->from[a]) * (1 - 0.1 * share);
    line.to = enf_world_locate(b->world, query->to, line.to.tetrahedron);
    int32_t portals[PORTALS];
    query->portals = portals;
    query->portal_capacity = PORTALS;
    if (enf_sight_between(b->world, NULL, query, &sight, NULL)) return;
    int class = CLASSES - 1;
    while (sight.is_free && class_least[class] > sight.portal_count) class --;
    query->portals = NULL;
    query->portal_capacity = 0;
    if (b->count[class] < LINES) b->lines[class][b->count[class]++] = line;
}

typedef enum question { PLAIN, LOCATED, PORTALS_TOO, DOORS, AJAR, RAY, QUESTIONS } question;

static void ask(const bench *b, const line *line, question question) {
    enf_sight_query query = line->query;
    enf_sight sight;
    int32_t portals[PORTALS];
    if (question == RAY) {
        enf_ray ray = {.size = sizeof ray, .place = &line->from};
        enf_ray_hit hit;
        for (int a = 0; a < 3; a++) {
            ray.origin[a] = query.from[a];
            ray.direction[a] = line->direction[a];
        }
        enf_ray_cast(b->world, NULL, &ray, &hit, NULL);
        return;
    }
    if (question != LOCATED) {
        query.from_place = &line->from;
        query.to_place = &line->to;
    }
    if (question == PORTALS_TOO) {
        query.portals = portals;
        query.portal_capacity = PORTALS;
    }
    const enf_instance *doors = question == DOORS ? b->doors : question == AJAR ? b->ajar : NULL;
    enf_sight_between(b->world, doors, &query, &sight, NULL);
}

/// Nanoseconds a question.
static double measure(const bench *b, int class, question question) {
    double least = INFINITY;
    for (int run = 0; run < RUNS; run++) {
        double begin = enf_timer_now();
        for (int i = 0; i < b->count[class]; i++) ask(b, &b->lines[class][i], question);
        least = fmin(least, enf_timer_now() - begin);
    }
    return least / b->count[class] * 1e9;
}

static void print_class(const bench *b, const char *name, int class) {
    if (b->count[class] < 20) return;
    char range[32] = "stopped";
    if (class < CLASSES - 1) snprintf(range, sizeof range, "%d", class_least[class]);
    if (class < CLASSES - 2 && class_least[class + 1] > class_least[class] + 1)
        snprintf(range, sizeof range, "%d-%d", class_least[class], class_least[class + 1] - 1);
    if (class == CLASSES - 2) snprintf(range, sizeof range, "%d-", class_least[class]);
    printf("%-24s %7d %8s %6d", name, (int)b->view->cell_count, range, b->count[class]);
    for (int question = 0; question < QUESTIONS; question++) printf(" %8.0f", measure(b, class, question));
    putchar('\n');
}

static enf_status measure_world(const cli_bench_subject *subject, void *user, enf_error *error) {
    (void)user;
    bench *b = calloc(1, sizeof *b);
    if (!b) return enf_fail_memory(error, "a table");
    enf_status status = enf_instance_create(&b->doors, subject->world, NULL, error);
    if (!status) status = enf_instance_create(&b->ajar, subject->world, NULL, error);
    if (!status) {
        b->world = subject->world;
        b->view = enf_world_file(subject->world);
        b->seed = 1;
        enf_door open = {.state = ENF_DOOR_OPEN}, shut = {.state = ENF_DOOR_CLOSED},
                 ajar = {ENF_DOOR_PARTLY, {1, 0, 0, 0x1p100}};
        for (int32_t i = 0; i < b->view->portal_count; i += 16) {
            enf_instance_set_door(b->doors, i, &shut, NULL);
            enf_instance_set_door(b->doors, i, &open, NULL);
            enf_instance_set_door(b->ajar, i, &ajar, NULL);
        }
        for (int n = 0; n < TRIES && b->view->cell_count > 0; n++) choose_line(b);
        for (int class = 0; class < CLASSES; class ++) print_class(b, subject->name, class);
    }
    enf_instance_free(b->doors);
    enf_instance_free(b->ajar);
    free(b);
    return status;
}

static void print_head(void *user) {
    (void)user;
    printf("%-24s %7s %8s %6s %8s %8s %8s %8s %8s %8s\n", "world", "cells", "portals", "lines", "plain",
           "located", "listed", "doors", "ajar", "ray");
}

int cli_bench_run_sight(int argc, char **argv) {
    cli_option options[] = {{0}};
    const cli_bench_table table = {
        .command = "enfilade bench run sight",
        .usage = "WORLD.enf ...",
        .summary =
            "Nanoseconds per line of sight between points whose places are known (plain), with both\n"
            "to be found (located), with the portals listed, with an eighth of the portals open again after\n"
            "having been shut (doors), or open partly but not shutting anything (ajar), and per ray\n"
            "without end, by the portals passed.",
        .options = options,
        .begin = print_head,
        .measure = measure_world};
    return cli_bench_run_worlds(&table, argc, argv);
}
