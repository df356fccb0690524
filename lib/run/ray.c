// SPDX-License-Identifier: MIT
// A ray is straight up to the first portal that transforms; each such leg is a segment that ends at the
// world's border. The nearest wall on it is found first, then the portals before that wall.
#include "enfilade/sight.h"

#include "format/frame.h"
#include "run/affine.h"
#include "run/walk.h"
#include "run/way.h"

#include <math.h>

enum { DEPTH_DEFAULT = 16, TRIANGLES_MAX = 4096 };

typedef struct caster {
    const enf_world *world;
    const enf_file_view *view;
    const enf_ray *ray;
    enf_ray_hit *hit;
    enf_way way;
    double reach;  ///< of the way, in lengths of hit->direction
    double length; ///< what is left of the ray
    enf_passed passed;
} caster;

// --- The nearest wall
// --------------------------------------------------------------------------------------------

typedef struct wall_hit {
    int32_t barrier; ///< -1: none
    double share;
} wall_hit;

static wall_hit find_nearest(const caster *c) {
    wall_hit nearest = {-1, ENF_WAY_WHOLE};
    enf_walk walk;
    enf_walk_begin(&walk, c->view, &c->way.segment, c->view->wall_nodes, c->view->wall_node_count);
    int32_t number;
    while ((number = enf_walk_next(&walk)) >= 0) {
        const enf_file_barrier *barrier = &c->view->barriers[number];
        double share;
        if (barrier->kind == ENF_FILE_BARRIER_DETAIL && c->ray->ignores_detail) continue;
        if (!enf_segment_passes(c->view, &c->way.segment, barrier, &share)) continue;
        if (share > nearest.share || (share == nearest.share && number > nearest.barrier)) continue;
        nearest = (wall_hit){number, share};
        enf_walk_shorten(&walk, share);
    }
    return nearest;
}

/// The least of the areas between a point and the edges of a triangle, along its normal: largest for the
/// triangle that holds the point.
static double inside_by(const enf_file_view *view, const enf_file_triangle *triangle, const double normal[3],
                        const double point[3]) {
    double least = INFINITY;
    for (int k = 0; k < 3; k++) {
        const double *p = view->render_points[triangle->point[k]],
                     *q = view->render_points[triangle->point[(k + 1) % 3]];
        double area = 0;
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, d = (a + 2) % 3;
            area += normal[a] * ((q[b] - p[b]) * (point[d] - p[d]) - (q[d] - p[d]) * (point[b] - p[b]));
        }
        least = fmin(least, area);
    }
    return least;
}

/// Which of a wall's triangles a point lies on.
static int32_t find_triangle(const enf_file_view *view, const enf_file_barrier *barrier,
                             const double point[3]) {
    int32_t first = barrier->index, best = first;
    if (!view->has_geometry || first < 0) return -1;
    if (barrier->kind != ENF_FILE_BARRIER_WALL) return first;
    double normal[3], most = -INFINITY;
    enf_view_direction_to_world(view, barrier->normal, normal);
    for (int32_t i = first; i < view->triangle_count && i - first < TRIANGLES_MAX; i++) {
        if (view->triangles[i].mesh_polygon != view->triangles[first].mesh_polygon) break;
        double inside = inside_by(view, &view->triangles[i], normal, point);
        if (inside <= most) continue;
        most = inside;
        best = i;
    }
    return best;
}

// --- Legs
// --------------------------------------------------------------------------------------------------------

/// How far it is to the border of the world's box, along a direction, in lengths of it.
static double way_out(const enf_file_view *view, const double from[3], const double direction[3]) {
    double scale = view->frame->locate_scale, way = INFINITY, start[3], along[3];
    enf_view_to_grid(view, from, start);
    enf_view_to_grid(view, direction, along);
    for (int a = 0; a < 3; a++) {
        double border = along[a] < 0 ? view->sight->box_min[a] : view->sight->box_max[a];
        if (along[a] != 0) way = fmin(way, (border - start[a] * scale) / (along[a] * scale));
    }
    return way;
}

/// The next leg, from hit->point on. False if there is nothing left of the ray.
static bool begin_leg(caster *c) {
    enf_ray_hit *hit = c->hit;
    double to[3];
    c->reach = fmin(way_out(c->view, hit->point, hit->direction), c->length);
    if (!(c->reach > 0) || isinf(c->reach)) return false;
    for (int a = 0; a < 3; a++) to[a] = hit->point[a] + c->reach * hit->direction[a];
    return enf_way_set(&c->way, hit->point, to);
}

static void go_to(caster *c, double share) {
    double point[3], way = fmin(share, 1) * c->reach;
    enf_way_point(&c->way, fmin(share, 1), point);
    for (int a = 0; a < 3; a++) c->hit->point[a] = point[a];
    c->hit->distance += way;
    c->length -= way;
}

/// Through a portal that transforms. False if that was one too many.
static bool pass_transform(caster *c, const enf_way_end *end) {
    enf_ray_hit *hit = c->hit;
    int32_t most = c->ray->depth_max > 0 ? c->ray->depth_max : DEPTH_DEFAULT;
    if (hit->depth >= most) {
        hit->end = ENF_RAY_TOO_DEEP;
        hit->portal = end->portal;
        return false;
    }
    hit->depth++;
    hit->cell = end->passage.to;
    enf_affine_point(end->passage.matrix, hit->point, hit->point);
    enf_affine_direction(end->passage.matrix, hit->direction, hit->direction);
    return true;
}

/// One leg. True if the ray goes on elsewhere.
static bool cast_leg(caster *c) {
    enf_ray_hit *hit = c->hit;
    if (!begin_leg(c)) return false;
    wall_hit wall = find_nearest(c);
    enf_way_end end = enf_way_pass(&c->way, wall.share, &hit->cell, -1, &c->passed);
    if (end.outcome != ENF_WAY_FREE) {
        go_to(c, end.share);
        if (end.outcome == ENF_WAY_LED) return pass_transform(c, &end);
        hit->end = ENF_RAY_DOOR;
        hit->portal = end.portal;
    } else {
        go_to(c, wall.share);
        if (wall.barrier < 0) return false;
        hit->end = ENF_RAY_TRIANGLE;
        hit->triangle = find_triangle(c->view, &c->view->barriers[wall.barrier], hit->point);
    }
    return false;
}

// --- The whole
// ---------------------------------------------------------------------------------------------------

/// The direction with length 1. False if there is none.
static bool take_direction(const double direction[3], double unit[3]) {
    double largest = 0, length = 0;
    for (int a = 0; a < 3; a++) {
        if (!isfinite(direction[a])) return false;
        largest = fmax(largest, fabs(direction[a]));
    }
    if (largest == 0) return false;
    int exponent;
    frexp(largest, &exponent);
    for (int a = 0; a < 3; a++) {
        unit[a] = ldexp(direction[a], -exponent);
        length += unit[a] * unit[a];
    }
    for (int a = 0; a < 3; a++) unit[a] /= sqrt(length);
    return true;
}

enf_status enf_ray_cast(const enf_world *world, const enf_instance *instance, const enf_ray *ray,
                        enf_ray_hit *hit, enf_error *error) {
    const enf_file_view *view = enf_world_file(world);
    *hit = (enf_ray_hit){.end = ENF_RAY_NOTHING, .triangle = -1, .portal = -1, .cell = -1};
    if (!view->sight) return enf_fail_sight(world, error);
    bool good = take_direction(ray->direction, hit->direction) && !isnan(ray->length);
    for (int a = 0; a < 3; a++) {
        good = good && isfinite(ray->origin[a]);
        hit->point[a] = ray->origin[a];
    }
    if (!good)
        return enf_fail(error, ENF_BAD_USAGE, "a ray needs a finite origin and a direction that is not 0");
    enf_place place = ray->place ? *ray->place : enf_world_locate(world, ray->origin, -1);
    if (place.cell < 0 || place.cell >= view->cell_count) {
        hit->end = ENF_RAY_NOWHERE;
        return ENF_OK;
    }
    hit->cell = place.cell;
    caster c = {.world = world,
                .view = view,
                .ray = ray,
                .hit = hit,
                .way = {.view = view, .instance = instance},
                .length = ray->length > 0 ? ray->length : INFINITY,
                .passed = {ray->portals, ray->portal_capacity, 0}};
    while (cast_leg(&c)) continue;
    hit->portal_count = c.passed.count;
    return ENF_OK;
}
