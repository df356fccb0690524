// SPDX-License-Identifier: GPL-3.0-or-later
// Plane recovery: what a rotation or a rounding took from a world comes back, within the tolerance, and worlds
// that lost nothing stay as they are.
#include "build/flatten.h"
#include "build/turn.h"
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

/// Models whose coordinates are round numbers; scaled so that four decimals are as fine as the tolerance.
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
                plain.complex.cell_count != turned.complex.cell_count || plain.cell_count != turned.cell_count)
                fail_msg("%s, rounding %d: %zu points, %zu polygons, %d fine cells, %d cells; not %zu, %zu, %d, %d",
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

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(turned_and_rounded_worlds_are_what_they_were),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
