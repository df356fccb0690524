// SPDX-License-Identifier: GPL-3.0-or-later
// enfilade bench run view: time against error of view traversal, per world and setting, and with --check the
// search for rays that hit what is not listed.
#include "base/timer.h"
#include "cli/bench_folder.h"
#include "cli/bench_run.h"
#include "cli/bench_run_worlds.h"
#include "cli/random.h"
#include "cli/view_check.h"

#include <inttypes.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FRAMES = 15, CAMERAS_MOST = 100000 };

#define STRIDE 1e-4 ///< from frame to frame, of the world's width

typedef struct setting {
    const char *name;
    enf_view_options options;
} setting;

static const setting settings[] = {
    {"rect", {.size = sizeof(enf_view_options), .rectangles = true}},
    {"rect, no pvs", {.size = sizeof(enf_view_options), .rectangles = true, .without = ENF_VIEW_PVS}},
    {"4", {.size = sizeof(enf_view_options), .edges_max = 4}},
    {"4, no pvs", {.size = sizeof(enf_view_options), .edges_max = 4, .without = ENF_VIEW_PVS}},
    {"8", {.size = sizeof(enf_view_options), .edges_max = 8}},
    {"8, no pvs", {.size = sizeof(enf_view_options), .edges_max = 8, .without = ENF_VIEW_PVS}},
    {"all", {.size = sizeof(enf_view_options), .edges_max = ENF_VIEW_EDGES_MAX}},
    {"all, no pvs",
     {.size = sizeof(enf_view_options), .edges_max = ENF_VIEW_EDGES_MAX, .without = ENF_VIEW_PVS}},
};

enum { SETTING_COUNT = sizeof settings / sizeof *settings };

typedef struct request {
    double cameras_wanted, rays_wanted, few_wanted; ///< as given
    int cameras, rays, few, seed;
    bool check, talks, stats;
    double seconds;
} request;

typedef struct bench {
    const request *request;
    const char *name;
    view_check check;
    int camera_count;
    check_camera *cameras;
    int32_t *cells_seen, *triangles_seen; ///< per camera, by rays
    bool *cell_marks, *triangle_marks;
} bench;

/// What many rays of one camera hit.
static void see(bench *b, int number) {
    const check_camera *look = &b->cameras[number];
    const enf_file_view *view = b->check.view;
    memset(b->cell_marks, 0, (size_t)view->cell_count);
    memset(b->triangle_marks, 0, (size_t)view->triangle_count);
    for (int n = 0; n < b->request->rays; n++) {
        double d[3], point[3];
        double x = 2 * cli_random_share(&b->check.seed) - 1, y = 2 * cli_random_share(&b->check.seed) - 1;
        view_check_direction(look, x, y, d);
        first_hit hit = first_hit_cast(&b->check.scene, look->camera.eye, d, 0);
        if (hit.triangle < 0 || !hit.front) continue;
        for (int a = 0; a < 3; a++) point[a] = look->camera.eye[a] + (hit.t * (1 - 1e-9)) * d[a];
        int32_t cell = enf_world_locate(b->check.world, point, -1).cell;
        if (cell >= 0) b->cell_marks[cell] = true;
        b->triangle_marks[hit.triangle] = true;
    }
    for (int32_t i = 0; i < view->cell_count; i++) b->cells_seen[number] += b->cell_marks[i];
    for (int32_t i = 0; i < view->triangle_count; i++) b->triangles_seen[number] += b->triangle_marks[i];
}

static int32_t count_triangles(bench *b, const enf_visible *visible) {
    const enf_file_view *view = b->check.view;
    int32_t count = 0;
    memset(b->triangle_marks, 0, (size_t)view->triangle_count);
    for (int32_t i = 0; i < visible->entry_count; i++) {
        const enf_file_cell *cell = &view->cells[visible->entries[i].cell];
        for (int32_t k = 0; k < cell->triangle_count; k++) {
            bool *mark = &b->triangle_marks[view->cell_triangles[cell->triangle_first + k]];
            count += !*mark;
            *mark = true;
        }
    }
    return count;
}

/// What a setting makes of all cameras.
typedef struct sums {
    double listed, triangles, visits;
    int flagged;
    enf_view_stats stats;
    double screens;                         ///< area of the regions
    double *first, *next, *few, *few_first; ///< seconds of each camera
    int few_count;
} sums;

static double find_area(const enf_view_entry *entry) {
    double twice = 0;
    for (int32_t i = 0; i < entry->vertex_count; i++) {
        const double *p = entry->vertices[i], *q = entry->vertices[(i + 1) % entry->vertex_count];
        twice += p[0] * q[1] - p[1] * q[0];
    }
    return twice / 2;
}

static void add_counts(bench *b, const enf_visible *visible, sums *sums) {
    sums->listed += visible->entry_count;
    for (int32_t i = 0; i < visible->entry_count; i++) sums->screens += find_area(&visible->entries[i]) / 4;
    sums->visits += (double)visible->stats.visits;
    sums->flagged += (visible->flags & ~(uint32_t)ENF_VIEW_GROWN) != 0;
    sums->triangles += count_triangles(b, visible);
    for (size_t k = 0; k < sizeof sums->stats / sizeof(int64_t); k++)
        ((int64_t *)&sums->stats)[k] += ((const int64_t *)&visible->stats)[k];
}

/// A step forward, if that is in a cell.
static void walk(const bench *b, const check_camera *look, enf_camera *camera, enf_place *place) {
    double eye[3];
    const enf_file_frame *frame = b->check.view->frame;
    for (int a = 0; a < 3; a++)
        eye[a] = camera->eye[a] + STRIDE * (frame->box_max[0] - frame->box_min[0]) * look->forward[a];
    enf_place next = enf_world_locate(b->check.world, eye, place->tetrahedron);
    if (next.cell < 0) return;
    *place = next;
    memcpy(camera->eye, eye, sizeof eye);
}

/// The first time each camera comes after another one; then it walks on, as from frame to frame.
static void run_camera(bench *b, enf_view *view, int number, sums *sums) {
    const check_camera *look = &b->cameras[number];
    enf_camera camera = look->camera;
    enf_place place = look->place;
    double frames[FRAMES];
    camera.place = &place;
    double started = enf_timer_now();
    const enf_visible *visible = enf_view_run(view, NULL, &camera);
    sums->first[number] = enf_timer_now() - started;
    bool is_few = visible->entry_count <= b->request->few;
    add_counts(b, visible, sums);
    for (int i = 0; i < FRAMES; i++) {
        walk(b, look, &camera, &place);
        started = enf_timer_now();
        enf_view_run(view, NULL, &camera);
        frames[i] = enf_timer_now() - started;
    }
    sums->next[number] = cli_median(frames, FRAMES);
    if (!is_few) return;
    sums->few_first[sums->few_count] = sums->first[number];
    sums->few[sums->few_count++] = sums->next[number];
}

static void print_stats(const enf_view_stats *sum, double n) {
    printf("    portals %.1f pvs %.1f sphere %.1f | polygons %.1f facing %.1f rectangle %.1f polygon %.1f "
           "near %.1f "
           "| passed %.1f contained %.1f joined %.1f grown %.2f edges %.1f\n",
           (double)sum->portals / n, (double)sum->by_pvs / n, (double)sum->by_sphere / n,
           (double)sum->polygons / n, (double)sum->by_facing / n, (double)sum->by_rectangle / n,
           (double)sum->by_polygon / n, (double)sum->near / n, (double)sum->passed / n,
           (double)sum->contained / n, (double)sum->joined / n, (double)sum->grown / n,
           (double)sum->edges_removed / n);
}

static void print_row(const bench *b, const setting *setting, sums *sums) {
    double n = b->camera_count, cells_seen = 0, triangles_seen = 0;
    for (int i = 0; i < b->camera_count; i++) {
        cells_seen += b->cells_seen[i];
        triangles_seen += b->triangles_seen[i];
    }
    size_t few = (size_t)sums->few_count, count = (size_t)b->camera_count;
    printf("%-14s %-12s %7.2f %7.2f %7.2f %7.2f %4zu %7.1f %7.1f %7.1f %6.2f %7.2f %8.1f %7.1f %6.2f %5d\n",
           b->name, setting->name, 1e6 * cli_median(sums->first, count), 1e6 * cli_median(sums->next, count),
           few ? 1e6 * cli_median(sums->few_first, few) : 0, few ? 1e6 * cli_median(sums->few, few) : 0, few,
           sums->visits / n, sums->listed / n, cells_seen / n, sums->listed / cells_seen, sums->screens / n,
           sums->triangles / n, triangles_seen / n, sums->triangles / triangles_seen, sums->flagged);
    if (b->request->stats) print_stats(&sums->stats, n);
    fflush(stdout);
}

static enf_status measure(bench *b, const setting *setting, enf_error *error) {
    enf_view *view = NULL;
    enf_status status = enf_view_create(&view, b->check.world, &setting->options, error);
    if (status) return status;
    size_t count = (size_t)b->camera_count + 1;
    double *times = malloc(4 * count * sizeof *times);
    if (times) {
        sums sums = {
            .first = times, .next = times + count, .few = times + 2 * count, .few_first = times + 3 * count};
        for (int i = 0; i < b->camera_count; i++) run_camera(b, view, i, &sums);
        if (b->camera_count > 0) print_row(b, setting, &sums);
    } else {
        status = enf_fail_memory(error, "a table");
    }
    free(times);
    enf_view_free(view);
    return status;
}

static enf_status make_table(bench *b, enf_error *error) {
    const enf_file_view *view = b->check.view;
    size_t cameras = (size_t)b->request->cameras;
    b->cameras = calloc(cameras, sizeof *b->cameras);
    b->cells_seen = calloc(cameras, sizeof *b->cells_seen);
    b->triangles_seen = calloc(cameras, sizeof *b->triangles_seen);
    b->cell_marks = malloc((size_t)view->cell_count + 1);
    b->triangle_marks = malloc((size_t)view->triangle_count + 1);
    if (!b->cameras || !b->cells_seen || !b->triangles_seen || !b->cell_marks || !b->triangle_marks)
        return enf_fail_memory(error, "a table");
    while (b->camera_count < b->request->cameras &&
           view_check_random(&b->check, &b->cameras[b->camera_count]))
        see(b, b->camera_count++);
    enf_status status = ENF_OK;
    for (int i = 0; i < SETTING_COUNT && !status; i++) status = measure(b, &settings[i], error);
    return status;
}

/// Half of the cameras anywhere, half on portals or next to them.
static enf_status check_world(bench *b, enf_error *error) {
    enf_view *views[SETTING_COUNT] = {0};
    enf_status status = ENF_OK;
    for (int i = 0; i < SETTING_COUNT && !status; i++)
        status = enf_view_create(&views[i], b->check.world, &settings[i].options, error);
    view_check *check = &b->check;
    check->talks = b->request->talks;
    double started = enf_timer_now();
    int made = 0, bad = 0, flagged = 0;
    for (; made < b->request->cameras && !status && enf_timer_now() - started < b->request->seconds; made++) {
        check_camera look;
        bool is_in =
            made % 2 ? view_check_on_portal(check, made / 2 % 5, &look) : view_check_random(check, &look);
        if (!is_in) continue;
        look.camera.place = &look.place;
        const enf_visible *visible = enf_view_run(views[made / 2 % SETTING_COUNT], NULL, &look.camera);
        flagged += (visible->flags & ~(uint32_t)ENF_VIEW_GROWN) != 0;
        bad += view_check_rays(check, &look, visible, b->request->rays) > 0;
    }
    if (!status)
        printf("%-16s %8d %10" PRId64 " %10" PRId64 " %9" PRId64 " %7" PRId64 " %8" PRId64 " %8" PRId64
               " %8" PRId64 " %8" PRId64 " %8d %5d\n",
               b->name, made, check->rays, check->hits, check->backs, check->lost, check->unlisted,
               check->elsewhere + check->seams, check->missed_cells, check->missed_regions, bad, flagged);
    for (int i = 0; i < SETTING_COUNT; i++) enf_view_free(views[i]);
    return status;
}

static enf_status measure_world(const cli_bench_subject *subject, void *user, enf_error *error) {
    const request *request = user;
    bench b = {.request = request, .name = subject->name};
    enf_status status = view_check_create(&b.check, subject->world, (uint64_t)request->seed, error);
    if (!status) status = request->check ? check_world(&b, error) : make_table(&b, error);
    view_check_free(&b.check);
    free(b.cameras);
    free(b.cells_seen);
    free(b.triangles_seen);
    free(b.cell_marks);
    free(b.triangle_marks);
    return status;
}

static void begin(void *user) {
    request *request = user;
    request->cameras = (int)fmax(1, fmin(request->cameras_wanted, CAMERAS_MOST));
    request->rays = (int)fmax(1, fmin(request->rays_wanted, 1e7));
    request->few = (int)fmin(request->few_wanted, 1e9);
    if (request->check)
        printf("%-16s %8s %10s %10s %9s %7s %8s %8s %8s %8s %8s %5s\n", "world", "cameras", "rays", "hits",
               "backs", "lost", "unlisted", "elsewh.", "no cell", "no reg.", "bad cam.", "flags");
    else
        printf("%-14s %-12s %7s %7s %7s %7s %4s %7s %7s %7s %6s %7s %8s %7s %6s %5s\n", "world", "regions",
               "us", "next", "few", "next", "few", "visits", "cells", "hit", "ratio", "screens", "tri.",
               "hit", "ratio", "flags");
}

int cli_bench_run_view(int argc, char **argv) {
    request request = {
        .cameras_wanted = 200, .rays_wanted = 4000, .few_wanted = 20, .seconds = INFINITY, .seed = 1};
    cli_option options[] = {
        {"--check", 0, CLI_FLAG, &request.check, NULL, "look for rays that hit what is not listed", NULL,
         false},
        {"--cameras", 0, CLI_LENGTH, &request.cameras_wanted, "N", "default 200", NULL, false},
        {"--rays", 0, CLI_LENGTH, &request.rays_wanted, "N", "per camera; default 4000", NULL, false},
        {"--few", 0, CLI_LENGTH, &request.few_wanted, "N", "cells, of what counts as few; default 20", NULL,
         false},
        {"--seconds", 0, CLI_SECONDS, &request.seconds, "S", "of --check, at most, per world", NULL, false},
        {"--seed", 0, CLI_COUNT, &request.seed, "N", "of the cameras; default 1", NULL, false},
        {"--talk", 0, CLI_FLAG, &request.talks, NULL, "print each miss", NULL, false},
        {"--stats", 0, CLI_FLAG, &request.stats, NULL, "print what each test spared", NULL, false},
        {0}};
    const cli_bench_table table = {
        .command = "enfilade bench run view",
        .usage = "[--check] [--cameras N] [--rays N] [--few N] [--seconds S] [--seed N] [--talk] [--stats] "
                 "WORLD.enf ...",
        .summary =
            "Median microseconds of a traversal by the shape of regions, from random eyes, tilted: the "
            "first\n"
            "time, after another eye; next, the median of frames while it walks on; both of those cameras\n"
            "that list few cells. Then cells looked at, cells listed, cells with a triangle that rays hit "
            "(the\n"
            "rays find fewer than there are), screens full of regions, and triangles listed and hit. With\n"
            "--check: rays from eyes anywhere and on portals whose first hit is in no listed cell, or "
            "outside\n"
            "its region. Counted apart: unlisted, whose last cell is in view but has not the triangle in "
            "its\n"
            "list; backs, which hit a back first; elsewhere, which begin behind a wall on which the eye is.",
        .options = options,
        .begin = begin,
        .measure = measure_world,
        .user = &request};
    return cli_bench_run_worlds(&table, argc, argv);
}
