// SPDX-License-Identifier: GPL-3.0-or-later
#include "view_scene.h"
#include "world_fixture.h"

#include "format/frame.h"
#include "run/instance.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { STEPS = 400 };

static const double tiny = 1e-9; ///< grid steps: rays that pass nearer to a border are nobody's

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

bool scene_has_chain(const enf_visible *visible, int32_t space, const scene_ray *ray) {
    for (int32_t i = ray->chain_count; i-- > 0; space = visible->spaces[space].parent)
        if (space <= 0 || visible->spaces[space].portal != ray->chain[i]) return false;
    return space == 0;
}

/// Is the ray's cell listed with the ray's pixel?
static void expect(scene *scene, const scene_ray *ray) {
    scene->passed++;
    for (int32_t i = 0; i < scene->visible->entry_count; i++) {
        const enf_view_entry *entry = &scene->visible->entries[i];
        if (entry->cell == ray->cell && scene_has_chain(scene->visible, entry->space, ray) &&
            covers(entry, ray->x, ray->y))
            return;
    }
    scene->missed++;
}

bool scene_is_inside(const enf_file_view *view, const enf_file_portal_polygon *polygon, const double p[3]) {
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

double scene_step_off(const double plane[4], const double p[3]) {
    return plane[0] * p[0] + plane[1] * p[1] + plane[2] * p[2] + plane[3];
}

/// The portal through which the ray leaves at a point; -1: a wall.
static int32_t find_portal(const scene *scene, const scene_ray *ray, const double point[3],
                           enf_passage *passage) {
    const enf_file_cell *cell = &scene->view->cells[ray->cell];
    for (int32_t i = 0; i < cell->portal_count; i++) {
        int32_t number = scene->view->cell_portals[cell->portal_first + i];
        const enf_file_portal *portal = &scene->view->portals[number];
        for (int32_t k = 0; k < portal->polygon_count; k++) {
            const enf_file_portal_polygon *polygon = &scene->view->portal_polygons[portal->polygon_first + k];
            double along = polygon->plane[0] * ray->direction[0] + polygon->plane[1] * ray->direction[1] +
                           polygon->plane[2] * ray->direction[2];
            if (along >= 0 || !scene_is_inside(scene->view, polygon, point)) continue;
            *passage = enf_instance_passage(scene->instance, scene->view, number);
            if (passage->cut && scene_step_off(passage->plane, point) < 1e-7) return -1;
            return passage->to < 0 ? -1 : number;
        }
    }
    return -1;
}

static void transform(scene_ray *ray, const double m[12]) {
    double o[3], d[3];
    for (int i = 0; i < 3; i++) {
        const double *row = m + 4 * i;
        o[i] = row[0] * ray->origin[0] + row[1] * ray->origin[1] + row[2] * ray->origin[2] + row[3];
        d[i] = row[0] * ray->direction[0] + row[1] * ray->direction[1] + row[2] * ray->direction[2];
    }
    memcpy(ray->origin, o, sizeof o);
    memcpy(ray->direction, d, sizeof d);
}

void scene_point_at(const scene_ray *ray, double t, double point[3]) {
    for (int a = 0; a < 3; a++) point[a] = ray->origin[a] + t * ray->direction[a];
}

/// Where the ray leaves the cube that it is in after `t`.
static double leave_cube(const scene *scene, const scene_ray *ray, double t) {
    double next[3], origin[3], end[3], least = INFINITY;
    scene_point_at(ray, 1, next);
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
void scene_follow(scene *scene, scene_ray ray) {
    double t = 0;
    expect(scene, &ray);
    for (int n = 0; n < STEPS; n++) {
        double point[3], beyond[3];
        enf_passage passage;
        t = leave_cube(scene, &ray, t);
        scene_point_at(&ray, t, point);
        scene_point_at(&ray, t + 1e-6, beyond);
        enf_place place = enf_world_locate(scene->world, beyond, -1);
        int32_t portal = find_portal(scene, &ray, point, &passage);
        if (portal < 0 && place.cell != ray.cell) return;
        if (portal < 0) continue;
        const scene_ray before = ray;
        ray.cell = passage.to;
        if (passage.matrix) {
            if (ray.chain_count == SCENE_TRANSFORMS) return;
            ray.chain[ray.chain_count++] = portal;
            transform(&ray, passage.matrix);
            scene_point_at(&ray, t + 1e-6, beyond);
            place = enf_world_locate(scene->world, beyond, -1);
        }
        if (place.cell != ray.cell) return; // past an edge of cubes
        expect(scene, &ray);
        if (scene->pass && passage.matrix) scene->pass(scene->user, &before, t, &ray);
        if (scene->come_to) scene->come_to(scene->user, &ray, beyond);
    }
}

void scene_direction(uint64_t *seed, double direction[3]) {
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

enf_camera scene_camera(const double eye[3], uint64_t *seed) {
    double forward[3], up[3];
    do {
        scene_direction(seed, forward);
        scene_direction(seed, up);
    } while (fabs(forward[0] * up[0] + forward[1] * up[1] + forward[2] * up[2]) > 0.9);
    return enf_camera_look(eye, forward, up, 1.2, 1.5);
}

void scene_aim(const enf_camera *camera, double x, double y, double direction[3]) {
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

bool scene_eye(const run_world *world, uint64_t *seed, double eye[3], enf_place *place) {
    for (int n = 0; n < 100; n++) {
        for (int a = 0; a < 3; a++)
            eye[a] = world->box_min[a] + run_random_share(seed) * (world->box_max[a] - world->box_min[a]);
        *place = enf_world_locate(world->world, eye, -1);
        if (place->cell >= 0) return true;
    }
    return false;
}

void scene_check(scene *scene, enf_view *view, const double eye[3], int32_t cell, uint64_t *seed) {
    enf_camera camera = scene_camera(eye, seed);
    scene->visible = enf_view_run(view, scene->instance, &camera);
    if (scene->visible->flags & (ENF_VIEW_OVERFLOW | ENF_VIEW_INCOMPLETE)) fail_msg("capacity ran out");
    for (int n = 0; n < SCENE_RAYS; n++) {
        scene_ray ray = {
            .cell = cell, .x = 2 * run_random_share(seed) - 1, .y = 2 * run_random_share(seed) - 1};
        memcpy(ray.origin, eye, sizeof ray.origin);
        scene_aim(&camera, ray.x, ray.y, ray.direction);
        scene_follow(scene, ray);
    }
}

void scene_set_doors(enf_instance *instance, const enf_file_view *view, uint64_t *seed) {
    for (int32_t i = 0; i < view->portal_count; i += 2) {
        enf_door door = {.state = (enf_door_state)(run_random(seed) % 3)};
        scene_direction(seed, door.plane);
        const double *c = view->portals[i].centre, *p = door.plane;
        door.plane[3] = -(p[0] * c[0] + p[1] * c[1] + p[2] * c[2]);
        assert_int_equal(enf_instance_set_door(instance, i, &door, NULL), ENF_OK);
    }
}

void scene_set_mirror(enf_instance *instance, const enf_file_view *view, int32_t portal) {
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
        scene_direction(seed, other);
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

void scene_set_transforms(enf_instance *instance, const enf_file_view *view, uint64_t *seed) {
    for (int n = 0; n < 6; n++) {
        int32_t one = (int32_t)(run_random(seed) % (uint64_t)view->portal_count);
        int32_t two = (int32_t)(run_random(seed) % (uint64_t)view->portal_count);
        if (view->portals[one].polygon_count > 1 || view->portals[two].polygon_count > 1) continue;
        if (n % 2)
            scene_set_mirror(instance, view, one);
        else
            set_link(instance, view, one, two, seed);
    }
}
