// SPDX-License-Identifier: GPL-3.0-or-later
// Objects that come with a view: what a ray of the camera meets, through portals that transform and in
// mirrors, is listed, in a space that carries it to the ray's pixel; what stands in a portal that transforms
// comes out of it; and the list is the one that a plain search makes.
#include "view_scene.h"

#include "enfilade/objects.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { OBJECTS = 60, SEEN_MAX = 4096 };

typedef struct stage {
    run_world world;
    const enf_file_view *file;
    enf_instance *instance;
    enf_view *view;
    enf_query *query;
    enf_objects *objects;
    enf_object handles[OBJECTS]; ///< the last one stands where a ray comes to
    enf_object_seen *seen;
    scene scene;
    const enf_camera *camera;
    int met[SCENE_TRANSFORMS + 1]; ///< by rays, by portals that transform and were passed
    int images, mirrors;           ///< of objects that stood in such portals
} stage;

static void add_random(stage *s, int number, uint64_t *seed) {
    enf_shape shape = {.radius = pow(run_random_share(seed), 3)};
    for (int a = 0; a < 3; a++) {
        double wide = 1.1 * (s->world.box_max[a] - s->world.box_min[a]);
        shape.centre[a] = s->world.box_min[a] + (run_random_share(seed) - 0.05) * wide;
    }
    enf_object *handle = &s->handles[number];
    assert_int_equal(enf_objects_add(s->objects, &shape, (uint64_t)number, NULL, handle, NULL), ENF_OK);
}

static stage make_stage(int side, bool turned, int32_t links_max, bool every_region, uint64_t *seed) {
    stage s = {.world = run_world_grid(side, turned, run_random(seed))};
    const enf_world *world = s.world.world;
    s.file = enf_world_file(world);
    s.seen = calloc(SEEN_MAX, sizeof *s.seen);
    assert_non_null(s.seen);
    enf_view_options looks = {.size = sizeof looks,
                              .transforms_max = SCENE_TRANSFORMS,
                              .visit_capacity = 100000,
                              .without = ENF_VIEW_PVS, // grids have a random one
                              .every_region = every_region};
    enf_objects_options options = {.size = sizeof options, .objects_max = OBJECTS, .links_max = links_max};
    enf_query_options scratch = {.size = sizeof scratch, .skip_triangles = true};
    assert_int_equal(enf_instance_create(&s.instance, world, NULL, NULL), ENF_OK);
    assert_int_equal(enf_view_create(&s.view, world, &looks, NULL), ENF_OK);
    assert_int_equal(enf_query_create(&s.query, world, &scratch, NULL), ENF_OK);
    assert_int_equal(enf_objects_create(&s.objects, world, &options, NULL), ENF_OK);
    for (int i = 0; i < OBJECTS - 1; i++) add_random(&s, i, seed);
    for (int i = 0; i < 20; i++) scene_set_transforms(s.instance, s.file, seed);
    s.scene = (scene){.world = world, .view = s.file, .instance = s.instance, .cut_chains = true};
    return s;
}

static void free_stage(stage *s) {
    enf_objects_free(s->objects);
    enf_query_free(s->query);
    enf_view_free(s->view);
    enf_instance_free(s->instance);
    run_world_free(&s->world);
    free(s->seen);
}

static bool same(enf_object a, enf_object b) {
    return a.slot == b.slot && a.generation == b.generation;
}

/// Where a point of a space is shown.
static void show(const enf_camera *camera, const enf_view_space *space, const double point[3], double xy[2]) {
    double p[3], clip[4];
    for (int i = 0; i < 3; i++) {
        const double *row = space->to_camera + 4 * i;
        p[i] = row[0] * point[0] + row[1] * point[1] + row[2] * point[2] + row[3];
    }
    for (int i = 0; i < 4; i++) {
        const double *row = camera->matrix + 4 * i;
        clip[i] = row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3];
    }
    for (int i = 0; i < 2; i++) xy[i] = clip[i] / clip[3];
}

/// Puts an object where the ray has come to, and looks for it in the ray's space and pixel.
static void put_in_the_way(void *user, const scene_ray *ray, const double point[3]) {
    stage *s = user;
    const enf_visible *visible = s->scene.visible;
    enf_object *handle = &s->handles[OBJECTS - 1];
    enf_shape shape = {.radius = 1e-9};
    memcpy(shape.centre, point, sizeof shape.centre);
    assert_int_equal(enf_objects_add(s->objects, &shape, OBJECTS - 1, NULL, handle, NULL), ENF_OK);
    int32_t count = enf_objects_in_view(s->objects, s->query, s->instance, visible, s->seen, SEEN_MAX),
            found = 0;
    assert_in_range(count, 1, SEEN_MAX);
    for (int32_t i = 0; i < count; i++) {
        const enf_object_seen *seen = &s->seen[i];
        if (!same(seen->object, *handle) || !scene_has_chain(visible, seen->space, ray) || seen->portal >= 0)
            continue;
        double xy[2];
        show(s->camera, &visible->spaces[seen->space], point, xy);
        assert_true(hypot(xy[0] - ray->x, xy[1] - ray->y) < 1e-3);
        found++;
    }
    assert_int_equal(found, 1);
    s->met[ray->chain_count]++;
    assert_int_equal(enf_objects_remove(s->objects, *handle, NULL), ENF_OK);
    *handle = (enf_object){0, 0};
}

/// Moves a point as a portal does. Is it a mirror?
static bool carry(const stage *s, int32_t portal, const double point[3], double carried[3]) {
    double m[12];
    int32_t to;
    assert_true(enf_instance_get_transform(s->instance, portal, &to, m));
    for (int i = 0; i < 3; i++)
        carried[i] = m[4 * i] * point[0] + m[4 * i + 1] * point[1] + m[4 * i + 2] * point[2] + m[4 * i + 3];
    const double volume = m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) +
                          m[2] * (m[4] * m[9] - m[5] * m[8]);
    return to == s->file->portals[portal].from && volume < 0;
}

/// Puts an object where the ray passes a portal that transforms, with its centre before it: behind it, the
/// image is seen in the ray's pixel. Mirrors have none.
static void put_in_the_portal(void *user, const scene_ray *before, double t, const scene_ray *after) {
    stage *s = user;
    const int32_t portal = after->chain[after->chain_count - 1];
    const double *d = before->direction, radius = 1e-3;
    enf_object *handle = &s->handles[OBJECTS - 1];
    enf_shape shape = {.radius = radius};
    double image[3], xy[2];
    scene_point_at(before, t - radius / 2 / sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), shape.centre);
    if (enf_world_locate(s->world.world, shape.centre, -1).cell != before->cell) return; // past an edge
    assert_int_equal(enf_objects_add(s->objects, &shape, OBJECTS - 1, NULL, handle, NULL), ENF_OK);
    const enf_visible *visible = s->scene.visible;
    const int32_t count = enf_objects_in_view(s->objects, s->query, s->instance, visible, s->seen, SEEN_MAX);
    const bool is_mirror = carry(s, portal, shape.centre, image);
    int found = 0;
    assert_in_range(count, 0, SEEN_MAX);
    for (int32_t i = 0; i < count; i++) {
        const enf_object_seen *seen = &s->seen[i];
        if (!same(seen->object, *handle) || seen->portal != portal) continue;
        if (!scene_has_chain(visible, seen->space, after)) continue;
        show(s->camera, &visible->spaces[seen->space], image, xy);
        assert_true(hypot(xy[0] - after->x, xy[1] - after->y) < 1e-3);
        found++;
    }
    assert_int_equal(found, !is_mirror);
    *(is_mirror ? &s->mirrors : &s->images) += 1;
    assert_int_equal(enf_objects_remove(s->objects, *handle, NULL), ENF_OK);
    *handle = (enf_object){0, 0};
}

/// Does a sphere that stands before the portal reach into it, at least as far as its planes tell?
static bool may_reach(const enf_file_view *file, int32_t portal, const enf_shape *shape) {
    const enf_file_portal *p = &file->portals[portal];
    for (int32_t i = 0; i < p->polygon_count; i++) {
        const double height =
            scene_step_off(file->portal_polygons[p->polygon_first + i].plane, shape->centre);
        if (height > -1e-6 && height < shape->radius + 1e-6) return true;
    }
    return false;
}

/// Images come last, each once in a space.
static void check_images(const stage *s, const enf_visible *visible, int32_t first, int32_t count) {
    for (int32_t i = first; i < count; i++) {
        const enf_object_seen *seen = &s->seen[i];
        enf_object_info info;
        double image[3];
        assert_true(seen->portal >= 0);
        assert_false(carry(s, seen->portal, s->file->portals[seen->portal].centre, image));
        assert_true(enf_objects_get(s->objects, seen->object, &info));
        assert_true(may_reach(s->file, seen->portal, &info.shape));
        assert_in_range(seen->entry, 0, visible->entry_count - 1);
        assert_int_equal(visible->entries[seen->entry].space, seen->space);
        for (int32_t k = first; k < i; k++)
            assert_false(same(s->seen[k].object, seen->object) && s->seen[k].portal == seen->portal &&
                         s->seen[k].space == seen->space);
    }
}

/// The first entry of a space with a cell of the object; -1: none.
static int32_t find_entry(const stage *s, const enf_visible *visible, int32_t space, enf_object object) {
    int32_t cells[256], count = enf_objects_cells(s->objects, object, cells, 256);
    assert_in_range(count, 0, 256);
    for (int32_t i = 0; i < visible->entry_count; i++)
        for (int32_t k = 0; visible->entries[i].space == space && k < count; k++)
            if (visible->entries[i].cell == cells[k]) return i;
    return -1;
}

static bool has_entry(const enf_visible *visible, int32_t space) {
    for (int32_t i = 0; i < visible->entry_count; i++)
        if (visible->entries[i].space == space) return true;
    return false;
}

/// Is each object there, once for each of its spaces, in order? Returns how many are behind portals that
/// transform, or everywhere.
static int check_list(const stage *s, const enf_visible *visible) {
    int32_t count = enf_objects_in_view(s->objects, s->query, s->instance, visible, s->seen, SEEN_MAX),
            expected = 0;
    int behind = 0;
    assert_in_range(count, 0, SEEN_MAX);
    for (int32_t space = 0; space < visible->space_count; space++) {
        for (int o = 0; o < OBJECTS; o++) {
            enf_object_info info;
            if (!enf_objects_get(s->objects, s->handles[o], &info)) continue;
            int32_t entry = find_entry(s, visible, space, s->handles[o]), found = 0;
            bool wanted = info.everywhere ? has_entry(visible, space) : entry >= 0;
            for (int32_t i = 0; i < count; i++) {
                if (s->seen[i].space != space || !same(s->seen[i].object, s->handles[o])) continue;
                if (s->seen[i].portal >= 0) continue;
                assert_int_equal(s->seen[i].entry, entry);
                found++;
            }
            assert_int_equal(found, wanted);
            expected += wanted;
            behind += wanted && (space > 0 || info.everywhere);
        }
    }
    assert_true(count >= expected);
    check_images(s, visible, expected, count);
    for (int32_t i = 1; i < expected; i++) {
        const enf_object_seen *seen = &s->seen[i], *before = seen - 1;
        assert_true(before->space <= seen->space);
        if (before->space == seen->space && seen->entry >= 0) assert_in_range(before->entry, 0, seen->entry);
    }
    assert_int_equal(enf_objects_in_view(s->objects, s->query, s->instance, visible, NULL, 0), count);
    if (count == 0) return behind;
    enf_object_seen last = s->seen[count - 1];
    memset(s->seen, 0, (size_t)count * sizeof last);
    assert_int_equal(enf_objects_in_view(s->objects, s->query, s->instance, visible, s->seen, count - 1),
                     count);
    assert_true(s->seen[count - 1].object.slot == 0);
    assert_true(enf_objects_in_view(s->objects, s->query, s->instance, visible, s->seen, count) == count);
    assert_true(same(s->seen[count - 1].object, last.object) && s->seen[count - 1].space == last.space);
    return behind;
}

/// Returns how many objects came from behind portals that transform, or are everywhere.
static int look_around(stage *s, int cameras, uint64_t *seed) {
    int behind = 0;
    s->scene.user = s;
    for (int n = 0; n < cameras; n++) {
        double eye[3];
        enf_place place;
        if (!scene_eye(&s->world, seed, eye, &place)) continue;
        enf_camera camera = scene_camera(eye, seed);
        s->camera = &camera;
        s->scene.visible = enf_view_run(s->view, s->instance, &camera);
        assert_int_equal(s->scene.visible->flags & (ENF_VIEW_OVERFLOW | ENF_VIEW_INCOMPLETE), 0);
        behind += check_list(s, s->scene.visible);
        s->scene.come_to = put_in_the_way;
        s->scene.pass = put_in_the_portal;
        for (int k = 0; k < SCENE_RAYS; k++) {
            scene_ray ray = {
                .cell = place.cell, .x = 2 * run_random_share(seed) - 1, .y = 2 * run_random_share(seed) - 1};
            memcpy(ray.origin, eye, sizeof eye);
            scene_aim(&camera, ray.x, ray.y, ray.direction);
            scene_follow(&s->scene, ray);
        }
    }
    assert_int_equal(s->scene.missed, 0);
    return behind;
}

static void rays_meet_what_is_listed(void **state) {
    (void)state;
    uint64_t seed = 1995;
    print_message("seed %llu\n", (unsigned long long)seed);
    int met[SCENE_TRANSFORMS + 1] = {0}, behind = 0, images = 0, mirrors = 0;
    for (int i = 0; i < 12; i++) {
        stage s = make_stage(6 + i % 2 * 2, i % 3 == 2, 10000, i % 4 == 3, &seed);
        behind += look_around(&s, 60, &seed);
        for (int k = 0; k <= SCENE_TRANSFORMS; k++) met[k] += s.met[k];
        images += s.images;
        mirrors += s.mirrors;
        free_stage(&s);
    }
    print_message("%d %d %d, %d behind, %d in portals, %d in mirrors\n", met[0], met[1], met[2], behind,
                  images, mirrors);
    assert_true(images > 1000 && mirrors > 100);
    assert_true(met[0] > 1000 && met[1] > 1000 && met[2] > 100 && behind > 1000);
}

static void crowded_objects_come_with_every_space(void **state) {
    (void)state;
    uint64_t seed = 7;
    print_message("seed %llu\n", (unsigned long long)seed);
    stage s = make_stage(6, false, 4, false, &seed);
    assert_true(enf_objects_get_use(s.objects).everywhere > 0);
    assert_true(look_around(&s, 40, &seed) > 100);
    free_stage(&s);
}

static void nothing_is_seen_without_cells(void **state) {
    (void)state;
    uint64_t seed = 3;
    stage s = make_stage(4, false, 4, false, &seed);
    const double far_away[3] = {1e6, 0, 0}, bad[3] = {NAN, 0, 0};
    assert_true(enf_objects_get_use(s.objects).everywhere > 0);
    for (int i = 0; i < 2; i++) {
        enf_camera camera = scene_camera(i ? bad : far_away, &seed);
        const enf_visible *visible = enf_view_run(s.view, s.instance, &camera);
        assert_int_equal(visible->entry_count, 0);
        assert_int_equal(enf_objects_in_view(s.objects, s.query, s.instance, visible, s.seen, SEEN_MAX), 0);
    }
    free_stage(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_meet_what_is_listed),
        cmocka_unit_test(crowded_objects_come_with_every_space),
        cmocka_unit_test(nothing_is_seen_without_cells),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
