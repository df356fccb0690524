// SPDX-License-Identifier: GPL-3.0-or-later
// Plane recovery: what a rotation or a rounding took from a world comes back, within the tolerance, and
// worlds that lost nothing stay as they are.
#include "build/write.h"
#include "format/locate.h"
#include "tests/clean_fixture.h"
#include "tests/pipeline_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

typedef enum rounding { ROUND_NOT, ROUND_FLOAT, ROUND_DECIMALS, ROUNDING_COUNT } rounding;

/// What a tool does to coordinates.
typedef struct motion {
    double rows[3][3], shift[3];
    rounding how;
} motion;

/// A random rotation, from a quaternion.
static motion random_rotation(uint64_t *seed, rounding how) {
    motion out = {.how = how};
    double q[4], n = 2;
    while (n > 1 || n < 0.01) {
        n = 0;
        for (int i = 0; i < 4; i++) {
            q[i] = (double)(fixture_random(seed) >> 11) * 0x1p-52 - 1;
            n += q[i] * q[i];
        }
    }
    double w = q[0], x = q[1], y = q[2], z = q[3];
    const double rows[3][3] = {{w * w + x * x - y * y - z * z, 2 * (x * y - w * z), 2 * (x * z + w * y)},
                               {2 * (x * y + w * z), w * w - x * x + y * y - z * z, 2 * (y * z - w * x)},
                               {2 * (x * z - w * y), 2 * (y * z + w * x), w * w - x * x - y * y + z * z}};
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) out.rows[i][k] = rows[i][k] / n;
    return out;
}

static void move_point(double *p, const motion *motion, rounding how) {
    double at[3] = {p[0], p[1], p[2]};
    for (int a = 0; a < 3; a++) {
        const double *row = motion->rows[a];
        double x = row[0] * at[0] + row[1] * at[1] + row[2] * at[2] + motion->shift[a];
        p[a] = how == ROUND_FLOAT ? (double)(float)x : how == ROUND_DECIMALS ? nearbyint(x * 1e4) / 1e4 : x;
    }
}

static void move_soup(enf_soup *soup, const motion *motion) {
    for (size_t i = 0; i < soup->point_count; i++) move_point(&soup->points[3 * i], motion, motion->how);
    for (size_t i = 0; i < soup->spawn_count; i++) move_point(&soup->spawns[3 * i], motion, ROUND_NOT);
}

/// Models whose coordinates are decimal fractions; scaled so that four decimals are as fine as the tolerance.
static const char *const models[] = {"four-rooms", "four-rooms-tessellated", "furnished", "post", "office"};
enum { MODELS = sizeof models / sizeof *models };

static void read_model(enf_soup *soup, size_t model) {
    pipeline_read_model(soup, models[model]);
    pipeline_move(soup, (const int[3]){0, 1, 2}, (const int[3]){1, 1, 1}, 64);
}

static void build_soup(enf_build *build, enf_soup *soup) {
    memset(build, 0, sizeof *build);
    build->soup = *soup;
    enf_build_options options = pipeline_options();
    pipeline_build(build, &options);
}

// ---- what comes back

static void turned_and_rounded_worlds_are_what_they_were(void **state) {
    (void)state;
    uint64_t seed = 20261122;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (size_t model = 0; model < MODELS; model++) {
        enf_soup soup;
        enf_build plain;
        read_model(&soup, model);
        build_soup(&plain, &soup);
        for (int how = 0; how < ROUNDING_COUNT; how++) {
            enf_build turned;
            motion motion = random_rotation(&seed, (rounding)how);
            read_model(&soup, model);
            move_soup(&soup, &motion);
            build_soup(&turned, &soup);
            assert_int_equal(turned.mesh.turn_outcome, ENF_TURN_FOUND);
            if (plain.mesh.point_count != turned.mesh.point_count ||
                plain.mesh.polygon_count != turned.mesh.polygon_count ||
                plain.complex.cell_count != turned.complex.cell_count ||
                plain.cell_count != turned.cell_count)
                fail_msg("%s, rounding %d: %zu points, %zu polygons, %d fine cells, %d cells; not %zu, %zu, "
                         "%d, %d",
                         models[model], how, turned.mesh.point_count, turned.mesh.polygon_count,
                         turned.complex.cell_count, turned.cell_count, plain.mesh.point_count,
                         plain.mesh.polygon_count, plain.complex.cell_count, plain.cell_count);
            assert_memory_equal(plain.mesh.points, turned.mesh.points,
                                3 * plain.mesh.point_count * sizeof(double));
            assert_true(pipeline_fingerprint(&plain) == pipeline_fingerprint(&turned));
            assert_true(turned.mesh.displacement_max <= turned.mesh.plane_tolerance);
            pipeline_check(&turned);
            enf_build_free(&turned);
        }
        enf_build_free(&plain);
    }
}

static void caverns_of_slopes_keep_their_rooms(void **state) {
    (void)state;
    uint64_t seed = 77;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int how = 0; how < ROUNDING_COUNT; how++) {
        enf_soup soup;
        enf_build build;
        motion motion = random_rotation(&seed, (rounding)how);
        pipeline_read_model(&soup, "cavern");
        pipeline_move(&soup, (const int[3]){0, 1, 2}, (const int[3]){1, 1, 1}, 64);
        move_soup(&soup, &motion);
        build_soup(&build, &soup);
        assert_false(build.regions.leak);
        for (int32_t s = 0; s < build.regions.spawn_count; s++)
            assert_true(build.regions.spawn_cell[s] >= 0 && build.cell_of[build.regions.spawn_cell[s]] >= 0);
        assert_true(build.mesh.displacement_max <= build.mesh.plane_tolerance + build.mesh.weld);
        pipeline_check(&build);
        enf_build_free(&build);
    }
}

/// A turned world that is shuffled, mirrored, turned by right angles or scaled by a power of two gives the
/// same.
static void what_comes_back_does_not_depend_on_the_order_or_on_right_angles(void **state) {
    (void)state;
    static const int axes[3][3] = {{1, 0, 2}, {2, 0, 1}, {0, 2, 1}};
    static const int signs[3][3] = {{-1, 1, 1}, {1, 1, -1}, {-1, -1, -1}};
    uint64_t seed = 4;
    print_message("seed %llu\n", (unsigned long long)seed);
    motion motion = random_rotation(&seed, ROUND_FLOAT);
    uint64_t expected = 0;
    for (int round = 0; round < 4; round++) {
        enf_soup soup, shuffled;
        enf_build build;
        pipeline_read_model(&soup, "cavern"); // hardly a lattice: nothing hides a difference in the last bits
        move_soup(&soup, &motion);
        if (round) {
            pipeline_move(&soup, axes[round - 1], signs[round - 1], ldexp(1, 5 * round));
            pipeline_shuffle(&soup, &shuffled, seed);
            enf_soup_free(&soup);
            soup = shuffled;
        }
        build_soup(&build, &soup);
        assert_int_equal(build.mesh.turn_outcome, ENF_TURN_FOUND);
        if (round == 0) expected = pipeline_fingerprint(&build);
        assert_true(pipeline_fingerprint(&build) == expected);
        enf_build_free(&build);
    }
}

static void a_shifted_lattice_is_a_lattice_too(void **state) {
    (void)state;
    uint64_t seed = 8;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int how = 0; how < ROUNDING_COUNT; how++) {
        enf_soup soup = {0};
        // Boxes and, between them, a slope whose corners lie in one plane only if whole numbers come back
        // whole.
        for (int i = 0; i < 20; i++) {
            double low[3], high[3];
            for (int a = 0; a < 3; a++) {
                low[a] = (double)(fixture_random(&seed) % 1000);
                high[a] = low[a] + 10 + (double)(fixture_random(&seed) % 100);
            }
            fixture_add_box(&soup, low, high, "");
        }
        const double slope[4][3] = {{0, 0, 0}, {700, 0, 300}, {700, 900, 1200}, {0, 900, 900}};
        fixture_add_polygon(&soup, 4, slope, "");
        motion motion = random_rotation(&seed, (rounding)how);
        for (int a = 0; a < 3; a++) motion.shift[a] = 100 * (double)(fixture_random(&seed) % 1000) / 999;
        move_soup(&soup, &motion);
        enf_mesh mesh;
        assert_int_equal(enf_mesh_clean(&mesh, &soup, NULL, NULL), ENF_OK);
        assert_int_equal(mesh.turn_outcome, ENF_TURN_FOUND);
        assert_int_equal(mesh.lattices, 3);
        assert_int_equal(mesh.triangulated, 0);
        assert_int_equal(mesh.polygon_count, soup.polygon_count);
        fixture_check_mesh(&mesh);
        enf_mesh_free(&mesh);
        enf_soup_free(&soup);
    }
}

// ---- what stays

static void clean_worlds_stay_bit_for_bit(void **state) {
    (void)state;
    for (size_t model = 0; model < MODELS; model++) {
        enf_soup soup;
        enf_mesh exact, mesh;
        read_model(&soup, model);
        assert_int_equal(enf_mesh_clean(&exact, &soup, &fixture_exact_options, NULL), ENF_OK);
        assert_int_equal(exact.turn_outcome, ENF_TURN_OFF);
        assert_int_equal(enf_mesh_clean(&mesh, &soup, NULL, NULL), ENF_OK);
        assert_true(mesh.turn_outcome == ENF_TURN_ROUND || mesh.turn_outcome == ENF_TURN_ALIGNED);
        assert_false(mesh.flattened || mesh.frame.is_turned);
        assert_int_equal(mesh.point_count, exact.point_count);
        assert_memory_equal(mesh.points, exact.points, 3 * exact.point_count * sizeof(double));
        enf_mesh_free(&exact);
        enf_mesh_free(&mesh);
        enf_soup_free(&soup);
    }
}

static void without_a_tolerance_nothing_is_turned(void **state) {
    (void)state;
    uint64_t seed = 12;
    enf_soup soup;
    enf_mesh mesh;
    motion motion = random_rotation(&seed, ROUND_NOT);
    read_model(&soup, 0);
    move_soup(&soup, &motion);
    enf_clean_options options = {.weld = -1, .plane_tolerance = 0};
    assert_int_equal(enf_mesh_clean(&mesh, &soup, &options, NULL), ENF_OK);
    assert_int_equal(mesh.turn_outcome, ENF_TURN_OFF);
    assert_false(mesh.frame.is_turned || mesh.flattened);
    assert_true(mesh.displacement_max <= mesh.weld);
    enf_mesh_free(&mesh);
    enf_soup_free(&soup);
}

/// Triangles at random angles show no common axes, and no coordinate of theirs is moved.
static void worlds_of_slopes_are_not_touched(void **state) {
    (void)state;
    uint64_t seed = 13;
    enf_soup soup = {0};
    enf_mesh mesh;
    for (int t = 0; t < 300; t++) {
        double at[3][3];
        for (int k = 0; k < 9; k++) at[k / 3][k % 3] = (double)(fixture_random(&seed) >> 11) * 0x1p-43;
        fixture_add_polygon(&soup, 3, (const double(*)[3])at, "");
    }
    assert_int_equal(enf_mesh_clean(&mesh, &soup, NULL, NULL), ENF_OK);
    assert_int_equal(mesh.turn_outcome, ENF_TURN_NONE);
    assert_false(mesh.flattened);
    assert_true(mesh.displacement_max <= mesh.frame.step);
    enf_mesh_free(&mesh);
    enf_soup_free(&soup);
}

// ---- how far points may move

/// The distance from a point to the mesh's nearest one, in the user's coordinates.
static double distance_to_mesh(const enf_mesh *mesh, const double p[3]) {
    double best = INFINITY;
    for (size_t i = 0; i < mesh->point_count; i++) {
        double world[3];
        enf_frame_to_world(&mesh->frame, &mesh->points[3 * i], world);
        double square = 0;
        for (int a = 0; a < 3; a++) square += (world[a] - p[a]) * (world[a] - p[a]);
        best = fmin(best, square);
    }
    return sqrt(best);
}

static void no_point_moves_farther_than_the_tolerance(void **state) {
    (void)state;
    uint64_t seed = 21;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 12; round++) {
        // Floors nearer to each other than the tolerance, torn and turned: clusters without end, if they
        // chained.
        enf_soup soup = {0};
        enf_clean_options options = {.weld = 0, .plane_tolerance = 0.01 * (1 + round % 3)};
        for (int i = 0; i < 60; i++) {
            double low[3] = {(double)(fixture_random(&seed) % 50), (double)(fixture_random(&seed) % 50),
                             0.004 * i},
                   high[3];
            for (int a = 0; a < 3; a++) high[a] = low[a] + 8 + (double)(fixture_random(&seed) % 8);
            fixture_add_box(&soup, low, high, "");
        }
        for (size_t i = 0; i < 3 * soup.point_count; i++)
            soup.points[i] += 0.004 * ((double)(fixture_random(&seed) >> 11) * 0x1p-53 - 0.5);
        motion motion = random_rotation(&seed, ROUND_NOT);
        if (round % 2) move_soup(&soup, &motion);
        enf_mesh mesh;
        assert_int_equal(enf_mesh_clean(&mesh, &soup, &options, NULL), ENF_OK);
        assert_int_equal(mesh.frame.is_turned, round % 2);
        assert_true(mesh.flattened && mesh.polygon_count < 2 * soup.polygon_count);
        double bound = options.plane_tolerance * (1 + 1e-12), largest = 0;
        for (size_t i = 0; i < soup.point_count; i++)
            largest = fmax(largest, distance_to_mesh(&mesh, &soup.points[3 * i]));
        assert_true(largest <= mesh.displacement_max && mesh.displacement_max <= bound);
        assert_true(mesh.displacement_mean > 0 && mesh.displacement_mean <= mesh.displacement_max);
        enf_mesh_free(&mesh);
        enf_soup_free(&soup);
    }
}

// ---- what the runtime sees

static void a_turned_world_answers_in_the_users_coordinates(void **state) {
    (void)state;
    uint64_t seed = 31;
    print_message("seed %llu\n", (unsigned long long)seed);
    enf_soup soup;
    enf_build plain, turned;
    enf_build_image plain_image, image;
    motion motion = random_rotation(&seed, ROUND_FLOAT);
    read_model(&soup, 0);
    build_soup(&plain, &soup);
    read_model(&soup, 0);
    move_soup(&soup, &motion);
    build_soup(&turned, &soup);
    assert_int_equal(enf_build_image_make(&plain_image, &plain, NULL, NULL), ENF_OK);
    assert_int_equal(enf_build_image_make(&image, &turned, NULL, NULL), ENF_OK);
    assert_non_null(image.view.turn);
    assert_null(plain_image.view.turn);
    const enf_file_frame *box = plain_image.view.frame;
    int differences = 0, inside = 0;
    for (int i = 0; i < 20000; i++) {
        double at[3];
        for (int a = 0; a < 3; a++)
            at[a] = box->box_min[a] +
                    (box->box_max[a] - box->box_min[a]) * ((double)(fixture_random(&seed) >> 11) * 0x1p-53);
        enf_place here = enf_view_locate(&plain_image.view, at, -1);
        move_point(at, &motion, ROUND_NOT);
        enf_place there = enf_view_locate(&image.view, at, -1);
        differences += here.fine_cell != there.fine_cell;
        inside += here.cell >= 0;
    }
    assert_true(inside > 1000);
    assert_true(differences <= 20); // points nearer to a wall than single precision took from it
    for (int32_t i = 0; i < image.view.portal_vertex_count; i++) {
        double at[3], square = 0; // the same portals, where the user has them
        memcpy(at, plain_image.view.portal_vertices[i], sizeof at);
        move_point(at, &motion, ROUND_NOT);
        for (int a = 0; a < 3; a++) square += pow(at[a] - image.view.portal_vertices[i][a], 2);
        assert_true(sqrt(square) <= 2 * turned.mesh.plane_tolerance);
    }
    enf_build_image_free(&plain_image);
    enf_build_image_free(&image);
    enf_build_free(&plain);
    enf_build_free(&turned);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(turned_and_rounded_worlds_are_what_they_were),
        cmocka_unit_test(caverns_of_slopes_keep_their_rooms),
        cmocka_unit_test(what_comes_back_does_not_depend_on_the_order_or_on_right_angles),
        cmocka_unit_test(a_shifted_lattice_is_a_lattice_too),
        cmocka_unit_test(clean_worlds_stay_bit_for_bit),
        cmocka_unit_test(without_a_tolerance_nothing_is_turned),
        cmocka_unit_test(worlds_of_slopes_are_not_touched),
        cmocka_unit_test(no_point_moves_farther_than_the_tolerance),
        cmocka_unit_test(a_turned_world_answers_in_the_users_coordinates),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
