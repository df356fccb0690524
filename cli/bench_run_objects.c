// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade bench run objects: nanoseconds per move inside a cell and across a portal, and per sphere query.
// Every number is the least of several runs over the same thousand places, so that other work on the machine
// disturbs little.
#include "base/timer.h"
#include "cli/bench_run.h"
#include "cli/bench_run_worlds.h"
#include "cli/random.h"
#include "enfilade/objects.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { PLACES = 1000, RUNS = 15, TRIES = 1000000 };

/// Two shapes that an object moves to and fro between.
typedef struct swing {
    enf_shape shape[2];
    int32_t cell; ///< of the first
    enf_object object;
} swing;

typedef struct bench {
    const enf_world *world;
    const enf_file_view *view;
    enf_query *query;
    enf_objects *objects;
    double radius;
    uint64_t seed;
    swing inside[PLACES], across[PLACES];
    int inside_count, across_count;
    double cells, triangles; ///< found, per query
} bench;

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/// An eighth of the edge of a cube as large as the middle cell.
static double choose_radius(const enf_file_view *view) {
    double *edges = malloc(((size_t)view->cell_count + 1) * sizeof *edges), radius = 1;
    if (!edges) return radius;
    for (int32_t i = 0; i < view->cell_count; i++) edges[i] = cbrt(fabs(view->cells[i].volume));
    qsort(edges, (size_t)view->cell_count, sizeof *edges, compare_doubles);
    if (view->cell_count > 0) radius = edges[view->cell_count / 2] / 8;
    free(edges);
    return radius;
}

static int32_t cell_count_of(bench *b, const enf_shape *shape, int32_t cell) {
    enf_reach reach;
    enf_query_cells(b->query, NULL, cell, shape, NULL, 0, &reach, NULL);
    return reach.count;
}

/// Places in random cells, so large halls do not take them all, that the object is in no other cell at.
static void choose_inside(bench *b) {
    for (int n = 0; n < TRIES && b->inside_count < PLACES; n++) {
        int32_t cell = (int32_t)(cli_random_share(&b->seed) * b->view->cell_count);
        const enf_file_cell *box = &b->view->cells[cell];
        swing *swing = &b->inside[b->inside_count];
        bool usable = true;
        for (int k = 0; k < 2 && usable; k++) {
            swing->shape[k] = (enf_shape){.kind = ENF_SHAPE_SPHERE, .radius = b->radius};
            for (int a = 0; a < 3; a++) {
                double share = cli_random_share(&b->seed);
                swing->shape[k].centre[a] = k ? swing->shape[0].centre[a] + (share - 0.5) * b->radius / 2
                                              : box->box_min[a] + share * (box->box_max[a] - box->box_min[a]);
            }
            usable = enf_world_locate(b->world, swing->shape[k].centre, -1).cell == cell &&
                     cell_count_of(b, &swing->shape[k], cell) == 1;
        }
        swing->cell = cell;
        b->inside_count += usable;
    }
}

/// From one side of a portal to the other, a little farther than the radius. Not quite straight: exactly on
/// planes of the world, as few things that move are, points are found more slowly.
static void choose_across(bench *b) {
    for (int n = 0; n < TRIES && b->across_count < PLACES && b->view->portal_count > 0; n++) {
        const enf_file_portal *portal =
            &b->view->portals[(int32_t)(cli_random_share(&b->seed) * b->view->portal_count)];
        const enf_file_portal_polygon *polygon = &b->view->portal_polygons[portal->polygon_first];
        swing *swing = &b->across[b->across_count];
        bool usable = true;
        for (int k = 0; k < 2; k++) {
            double side = (k ? -1.25 : 1.25) * b->radius;
            swing->shape[k] = (enf_shape){.kind = ENF_SHAPE_SPHERE, .radius = b->radius};
            for (int a = 0; a < 3; a++)
                swing->shape[k].centre[a] =
                    b->view->portal_vertices[polygon->vertex_first][a] / 2 +
                    b->view->portal_vertices[polygon->vertex_first + polygon->vertex_count / 2][a] / 2 +
                    side * polygon->plane[a] + (cli_random_share(&b->seed) - 0.5) * b->radius / 5;
            usable = usable && enf_world_locate(b->world, swing->shape[k].centre, -1).cell ==
                                   (k ? portal->to : portal->from);
        }
        swing->cell = portal->from;
        b->across_count += usable;
    }
}

static double time_moves(bench *b, swing *swings, int count) {
    double least = INFINITY;
    for (int i = 0; i < count; i++)
        enf_objects_add(b->objects, &swings[i].shape[0], 0, NULL, &swings[i].object, NULL);
    for (int run = 1; run <= RUNS; run++) {
        double start = enf_timer_now();
        for (int i = 0; i < count; i++)
            enf_objects_move(b->objects, swings[i].object, &swings[i].shape[run % 2], NULL);
        least = fmin(least, enf_timer_now() - start);
    }
    for (int i = 0; i < count; i++) enf_objects_remove(b->objects, swings[i].object, NULL);
    return least / count * 1e9;
}

static double time_queries(bench *b, swing *swings, int count, bool with_triangles) {
    double least = INFINITY;
    for (int run = 0; run < RUNS; run++) {
        double start = enf_timer_now();
        b->cells = b->triangles = 0;
        for (int i = 0; i < count; i++) {
            b->cells += cell_count_of(b, &swings[i].shape[0], swings[i].cell);
            if (with_triangles) b->triangles += (double)enf_query_triangles(b->query, NULL, 0);
        }
        least = fmin(least, enf_timer_now() - start);
    }
    b->cells /= count;
    b->triangles /= count;
    return least / count * 1e9;
}

/// Of random places in the list, at three times the radius.
static double time_large(bench *b, double *cells) {
    for (int i = 0; i < b->across_count; i++) b->across[i].shape[0].radius = 3 * b->radius;
    double time = time_queries(b, b->across, b->across_count, false);
    *cells = b->cells;
    return time;
}

static void print_row(bench *b, const char *name) {
    double large_cells, triangle_cells;
    double inside = time_moves(b, b->inside, b->inside_count);
    double across = time_moves(b, b->across, b->across_count);
    double query = time_queries(b, b->inside, b->inside_count, false);
    double triangles = time_queries(b, b->inside, b->inside_count, true);
    triangle_cells = b->triangles;
    double large = time_large(b, &large_cells);
    printf("%-24s %7d %8.3g %9.0f %9.0f %9.0f %9.0f %7.1f %9.0f %6.1f\n", name, (int)b->view->cell_count,
           b->radius, inside, across, query, triangles, triangle_cells, large, large_cells);
}

/// Makes what the questions need; `radius` 0: one that suits the world.
static enf_status prepare(bench *b, const enf_world *world, double radius, enf_error *error) {
    const enf_objects_options options = {
        .size = sizeof options, .objects_max = PLACES, .links_max = 50 * PLACES};
    b->world = world;
    b->view = enf_world_file(world);
    b->radius = radius > 0 ? radius : choose_radius(b->view);
    enf_status status = enf_query_create(&b->query, world, NULL, error);
    return status ? status : enf_objects_create(&b->objects, world, &options, error);
}

static enf_status measure_world(const cli_bench_subject *subject, void *user, enf_error *error) {
    const double *radius = user;
    bench *b = calloc(1, sizeof *b);
    if (!b) return enf_fail_memory(error, "a table");
    enf_status status = prepare(b, subject->world, *radius, error);
    if (!status) {
        choose_inside(b);
        choose_across(b);
        if (b->inside_count > 0 && b->across_count > 0)
            print_row(b, subject->name);
        else
            printf("%-24s no place for objects with a radius of %g\n", subject->name, b->radius);
    }
    enf_objects_free(b->objects);
    enf_query_free(b->query);
    free(b);
    return status;
}

static void print_head(void *user) {
    (void)user;
    printf("nanoseconds per move inside a cell and across a portal, per sphere query for cells, and with "
           "triangles,\n"
           "and per query for cells next to portals with three times the radius\n"
           "%-24s %7s %8s %9s %9s %9s %9s %7s %9s %6s\n",
           "world", "cells", "radius", "inside", "across", "cells", "triangles", "found", "large", "found");
}

int cli_bench_run_objects(int argc, char **argv) {
    double radius = 0;
    cli_option options[] = {
        {"--radius", 0, CLI_LENGTH, &radius, "LENGTH",
         "of the objects (default: an eighth of the middle cell's edge)", NULL, false},
        {0},
    };
    const cli_bench_table table = {.command = "enfilade bench run objects",
                                   .usage = "WORLD.enf ... [--radius LENGTH]",
                                   .summary = "Times moving objects and sphere queries in compiled worlds.",
                                   .options = options,
                                   .begin = print_head,
                                   .measure = measure_world,
                                   .user = &radius};
    return cli_bench_run_worlds(&table, argc, argv);
}
