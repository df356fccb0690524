// SPDX-License-Identifier: GPL-3.0-or-later
// Views of worlds of cubes, whose rays are easy to follow by other means: from cube to cube. What a ray
// passes must be listed, in a region that has the ray's pixel; with doors, mirrors and portals that lead
// elsewhere. Nonsense in the file, and capacities that run out, end quickly and are reported.
#include "run_worlds.h"
#include "world_fixture.h"

#include "enfilade/view.h"
#include "format/frame.h"
#include "run/instance.h"
#include "run/view_clip.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { RAYS = 60, STEPS = 400, TRANSFORMS = 2, CHAIN = 8 };

static const double tiny = 1e-9; ///< grid steps: rays that pass nearer to a border are nobody's

// --- Following rays
// ------------------------------------------------------------------------------------------

typedef struct ray {
    double origin[3], direction[3]; ///< world, as transforms have it
    double x, y;                    ///< of the screen
    int32_t cell;
    int32_t chain[CHAIN], chain_count; ///< portals that transform, passed
} ray;

typedef struct scene {
    const enf_world *world;
    const enf_file_view *view;
    const enf_instance *instance;
    const enf_visible *visible;
    int64_t passed, missed;
    bool cut_chains; ///< stop at TRANSFORMS of them
} scene;

static bool covers(const enf_view_entry *entry, double x, double y) {
    const double slack = 1e-4, *r = entry->rectangle;
    if (x < r[0] - slack || x > r[2] + slack || y < r[1] - slack || y > r[3] + slack) return false;
    for (int32_t i = 0; i < entry->vertex_count; i++) {
        const double *from = entry->vertices[i], *to = entry->vertices[(i + 1) % entry->vertex_count];
        double u = to[0] - from[0], v = to[1] - from[1];
        if (u * (y - from[1]) - v * (x - from[0]) < -slack * hypot(u, v) - 1e-12) return false;
    }
    return true;
}

static bool has_chain(const enf_visible *visible, int32_t space, const ray *ray) {
    for (int32_t i = ray->chain_count; i-- > 0; space = visible->spaces[space].parent)
        if (space <= 0 || visible->spaces[space].portal != ray->chain[i]) return false;
    return space == 0;
}

/// Is the ray's cell listed with the ray's pixel?
static void expect(scene *scene, const ray *ray) {
    scene->passed++;
    for (int32_t i = 0; i < scene->visible->entry_count; i++) {
        const enf_view_entry *entry = &scene->visible->entries[i];
        if (entry->cell == ray->cell && has_chain(scene->visible, entry->space, ray) &&
            covers(entry, ray->x, ray->y))
            return;
    }
    scene->missed++;
}

static bool is_inside(const enf_file_view *view, const enf_file_portal_polygon *polygon, const double p[3]) {
    const double(*v)[3] = view->portal_vertices + polygon->vertex_first, *n = polygon->plane;
    for (int32_t i = 0; i < polygon->vertex_count; i++) {
        const double *a = v[i], *b = v[(i + 1) % polygon->vertex_count];
        double side = 0;
        for (int k = 0; k < 3; k++) {
            int s = (k + 1) % 3, t = (k + 2) % 3;
            side += n[k] * ((b[s] - a[s]) * (p[t] - a[t]) - (b[t] - a[t]) * (p[s] - a[s]));
        }
        if (side < 1e-7) return false;
    }
    return fabs(n[0] * p[0] + n[1] * p[1] + n[2] * p[2] + n[3]) < 1e-7;
}

static double step_off(const double plane[4], const double p[3]) {
    return plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] + plane[3];
}

/// The portal through which the ray leaves at a point; -1: a wall.
static int32_t find_portal(const scene *scene, const ray *ray, const double point[3], enf_passage *passage) {
    const enf_file_cell *cell = &scene->view->cells[ray->cell];
    for (int32_t i = 0; i < cell->portal_count; i++) {
        int32_t number = scene->view->cell_portals[cell->portal_first + i];
        const enf_file_portal *portal = &scene->view->portals[number];
        for (int32_t k = 0; k < portal->polygon_count; k++) {
            const enf_file_portal_polygon *polygon = &scene->view->portal_polygons[portal->polygon_first + k];
            double along = polygon->plane[0] * ray->direction[0] + polygon->plane[1] * ray->direction[1] +
                           polygon->plane[2] * ray->direction[2];
            if (along >= 0 || !is_inside(scene->view, polygon, point)) continue;
            *passage = enf_instance_passage(scene->instance, scene->view, number);
            if (passage->cut && step_off(passage->plane, point) < 1e-7) return -1;
            return passage->to < 0 ? -1 : number;
        }
    }
    return -1;
}

static void transform(ray *ray, const double m[12]) {
    double o[3], d[3];
    for (int i = 0; i < 3; i++) {
        const double *row = m + 4 * i;
        o[i] = row[0] * ray->origin[0] + row[1] * ray->origin[1] + row[2] * ray->origin[2] + row[3];
        d[i] = row[0] * ray->direction[0] + row[1] * ray->direction[1] + row[2] * ray->direction[2];
    }
    memcpy(ray->origin, o, sizeof o);
    memcpy(ray->direction, d, sizeof d);
}

static void point_at(const ray *ray, double t, double point[3]) {
    for (int a = 0; a < 3; a++) point[a] = ray->origin[a] + t * ray->direction[a];
}

/// Where the ray leaves the cube that it is in after `t`.
static double leave_cube(const scene *scene, const ray *ray, double t) {
    double next[3], origin[3], end[3], least = INFINITY;
    point_at(ray, 1, next);
    enf_view_to_grid(scene->view, ray->origin, origin);
    enf_view_to_grid(scene->view, next, end);
    for (int a = 0; a < 3; a++) {
        double d = end[a] - origin[a];
        if (fabs(d) < 1e-6) continue;
        double at = origin[a] + t * d, face = at / FIXTURE_SPACING + (d > 0 ? tiny : -tiny);
        face = FIXTURE_SPACING * (d > 0 ? floor(face) + 1 : ceil(face) - 1);
        least = fmin(least, (face - origin[a]) / d);
    }
    return least;
}

/// From cube to cube until a wall.
static void follow(scene *scene, ray ray) {
    double t = 0;
    expect(scene, &ray);
    for (int n = 0; n < STEPS; n++) {
        double point[3], beyond[3];
        enf_passage passage;
        t = leave_cube(scene, &ray, t);
        point_at(&ray, t, point);
        point_at(&ray, t + 1e-6, beyond);
        enf_place place = enf_world_locate(scene->world, beyond, -1);
        int32_t portal = find_portal(scene, &ray, point, &passage);
        if (portal < 0 && place.cell != ray.cell) return;
        if (portal < 0) continue;
        ray.cell = passage.to;
        if (passage.matrix) {
            if (ray.chain_count == TRANSFORMS) return;
            ray.chain[ray.chain_count++] = portal;
            transform(&ray, passage.matrix);
            point_at(&ray, t + 1e-6, beyond);
            place = enf_world_locate(scene->world, beyond, -1);
        }
        if (place.cell != ray.cell) return; // past an edge of cubes
        expect(scene, &ray);
    }
}

// --- Cameras
// -------------------------------------------------------------------------------------------------

static void random_direction(uint64_t *seed, double direction[3]) {
    double square;
    do {
        square = 0;
        for (int a = 0; a < 3; a++) {
            direction[a] = 2 * run_random_share(seed) - 1;
            square += direction[a] * direction[a];
        }
    } while (square > 1 || square < 0.01);
    for (int a = 0; a < 3; a++) direction[a] /= sqrt(square);
}

static enf_camera random_camera(const double eye[3], uint64_t *seed) {
    double forward[3], up[3];
    do {
        random_direction(seed, forward);
        random_direction(seed, up);
    } while (fabs(forward[0] * up[0] + forward[1] * up[1] + forward[2] * up[2]) > 0.9);
    return enf_camera_look(eye, forward, up, 1.2, 1.5);
}

/// The direction of a pixel: what the matrix takes to (x, y, 1).
static void aim(const enf_camera *camera, double x, double y, double direction[3]) {
    double m[3][4];
    for (int i = 0; i < 3; i++) {
        memcpy(m[i], camera->matrix + (i == 2 ? 12 : 4 * i), 3 * sizeof(double));
        m[i][3] = i == 0 ? x : i == 1 ? y : 1;
    }
    for (int i = 0; i < 3; i++) { // Gauss, with the largest pivot
        int best = i;
        for (int k = i + 1; k < 3; k++)
            if (fabs(m[k][i]) > fabs(m[best][i])) best = k;
        for (int k = 0; k < 4; k++) {
            double swap = m[i][k];
            m[i][k] = m[best][k];
            m[best][k] = swap;
        }
        for (int r = 0; r < 3; r++) {
            double share = r == i ? 0 : m[r][i] / m[i][i];
            for (int k = 0; k < 4; k++) m[r][k] -= share * m[i][k];
        }
    }
    for (int i = 0; i < 3; i++) direction[i] = m[i][3] / m[i][i];
}

static bool random_eye(const run_world *world, uint64_t *seed, double eye[3], enf_place *place) {
    for (int n = 0; n < 100; n++) {
        for (int a = 0; a < 3; a++)
            eye[a] = world->box_min[a] + run_random_share(seed) * (world->box_max[a] - world->box_min[a]);
        *place = enf_world_locate(world->world, eye, -1);
        if (place->cell >= 0) return true;
    }
    return false;
}

static void check_view(scene *scene, enf_view *view, const double eye[3], int32_t cell, uint64_t *seed) {
    enf_camera camera = random_camera(eye, seed);
    scene->visible = enf_view_run(view, scene->instance, &camera);
    if (scene->visible->flags & (ENF_VIEW_OVERFLOW | ENF_VIEW_INCOMPLETE)) fail_msg("capacity ran out");
    for (int n = 0; n < RAYS; n++) {
        ray ray = {.cell = cell, .x = 2 * run_random_share(seed) - 1, .y = 2 * run_random_share(seed) - 1};
        memcpy(ray.origin, eye, sizeof ray.origin);
        aim(&camera, ray.x, ray.y, ray.direction);
        follow(scene, ray);
    }
}

// --- Instances
// -----------------------------------------------------------------------------------------------

/// A third of the doors closed, a third ajar.
static void set_doors(enf_instance *instance, const enf_file_view *view, uint64_t *seed) {
    for (int32_t i = 0; i < view->portal_count; i += 2) {
        enf_door door = {.state = (enf_door_state)(run_random(seed) % 3)};
        random_direction(seed, door.plane);
        const double *c = view->portals[i].centre, *p = door.plane;
        door.plane[3] = -(p[0] * c[0] + p[1] * c[1] + p[2] * c[2]);
        assert_int_equal(enf_instance_set_door(instance, i, &door, NULL), ENF_OK);
    }
}

/// A reflection in the plane of a portal that is flat.
static void set_mirror(enf_instance *instance, const enf_file_view *view, int32_t portal) {
    const double *p = view->portal_polygons[view->portals[portal].polygon_first].plane;
    double m[12];
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 4; k++) m[4 * i + k] = (i == k) - 2 * p[i] * p[k];
    assert_int_equal(enf_instance_set_transform(instance, portal, view->portals[portal].from, m, NULL),
                     ENF_OK);
}

/// What enters one portal leaves by another: a rotation that turns planes and centres onto each other, with a
/// random turn about the normal.
static void set_link(enf_instance *instance, const enf_file_view *view, int32_t from, int32_t to,
                     uint64_t *seed) {
    const enf_file_portal *a = &view->portals[from], *b = &view->portals[to];
    const double *planes[2] = {view->portal_polygons[a->polygon_first].plane,
                               view->portal_polygons[b->polygon_first].plane};
    double frames[2][3][3], m[12];
    for (int s = 0; s < 2; s++) {
        double(*f)[3] = frames[s], other[3], length = 0;
        memcpy(f[0], planes[s], sizeof f[0]);
        random_direction(seed, other);
        for (int k = 0; k < 3; k++)
            f[1][k] = f[0][(k + 1) % 3] * other[(k + 2) % 3] - f[0][(k + 2) % 3] * other[(k + 1) % 3];
        for (int k = 0; k < 3; k++) length += f[1][k] * f[1][k];
        for (int k = 0; k < 3; k++) f[1][k] /= sqrt(length);
        for (int k = 0; k < 3; k++)
            f[2][k] = f[0][(k + 1) % 3] * f[1][(k + 2) % 3] - f[0][(k + 2) % 3] * f[1][(k + 1) % 3];
    }
    for (int i = 0; i < 3; i++) {
        m[4 * i + 3] = b->centre[i];
        for (int k = 0; k < 3; k++) {
            m[4 * i + k] = 0;
            for (int r = 0; r < 3; r++) m[4 * i + k] += frames[1][r][i] * frames[0][r][k];
        }
        for (int k = 0; k < 3; k++) m[4 * i + 3] -= m[4 * i + k] * a->centre[k];
    }
    assert_int_equal(enf_instance_set_transform(instance, from, b->to, m, NULL), ENF_OK);
}

static void set_transforms(enf_instance *instance, const enf_file_view *view, uint64_t *seed) {
    for (int n = 0; n < 6; n++) {
        int32_t one = (int32_t)(run_random(seed) % (uint64_t)view->portal_count);
        int32_t two = (int32_t)(run_random(seed) % (uint64_t)view->portal_count);
        if (view->portals[one].polygon_count > 1 || view->portals[two].polygon_count > 1) continue;
        if (n % 2)
            set_mirror(instance, view, one);
        else
            set_link(instance, view, one, two, seed);
    }
}

// --- Tests
// ---------------------------------------------------------------------------------------------------

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
        if (doors) set_doors(instance, scene.view, &seed);
        if (transforms) set_transforms(instance, scene.view, &seed);
        for (int s = 0; s < SHAPES; s++) {
            enf_view_options options = shapes[s];
            enf_view *view = NULL;
            options.transforms_max = TRANSFORMS;
            assert_int_equal(enf_view_create(&view, world.world, &options, NULL), ENF_OK);
            for (int n = 0; n < 12; n++) {
                double eye[3];
                enf_place place;
                if (random_eye(&world, &seed, eye, &place)) check_view(&scene, view, eye, place.cell, &seed);
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
    double side = step_off(polygon->plane, point), foot[3];
    for (int a = 0; a < 3; a++) foot[a] = point[a] - side * polygon->plane[a];
    if (side >= 0 || step_off(polygon->plane, eye) < -1e-12 || !is_inside(view, polygon, foot)) return false;
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
            enf_camera camera = random_camera(eye, &seed);
            scene.visible = enf_view_run(view, NULL, &camera);
            for (int r = 0; r < RAYS; r++) {
                ray ray = {.x = 2 * run_random_share(&seed) - 1, .y = 2 * run_random_share(&seed) - 1};
                double point[3];
                aim(&camera, ray.x, ray.y, ray.direction);
                memcpy(ray.origin, eye, sizeof eye);
                point_at(&ray, 1e-4, point);
                int32_t cell = enf_world_locate(world.world, point, -1).cell;
                ray.cell = scene.visible->cell;
                // It begins behind the portal? Only what lies straight behind it is free to be seen.
                if (cell != ray.cell && !is_behind(scene.view, polygon, eye, point, ray.cell, cell)) continue;
                ray.cell = cell;
                memcpy(ray.origin, point, sizeof point);
                follow(&scene, ray);
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
    for (int n = 0; n < 10; n++) set_transforms(instance, file, &seed);
    assert_int_equal(enf_view_create(&view, world.world, NULL, NULL), ENF_OK);
    for (int n = 0; n < 200; n++) {
        double eye[3];
        enf_place place;
        if (!random_eye(&world, &seed, eye, &place)) continue;
        enf_camera camera = random_camera(eye, &seed);
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
        random_direction(&seed, door.plane);
        door.plane[3] = -step_off(door.plane, file->portals[i].centre);
        assert_int_equal(enf_instance_set_door(ajar, i, &door, NULL), ENF_OK);
    }
    for (int n = 0; n < 300; n++) {
        double eye[3];
        enf_place place;
        if (!random_eye(&world, &seed, eye, &place)) continue;
        enf_camera camera = random_camera(eye, &seed);
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
                aim(&camera, a[0] + s * (b[0] - a[0]) + t * (c[0] - a[0]),
                    a[1] + s * (b[1] - a[1]) + t * (c[1] - a[1]), d);
                double along = p[0] * d[0] + p[1] * d[1] + p[2] * d[2], at = -step_off(p, eye) / along;
                for (int x = 0; x < 3; x++) hit[x] = eye[x] + at * d[x];
                enf_passage passage = enf_instance_passage(ajar, file, e->portal);
                assert_true(step_off(passage.plane, hit) >= -1e-4);
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
            if (!random_eye(&world, &seed, eye, &place)) continue;
            enf_camera camera = random_camera(eye, &seed);
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
        if (file->portals[i].polygon_count == 1) set_mirror(instance, file, i);
    for (int i = 0; i < 6; i++)
        assert_int_equal(enf_view_create(&views[i], world.world, &options[i], NULL), ENF_OK);
    for (int n = 0; n < 100; n++) {
        double eye[3];
        enf_place place;
        if (!random_eye(&world, &seed, eye, &place)) continue;
        enf_camera camera = random_camera(eye, &seed);
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
    enf_camera camera = random_camera(far_away, &seed);
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
                if (!random_eye(&sane, &seed, eye, &place)) continue;
                enf_camera camera = random_camera(eye, &seed);
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

// --- Polygons
// ------------------------------------------------------------------------------------------------

static int32_t random_polygon(uint64_t *seed, double (*corners)[2], int32_t count) {
    double flat = run_random(seed) % 3 ? 1 : pow(10, -6 * run_random_share(seed));
    for (int32_t i = 0; i < count; i++) {
        double angle = 7 * run_random_share(seed), r = 0.5 + 0.1 * run_random_share(seed);
        corners[i][0] = r * cos(angle);
        corners[i][1] = r * sin(angle) * flat;
    }
    return enf_hull(corners, count);
}

/// How much a polygon grows without an edge, by areas alone.
static double growth(const double (*c)[2], int32_t count, int32_t edge) {
    const double *p = c[(edge + count - 1) % count], *a = c[edge], *b = c[(edge + 1) % count],
                 *q = c[(edge + 2) % count];
    double d = (a[0] - p[0]) * (b[1] - q[1]) - (a[1] - p[1]) * (b[0] - q[0]);
    double s = ((q[0] - a[0]) * (b[1] - q[1]) - (q[1] - a[1]) * (b[0] - q[0])) / d;
    double x = a[0] + s * (a[0] - p[0]), y = a[1] + s * (a[1] - p[1]);
    double ahead = (x - b[0]) * (b[0] - q[0]) + (y - b[1]) * (b[1] - q[1]);
    if (!(s >= 0) || !(ahead >= 0)) return INFINITY;
    return 0.5 * fabs((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]));
}

static void edges_removed_add_least(void **state) {
    uint64_t seed = 10;
    (void)state;
    print_message("seed %" PRIu64 "\n", seed);
    for (int n = 0; n < 20000; n++) {
        double corners[12][2], before[12][2];
        int32_t count = random_polygon(&seed, corners, 5 + (int32_t)(run_random(&seed) % 8));
        if (count < 5) continue;
        memcpy(before, corners, sizeof corners);
        double least = INFINITY, area = enf_polygon_area((const double(*)[2])before, count);
        for (int32_t i = 0; i < count; i++) least = fmin(least, growth((const double(*)[2])before, count, i));
        int32_t target = n % 2 ? 4 : count - 1;
        assert_int_equal(enf_polygon_simplify(corners, count, target), target);
        double grown = enf_polygon_area((const double(*)[2])corners, target) - area;
        if (n % 2 == 0 && fabs(grown - least) > 1e-9 * (1 + least)) fail_msg("%g for %g", grown, least);
        for (int32_t i = 0; i < target; i++)
            for (int32_t k = 0; k < count; k++) {
                const double *a = corners[i], *b = corners[(i + 1) % target], *p = before[k];
                double side = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
                assert_true(side >= -1e-9 * hypot(b[0] - a[0], b[1] - a[1]) - 1e-15);
            }
    }
}

/// Hulls are convex and contain their points, also of corners that are the same but for rounding.
static void hulls_are_convex(void **state) {
    uint64_t seed = 13;
    (void)state;
    for (int n = 0; n < 50000; n++) {
        double points[32][2], before[32][2];
        int32_t count = random_polygon(&seed, points, 3 + (int32_t)(run_random(&seed) % 12)), all = count;
        for (int32_t i = 0; i < count; i++) // once more, moved by a few roundings
            for (int a = 0; a < 2; a++)
                points[all + i][a] = points[i][a] + (double)(run_random(&seed) % 5) * 0x1p-53;
        all += count;
        memcpy(before, points, sizeof points);
        count = enf_hull(points, all);
        for (int32_t i = 0; count > 2 && i < count; i++)
            for (int32_t k = 0; k < all; k++) {
                const double *a = points[i], *b = points[(i + 1) % count], *p = before[k];
                double side = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
                if (hypot(b[0] - a[0], b[1] - a[1]) > 1e-4) assert_true(side >= -1e-10);
                const double *c = points[(i + 2) % count];
                assert_true((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) >= 0);
            }
    }
}

/// Lines have all corners within, also those of polygons as thin as rounding, and simplified ones.
static void lines_lose_no_corner(void **state) {
    uint64_t seed = 11;
    double memory[2][ENF_VIEW_EDGES_MAX][2];
    enf_view_line lines[2][ENF_VIEW_LINES];
    (void)state;
    for (int n = 0; n < 20000; n++) {
        double corners[24][2], before[24][2];
        int32_t count = random_polygon(&seed, corners, 1 + (int32_t)(run_random(&seed) % 20));
        for (int32_t i = 0; n % 3 == 0 && i < count; i++) // not quite convex
            for (int a = 0; a < 2; a++) corners[i][a] += 1e-9 * run_random_share(&seed);
        memcpy(before, corners, sizeof corners);
        enf_view_region region = {.corners = memory[0], .lines = lines[0]};
        enf_view_region simple = {.corners = memory[1], .lines = lines[1]};
        enf_region_outline(&region, corners, count);
        enf_region_draw(&region, NULL, NULL);
        enf_region_simplify(&simple, &region, 4);
        assert_true(enf_region_contains(&region, &region));
        double moved[24][2]; // out of it by two slacks
        enf_view_region other = {.corners = memory[1], .lines = lines[1]};
        for (int32_t i = 0; i < region.count; i++) {
            moved[i][0] = region.corners[i][0] + 3 * ENF_VIEW_SLACK;
            moved[i][1] = region.corners[i][1];
        }
        enf_region_outline(&other, moved, region.count);
        assert_false(enf_region_contains(&region, &other));
        for (int32_t k = 0; k < count; k++)
            for (int s = 0; s < 2; s++) {
                const enf_view_region *r = s ? &simple : &region;
                for (int32_t i = 0; i < r->line_count; i++) {
                    const enf_view_line *l = &r->lines[i];
                    assert_true(l->a * before[k][0] + l->b * before[k][1] + l->c >= 0.4 * ENF_VIEW_SLACK);
                }
            }
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
        cmocka_unit_test(edges_removed_add_least),
        cmocka_unit_test(hulls_are_convex),
        cmocka_unit_test(lines_lose_no_corner),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
