// SPDX-License-Identifier: GPL-3.0-or-later
// Lines of sight and rays in compiled worlds, against looking at every triangle that is drawn; the segments
// are random, or go exactly through corners and edges of triangles. And points located from bricks, from
// hints and by search are in the same place.
#include "pipeline_fixture.h"

#include "base/exact.h"
#include "build/write.h"
#include "enfilade/sight.h"
#include "format/frame.h"
#include "format/locate_point.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static uint64_t next_random(uint64_t *seed) { // splitmix64
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static double next_unit(uint64_t *seed) {
    return (double)(next_random(seed) >> 11) * 0x1p-53;
}

typedef struct opened {
    enf_world *world;
    const enf_file_view *view;
    double (*points)[3]; ///< render points, on the fine grid
} opened;

static void to_fine(const enf_file_view *view, const double world[3], double fine[3]) {
    enf_view_to_grid(view, world, fine);
    for (int a = 0; a < 3; a++) fine[a] = nearbyint(fine[a] * view->frame->locate_scale);
}

static void to_world(const enf_file_view *view, const double fine[3], double world[3]) {
    double grid[3];
    for (int a = 0; a < 3; a++) grid[a] = fine[a] / view->frame->locate_scale;
    enf_view_to_world(view, grid, world);
}

static opened open_world(enf_build *build) {
    opened o;
    char path[] = "sight-XXXXXX";
    int file = mkstemp(path);
    enf_error error = {0};
    assert_true(file >= 0);
    close(file);
    enf_build_options options = pipeline_options();
    pipeline_build(build, &options);
    enf_status status = enf_build_write(build, "{}", path, &error);
    if (!status) status = enf_world_open_path(&o.world, path, NULL, &error);
    remove(path);
    if (status) fail_msg("%s", error.text);
    o.view = enf_world_file(o.world);
    o.points = malloc((size_t)o.view->render_point_count * sizeof *o.points);
    assert_non_null(o.points);
    for (int32_t i = 0; i < o.view->render_point_count; i++)
        to_fine(o.view, o.view->render_points[i], o.points[i]);
    return o;
}

static void close_world(opened *o, enf_build *build) {
    free(o->points);
    enf_world_close(o->world);
    enf_build_free(build);
}

// --- The other way
// -----------------------------------------------------------------------------------------------

static bool triangle_stops(const opened *o, const enf_file_triangle *triangle, const double from[3],
                           const double to[3]) {
    const double *p[3];
    for (int k = 0; k < 3; k++) p[k] = o->points[triangle->point[k]];
    int one = enf_points_orient_exactly(p[0], p[1], p[2], from),
        other = enf_points_orient_exactly(p[0], p[1], p[2], to);
    if (one * other >= 0) return false;
    int least = 1, most = -1;
    for (int k = 0; k < 3; k++) {
        int side = enf_points_orient_exactly(from, to, p[k], p[(k + 1) % 3]);
        if (side < least) least = side;
        if (side > most) most = side;
    }
    return least >= 0 || most <= 0;
}

static int32_t find_stop(const opened *o, const double from[3], const double to[3]) {
    for (int32_t i = 0; i < o->view->triangle_count; i++) {
        const enf_file_triangle *triangle = &o->view->triangles[i];
        if (triangle->mesh_polygon >= 0 && triangle_stops(o, triangle, from, to)) return i;
    }
    return -1;
}

/// A quarter of the pairs are near each other; half have a corner of a triangle, or a point of an edge,
/// exactly between them.
static void choose_pair(const opened *o, uint64_t *seed, int n, double from[3], double to[3]) {
    double low[3], high[3];
    to_fine(o->view, o->view->frame->box_min, low);
    to_fine(o->view, o->view->frame->box_max, high);
    for (int a = 0; a < 3; a++) {
        from[a] = nearbyint(low[a] + (high[a] - low[a]) * next_unit(seed));
        to[a] = nearbyint(low[a] + (high[a] - low[a]) * next_unit(seed));
    }
    for (int a = 0; a < 3 && n % 4 == 1; a++) to[a] = nearbyint(from[a] + (to[a] - from[a]) * 0.1);
    if (n % 2) return;
    const enf_file_triangle *triangle =
        &o->view->triangles[next_random(seed) % (uint64_t)o->view->triangle_count];
    int k = (int)(next_random(seed) % 3);
    const double *p = o->points[triangle->point[k]], *q = o->points[triangle->point[n % 4 ? k : (k + 1) % 3]];
    for (int a = 0; a < 3; a++) {
        double middle = floor((p[a] + q[a]) / 2),
               way = nearbyint((from[a] - middle) * 0.25 * next_unit(seed));
        from[a] = middle + 2 * way;
        to[a] = middle - way;
    }
}

static void check_pair(const opened *o, int n, double from[3], double to[3], int counts[2]) {
    enf_sight_query query = {.size = sizeof query};
    enf_sight sight, back;
    int32_t portals[256];
    to_world(o->view, from, query.from);
    to_world(o->view, to, query.to);
    to_fine(o->view, query.from, from); // a turned world rounds
    to_fine(o->view, query.to, to);
    query.portals = portals;
    query.portal_capacity = 256;
    assert_int_equal(enf_sight_between(o->world, NULL, &query, &sight, NULL), ENF_OK);
    if (sight.from.cell < 0 || sight.to.cell < 0) {
        assert_false(sight.is_free);
        return;
    }
    int32_t stop = find_stop(o, from, to);
    if (sight.is_free != (stop < 0))
        fail_msg("pair %d: %.17g %.17g %.17g to %.17g %.17g %.17g: %d, but triangle %d", n, query.from[0],
                 query.from[1], query.from[2], query.to[0], query.to[1], query.to[2], sight.is_free,
                 (int)stop);
    if (sight.is_free && n % 2) { // of the others, some run in the planes of portals
        int32_t cell = sight.from.cell;
        for (int32_t i = 0; i < sight.portal_count; i++) {
            assert_int_equal(o->view->portals[portals[i]].from, cell);
            cell = o->view->portals[portals[i]].to;
        }
        assert_int_equal(cell, sight.to.cell);
    }
    counts[sight.is_free]++;
    enf_sight_query turned = {.size = sizeof turned};
    memcpy(turned.from, query.to, sizeof turned.from);
    memcpy(turned.to, query.from, sizeof turned.to);
    assert_int_equal(enf_sight_between(o->world, NULL, &turned, &back, NULL), ENF_OK);
    assert_int_equal(back.is_free, sight.is_free);

    enf_ray ray = {.size = sizeof ray, .ignores_detail = true};
    enf_ray_hit hit;
    double length = 0;
    for (int a = 0; a < 3; a++) {
        ray.origin[a] = query.from[a];
        ray.direction[a] = query.to[a] - query.from[a];
        length += ray.direction[a] * ray.direction[a];
    }
    if (n % 2 == 0 || length == 0) return; // rounding decides where it just touches
    ray.length = sqrt(length);
    assert_int_equal(enf_ray_cast(o->world, NULL, &ray, &hit, NULL), ENF_OK);
    assert_int_equal(hit.end, sight.is_free ? ENF_RAY_NOTHING : ENF_RAY_TRIANGLE);
    if (sight.is_free) assert_int_equal(hit.cell, sight.to.cell);
    if (sight.is_free) return;
    double before[3];
    for (int a = 0; a < 3; a++) before[a] = hit.point[a] + (query.from[a] - hit.point[a]) * 1e-6;
    to_fine(o->view, before, before);
    assert_int_equal(find_stop(o, from, before), -1); // nothing is nearer
}

static void check_pairs(opened *o, int count) {
    uint64_t seed = 21;
    int counts[2] = {0, 0};
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int n = 0; n < count; n++) {
        double from[3], to[3];
        choose_pair(o, &seed, n, from, to);
        check_pair(o, n, from, to, counts);
    }
    print_message("%d stopped, %d free\n", counts[0], counts[1]);
    assert_true(counts[0] > count / 100 && counts[1] > count / 100);
}

/// Opens, shuts or sets ajar a random door, or gives a portal a transform, or takes it away.
static void change_portal(const opened *o, enf_instance *instance, uint64_t *seed) {
    static const double half_turn[12] = {-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0};
    int32_t portal = (int32_t)(next_random(seed) % (uint64_t)o->view->portal_count);
    uint64_t kind = next_random(seed) % 8;
    enf_door door = {.state = kind == 0 ? ENF_DOOR_CLOSED : kind == 1 ? ENF_DOOR_PARTLY : ENF_DOOR_OPEN};
    for (int a = 0; a < 3 && kind == 1; a++) {
        door.plane[a] = next_unit(seed) - 0.5;
        door.plane[3] -= door.plane[a] * o->view->portals[portal].centre[a];
    }
    enf_status status = kind < 6 ? enf_instance_set_door(instance, portal, &door, NULL)
                                 : enf_instance_set_transform(instance, portal, o->view->portals[portal].to,
                                                              kind == 6 ? half_turn : NULL, NULL);
    assert_int_equal(status, ENF_OK);
}

/// What the doors on a line mean is found by looking at those that were changed alone, or at all portals on
/// the line, in their order: the same.
static void check_changes(const opened *o, int count) {
    uint64_t seed = 23;
    int stopped = 0, free = 0;
    enf_instance *instance;
    assert_int_equal(enf_instance_create(&instance, o->world, NULL, NULL), ENF_OK);
    for (int n = 0; n < count; n++) {
        double from[3], to[3];
        int32_t portals[1];
        enf_sight_query query = {.size = sizeof query};
        enf_sight quick, whole;
        change_portal(o, instance, &seed);
        choose_pair(o, &seed, n, from, to);
        to_world(o->view, from, query.from);
        to_world(o->view, to, query.to);
        assert_int_equal(enf_sight_between(o->world, instance, &query, &quick, NULL), ENF_OK);
        query.portals = portals;
        query.portal_capacity = 1;
        assert_int_equal(enf_sight_between(o->world, instance, &query, &whole, NULL), ENF_OK);
        if (quick.is_free != whole.is_free || quick.portal != whole.portal)
            fail_msg("pair %d: %d by portal %d, but %d by portal %d", n, quick.is_free, (int)quick.portal,
                     whole.is_free, (int)whole.portal);
        stopped += quick.portal >= 0;
        free += quick.is_free;
    }
    print_message("%d stopped by doors, %d free\n", stopped, free);
    if (o->view->portal_count > 0) assert_true(stopped > 0 && free > 0);
    enf_instance_free(instance);
}

/// The fine cell by looking at every box that holds the point; -1: none.
static int32_t find_place(const enf_file_view *view, const double world[3]) {
    enf_locating point = {.view = view, .best = -1, .best_tetrahedron = -1};
    to_fine(view, world, point.at);
    enf_locating_search(&point);
    if (point.best < 0) enf_locating_search_nearest(&point);
    return point.best;
}

/// Anywhere, also a little outside of the world's box; or at a corner, on an edge or on a face of a triangle,
/// a few steps of the fine grid beside it, or beside it by no more than rounding explains.
static void choose_place(const opened *o, uint64_t *seed, int n, double world[3]) {
    const enf_file_frame *frame = o->view->frame;
    const enf_file_triangle *triangle =
        &o->view->triangles[next_random(seed) % (uint64_t)o->view->triangle_count];
    double share[2] = {n % 4 > 1 ? next_unit(seed) / 2 : 0, n % 4 > 2 ? next_unit(seed) / 2 : 0}, fine[3];
    double beside = n / 4 % 4 ? pow(8, n / 4 % 4) : 0;
    for (int a = 0; a < 3; a++) {
        double p = o->points[triangle->point[0]][a], q = o->points[triangle->point[1]][a],
               r = o->points[triangle->point[2]][a];
        fine[a] = nearbyint(p + share[0] * (q - p) + share[1] * (r - p) + beside * (next_unit(seed) - 0.5));
    }
    to_world(o->view, fine, world);
    for (int a = 0; a < 3 && n % 4 == 0; a++)
        world[a] =
            frame->box_min[a] + (1.2 * next_unit(seed) - 0.1) * (frame->box_max[a] - frame->box_min[a]);
}

/// A walk from wherever it begins finds what a search through all tetrahedra does.
static void check_places(const opened *o, int count) {
    uint64_t seed = 22;
    int outside = 0;
    for (int n = 0; n < count; n++) {
        double point[3];
        choose_place(o, &seed, n, point);
        int32_t hint = (int32_t)(next_random(&seed) % (uint64_t)o->view->tetrahedron_count),
                fine = find_place(o->view, point);
        enf_place place = enf_world_locate(o->world, point, -1),
                  hinted = enf_world_locate(o->world, point, hint);
        if (place.fine_cell != fine || hinted.fine_cell != fine)
            fail_msg("place %d, %.17g %.17g %.17g: %d, from tetrahedron %d %d, but searched %d", n, point[0],
                     point[1], point[2], (int)place.fine_cell, (int)hint, (int)hinted.fine_cell, (int)fine);
        assert_int_equal(place.cell, hinted.cell);
        outside += fine < 0;
    }
    print_message("%d of %d places outside\n", outside, count);
    assert_true(outside > 0 && outside < count);
}

static void models_are_seen_as_they_are_drawn(void **state) {
    (void)state;
    static const char *const models[] = {"four-rooms", "four-rooms-tessellated", "furnished", "post",
                                         "office"};
    for (size_t i = 0; i < sizeof models / sizeof *models; i++) {
        enf_build build = {0};
        print_message("%s\n", models[i]);
        pipeline_read_model(&build.soup, models[i]);
        opened o = open_world(&build);
        check_pairs(&o, 3000);
        check_changes(&o, 3000);
        check_places(&o, 20000);
        close_world(&o, &build);
    }
}

static void places_in_a_turned_world(void **state) {
    (void)state;
    const char *const settings[] = {"rotate=10,20,30", "noise=0.01", "seed=3"};
    enf_build build = {0};
    pipeline_generate(&build.soup, "furnished", settings, sizeof settings / sizeof *settings);
    opened o = open_world(&build);
    check_places(&o, 20000);
    close_world(&o, &build);
}

static void a_level_is_seen_as_it_is_drawn(void **state) {
    (void)state;
    const char *path = pipeline_shared("quake/obj/e1m4.obj.gz");
    if (!path) skip();
    enf_build build = {0};
    enf_error error = {0};
    if (enf_soup_read(&build.soup, path, &error)) fail_msg("%s", error.text);
    opened o = open_world(&build);
    check_pairs(&o, 4000);
    check_changes(&o, 6000);
    check_places(&o, 20000);
    close_world(&o, &build);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(models_are_seen_as_they_are_drawn),
        cmocka_unit_test(places_in_a_turned_world),
        cmocka_unit_test(a_level_is_seen_as_it_is_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
