// SPDX-License-Identifier: GPL-3.0-or-later
// Every exact decision of build/geometry.h, build/loop.h and base/exact.h against the oracle, on points that
// are mostly degenerate: small lattices, few planes shared by many points, and those moved by one grid step
// at the largest magnitude.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/exact.h"
#include "build/loop.h"
#include "oracle.h"

enum { POINTS = 14, PLANES = 12, CROSSINGS = 10, SCENE_KINDS = 12 };

static const uint64_t seed = 1122;

static uint64_t next_random(uint64_t *state) {
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static int64_t between(uint64_t *state, int64_t low, int64_t high) {
    return low + (int64_t)(next_random(state) % (uint64_t)(high - low + 1));
}

/// How many cases: `usual`, times the environment variable ENFILADE_TEST_SCALE.
static long scaled(long usual) {
    const char *text = getenv("ENFILADE_TEST_SCALE");
    double scale = text ? atof(text) : 1;
    return scale > 0 ? (long)ceil((double)usual * scale) : usual;
}

// ---- Scenes: points and planes ----

typedef struct scene {
    int kind;
    double points[3 * POINTS];
    int32_t planes[PLANES][3];
    enf_plane_filter filters[PLANES];
    enf_geometry geometry;
} scene;

static const int64_t largest = INT64_C(1) << 53;

static int64_t clamp(int64_t x) {
    return x > largest ? largest : x < -largest ? -largest : x;
}

static void random_points(scene *s, uint64_t *state) {
    const int64_t unit = INT64_C(1) << 50;
    const int64_t few =
        INT64_C(8) << between(state, 0, 8); // as many bits as doubles just can, or just can't, take
    int64_t origin[3], u[3], v[3], levels[3][3];
    for (int k = 0; k < 3; k++) {
        origin[k] = between(state, -largest / 2, largest / 2);
        u[k] = between(state, -unit, unit);
        v[k] = between(state, -unit, unit);
        for (int i = 0; i < 3; i++) levels[k][i] = between(state, -largest, largest);
    }
    for (int p = 0; p < POINTS; p++) {
        int64_t i = between(state, -1, 1), j = between(state, -1, 1);
        for (int k = 0; k < 3; k++) {
            int64_t jitter = between(state, 0, 5) == 0 ? between(state, -1, 1) : 0, x = 0;
            switch (s->kind) {
            case 0:
                x = between(state, -2, 2);
                break; // a small lattice
            case 1:
                x = between(state, -4, 4) * 2 * unit;
                break; // the same, as large as can be
            case 2:
                x = between(state, -largest, largest);
                break; // anywhere
            case 3:
                x = between(state, -4, 4) * 2 * unit + jitter;
                break; // a lattice, not quite
            case 4:
                x = levels[k][between(state, 0, 2)];
                break; // corners of boxes
            case 5:
                x = origin[k] + i * u[k] + j * v[k];
                break; // all in one plane
            case 6:
                x = origin[k] + i * u[k] + j * v[k] + jitter;
                break; // nearly
            case 7:
                x = between(state, -(INT64_C(1) << 20), INT64_C(1) << 20) * 64;
                break; // few significant bits
            case 8:
                x = i * largest + between(state, -2, 2);
                break; // near a diagonal of the whole grid
            case 9:
                x = k == 0 ? origin[0] : i * largest + between(state, -2, 2);
                break; // that in an axis plane
            case 10:
                x = levels[k][between(state, 0, 2)] % few;
                break; // corners of small boxes
            default:
                x = (origin[k] % few) + i * (u[k] % few) + j * (v[k] % few);
                break; // in a plane, and small
            }
            s->points[3 * p + k] = (double)clamp(x);
        }
    }
}

static const double *point_at(const scene *s, int32_t p) {
    return s->points + 3 * p;
}

static oracle_plane describe(const scene *s, const int32_t defined[3]) {
    oracle_plane plane = {.axis = defined[2] < 0 ? -1 - defined[2] : -1};
    memcpy(plane.p, point_at(s, defined[0]), sizeof plane.p);
    memcpy(plane.q, point_at(s, defined[1]), sizeof plane.q);
    if (defined[2] >= 0) memcpy(plane.r, point_at(s, defined[2]), sizeof plane.r);
    return plane;
}

static oracle_corner describe_vertex(const scene *s, const enf_geometry *geometry, int32_t vertex) {
    oracle_corner corner = {.is_point = vertex < POINTS};
    if (corner.is_point) {
        memcpy(corner.point, point_at(s, vertex), sizeof corner.point);
        return corner;
    }
    const enf_crossing *crossing = enf_geometry_crossing(geometry, vertex);
    for (int i = 0; i < 3; i++) corner.planes[i] = describe(s, s->planes[crossing->plane[i]]);
    return corner;
}

static void describe_planes(const scene *s, oracle_plane planes[PLANES]) {
    for (int32_t p = 0; p < PLANES; p++) planes[p] = describe(s, s->planes[p]);
}

static bool random_planes(scene *s, uint64_t *state) {
    for (int i = 0; i < PLANES; i++) {
        oracle_plane plane;
        int tries = 0;
        do {
            for (int k = 0; k < 3; k++) s->planes[i][k] = (int32_t)between(state, 0, POINTS - 1);
            if (between(state, 0, 2) == 0) s->planes[i][2] = -1 - (int32_t)between(state, 0, 2);
            if (i > 0 && between(state, 0, 3) == 0) { // shares an edge with the one before
                s->planes[i][0] = s->planes[i - 1][1];
                s->planes[i][1] = s->planes[i - 1][0];
            }
            plane = describe(s, s->planes[i]);
        } while (!oracle_spans(&plane) && ++tries < 200);
        if (tries == 200) return false;
    }
    return true;
}

/// False for points of which no plane can be made.
static bool make_scene(scene *s, int kind, uint64_t *state) {
    memset(s, 0, sizeof *s);
    s->kind = kind;
    random_points(s, state);
    if (!random_planes(s, state)) return false;
    s->geometry = (enf_geometry){.point_count = POINTS,
                                 .points = s->points,
                                 .planes = s->planes,
                                 .filters = s->filters,
                                 .plane_count = PLANES};
    for (int32_t i = 0; i < PLANES; i++) enf_geometry_set_plane(&s->geometry, i);
    return true;
}

static bool random_crossing(scene *s, enf_geometry *geometry, uint64_t *state, int32_t *vertex) {
    for (int tries = 0; tries < 50; tries++) {
        int32_t p[3];
        oracle_plane planes[3];
        for (int i = 0; i < 3; i++) {
            p[i] = (int32_t)between(state, 0, PLANES - 1);
            planes[i] = describe(s, s->planes[p[i]]);
        }
        if (!oracle_crosses(planes)) continue;
        *vertex = enf_geometry_cross(geometry, p[0], p[1], p[2]);
        return true;
    }
    return false;
}

// ---- Predicates ----

static void orientation_of_four_points_is_right(void **unused) {
    (void)unused;
    uint64_t state = seed;
    for (long i = 0; i < scaled(120000); i++) {
        scene s = {.kind = (int)(i % SCENE_KINDS)};
        random_points(&s, &state);
        for (int k = 0; k < 10; k++) {
            const double *p[4];
            for (int j = 0; j < 4; j++) p[j] = point_at(&s, (int32_t)between(&state, 0, POINTS - 1));
            assert_int_equal(enf_points_orient(p[0], p[1], p[2], p[3]),
                             oracle_orient(p[0], p[1], p[2], p[3]));
        }
    }
}

static void side_of_a_plane_is_right(void **unused) {
    (void)unused;
    uint64_t state = seed + 1, zeros = 0, cases = 0, decided[ENF_TIERS] = {0};
    oracle_plane planes[PLANES];
    for (long i = 0; i < scaled(4500); i++) {
        scene s;
        if (!make_scene(&s, (int)(i % SCENE_KINDS), &state)) continue;
        enf_kept_filters kept = {0};
        if (between(&state, 0, 1)) s.geometry.kept = &kept;
        int32_t vertex;
        for (int k = 0; k < CROSSINGS; k++) {
            if (!random_crossing(&s, &s.geometry, &state, &vertex)) break;
        }
        for (vertex = 0; vertex < POINTS + s.geometry.crossing_count; vertex++) {
            oracle_corner corner = describe_vertex(&s, &s.geometry, vertex);
            int expected[PLANES];
            describe_planes(&s, planes);
            oracle_sides(&corner, planes, PLANES, expected);
            for (int32_t p = 0; p < PLANES; p++) {
                if (cases++ % 256 == 0)
                    assert_int_equal(expected[p], oracle_side_by_kernel(&corner, &planes[p]));
                zeros += expected[p] == 0;
                assert_int_equal(enf_geometry_side(&s.geometry, vertex, p), expected[p]);
            }
        }
        for (int k = 0; k < ENF_TIERS; k++) decided[k] += s.geometry.decided[k];
        free(s.geometry.crossings);
    }
    printf("%llu cases, %llu of them on the plane; %llu by the filter, %llu in pairs, %llu exactly\n",
           (unsigned long long)cases, (unsigned long long)zeros, (unsigned long long)decided[ENF_TIER_FILTER],
           (unsigned long long)decided[ENF_TIER_PAIRS], (unsigned long long)decided[ENF_TIER_EXACT]);
    // The cases are as hard as they are meant to be.
    assert_true(zeros > cases / 20 && decided[ENF_TIER_FILTER] > 0 && decided[ENF_TIER_PAIRS] > cases / 400 &&
                decided[ENF_TIER_EXACT] > cases / 20);
}

/// A quarter of a grid step for what the filter lets pass, and a few roundings to double.
static double position_bound(const double position[3]) {
    double size = fmax(fabs(position[0]), fmax(fabs(position[1]), fabs(position[2])));
    return 0.26 + 0x1p-50 * size;
}

static void positions_are_close_to_the_crossing(void **unused) {
    (void)unused;
    uint64_t state = seed + 3, inside = 0;
    for (long i = 0; i < scaled(2000); i++) {
        scene s;
        if (!make_scene(&s, (int)(i % SCENE_KINDS), &state)) continue;
        int32_t vertex;
        for (int k = 0; k < CROSSINGS && random_crossing(&s, &s.geometry, &state, &vertex); k++) {
            double position[3], error;
            oracle_corner corner = describe_vertex(&s, &s.geometry, vertex);
            enf_geometry_position(&s.geometry, vertex, position);
            if (!oracle_position_error(&corner, position, 0x1p53, &error)) continue;
            inside++;
            assert_true(error <= position_bound(position));
        }
        free(s.geometry.crossings);
    }
    assert_true(inside > (uint64_t)scaled(2000));
}

static void dominant_axis_and_facing_are_right(void **unused) {
    (void)unused;
    uint64_t state = seed + 4, parallel = 0;
    for (long i = 0; i < scaled(4000); i++) {
        scene s;
        if (!make_scene(&s, (int)(i % SCENE_KINDS), &state)) continue;
        for (int32_t p = 0; p < PLANES; p++) {
            if (s.planes[p][2] < 0) continue;
            int sign = 0, expected_sign = 0;
            oracle_plane plane = describe(&s, s.planes[p]);
            assert_int_equal(enf_geometry_dominant_axis(&s.geometry, s.planes[p], &sign),
                             oracle_dominant_axis(&plane, &expected_sign));
            assert_int_equal(sign, expected_sign);
            for (int32_t q = 0; q < p; q++) {
                if (s.planes[q][2] < 0) continue;
                bool same = true;
                for (int k = 0; k < 3; k++)
                    same = same && enf_geometry_side(&s.geometry, s.planes[q][k], p) == 0;
                if (!same) continue;
                parallel++;
                oracle_plane other = describe(&s, s.planes[q]);
                assert_int_equal(enf_geometry_same_way(&s.geometry, p, q), oracle_same_way(&plane, &other));
            }
        }
    }
    assert_true(parallel > 0);
}

// ---- Loops ----

/// The corners of a loop for the oracle. The caller frees them.
static oracle_corner *describe_loop(const scene *s, const enf_pool *pool, enf_loop loop) {
    oracle_corner *corners = calloc((size_t)loop.count + 1, sizeof *corners);
    assert_non_null(corners);
    for (int32_t i = 0; i < loop.count; i++)
        corners[i] = describe_vertex(s, &pool->geometry, pool->corners[loop.first + i].vertex);
    return corners;
}

/// The loop is a convex polygon on its plane: every edge plane holds the ends of its edge, and no corner but
/// those lies on the other side of it.
static void assert_convex(const scene *s, enf_pool *pool, enf_loop loop) {
    enum { MOST = 64 };
    assert_true(loop.count >= 3 && loop.count < MOST);
    oracle_corner *corners = describe_loop(s, pool, loop);
    oracle_plane planes[MOST]; // of the edges, then the loop's
    int inner[MOST], sides[MOST];
    for (int32_t i = 0; i < loop.count; i++) {
        planes[i] = describe(s, s->planes[pool->corners[loop.first + i].edge_plane]);
        inner[i] = enf_pool_edge_side(pool, loop, i);
        assert_int_not_equal(inner[i], 0);
    }
    planes[loop.count] = describe(s, s->planes[loop.plane]);
    for (int32_t k = 0; k < loop.count; k++) {
        oracle_sides(&corners[k], planes, loop.count + 1, sides);
        assert_int_equal(sides[loop.count], 0);
        for (int32_t i = 0; i < loop.count; i++)
            assert_int_equal(sides[i], k == i || k == (i + 1) % loop.count ? 0 : inner[i]);
    }
    free(corners);
}

/// A triangle on plane 0 with edge planes that are not parallel to it; planes 0 to 3 are set for it. False if
/// the points drawn are of no use.
static bool make_triangle(scene *s, enf_pool *pool, uint64_t *state, enf_loop *triangle) {
    int32_t corner[3];
    for (int i = 0; i < 3; i++) corner[i] = (int32_t)between(state, 0, POINTS - 1);
    oracle_plane plane = describe(s, corner);
    if (!oracle_spans(&plane)) return false;
    int sign;
    int axis = oracle_dominant_axis(&plane, &sign);
    enf_corner corners[3];
    memcpy(s->planes[0], corner, sizeof corner);
    for (int32_t i = 0; i < 3; i++) {
        s->planes[1 + i][0] = corner[i];
        s->planes[1 + i][1] = corner[(i + 1) % 3];
        s->planes[1 + i][2] = -1 - axis;
        corners[i] = (enf_corner){corner[i], 1 + i};
    }
    for (int32_t i = 0; i < 4; i++) enf_geometry_set_plane(&s->geometry, i);
    pool->geometry = s->geometry;
    *triangle = enf_pool_loop(pool, 0, corners, 3);
    return true;
}

static enf_position oracle_classify(const scene *s, const enf_pool *pool, enf_loop loop, int32_t plane) {
    oracle_corner *corners = describe_loop(s, pool, loop);
    oracle_plane by = describe(s, s->planes[plane]);
    bool behind = false, front = false;
    for (int32_t i = 0; i < loop.count; i++) {
        int side;
        oracle_sides(&corners[i], &by, 1, &side);
        behind = behind || side < 0;
        front = front || side > 0;
    }
    free(corners);
    return behind && front ? ENF_POSITION_ACROSS
           : behind        ? ENF_POSITION_BEHIND
           : front         ? ENF_POSITION_FRONT
                           : ENF_POSITION_ON;
}

/// Area(whole) = area(one) + area(two), all turning the same way.
static void assert_areas_add_up(const scene *s, const enf_pool *pool, enf_loop whole, enf_loop one,
                                enf_loop two) {
    oracle_corner *corners[3] = {describe_loop(s, pool, whole), describe_loop(s, pool, one),
                                 describe_loop(s, pool, two)};
    oracle_plane plane = describe(s, s->planes[0]);
    int sign, sign_of_area, expected = 0;
    int axis = oracle_dominant_axis(&plane, &expected);
    sign = oracle_compare_areas(axis, corners[0], whole.count, corners[1], one.count, corners[2], two.count,
                                &sign_of_area);
    assert_int_equal(sign, 0);
    assert_int_equal(sign_of_area, expected);
    oracle_compare_areas(axis, corners[1], one.count, NULL, 0, NULL, 0, &sign_of_area);
    assert_int_equal(sign_of_area, expected);
    oracle_compare_areas(axis, corners[2], two.count, NULL, 0, NULL, 0, &sign_of_area);
    assert_int_equal(sign_of_area, expected);
    for (int i = 0; i < 3; i++) free(corners[i]);
}

static void cutting_a_loop_loses_no_area(void **unused) {
    (void)unused;
    uint64_t state = seed + 5, cuts = 0;
    for (long i = 0; i < scaled(1500); i++) {
        scene s;
        enf_pool pool = {0};
        enf_loop loop;
        if (!make_scene(&s, (int)(i % SCENE_KINDS), &state) || !make_triangle(&s, &pool, &state, &loop))
            continue;
        assert_convex(&s, &pool, loop);
        for (int32_t p = 4; p < PLANES; p++) {
            enf_position position = enf_pool_classify(&pool, loop, p);
            assert_int_equal(position, oracle_classify(&s, &pool, loop, p));
            if (position != ENF_POSITION_ACROSS) continue;
            enf_loop behind, front;
            enf_pool_cut(&pool, loop, p, &behind, &front);
            assert_false(pool.failed);
            cuts++;
            assert_int_equal(oracle_classify(&s, &pool, behind, p), ENF_POSITION_BEHIND);
            assert_int_equal(oracle_classify(&s, &pool, front, p), ENF_POSITION_FRONT);
            assert_convex(&s, &pool, behind);
            assert_convex(&s, &pool, front);
            assert_areas_add_up(&s, &pool, loop, behind, front);
            loop = between(&state, 0, 1) ? behind : front;
        }
        enf_pool_free(&pool);
    }
    assert_true(cuts > (uint64_t)scaled(1500));
}

static void keeping_both_sides_keeps_all_area(void **unused) {
    (void)unused;
    uint64_t state = seed + 6;
    for (long i = 0; i < scaled(2000); i++) {
        scene s;
        enf_pool pool = {0};
        enf_loop loop;
        if (!make_scene(&s, (int)(i % SCENE_KINDS), &state) || !make_triangle(&s, &pool, &state, &loop))
            continue;
        for (int32_t p = 4; p < PLANES; p++) {
            enf_position position = oracle_classify(&s, &pool, loop, p);
            enf_loop behind = loop, front = loop;
            bool some_behind = enf_pool_keep(&pool, &behind, p, -1),
                 some_front = enf_pool_keep(&pool, &front, p, 1);
            assert_int_equal(some_behind, position == ENF_POSITION_BEHIND || position == ENF_POSITION_ACROSS);
            assert_int_equal(some_front, position == ENF_POSITION_FRONT || position == ENF_POSITION_ACROSS);
            if (some_behind && some_front) assert_areas_add_up(&s, &pool, loop, behind, front);
            if (some_behind && !some_front) assert_int_equal(behind.first, loop.first);
            if (some_behind || some_front) loop = some_behind ? behind : front;
        }
        enf_pool_free(&pool);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(orientation_of_four_points_is_right),
        cmocka_unit_test(side_of_a_plane_is_right),
        cmocka_unit_test(positions_are_close_to_the_crossing),
        cmocka_unit_test(dominant_axis_and_facing_are_right),
        cmocka_unit_test(cutting_a_loop_loses_no_area),
        cmocka_unit_test(keeping_both_sides_keeps_all_area),
    };
    printf("seed %llu\n", (unsigned long long)seed);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
