// SPDX-License-Identifier: GPL-3.0-or-later
// Views of worlds of cubes: what a ray passes is listed, with doors, mirrors and portals that lead elsewhere.
// Nonsense in the file, and capacities that run out, end quickly and are reported.
#include "view_scene.h"

#include "run/affine.h"
#include "run/instance.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const enf_view_options shapes[] = {
    {.size = sizeof(enf_view_options), .rectangles = true, .without = ENF_VIEW_PVS},
    {.size = sizeof(enf_view_options), .edges_max = 4, .without = ENF_VIEW_PVS},
    {.size = sizeof(enf_view_options), .without = ENF_VIEW_PVS, .every_region = true},
    {.size = sizeof(enf_view_options), .edges_max = 99, .regions_max = 1, .without = ENF_VIEW_PVS},
    {.size = sizeof(enf_view_options), .regions_max = 2, .without = ENF_VIEW_PVS, .every_region = true},
};

enum { SHAPES = sizeof shapes / sizeof *shapes };

static void check_worlds(uint64_t seed, int worlds, bool doors, bool transforms) {
    scene scene = {0};
    print_message("seed %" PRIu64 "\n", seed);
    for (int w = 0; w < worlds; w++) {
        run_world world = run_world_grid(6 + 2 * (w % 2), w % 3 == 1, run_random(&seed));
        enf_instance *instance = NULL;
        assert_int_equal(enf_instance_create(&instance, world.world, NULL, NULL), ENF_OK);
        scene.world = world.world;
        scene.view = enf_world_file(world.world);
        scene.instance = doors || transforms ? instance : NULL;
        if (doors) scene_set_doors(instance, scene.view, &seed);
        if (transforms) scene_set_transforms(instance, scene.view, &seed);
        for (int s = 0; s < SHAPES; s++) {
            enf_view_options options = shapes[s];
            enf_view *view = NULL;
            options.transforms_max = SCENE_TRANSFORMS;
            assert_int_equal(enf_view_create(&view, world.world, &options, NULL), ENF_OK);
            for (int n = 0; n < 12; n++) {
                double eye[3];
                enf_place place;
                if (scene_eye(&world, &seed, eye, &place)) scene_check(&scene, view, eye, place.cell, &seed);
            }
            enf_view_free(view);
        }
        enf_instance_free(instance);
        run_world_free(&world);
    }
    print_message("%" PRId64 " cells passed by rays, %" PRId64 " missed\n", scene.passed, scene.missed);
    assert_true(scene.passed > 1000 && scene.missed == 0);
}

static void what_a_ray_passes_is_listed(void **state) {
    (void)state;
    check_worlds(1, 6, false, false);
}

static void doors_are_obeyed(void **state) {
    (void)state;
    check_worlds(2, 6, true, false);
}

static void transforms_are_followed(void **state) {
    (void)state;
    check_worlds(3, 8, false, true);
    check_worlds(4, 4, true, true);
}

/// Is a point behind a portal's polygon that leads from one cell to another, and the eye not?
static bool is_behind(const enf_file_view *view, const enf_file_portal_polygon *polygon, const double eye[3],
                      const double point[3], int32_t from, int32_t to) {
    double side = scene_step_off(polygon->plane, point), foot[3];
    for (int a = 0; a < 3; a++) foot[a] = point[a] - side * polygon->plane[a];
    if (side >= 0 || scene_step_off(polygon->plane, eye) < -1e-12 || !scene_is_inside(view, polygon, foot))
        return false;
    for (int32_t k = 0; k < view->portal_count; k++) {
        const enf_file_portal *p = &view->portals[k];
        const enf_file_portal_polygon *first = &view->portal_polygons[p->polygon_first];
        if (p->from == from && p->to == to && polygon >= first && polygon < first + p->polygon_count)
            return true;
    }
    return false;
}

/// An eye on a portal, whose rays begin on either side of it.
static void an_eye_on_a_portal_misses_nothing(void **state) {
    uint64_t seed = 5;
    scene scene = {0};
    (void)state;
    for (int w = 0; w < 4; w++) {
        run_world world = run_world_grid(6, w % 2, run_random(&seed));
        enf_view *view = NULL;
        scene.world = world.world;
        scene.view = enf_world_file(world.world);
        assert_int_equal(enf_view_create(&view, world.world, &shapes[w % SHAPES], NULL), ENF_OK);
        for (int n = 0; n < 200; n++) {
            const enf_file_portal_polygon *polygon =
                &scene.view->portal_polygons[run_random(&seed) % (uint64_t)scene.view->portal_polygon_count];
            const double(*v)[3] = scene.view->portal_vertices + polygon->vertex_first;
            int32_t i = (int32_t)(run_random(&seed) % (uint64_t)polygon->vertex_count);
            const double *a = v[i], *b = v[(i + 1) % polygon->vertex_count],
                         *c = v[(i + 2) % polygon->vertex_count];
            double s = n % 3 == 0 ? 0 : run_random_share(&seed), eye[3];
            double t = n % 3 == 2 ? run_random_share(&seed) * (1 - s) : 0;
            double step = n % 5 ? (n % 5 - 2) * 1e-6 : 0; // through it in small steps
            for (int k = 0; k < 3; k++)
                eye[k] = a[k] + s * (b[k] - a[k]) + t * (c[k] - a[k]) + step * polygon->plane[k];
            enf_camera camera = scene_camera(eye, &seed);
            scene.visible = enf_view_run(view, NULL, &camera);
            for (int r = 0; r < SCENE_RAYS; r++) {
                scene_ray ray = {.x = 2 * run_random_share(&seed) - 1, .y = 2 * run_random_share(&seed) - 1};
                double point[3];
                scene_aim(&camera, ray.x, ray.y, ray.direction);
                memcpy(ray.origin, eye, sizeof eye);
                scene_point_at(&ray, 1e-4, point);
                int32_t cell = enf_world_locate(world.world, point, -1).cell;
                ray.cell = scene.visible->cell;
                // It begins behind the portal? Only what lies straight behind it is free to be seen.
                if (cell != ray.cell && !is_behind(scene.view, polygon, eye, point, ray.cell, cell)) continue;
                ray.cell = cell;
                memcpy(ray.origin, point, sizeof point);
                scene_follow(&scene, ray);
            }
        }
        enf_view_free(view);
        run_world_free(&world);
    }
    print_message("%" PRId64 " cells passed by rays, %" PRId64 " missed\n", scene.passed, scene.missed);
    assert_true(scene.passed > 10000 && scene.missed == 0);
}

/// Entries come after their parents, near ones first, and the spaces are those of the instance's matrices.
static void lists_are_in_order(void **state) {
    uint64_t seed = 6;
    run_world world = run_world_grid(8, false, 3);
    const enf_file_view *file = enf_world_file(world.world);
    enf_instance *instance = NULL;
    enf_view *view = NULL;
    int64_t entries = 0, deep = 0;
    (void)state;
    assert_int_equal(enf_instance_create(&instance, world.world, NULL, NULL), ENF_OK);
    for (int n = 0; n < 10; n++) scene_set_transforms(instance, file, &seed);
    assert_int_equal(enf_view_create(&view, world.world, NULL, NULL), ENF_OK);
    for (int n = 0; n < 200; n++) {
        double eye[3];
        enf_place place;
        if (!scene_eye(&world, &seed, eye, &place)) continue;
        enf_camera camera = scene_camera(eye, &seed);
        const enf_visible *visible = enf_view_run(view, instance, &camera);
        assert_int_equal(visible->cell, place.cell);
        entries += visible->entry_count;
        for (int32_t i = 0; i < visible->entry_count; i++) {
            const enf_view_entry *e = &visible->entries[i];
            const enf_view_space *space = &visible->spaces[e->space];
            assert_true(e->parent < i && (e->parent >= 0) == (i > 0) && (e->portal >= 0) == (i > 0));
            if (i == 0) continue;
            assert_true(e->nearest >= visible->entries[i - 1].nearest);
            assert_true(e->depth >= 1);
            assert_true(e->vertex_count >= 3 && e->vertex_count <= 8);
            deep += space->transforms > 1;
            const double *a = space->to_camera, *b = space->from_camera;
            for (int r = 0; r < 3; r++)
                for (int c = 0; c < 4; c++) {
                    double sum = c == 3 ? a[4 * r + 3] : 0;
                    for (int k = 0; k < 3; k++) sum += a[4 * r + k] * b[4 * k + c];
                    assert_true(fabs(sum - (r == c)) < 1e-9);
                }
            double det = enf_affine_determinant(a);
            assert_true((det < 0) == space->mirrored && fabs(fabs(det) - 1) < 1e-9);
        }
        for (int32_t i = 0; i < visible->entry_count; i++) // merged: no cell twice in a space
            for (int32_t k = 0; k < i; k++)
                assert_false(visible->entries[i].cell == visible->entries[k].cell &&
                             visible->entries[i].space == visible->entries[k].space);
    }
    assert_true(entries > 400 && deep > 20);
    enf_view_free(view);
    enf_instance_free(instance);
    run_world_free(&world);
}

static bool has_cell(const enf_visible *visible, int32_t cell) {
    for (int32_t i = 0; i < visible->entry_count; i++)
        if (visible->entries[i].cell == cell) return true;
    return false;
}

/// Nothing is seen through a door that is shut, and only the open part of one that is ajar: rays through a
/// region, not too near to its border, pass there.
static void doors_hide(void **state) {
    uint64_t seed = 12;
    run_world world = run_world_grid(8, true, 6);
    const enf_file_view *file = enf_world_file(world.world);
    const enf_view_options options = {
        .size = sizeof options, .edges_max = 99, .every_region = true, .without = ENF_VIEW_PVS};
    enf_instance *shut = NULL, *ajar = NULL;
    enf_view *view = NULL;
    int64_t tried = 0;
    (void)state;
    assert_int_equal(enf_instance_create(&shut, world.world, NULL, NULL), ENF_OK);
    assert_int_equal(enf_instance_create(&ajar, world.world, NULL, NULL), ENF_OK);
    assert_int_equal(enf_view_create(&view, world.world, &options, NULL), ENF_OK);
    for (int32_t i = 0; i < file->portal_count; i += 2) {
        enf_door door = {.state = ENF_DOOR_CLOSED};
        assert_int_equal(enf_instance_set_door(shut, i, &door, NULL), ENF_OK);
        door.state = ENF_DOOR_PARTLY;
        scene_direction(&seed, door.plane);
        door.plane[3] = -scene_step_off(door.plane, file->portals[i].centre);
        assert_int_equal(enf_instance_set_door(ajar, i, &door, NULL), ENF_OK);
    }
    for (int n = 0; n < 300; n++) {
        double eye[3];
        enf_place place;
        if (!scene_eye(&world, &seed, eye, &place)) continue;
        enf_camera camera = scene_camera(eye, &seed);
        assert_int_equal(enf_view_run(view, shut, &camera)->entry_count, 1);
        const enf_visible *visible = enf_view_run(view, ajar, &camera);
        if (visible->stats.joined + visible->stats.grown > 0) continue; // larger regions
        for (int32_t i = 0; i < visible->entry_count; i++) {
            const enf_view_entry *e = &visible->entries[i];
            if (e->depth != 1 || file->portals[e->portal].polygon_count > 1) continue;
            const enf_file_portal_polygon *polygon =
                &file->portal_polygons[file->portals[e->portal].polygon_first];
            const double *p = polygon->plane;
            for (int k = 0; k < 20; k++) {
                double shares[2] = {run_random_share(&seed), run_random_share(&seed)}, d[3], hit[3];
                const double *a = e->vertices[0], *b = e->vertices[1 + k % (e->vertex_count - 2)],
                             *c = e->vertices[2 + k % (e->vertex_count - 2)];
                double s = shares[0] * shares[1], t = shares[0] * (1 - shares[1]);
                scene_aim(&camera, a[0] + s * (b[0] - a[0]) + t * (c[0] - a[0]),
                          a[1] + s * (b[1] - a[1]) + t * (c[1] - a[1]), d);
                double along = p[0] * d[0] + p[1] * d[1] + p[2] * d[2], at = -scene_step_off(p, eye) / along;
                for (int x = 0; x < 3; x++) hit[x] = eye[x] + at * d[x];
                enf_passage passage = enf_instance_passage(ajar, file, e->portal);
                assert_true(scene_step_off(passage.plane, hit) >= -1e-4);
                tried++;
            }
        }
    }
    assert_true(tried > 1000);
    enf_view_free(view);
    enf_instance_free(shut);
    enf_instance_free(ajar);
    run_world_free(&world);
}

/// Without an early out the list may be longer, never shorter.
static void early_outs_lose_nothing(void **state) {
    static const uint32_t tests[] = {ENF_VIEW_FACING,  ENF_VIEW_SPHERE, ENF_VIEW_RECTANGLE,
                                     ENF_VIEW_POLYGON, ENF_VIEW_PVS,    31};
    uint64_t seed = 7;
    run_world world = run_world_grid(8, false, 4);
    enf_view *view = NULL;
    (void)state;
    assert_int_equal(enf_view_create(&view, world.world, NULL, NULL), ENF_OK);
    for (size_t t = 0; t < sizeof tests / sizeof *tests; t++) {
        enf_view_options options = {.size = sizeof options, .without = tests[t]};
        enf_view *other = NULL;
        assert_int_equal(enf_view_create(&other, world.world, &options, NULL), ENF_OK);
        for (int n = 0; n < 60; n++) {
            double eye[3];
            enf_place place;
            if (!scene_eye(&world, &seed, eye, &place)) continue;
            enf_camera camera = scene_camera(eye, &seed);
            const enf_visible *with = enf_view_run(view, NULL, &camera);
            const enf_visible *without = enf_view_run(other, NULL, &camera);
            for (int32_t i = 0; i < with->entry_count; i++)
                assert_true(has_cell(without, with->entries[i].cell));
        }
        enf_view_free(other);
    }
    enf_view_free(view);
    run_world_free(&world);
}

static bool refuse_all(void *user, const enf_view_step *step) {
    const enf_file_view *file = user;
    assert_true(step->portal >= 0 && step->portal < file->portal_count && step->depth == 1);
    assert_true(step->pixels > 0 && step->to == file->portals[step->portal].to);
    return false;
}

/// Two mirrors that face each other, limits, decisions, and what can't be done.
static void limits_are_reported(void **state) {
    uint64_t seed = 8;
    run_world world = run_world_grid(8, false, 5);
    const enf_file_view *file = enf_world_file(world.world);
    enf_instance *instance = NULL;
    enf_view *views[6] = {0};
    const enf_view_options options[6] = {
        {.size = sizeof(enf_view_options), .transforms_max = 3},
        {.size = sizeof(enf_view_options), .transforms_max = -1},
        {.size = sizeof(enf_view_options), .visit_capacity = 2},
        {.size = sizeof(enf_view_options), .decide = refuse_all, .user = (void *)(uintptr_t)file},
        {.size = sizeof(enf_view_options), .pixels_min = 1e9},
        {.size = sizeof(enf_view_options), .outside = ENF_VIEW_OUTSIDE_ALL}};
    int deep = 0, overflows = 0;
    (void)state;
    assert_int_equal(enf_instance_create(&instance, world.world, NULL, NULL), ENF_OK);
    for (int32_t i = 0; i < file->portal_count; i++)
        if (file->portals[i].polygon_count == 1) scene_set_mirror(instance, file, i);
    for (int i = 0; i < 6; i++)
        assert_int_equal(enf_view_create(&views[i], world.world, &options[i], NULL), ENF_OK);
    for (int n = 0; n < 100; n++) {
        double eye[3];
        enf_place place;
        if (!scene_eye(&world, &seed, eye, &place)) continue;
        enf_camera camera = scene_camera(eye, &seed);
        const enf_visible *visible = enf_view_run(views[0], instance, &camera);
        for (int32_t i = 0; i < visible->space_count; i++) assert_true(visible->spaces[i].transforms <= 3);
        deep += (visible->flags & ENF_VIEW_DEPTH) != 0;
        visible = enf_view_run(views[1], instance, &camera);
        assert_int_equal(visible->space_count, 1);
        visible = enf_view_run(views[2], NULL, &camera);
        if (visible->flags & ENF_VIEW_OVERFLOW) {
            const enf_visible *whole = enf_view_run(views[5], NULL, &camera);
            for (int32_t i = 0; i < whole->entry_count; i++)
                assert_true(has_cell(visible, whole->entries[i].cell));
            assert_false(visible->flags & ENF_VIEW_INCOMPLETE);
            overflows++;
        }
        for (int i = 3; i < 5; i++) assert_int_equal(enf_view_run(views[i], NULL, &camera)->entry_count, 1);
    }
    assert_true(deep > 10 && overflows > 5);
    double far_away[3] = {1e6, 0, 0};
    enf_camera camera = scene_camera(far_away, &seed);
    const enf_visible *visible = enf_view_run(views[0], NULL, &camera);
    assert_true(visible->flags == ENF_VIEW_OUTSIDE && visible->entry_count == 0 && visible->cell == -1);
    visible = enf_view_run(views[5], NULL, &camera);
    assert_true(visible->flags == ENF_VIEW_OUTSIDE && visible->entry_count == file->cell_count);
    camera.matrix[5] = NAN;
    assert_int_equal(enf_view_run(views[5], NULL, &camera)->flags, ENF_VIEW_NO_CAMERA);
    memset(camera.matrix, 0, sizeof camera.matrix);
    assert_int_equal(enf_view_run(views[5], NULL, &camera)->flags, ENF_VIEW_NO_CAMERA);
    for (int i = 0; i < 6; i++) enf_view_free(views[i]);
    enf_instance_free(instance);
    run_world_free(&world);
}

static void nonsense_options_are_refused(void **state) {
    const enf_view_options nonsense[] = {{.size = sizeof(enf_view_options), .edges_max = 3},
                                         {.size = sizeof(enf_view_options), .edges_max = -1},
                                         {.size = sizeof(enf_view_options), .regions_max = -1},
                                         {.size = sizeof(enf_view_options), .visit_capacity = -1},
                                         {.size = sizeof(enf_view_options), .pixels_min = -1},
                                         {.size = sizeof(enf_view_options), .pixels_min = NAN},
                                         {.size = sizeof(enf_view_options), .outside = (enf_view_outside)9}};
    run_world world = run_world_grid(2, false, 1);
    enf_view *view;
    (void)state;
    for (size_t i = 0; i < sizeof nonsense / sizeof *nonsense; i++) {
        assert_int_equal(enf_view_create(&view, world.world, &nonsense[i], NULL), ENF_BAD_USAGE);
        assert_null(view);
    }
    run_world_free(&world);
}

/// Portals that make no sense: each place is looked at a bounded number of times.
static void nonsense_ends(void **state) {
    uint64_t seed = 9;
    (void)state;
    print_message("seed %" PRIu64 "\n", seed);
    for (int w = 0; w < 8; w++) {
        run_world world = run_world_grid(6, w % 2, run_random(&seed));
        run_world sane = run_world_grid(6, w % 2, run_random(&seed));
        if (w % 4 < 3) run_world_scramble(&world, &seed);
        const enf_file_view *file = enf_world_file(world.world);
        enf_instance *instance = NULL;
        assert_int_equal(enf_instance_create(&instance, world.world, NULL, NULL), ENF_OK);
        for (int32_t i = 0; i < file->portal_count; i += 3) {
            double m[12];
            for (int k = 0; k < 12; k++) m[k] = w % 2 ? 2 * run_random_share(&seed) - 1 : run_nasty(&seed);
            enf_instance_set_transform(instance, i, 0, m, NULL);
        }
        for (int s = 0; s < SHAPES; s++) {
            enf_view_options options = shapes[s];
            enf_view *view = NULL;
            options.without = (uint32_t)(run_random(&seed) % 32);
            assert_int_equal(enf_view_create(&view, world.world, &options, NULL), ENF_OK);
            for (int n = 0; n < 20; n++) {
                double eye[3];
                enf_place place;
                if (!scene_eye(&sane, &seed, eye, &place)) continue;
                enf_camera camera = scene_camera(eye, &seed);
                place.cell = (int32_t)(run_random(&seed) % (uint64_t)file->cell_count);
                camera.place = &place;
                if (n % 4 == 3) camera.matrix[run_random(&seed) % 16] = run_nasty(&seed);
                const enf_visible *visible = enf_view_run(view, n % 2 ? instance : NULL, &camera);
                assert_true(visible->stats.visits <= 16384 * 16);
                for (int32_t i = 0; i < visible->entry_count; i++)
                    assert_true(visible->entries[i].cell >= 0 && visible->entries[i].cell < file->cell_count);
            }
            enf_view_free(view);
        }
        enf_instance_free(instance);
        run_world_free(&sane);
        run_world_free(&world);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_a_ray_passes_is_listed),
        cmocka_unit_test(doors_are_obeyed),
        cmocka_unit_test(doors_hide),
        cmocka_unit_test(transforms_are_followed),
        cmocka_unit_test(an_eye_on_a_portal_misses_nothing),
        cmocka_unit_test(lists_are_in_order),
        cmocka_unit_test(early_outs_lose_nothing),
        cmocka_unit_test(limits_are_reported),
        cmocka_unit_test(nonsense_options_are_refused),
        cmocka_unit_test(nonsense_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
