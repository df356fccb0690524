// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade bench run paths: microseconds per path by table and by search, per line, per list of near cells
// and per sound. Every number is the least of several runs over the same random places next to portals, so
// that other work on the machine disturbs little.
#include "base/timer.h"
#include "cli/bench_run.h"
#include "cli/bench_run_worlds.h"
#include "cli/random.h"
#include "enfilade/sound.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PLACES = 400, RUNS = 5, NEAR_CELLS = 32, WAYS = 4 };

typedef struct place {
    int32_t cell;
    double point[3];
} place;

typedef struct bench {
    const enf_world *world;
    const enf_file_view *view;
    enf_instance *instance;
    enf_paths *table, *plain; ///< with and without a table
    enf_path_finder *table_finder, *finder;
    double table_time; ///< of making it, seconds
    place from[PLACES], to[PLACES];
    int32_t *portals;
    double (*points)[3];
    double portal_sum, sweep_sum, way_sum; ///< of the latest run
    int found;
} bench;

static void choose_place(const bench *b, place *p, uint64_t *seed) {
    const enf_file_portal *portal = &b->view->portals[cli_random(seed) % (uint64_t)b->view->portal_count];
    const enf_file_portal_polygon *polygon = &b->view->portal_polygons[portal->polygon_first];
    p->cell = portal->from;
    for (int a = 0; a < 3; a++)
        p->point[a] = b->view->portal_vertices[polygon->vertex_first][a] / 2 +
                      b->view->portal_vertices[polygon->vertex_first + polygon->vertex_count / 2][a] / 2 +
                      portal->radius / 4 * polygon->plane[a];
}

typedef void ask(bench *b, int i);

static void ask_path(bench *b, enf_path_finder *finder, const enf_instance *instance, int i, bool portals,
                     bool line) {
    enf_path_query query = {.size = sizeof query,
                            .from_cell = b->from[i].cell,
                            .to_cell = b->to[i].cell,
                            .from = b->from[i].point,
                            .to = b->to[i].point,
                            .portals = portals ? b->portals : NULL,
                            .portal_capacity = b->view->portal_count,
                            .points = line ? b->points : NULL,
                            .point_capacity = b->view->portal_count + 2};
    enf_path path;
    enf_path_find(finder, instance, &query, &path, NULL);
    b->found += path.is_found;
    b->portal_sum += path.portal_count;
    b->sweep_sum += path.sweeps;
}

static void ask_next(bench *b, int i) {
    ask_path(b, b->table_finder, NULL, i, false, false);
}

static void ask_portals(bench *b, int i) {
    ask_path(b, b->table_finder, NULL, i, true, false);
}

static void ask_search(bench *b, int i) {
    ask_path(b, b->finder, NULL, i, true, false);
}

static void ask_doors(bench *b, int i) {
    ask_path(b, b->finder, b->instance, i, true, false);
}

static void ask_line(bench *b, int i) {
    ask_path(b, b->finder, NULL, i, true, true);
}

static void ask_near(bench *b, int i) {
    enf_near_cell list[NEAR_CELLS];
    int32_t count;
    enf_path_near(b->finder, NULL, b->from[i].cell, b->from[i].point, INFINITY, list, NEAR_CELLS, &count,
                  NULL);
    b->found += count > 0;
}

/// From a place to the cell 8 portals away, or less, on the path; in a range of twice its length.
static void ask_sound(bench *b, int i) {
    enf_sound_path ways[WAYS];
    enf_sound sound;
    enf_sound_query query = {
        .size = sizeof query, .source_cell = b->from[i].cell, .listener_cell = b->to[i].cell};
    for (int a = 0; a < 3; a++) {
        query.source[a] = b->from[i].point[a];
        query.listener[a] = b->to[i].point[a];
        query.range += (query.source[a] - query.listener[a]) * (query.source[a] - query.listener[a]);
    }
    query.range = 2 * sqrt(query.range);
    enf_sound_find(b->finder, NULL, &query, ways, WAYS, &sound, NULL);
    b->way_sum += sound.count;
    b->found += sound.count > 0;
}

/// Microseconds per question.
static double measure_time(bench *b, ask *question) {
    double least = INFINITY;
    for (int run = 0; run < RUNS; run++) {
        b->portal_sum = b->sweep_sum = b->way_sum = b->found = 0;
        double start = enf_timer_now();
        for (int i = 0; i < PLACES; i++) question(b, i);
        least = fmin(least, enf_timer_now() - start);
    }
    return least / PLACES * 1e6;
}

/// Lets sounds be heard at most 8 portals away.
static void come_nearer(bench *b) {
    for (int i = 0; i < PLACES; i++) {
        enf_path_query query = {.size = sizeof query,
                                .from_cell = b->from[i].cell,
                                .to_cell = b->to[i].cell,
                                .from = b->from[i].point,
                                .portals = b->portals,
                                .portal_capacity = b->view->portal_count};
        enf_path path;
        enf_path_find(b->finder, NULL, &query, &path, NULL);
        if (path.portal_count <= 8) continue;
        const enf_file_portal *portal = &b->view->portals[b->portals[7]];
        b->to[i].cell = portal->to;
        memcpy(b->to[i].point, portal->centre, sizeof portal->centre);
    }
}

static void print_row(bench *b, const char *name) {
    enf_paths_info info;
    enf_paths_get_info(b->table, &info);
    printf("%-16s %7" PRId32 " %7" PRId32 " %7" PRId32, name, info.cells, info.junctions, info.gates);
    printf(" %9.1f", (double)info.table_bytes / (1 << 20));
    if (info.has_table)
        printf(" %8.0f %8.2f %8.2f", b->table_time * 1e3, measure_time(b, ask_next),
               measure_time(b, ask_portals));
    else
        printf(" %8s %8s %8s", "-", "-", "-");
    double search = measure_time(b, ask_search), passed = b->found ? b->portal_sum / b->found : 0;
    double doors = measure_time(b, ask_doors), line = measure_time(b, ask_line);
    double sweeps = b->found ? b->sweep_sum / b->found : 0;
    printf(" %8.1f %6.1f %8.1f %8.1f %6.1f", search, passed, doors, line - search, sweeps);
    double near = measure_time(b, ask_near);
    come_nearer(b);
    double sound = measure_time(b, ask_sound);
    printf(" %8.1f %8.1f %5.1f\n", near, sound, b->way_sum / PLACES);
}

static enf_status prepare(bench *b, uint64_t table_size, enf_error *error) {
    enf_paths_options options = {.size = sizeof options, .table_bytes_max = table_size};
    b->view = enf_world_file(b->world);
    double start = enf_timer_now();
    enf_status status = enf_paths_create(&b->table, b->world, &options, error);
    b->table_time = enf_timer_now() - start;
    options.skip_table = true;
    if (!status) status = enf_paths_create(&b->plain, b->world, &options, error);
    if (!status) status = enf_path_finder_create(&b->table_finder, b->table, NULL, error);
    if (!status) status = enf_path_finder_create(&b->finder, b->plain, NULL, error);
    if (!status) status = enf_instance_create(&b->instance, b->world, NULL, error);
    size_t count = (size_t)b->view->portal_count + 2;
    b->portals = malloc(count * sizeof *b->portals);
    b->points = malloc(count * sizeof *b->points);
    if (!status && (!b->portals || !b->points)) status = enf_fail_memory(error, "a path");
    uint64_t seed = 1;
    for (int i = 0; !status && i < PLACES && b->view->portal_count > 0; i++) {
        choose_place(b, &b->from[i], &seed);
        choose_place(b, &b->to[i], &seed);
    }
    for (int32_t i = 0; !status && i < b->view->portal_count; i += 2) // one door in a hundred is closed
        if (cli_random(&seed) % 100 == 0)
            enf_instance_set_door(b->instance, i, &(enf_door){.state = ENF_DOOR_CLOSED}, NULL);
    return status;
}

static void free_bench(bench *b) {
    enf_path_finder_free(b->finder);
    enf_path_finder_free(b->table_finder);
    enf_paths_free(b->plain);
    enf_paths_free(b->table);
    enf_instance_free(b->instance);
    free(b->portals);
    free(b->points);
    free(b);
}

static enf_status measure_world(const cli_bench_subject *subject, void *user, enf_error *error) {
    const uint64_t *table_size = user;
    bench *b = calloc(1, sizeof *b);
    if (!b) return enf_fail_memory(error, "a table");
    b->world = subject->world;
    enf_status status = prepare(b, *table_size, error);
    if (!status && b->view->portal_count > 0) print_row(b, subject->name);
    free_bench(b);
    return status;
}

static void print_head(void *user) {
    (void)user;
    printf(
        "table: MiB, milliseconds to make it; microseconds for the next portal and the length, and for all "
        "portals;\n"
        "search: microseconds, portals passed; with 1%% of doors closed; pulling the line, sweeps;\n"
        "the %d nearest cells; the %d best ways of a sound at most 8 portals away, ways found\n"
        "%-16s %7s %7s %7s %9s %8s %8s %8s %8s %6s %8s %8s %6s %8s %8s %5s\n",
        NEAR_CELLS, WAYS, "world", "cells", "junct.", "gates", "MiB", "ms", "next", "all", "search", "passed",
        "doors", "line", "sweeps", "near", "sound", "ways");
}

int cli_bench_run_paths(int argc, char **argv) {
    uint64_t table_size = UINT64_C(64) << 20;
    cli_option options[] = {
        {"--table", 0, CLI_BYTES, &table_size, "BYTES", "no larger table is made (default: 64M)", NULL,
         false},
        {0},
    };
    const cli_bench_table table = {.command = "enfilade bench run paths",
                                   .usage = "WORLD.enf ... [--table BYTES]",
                                   .summary = "Times paths, lines, near cells and sounds in compiled worlds.",
                                   .options = options,
                                   .begin = print_head,
                                   .measure = measure_world,
                                   .user = &table_size};
    return cli_bench_run_worlds(&table, argc, argv);
}
