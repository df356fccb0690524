// SPDX-License-Identifier: GPL-3.0-or-later
// Views of compiled worlds, with their visible sets, against rays that know triangles only: what a ray hits
// first from its front is in a listed cell, in whose region its pixel is. Eyes are anywhere, or on portals,
// their edges and corners, and next to them; and on what is drawn.
#include "pipeline_fixture.h"

#include "build/write.h"
#include "cli/random.h"
#include "cli/view_check.h"
#include "format/save.h"
#include "visibility/world_pvs.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

static const enf_view_options settings[] = {
    {.size = sizeof(enf_view_options), .rectangles = true},
    {.size = sizeof(enf_view_options), .edges_max = 4},
    {.size = sizeof(enf_view_options), .every_region = true},
    {.size = sizeof(enf_view_options), .edges_max = 99},
    {.size = sizeof(enf_view_options), .without = ENF_VIEW_PVS},
    {.size = sizeof(enf_view_options), .without = ENF_VIEW_FACING | ENF_VIEW_SPHERE},
};

enum { SETTINGS = sizeof settings / sizeof *settings, STEPS = 8 };

/// Weights of a triangle's corners: all on one, on an edge, or anywhere.
static void choose_weights(uint64_t *seed, int kind, double weight[3]) {
    double s = kind > 0 ? cli_random_share(seed) : 0, t = kind > 1 ? cli_random_share(seed) * (1 - s) : 0;
    weight[0] = 1 - s - t;
    weight[1] = s;
    weight[2] = t;
}

static void mix(const double *const corner[3], const double weight[3], double point[3]) {
    for (int a = 0; a < 3; a++)
        point[a] = weight[0] * corner[0][a] + weight[1] * corner[1][a] + weight[2] * corner[2][a];
}

static int32_t choose(uint64_t *seed, int32_t count) {
    return (int32_t)(cli_random_share(seed) * count);
}

/// A point of a portal: a corner, on an edge or inside.
static void choose_on_portal(view_check *check, int kind, double point[3]) {
    const enf_file_view *view = check->view;
    const enf_file_portal_polygon *polygon =
        &view->portal_polygons[choose(&check->seed, view->portal_polygon_count)];
    const double(*v)[3] = view->portal_vertices + polygon->vertex_first;
    int32_t i = choose(&check->seed, polygon->vertex_count), count = polygon->vertex_count;
    double weight[3];
    choose_weights(&check->seed, kind, weight);
    mix((const double *const[3]){v[i], v[(i + 1) % count], v[(i + 2) % count]}, weight, point);
}

/// The same of a triangle.
static void choose_on_wall(view_check *check, int kind, double point[3]) {
    const enf_file_view *view = check->view;
    const enf_file_triangle *triangle = &view->triangles[choose(&check->seed, view->triangle_count)];
    int k = choose(&check->seed, 3);
    const double *corner[3];
    double weight[3];
    for (int i = 0; i < 3; i++) corner[i] = view->render_points[triangle->point[(k + i) % 3]];
    choose_weights(&check->seed, kind, weight);
    mix(corner, weight, point);
}

static enf_world *open_build(enf_build *build) {
    char path[] = "view-XXXXXX";
    enf_build_image image;
    enf_visibility visibility;
    enf_error error = {0};
    enf_world *world = NULL;
    enf_build_options options = pipeline_options();
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    pipeline_build(build, &options);
    enf_status status = enf_build_image_make(&image, build, "{}", &error);
    const enf_visibility_options ladder = {.method = ENF_METHOD_HOURGLASS, .threads = 1};
    if (!status) status = enf_world_pvs_add(&image, &ladder, NULL, &visibility, &error);
    if (!status) status = enf_view_save(&image.view, path, &error);
    if (!status) status = enf_world_open_path(&world, path, NULL, &error);
    remove(path);
    if (status) fail_msg("%s", error.text);
    enf_visibility_free(&visibility);
    enf_build_image_free(&image);
    enf_build_free(build);
    return world;
}

/// Looks from an eye. Returns how many rays missed.
static int64_t check_eye(view_check *check, enf_view *view, const double eye[3], int rays) {
    check_camera look;
    if (!view_check_look(check, eye, &look)) return 0;
    const enf_visible *visible = enf_view_run(view, NULL, &look.camera);
    assert_int_equal(visible->cell, look.place.cell);
    return view_check_rays(check, &look, visible, rays);
}

/// Eyes that go through portals in steps of 1e-6, and one of the steps is exactly on it; and such on corners,
/// edges and faces of what is drawn.
static int64_t check_borders(view_check *check, enf_view *const *views, int passages, int rays) {
    int64_t missed = 0;
    for (int n = 0; n < passages; n++) {
        double point[3], eye[3], step[3];
        enf_view *view = views[n % SETTINGS];
        choose_on_portal(check, n % 3, point);
        for (int a = 0; a < 3; a++) step[a] = 1e-6 * (2 * cli_random_share(&check->seed) - 1);
        for (int k = -STEPS; k <= STEPS; k++) {
            for (int a = 0; a < 3; a++) eye[a] = point[a] + k * step[a];
            missed += check_eye(check, view, eye, rays);
        }
        for (int k = 0; k < STEPS; k++) {
            choose_on_wall(check, k % 3, eye);
            missed += check_eye(check, view, eye, rays);
        }
    }
    return missed;
}

static void check_world(enf_world *world, const char *name, int cameras, int rays) {
    view_check check;
    enf_view *views[SETTINGS];
    const uint64_t seed = 1;
    int64_t missed = 0, cut = 0;
    assert_int_equal(view_check_create(&check, world, seed, NULL), ENF_OK);
    check.talks = true;
    for (int i = 0; i < SETTINGS; i++)
        assert_int_equal(enf_view_create(&views[i], world, &settings[i], NULL), ENF_OK);
    for (int n = 0; n < cameras; n++) {
        check_camera look;
        bool is_in =
            n % 2 ? view_check_on_portal(&check, n / 2 % 5, &look) : view_check_random(&check, &look);
        if (!is_in) continue;
        const enf_visible *visible = enf_view_run(views[n / 10 % SETTINGS], NULL, &look.camera);
        assert_int_equal(visible->cell, look.place.cell);
        cut += visible->entry_count < check.view->cell_count;
        for (int32_t i = 0; n / 10 % SETTINGS == 3 && i < visible->entry_count; i++) // with all their edges
            for (int32_t k = 0; k < visible->entries[i].vertex_count; k++)
                for (int a = 0; a < 2; a++) assert_true(fabs(visible->entries[i].vertices[k][a]) < 1.001);
        missed += view_check_rays(&check, &look, visible, rays);
    }
    int64_t hits = check.hits;
    missed += check_borders(&check, views, cameras / 10, 20);
    assert_true(check.hits - hits > 10 * cameras);
    print_message("%s: seed %" PRIu64 ", %" PRId64 " hits, %" PRId64 " missed\n", name, seed, check.hits,
                  missed);
    assert_true(check.hits > 10 * cameras && missed == 0 && check.unlisted == 0 && cut > 0);
    for (int i = 0; i < SETTINGS; i++) enf_view_free(views[i]);
    view_check_free(&check);
    enf_world_close(world);
}

static void models_miss_nothing(void **state) {
    static const char *const names[] = {"four-rooms", "four-rooms-distorted", "cavern", "furnished", "office",
                                        "post"};
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        enf_build build = {0};
        pipeline_read_model(&build.soup, names[i]);
        check_world(open_build(&build), names[i], 300, 60);
    }
}

static void a_level_misses_nothing(void **state) {
    const char *path = pipeline_shared("quake/obj/end.obj.gz");
    enf_build build = {0};
    enf_error error = {0};
    (void)state;
    if (!path) skip();
    if (enf_soup_read(&build.soup, path, &error)) fail_msg("%s", error.text);
    check_world(open_build(&build), "end", 400, 60);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(models_miss_nothing),
        cmocka_unit_test(a_level_misses_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
