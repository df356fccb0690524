// SPDX-License-Identifier: GPL-3.0-or-later
// Lines of sight, rays and steps: against looking at every wall in whole numbers, through doors and portals
// that lead elsewhere, and in files that make no sense.
#include "world_fixture.h"

#include "enfilade/sight.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { SIDE = 4, FINE_GRID = 1024, HALF = SIDE / 2 * FIXTURE_SPACING, WHOLE = SIDE * FIXTURE_SPACING };

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
    fixture fixture;
    unsigned char *bytes;
    size_t size;
    enf_world *world;
    const enf_file_view *view;
    enf_instance *instance;
} opened;

static const enf_frame frames[] = {
    {0.25, {0, 1, 2}, {1, 1, 1}, 1, false, {{0}}},
    {0x1p-40, {1, 2, 0}, {-1, 1, -1}, 1, false, {{0}}},
    {0x1p60, {2, 1, 0}, {1, 1, 1}, -1, false, {{0}}},
    {1, {0, 1, 2}, {1, -1, 1}, -1, false, {{0}}},
};

enum { FRAME_COUNT = sizeof frames / sizeof *frames };

static opened open_fixture(const enf_frame *frame) {
    opened o;
    fixture_make_with_screen(&o.fixture, SIDE, frame);
    o.bytes = fixture_save(&o.fixture, &o.size);
    assert_int_equal(enf_world_open_memory(&o.world, o.bytes, o.size, NULL, NULL), ENF_OK);
    assert_int_equal(enf_instance_create(&o.instance, o.world, NULL, NULL), ENF_OK);
    o.view = enf_world_file(o.world);
    return o;
}

static void close_fixture(opened *o) {
    enf_instance_free(o->instance);
    enf_world_close(o->world);
    free(o->bytes);
    fixture_free(&o->fixture);
}

static void to_world(const opened *o, const int64_t at[3], double world[3]) {
    double grid[3];
    for (int a = 0; a < 3; a++) grid[a] = (double)at[a] / FINE_GRID;
    enf_frame_to_world(&o->fixture.build.mesh.frame, grid, world);
}

static void grid_to_world(const opened *o, double x, double y, double z, double world[3]) {
    enf_frame_to_world(&o->fixture.build.mesh.frame, (const double[3]){x, y, z}, world);
}

// --- The other way: every triangle of input, sides in whole numbers of 1/1024 grid steps
// ---------------------------------------------------------------------------------

static int sign_of(const int64_t p[3], const int64_t q[3], const int64_t r[3], const int64_t s[3]) {
    int64_t u[3], v[3], w[3];
    for (int a = 0; a < 3; a++) {
        u[a] = q[a] - p[a];
        v[a] = r[a] - p[a];
        w[a] = s[a] - p[a];
    }
    int64_t volume = w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
                     w[2] * (u[0] * v[1] - u[1] * v[0]);
    return (volume > 0) - (volume < 0);
}

/// The rule of sight.h. *share: how far along.
static bool triangle_stops(int64_t corner[3][3], const int64_t from[3], const int64_t to[3]) {
    int one = sign_of(corner[0], corner[1], corner[2], from);
    int other = sign_of(corner[0], corner[1], corner[2], to);
    if (one * other >= 0) return false;
    int least = 1, most = -1;
    for (int k = 0; k < 3; k++) {
        int side = sign_of(from, to, corner[k], corner[(k + 1) % 3]);
        if (side < least) least = side;
        if (side > most) most = side;
    }
    return least >= 0 || most <= 0;
}

static void wall_corners(const fixture *f, size_t polygon, int64_t corner[3][3]) {
    for (int k = 0; k < 3; k++) {
        const double *point =
            f->build.mesh.points + 3 * (size_t)f->build.mesh.corners[3 * polygon + (size_t)k];
        for (int a = 0; a < 3; a++) corner[k][a] = (int64_t)point[a] * FINE_GRID;
    }
}

static bool is_free(const opened *o, const int64_t from[3], const int64_t to[3]) {
    for (size_t i = 0; i < o->fixture.build.mesh.polygon_count; i++) {
        int64_t corner[3][3];
        wall_corners(&o->fixture, i, corner);
        if (triangle_stops(corner, from, to)) return false;
    }
    return true;
}

/// Half of them aim at what is delicate: a coarse grid has corners, edges and the planes of walls.
static void random_point(uint64_t *seed, int64_t at[3]) {
    static const int64_t grains[] = {1, FINE_GRID / 4, FINE_GRID * FIXTURE_SPACING / 2,
                                     FINE_GRID * FIXTURE_SPACING};
    int64_t grain = grains[next_random(seed) % 4];
    for (int a = 0; a < 3; a++)
        at[a] = (int64_t)(next_random(seed) % (uint64_t)(WHOLE * FINE_GRID + 1)) / grain * grain;
}

static enf_sight look(const opened *o, const double from[3], const double to[3], int32_t *portals,
                      int32_t capacity) {
    enf_sight_query query = {.size = sizeof query, .portals = portals, .portal_capacity = capacity};
    enf_sight sight;
    memcpy(query.from, from, sizeof query.from);
    memcpy(query.to, to, sizeof query.to);
    assert_int_equal(enf_sight_between(o->world, o->instance, &query, &sight, NULL), ENF_OK);
    return sight;
}

static void check_chain(const opened *o, const enf_sight *sight, const int32_t *portals) {
    int32_t cell = sight->from.cell;
    for (int32_t i = 0; i < sight->portal_count; i++) {
        assert_int_equal(o->view->portals[portals[i]].from, cell);
        cell = o->view->portals[portals[i]].to;
    }
    assert_int_equal(cell, sight->to.cell);
}

static void sight_is_what_the_walls_leave(void **state) {
    (void)state;
    uint64_t seed = 11;
    int free_count = 0, passed = 0;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int i = 0; i < FRAME_COUNT; i++) {
        opened o = open_fixture(&frames[i]);
        for (int n = 0; n < 20000; n++) {
            int64_t from[3], to[3];
            double a[3], b[3];
            int32_t portals[8];
            random_point(&seed, from);
            random_point(&seed, to);
            to_world(&o, from, a);
            to_world(&o, to, b);
            enf_sight sight = look(&o, a, b, portals, 8), back = look(&o, b, a, NULL, 0);
            bool expected = sight.from.cell >= 0 && sight.to.cell >= 0 && is_free(&o, from, to);
            if (sight.is_free != expected || back.is_free != expected)
                fail_msg("frame %d: %g %g %g to %g %g %g: %d, back %d, not %d", i,
                         (double)from[0] / FINE_GRID, (double)from[1] / FINE_GRID,
                         (double)from[2] / FINE_GRID, (double)to[0] / FINE_GRID, (double)to[1] / FINE_GRID,
                         (double)to[2] / FINE_GRID, sight.is_free, back.is_free, expected);
            free_count += expected;
            if (!expected) assert_int_equal(sight.portal_count, 0);
            if (!expected || (from[1] == HALF * FINE_GRID && to[1] == from[1])) continue;
            passed += sight.portal_count;
            check_chain(&o, &sight, portals);
        }
        close_fixture(&o);
    }
    assert_true(free_count > 10000 && passed > 1000);
}

/// Through a point of a common edge or corner of two triangles of the screen: nothing slips through.
static void nothing_slips_between_triangles(void **state) {
    (void)state;
    uint64_t seed = 12;
    print_message("seed %llu\n", (unsigned long long)seed);
    opened o = open_fixture(NULL);
    for (int n = 0; n < 20000; n++) {
        int64_t at[3] = {0, 0, HALF * FINE_GRID}, from[3], to[3], step = FIXTURE_SPACING * FINE_GRID;
        int64_t along = (int64_t)(next_random(&seed) % (uint64_t)(step + 1)) * (n % 4 != 0);
        at[0] = step * (int64_t)(next_random(&seed) % (SIDE / 2)) + along;
        at[1] = step * (int64_t)(next_random(&seed) % (SIDE / 2)) + (n % 3 ? along : 0);
        for (int a = 0; a < 3; a++) {
            int64_t way = (int64_t)(next_random(&seed) % 2000) - 1000;
            if (a == 2 && way == 0) way = 1;
            from[a] = at[a] + way * 3;
            to[a] = at[a] - way;
        }
        double a[3], b[3];
        to_world(&o, from, a);
        to_world(&o, to, b);
        assert_false(look(&o, a, b, NULL, 0).is_free);
    }
    close_fixture(&o);
}

static void outside_of_cells_nothing_is_seen(void **state) {
    (void)state;
    opened o = open_fixture(NULL);
    double inside[3], rock[3], far[3] = {1e300, 0, 0}, wrong[3] = {0, NAN, 0};
    grid_to_world(&o, 1, 1, 1, inside);
    grid_to_world(&o, HALF + 1, 1, 1, rock);
    assert_true(look(&o, inside, inside, NULL, 0).is_free);
    assert_false(look(&o, inside, rock, NULL, 0).is_free);
    assert_false(look(&o, rock, rock, NULL, 0).is_free);
    assert_false(look(&o, inside, far, NULL, 0).is_free);
    assert_false(look(&o, wrong, inside, NULL, 0).is_free);
    close_fixture(&o);
}

static void detail_stops_those_who_ask(void **state) {
    (void)state;
    opened o = open_fixture(NULL); // the detail lies at z = one spacing, in the first square
    enf_sight_query query = {.size = sizeof query};
    enf_sight sight;
    grid_to_world(&o, 1, 2, 1, query.from);
    grid_to_world(&o, 1, 2, 7, query.to);
    assert_int_equal(enf_sight_between(o.world, NULL, &query, &sight, NULL), ENF_OK);
    assert_true(sight.is_free);
    query.stopped_by_detail = true;
    assert_int_equal(enf_sight_between(o.world, NULL, &query, &sight, NULL), ENF_OK);
    assert_false(sight.is_free);
    assert_int_equal(o.view->triangles[sight.triangle].mesh_polygon, -1);
    close_fixture(&o);
}

// --- Doors
// -------------------------------------------------------------------------------------------------------

static void doors_stop_sight(void **state) {
    (void)state;
    uint64_t seed = 13;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int i = 0; i < FRAME_COUNT; i++) {
        opened o = open_fixture(&frames[i]);
        enf_door closed = {.state = ENF_DOOR_CLOSED}, open = {.state = ENF_DOOR_OPEN},
                 partly = {ENF_DOOR_PARTLY, {0}};
        double origin[3], above[3], unit = 0;
        grid_to_world(&o, 0, 0, HALF + 0.5, origin); // open above it
        grid_to_world(&o, 0, 0, HALF + 1.5, above);
        for (int a = 0; a < 3; a++) unit += (above[a] - origin[a]) * (above[a] - origin[a]);
        for (int a = 0; a < 3; a++) {
            partly.plane[a] = (above[a] - origin[a]) / unit;
            partly.plane[3] -= partly.plane[a] * origin[a];
        }
        for (int n = 0; n < 3000; n++) {
            int64_t from[3], to[3];
            double a[3], b[3];
            random_point(&seed, from);
            random_point(&seed, to);
            from[0] /= 2;
            to[0] /= 2;
            if (!is_free(&o, from, to)) continue;
            if (from[1] == to[1]) continue; // perhaps in the portal's plane
            to_world(&o, from, a);
            to_world(&o, to, b);
            bool across = enf_world_locate(o.world, a, -1).cell != enf_world_locate(o.world, b, -1).cell;
            double share = across ? (double)(HALF * FINE_GRID - from[1]) / (double)(to[1] - from[1]) : 0;
            double height =
                (double)from[2] / FINE_GRID + share * (double)(to[2] - from[2]) / FINE_GRID - HALF - 0.5;
            assert_int_equal(enf_instance_set_door(o.instance, n % 2, &closed, NULL), ENF_OK);
            enf_sight sight = look(&o, a, b, NULL, 0);
            assert_int_equal(sight.is_free, !across);
            assert_int_equal(sight.portal >= 0, across);
            assert_int_equal(enf_instance_set_door(o.instance, n % 2, &partly, NULL), ENF_OK);
            if (fabs(height) > 1e-6) assert_int_equal(look(&o, a, b, NULL, 0).is_free, !across || height > 0);
            assert_int_equal(enf_instance_set_door(o.instance, n % 2, &open, NULL), ENF_OK);
            assert_true(look(&o, a, b, NULL, 0).is_free);
        }
        close_fixture(&o);
    }
}

// --- Rays
// --------------------------------------------------------------------------------------------------------

/// The nearest triangle of input that stops the ray's segment, in doubles; -1: none.
static double nearest_stop(const opened *o, const int64_t from[3], const int64_t to[3]) {
    double nearest = 2;
    for (size_t i = 0; i < o->fixture.build.mesh.polygon_count; i++) {
        int64_t corner[3][3];
        wall_corners(&o->fixture, i, corner);
        if (!triangle_stops(corner, from, to)) continue;
        int axis =
            corner[0][0] == corner[1][0] && corner[1][0] == corner[2][0] ? 0 : 2; // the wall or the screen
        double share = (double)(corner[0][axis] - from[axis]) / (double)(to[axis] - from[axis]);
        if (share < nearest) nearest = share;
    }
    return nearest;
}

static bool triangle_holds(const enf_file_view *view, int32_t triangle, const double point[3]) {
    const int32_t *corners = view->triangles[triangle].point;
    double whole = 0, parts = 0;
    for (int part = -1; part < 3; part++) {
        const double *p[3];
        for (int k = 0; k < 3; k++) p[k] = k == part ? point : view->render_points[corners[k]];
        double square = 0;
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            double area =
                (p[1][b] - p[0][b]) * (p[2][c] - p[0][c]) - (p[1][c] - p[0][c]) * (p[2][b] - p[0][b]);
            square += area * area;
        }
        *(part < 0 ? &whole : &parts) += sqrt(square);
    }
    return fabs(whole - parts) < 1e-9 * whole;
}

static void rays_end_at_the_nearest_wall(void **state) {
    (void)state;
    uint64_t seed = 14;
    int hits = 0, ends = 0;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int i = 0; i < FRAME_COUNT; i++) {
        opened o = open_fixture(&frames[i]);
        double step = frames[i].step;
        for (int n = 0; n < 5000; n++) {
            int64_t from[3], to[3];
            double to_point[3], length = 0;
            random_point(&seed, from);
            random_point(&seed, to);
            from[0] /= 2;
            if (memcmp(from, to, sizeof from) == 0) continue;
            enf_ray ray = {.size = sizeof ray, .ignores_detail = true};
            enf_ray_hit hit;
            to_world(&o, from, ray.origin);
            to_world(&o, to, to_point);
            for (int a = 0; a < 3; a++) {
                ray.direction[a] = to_point[a] - ray.origin[a];
                length += ray.direction[a] * ray.direction[a];
            }
            ray.length = length = sqrt(length);
            assert_int_equal(enf_ray_cast(o.world, o.instance, &ray, &hit, NULL), ENF_OK);
            double share = nearest_stop(&o, from, to);
            // Rounding the direction may decide where a ray just touches.
            bool touches = share < 1 + 1e-9 && share > 1 - 1e-9;
            if (hit.end == ENF_RAY_NOTHING && share > 1) {
                ends++;
                assert_true(fabs(hit.distance - length) < 1e-9 * length);
            } else if (hit.end == ENF_RAY_TRIANGLE && share <= 1) {
                hits++;
                if (fabs(hit.distance - share * length) > 1e-9 * WHOLE * step) touches = true;
                assert_true(triangle_holds(o.view, hit.triangle, hit.point));
            } else {
                touches = true;
            }
            if (touches && from[0] % FIXTURE_SPACING && from[1] % 7 && from[2] % 5 && to[0] % 3 && to[1] % 11)
                fail_msg("frame %d, ray %d: ended as %d at %g, not at %g", i, n, hit.end,
                         hit.distance / length, share);
        }
        close_fixture(&o);
    }
    assert_true(hits > 1000 && ends > 1000);
}

static void rays_without_end_leave_or_hit(void **state) {
    (void)state;
    opened o = open_fixture(NULL);
    enf_ray ray = {.size = sizeof ray, .direction = {1e-200, 0, 0}};
    enf_ray_hit hit;
    int32_t portal = -1;
    grid_to_world(&o, 1, 2, 1, ray.origin);
    assert_int_equal(enf_ray_cast(o.world, NULL, &ray, &hit, NULL), ENF_OK);
    assert_int_equal(hit.end, ENF_RAY_TRIANGLE);
    assert_true(fabs(hit.distance - (HALF - 1) * 0.25) < 1e-12);
    ray.direction[0] = 0;
    ray.direction[1] = 1;
    ray.portals = &portal;
    ray.portal_capacity = 1;
    assert_int_equal(enf_ray_cast(o.world, NULL, &ray, &hit, NULL), ENF_OK);
    assert_int_equal(hit.end, ENF_RAY_NOTHING);
    assert_int_equal(hit.portal_count, 1);
    assert_int_equal(o.view->portals[portal].from, 0);
    assert_int_equal(hit.cell, 1);
    assert_true(fabs(hit.distance - (WHOLE - 2) * 0.25) < 1e-12);
    ray.direction[1] = 0;
    assert_int_equal(enf_ray_cast(o.world, NULL, &ray, &hit, NULL), ENF_BAD_USAGE);
    ray.direction[1] = INFINITY;
    assert_int_equal(enf_ray_cast(o.world, NULL, &ray, &hit, NULL), ENF_BAD_USAGE);
    ray.direction[1] = 1;
    grid_to_world(&o, HALF + 1, 2, 1, ray.origin);
    assert_int_equal(enf_ray_cast(o.world, NULL, &ray, &hit, NULL), ENF_OK);
    assert_int_equal(hit.end, ENF_RAY_NOWHERE);
    close_fixture(&o);
}

// --- Portals that lead elsewhere
// ---------------------------------------------------------------------------------

/// Portal 0 leads from cell 0, at small y, to cell 1. Steps are 1/4.
static void a_mirror_turns_rays_back(void **state) {
    (void)state;
    opened o = open_fixture(NULL);
    double wall = HALF * 0.25, mirror[12] = {1, 0, 0, 0, 0, -1, 0, 2 * wall, 0, 0, 1, 0};
    assert_int_equal(enf_instance_set_transform(o.instance, 0, 0, mirror, NULL), ENF_OK);
    enf_ray ray = {.size = sizeof ray, .direction = {0, 1, 0}};
    enf_ray_hit hit;
    grid_to_world(&o, 1, 2, 1, ray.origin);
    assert_int_equal(enf_ray_cast(o.world, o.instance, &ray, &hit, NULL), ENF_OK);
    assert_int_equal(hit.end, ENF_RAY_NOTHING);
    assert_int_equal(hit.depth, 1);
    assert_int_equal(hit.cell, 0);
    assert_true(hit.direction[1] == -1 && fabs(hit.point[1]) < 1e-12);
    assert_true(fabs(hit.distance - (2 * HALF - 2) * 0.25) < 1e-12);

    double behind[3];
    grid_to_world(&o, 1, HALF + 2, 1, behind);
    assert_false(look(&o, ray.origin, behind, NULL, 0).is_free);
    assert_true(look(&o, behind, ray.origin, NULL, 0).is_free); // the twin leads straight on
    close_fixture(&o);
}

static void rays_that_go_round_end(void **state) {
    (void)state;
    opened o = open_fixture(NULL);
    double back[12] = {1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1, 0}; // one unit back, in front of the portal again
    assert_int_equal(enf_instance_set_transform(o.instance, 0, 0, back, NULL), ENF_OK);
    enf_ray ray = {.size = sizeof ray, .direction = {0, 1, 0}};
    enf_ray_hit hit;
    grid_to_world(&o, 1, 2, 1, ray.origin);
    for (ray.depth_max = 0; ray.depth_max < 40; ray.depth_max += 13) {
        int most = ray.depth_max ? ray.depth_max : 16;
        assert_int_equal(enf_ray_cast(o.world, o.instance, &ray, &hit, NULL), ENF_OK);
        assert_int_equal(hit.end, ENF_RAY_TOO_DEEP);
        assert_int_equal(hit.depth, most);
        assert_true(fabs(hit.distance - ((HALF - 2) * 0.25 + most)) < 1e-9);
        assert_int_equal(hit.portal_count, most + 1);
    }
    close_fixture(&o);
}

// --- Steps
// -------------------------------------------------------------------------------------------------------

static enf_stepped take_step(const opened *o, const enf_place *place, const double from[3],
                             const double to[3], int32_t *portals, int32_t capacity) {
    enf_step step = {.size = sizeof step, .place = *place, .portals = portals, .portal_capacity = capacity};
    enf_stepped stepped;
    memcpy(step.from, from, sizeof step.from);
    memcpy(step.to, to, sizeof step.to);
    assert_int_equal(enf_world_follow(o->world, o->instance, &step, &stepped, NULL), ENF_OK);
    return stepped;
}

static void a_walk_is_followed(void **state) {
    (void)state;
    uint64_t seed = 15;
    print_message("seed %llu\n", (unsigned long long)seed);
    opened o = open_fixture(NULL);
    double at[3] = {0.25, 0.25, 0.25};
    enf_place place = enf_world_locate(o.world, at, -1);
    int passed = 0;
    for (int n = 0; n < 5000; n++) {
        double to[3];
        int32_t portals[4];
        for (int a = 0; a < 3; a++) {
            to[a] = at[a] + 0.6 * (next_unit(&seed) - 0.5);
            to[a] = fmin(fmax(to[a], 0.01), (a == 0 ? HALF : WHOLE) * 0.25 - 0.01);
        }
        enf_stepped stepped = take_step(&o, &place, at, to, portals, 4);
        enf_place expected = enf_world_locate(o.world, to, -1);
        assert_int_equal(stepped.place.cell, expected.cell);
        assert_int_equal(stepped.place.fine_cell, expected.fine_cell);
        assert_int_equal(stepped.portal, -1);
        assert_int_equal(stepped.portal_count, place.cell != expected.cell);
        if (stepped.portal_count) assert_int_equal(o.view->portals[portals[0]].from, place.cell);
        passed += stepped.portal_count;
        place = stepped.place;
        memcpy(at, to, sizeof at);
    }
    assert_true(passed > 20);
    close_fixture(&o);
}

static void steps_obey_doors_and_transforms(void **state) {
    (void)state;
    opened o = open_fixture(NULL);
    double from[3], to[3];
    grid_to_world(&o, 1, HALF - 1, 1, from);
    grid_to_world(&o, 2, HALF + 1, 1, to);
    enf_place place = enf_world_locate(o.world, from, -1);
    enf_door closed = {.state = ENF_DOOR_CLOSED}, open = {.state = ENF_DOOR_OPEN};
    assert_int_equal(enf_instance_set_door(o.instance, 1, &closed, NULL), ENF_OK);
    enf_stepped stepped = take_step(&o, &place, from, to, NULL, 0);
    assert_int_equal(stepped.portal, 0);
    assert_int_equal(stepped.place.cell, 0);
    assert_true(fabs(stepped.point[1] - HALF * 0.25) < 1e-12 && fabs(stepped.point[0] - 1.5 * 0.25) < 1e-12);

    double up[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 2.25}; // to the same place, but higher
    assert_int_equal(enf_instance_set_door(o.instance, 1, &open, NULL), ENF_OK);
    assert_int_equal(enf_instance_set_transform(o.instance, 0, 1, up, NULL), ENF_OK);
    stepped = take_step(&o, &place, from, to, NULL, 0);
    enf_place expected = enf_world_locate(o.world, stepped.point, -1);
    assert_int_equal(stepped.portal, -1);
    assert_int_equal(stepped.depth, 1);
    assert_int_equal(stepped.place.cell, 1);
    assert_int_equal(stepped.place.fine_cell, expected.fine_cell);
    assert_true(fabs(stepped.point[2] - (to[2] + 2.25)) < 1e-12 && fabs(stepped.point[1] - to[1]) < 1e-12);
    assert_memory_equal(stepped.matrix, up, sizeof up);

    double back[12] = {1, 0, 0, 0, 0, 1, 0, -0.01, 0, 0, 1, 0}; // round and round
    assert_int_equal(enf_instance_set_transform(o.instance, 0, 0, back, NULL), ENF_OK);
    stepped = take_step(&o, &place, from, to, NULL, 0);
    assert_int_equal(stepped.depth, 16);
    assert_int_equal(stepped.portal, 0);
    close_fixture(&o);
}

// --- Files that make no sense
// ------------------------------------------------------------------------------------

static const enf_file_section *find_section(const unsigned char *bytes, const char *tag) {
    const enf_file_header *header = (const void *)bytes;
    const enf_file_section *sections = (const void *)(bytes + header->table_offset);
    for (uint32_t i = 0; i < header->section_count; i++) {
        if (strncmp(sections[i].tag, tag, 8) == 0) return &sections[i];
    }
    fail_msg("no section %s", tag);
    return NULL;
}

static void query_everything(opened *o, uint64_t *seed) {
    enf_instance *instance;
    assert_int_equal(enf_instance_create(&instance, o->world, NULL, NULL), ENF_OK);
    enf_door closed = {.state = ENF_DOOR_CLOSED};
    double back[12] = {1, 0, 0, 0, 0, 1, 0, -1, 0, 0, 1, 0};
    for (int n = 0; n < 40; n++) {
        int32_t portals[4];
        enf_sight_query query = {.size = sizeof query, .portals = portals, .portal_capacity = 4};
        enf_step step = {.size = sizeof step, .portals = portals, .portal_capacity = 4};
        enf_ray ray = {.size = sizeof ray, .portals = portals, .portal_capacity = 4};
        for (int a = 0; a < 3; a++) {
            query.from[a] = step.from[a] = ray.origin[a] = next_unit(seed) * WHOLE / 4;
            query.to[a] = step.to[a] = next_unit(seed) * WHOLE / 4;
            ray.direction[a] = query.to[a] - query.from[a];
        }
        enf_sight sight;
        enf_ray_hit hit;
        enf_stepped stepped;
        if (n == 10) enf_instance_set_door(instance, 0, &closed, NULL);
        if (n == 20) enf_instance_set_transform(instance, 1, 1, back, NULL);
        assert_int_equal(enf_sight_between(o->world, instance, &query, &sight, NULL), ENF_OK);
        assert_int_equal(enf_ray_cast(o->world, instance, &ray, &hit, NULL), ENF_OK);
        step.place = sight.from;
        assert_int_equal(enf_world_follow(o->world, instance, &step, &stepped, NULL), ENF_OK);
    }
    enf_instance_free(instance);
}

static void nonsense_ends(void **state) {
    (void)state;
    static const char *const tags[] = {"SIGHT",  "BARRIER", "BARRVERT", "WALLTREE", "PORTTREE",
                                       "RPOINT", "PORTAL",  "BRICKS",   "BRICKTET"};
    uint64_t seed = 16;
    int opened_count = 0;
    print_message("seed %llu\n", (unsigned long long)seed);
    opened o = open_fixture(NULL);
    unsigned char *good = malloc(o.size);
    assert_non_null(good);
    memcpy(good, o.bytes, o.size);
    enf_instance_free(o.instance);
    for (int n = 0; n < 3000; n++) {
        enf_world_close(o.world);
        memcpy(o.bytes, good, o.size);
        const enf_file_section *section = find_section(o.bytes, tags[n % 9]);
        int changes = 1 + (int)(next_random(&seed) % 8);
        for (int k = 0; k < changes && section->size; k++) {
            unsigned char *word = o.bytes + section->offset + next_random(&seed) % (section->size / 4) * 4;
            uint32_t value = (uint32_t)next_random(&seed);
            if (k % 2) value %= 40;
            memcpy(word, &value, sizeof value);
        }
        fixture_fix_checksums(o.bytes);
        if (enf_world_open_memory(&o.world, o.bytes, o.size, NULL, NULL)) continue;
        opened_count++;
        query_everything(&o, &seed);
    }
    assert_true(opened_count > 300);
    o.instance = NULL;
    free(good);
    close_fixture(&o);
}

/// A tag that readers do not know is skipped.
static void a_file_without_the_part_says_so(void **state) {
    (void)state;
    static const char *const tags[] = {"SIGHT", "BARRIER", "BARRVERT", "WALLTREE", "PORTTREE"};
    opened o = open_fixture(NULL);
    for (int i = 0; i < 5; i++) {
        enf_world_close(o.world);
        o.world = NULL;
        ((enf_file_section *)(uintptr_t)find_section(o.bytes, tags[i]))->tag[0] = '?';
        fixture_fix_checksums(o.bytes);
        enf_status status = enf_world_open_memory(&o.world, o.bytes, o.size, NULL, NULL);
        assert_int_equal(status, i < 4 ? ENF_BAD_INPUT : ENF_OK); // all or nothing
    }
    enf_sight_query query = {.size = sizeof query};
    enf_sight sight;
    enf_error error = {0};
    assert_int_equal(enf_sight_between(o.world, NULL, &query, &sight, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "compile the world again"));
    close_fixture(&o);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sight_is_what_the_walls_leave),
        cmocka_unit_test(nothing_slips_between_triangles),
        cmocka_unit_test(outside_of_cells_nothing_is_seen),
        cmocka_unit_test(detail_stops_those_who_ask),
        cmocka_unit_test(doors_stop_sight),
        cmocka_unit_test(rays_end_at_the_nearest_wall),
        cmocka_unit_test(rays_without_end_leave_or_hit),
        cmocka_unit_test(a_mirror_turns_rays_back),
        cmocka_unit_test(rays_that_go_round_end),
        cmocka_unit_test(a_walk_is_followed),
        cmocka_unit_test(steps_obey_doors_and_transforms),
        cmocka_unit_test(nonsense_ends),
        cmocka_unit_test(a_file_without_the_part_says_so),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
