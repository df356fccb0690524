// SPDX-License-Identifier: GPL-3.0-or-later
// Soups as bad as they come: random and degenerate polygons go through the whole recipe, and every invariant
// is checked exactly. ENFILADE_TEST_SCALE multiplies the number of seeds.
#include "clean_fixture.h"
#include "pipeline_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static double uniform(uint64_t *seed, double low, double high) {
    return low + (high - low) * (double)(fixture_random(seed) >> 11) * 0x1p-53;
}

static void random_point(uint64_t *seed, double size, double at[3]) {
    for (int k = 0; k < 3; k++) at[k] = uniform(seed, -size, size);
}

static void lattice_point(uint64_t *seed, int side, double at[3]) {
    for (int k = 0; k < 3; k++) at[k] = (double)(fixture_random(seed) % (uint64_t)side);
}

static void add_random_triangles(enf_soup *soup, uint64_t *seed) {
    for (int i = 0; i < 24; i++) {
        double at[3][3];
        for (int k = 0; k < 3; k++) random_point(seed, 10, at[k]);
        fixture_add_polygon(soup, 3, (const double(*)[3])at, "a");
    }
}

/// Coplanar, collinear and shared in every way.
static void add_lattice_triangles(enf_soup *soup, uint64_t *seed) {
    for (int i = 0; i < 40; i++) {
        double at[3][3];
        for (int k = 0; k < 3; k++) lattice_point(seed, 4, at[k]);
        fixture_add_polygon(soup, 3, (const double(*)[3])at, "a");
    }
}

static void add_coplanar_stack(enf_soup *soup, uint64_t *seed) {
    double tilt = uniform(seed, -1, 1);
    for (int i = 0; i < 12; i++) {
        double x = uniform(seed, 0, 6), y = uniform(seed, 0, 6), w = uniform(seed, 1, 5),
               h = uniform(seed, 1, 5);
        double z = i % 3 ? 0 : 1e-9 * i;
        const double at[4][3] = {{x, y, tilt * x + z},
                                 {x + w, y, tilt * (x + w) + z},
                                 {x + w, y + h, tilt * (x + w) + z},
                                 {x, y + h, tilt * x + z}};
        fixture_add_polygon(soup, 4, at, "a");
    }
    fixture_add_box(soup, (const double[]){-1, -1, -20}, (const double[]){20, 20, 20}, "hull");
}

static void add_overlapping_boxes(enf_soup *soup, uint64_t *seed) {
    for (int i = 0; i < 6; i++) {
        double low[3], high[3];
        for (int k = 0; k < 3; k++) {
            low[k] = (double)(fixture_random(seed) % 6);
            high[k] = low[k] + 1 + (double)(fixture_random(seed) % 5);
        }
        fixture_add_box(soup, low, high, "a");
    }
}

static void add_turned_boxes(enf_soup *soup, uint64_t *seed) {
    add_overlapping_boxes(soup, seed);
    double angle = uniform(seed, 0, 7), c = cos(angle), s = sin(angle);
    for (size_t i = 0; i < soup->point_count; i++) {
        double *p = soup->points + 3 * i, x = p[0], y = p[1];
        p[0] = c * x - s * y;
        p[1] = s * x + c * y;
        y = p[1];
        p[1] = c * y - s * p[2];
        p[2] = s * y + c * p[2];
    }
}

static void add_slivers(enf_soup *soup, uint64_t *seed) {
    for (int i = 0; i < 20; i++) {
        double at[3][3];
        random_point(seed, 10, at[0]);
        random_point(seed, 10, at[1]);
        for (int k = 0; k < 3; k++) at[2][k] = (at[0][k] + at[1][k]) / 2 + uniform(seed, -1e-7, 1e-7);
        fixture_add_polygon(soup, 3, (const double(*)[3])at, "a");
    }
}

static void add_jittered_cubes(enf_soup *soup, uint64_t *seed) {
    double jitter = pow(10, -uniform(seed, 2, 15));
    for (int i = 0; i < 4; i++) {
        double low[3], high[3];
        for (int k = 0; k < 3; k++) {
            low[k] = uniform(seed, -jitter, jitter);
            high[k] = 4 + uniform(seed, -jitter, jitter);
        }
        fixture_add_box(soup, low, high, "a");
    }
}

static void add_tjunctions(enf_soup *soup, uint64_t *seed) {
    add_overlapping_boxes(soup, seed);
    double x = 0;
    for (int i = 0; i < 8; i++) {
        double w = uniform(seed, 0.1, 1);
        const double upper[4][3] = {{x, 0, 0}, {x + w, 0, 0}, {x + w, 3, 0}, {x, 3, 0}};
        fixture_add_polygon(soup, 4, upper, "a");
        x += w;
    }
    const double lower[4][3] = {{0, -3, 0}, {x, -3, 0}, {x, 0, 0}, {0, 0, 0}};
    fixture_add_polygon(soup, 4, lower, "a");
}

static void far_away(enf_soup *soup, uint64_t *seed) {
    add_overlapping_boxes(soup, seed);
    double offset = uniform(seed, 1e5, 1e7), scale = pow(2, uniform(seed, -200, 200));
    for (size_t i = 0; i < 3 * soup->point_count; i++) soup->points[i] = (soup->points[i] + offset) * scale;
}

static const struct {
    const char *name;
    void (*add)(enf_soup *soup, uint64_t *seed);
} families[] = {
    {"random triangles", add_random_triangles},
    {"lattice triangles", add_lattice_triangles},
    {"coplanar stack", add_coplanar_stack},
    {"overlapping boxes", add_overlapping_boxes},
    {"turned boxes", add_turned_boxes},
    {"slivers", add_slivers},
    {"jittered cubes", add_jittered_cubes},
    {"T-junctions", add_tjunctions},
    {"far away", far_away},
};

static int seeds_per_family(void) {
    const char *scale = getenv("ENFILADE_TEST_SCALE");
    double factor = scale ? atof(scale) : 1;
    return factor * 12 >= 1 ? (int)(factor * 12) : 1;
}

static void every_soup_passes_every_check(void **state) {
    (void)state;
    for (size_t f = 0; f < sizeof families / sizeof *families; f++) {
        for (int i = 0; i < seeds_per_family(); i++) {
            uint64_t seed = 1000 * f + (uint64_t)i;
            print_message("%s, seed %llu\n", families[f].name, (unsigned long long)seed);
            enf_build build = {0};
            families[f].add(&build.soup, &seed);
            enf_build_options options = pipeline_options();
            options.keep = i % 2 ? ENF_KEEP_ALL : ENF_KEEP_OUTSIDE;
            options.clean.weld = i % 3 ? -1 : 0;
            options.stop = (enf_stop){.rule = ENF_STOP_CELLS, .cells = 10};
            enf_error error = {0};
            enf_status status = enf_build_run(&build, &options, &error);
            if (status == ENF_OK) {
                pipeline_check(&build);
            } else { // allowed only where everything is solid
                assert_int_equal(options.keep, ENF_KEEP_OUTSIDE);
                assert_int_equal(status, ENF_BAD_INPUT);
            }
            enf_build_free(&build);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_soup_passes_every_check)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
