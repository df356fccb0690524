// SPDX-License-Identifier: GPL-3.0-or-later
// What a region is made of, which regions are kept, leaks, and cracks that are none.
#include "clean_fixture.h"
#include "pipeline_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void assert_near(double value, double expected, double tolerance) {
    if (!(fabs(value - expected) <= tolerance)) fail_msg("%.17g, not %.17g", value, expected);
}

static void add_spawn(enf_soup *soup, double x, double y, double z) {
    assert_true(enf_soup_add_spawn(soup, x, y, z));
}

/// A room drawn as a shell: a box whose fronts face inwards.
static void add_room(enf_soup *soup, const double low[3], const double high[3]) {
    size_t first = soup->polygon_count;
    fixture_add_box(soup, low, high, "room");
    for (size_t p = first; p < soup->polygon_count; p++) {
        int32_t *corner = soup->corner_point + soup->polygon_corner[p], swap = corner[0];
        corner[0] = corner[2];
        corner[2] = swap;
    }
}

static void build_soup(enf_build *build, enf_soup *soup, enf_keep keep) {
    memset(build, 0, sizeof *build);
    build->soup = *soup;
    enf_build_options options = pipeline_options();
    options.keep = keep;
    pipeline_build(build, &options);
    pipeline_check(build);
}

/// The kind of the region whose volume is this (world units cubed); fails if there is none.
static enf_kind kind_of_volume(const enf_build *build, double volume) {
    double step = build->mesh.frame.step;
    for (int32_t r = 0; r < build->regions.region_count; r++) {
        if (fabs(build->regions.volume[r] * step * step * step - volume) < 1e-9 * volume) {
            return (enf_kind)build->regions.kind[r];
        }
    }
    fail_msg("no region has the volume %g", volume);
    return ENF_KIND_AIR;
}

static double kept_volume(const enf_build *build) {
    double step = build->mesh.frame.step, volume = 0;
    for (int32_t r = 0; r < build->regions.region_count; r++) {
        if (build->regions.kept[r]) volume += build->regions.volume[r] * step * step * step;
    }
    return volume;
}

static void the_inside_of_a_shell_is_air_and_its_furniture_rock(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_build build;
    add_room(&soup, (const double[]){0, 0, 0}, (const double[]){8, 6, 4});
    fixture_add_box(&soup, (const double[]){1, 1, 0}, (const double[]){2, 2, 1}, "chest");
    build_soup(&build, &soup, ENF_KEEP_AUTO);
    assert_int_equal(kind_of_volume(&build, 191), ENF_KIND_AIR);
    assert_int_equal(kind_of_volume(&build, 1), ENF_KIND_ROCK);
    assert_near(kept_volume(&build), 191, 1e-9);
    enf_build_free(&build);
}

static void overlapping_solids_are_rock_in_all_their_parts(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_build build;
    add_room(&soup, (const double[]){0, 0, 0}, (const double[]){16, 16, 16});
    fixture_add_box(&soup, (const double[]){4, 4, 4}, (const double[]){8, 8, 8}, "one");
    fixture_add_box(&soup, (const double[]){6, 6, 6}, (const double[]){11, 11, 11}, "other");
    build_soup(&build, &soup, ENF_KEEP_AUTO);
    assert_int_equal(kind_of_volume(&build, 64 - 8), ENF_KIND_ROCK);
    assert_int_equal(kind_of_volume(&build, 8), ENF_KIND_ROCK);
    assert_int_equal(kind_of_volume(&build, 125 - 8), ENF_KIND_ROCK);
    assert_near(kept_volume(&build), 4096 - 64 - 125 + 8, 1e-6);
    enf_build_free(&build);
}

/// Six slabs around a hollow, as levels are built.
static void add_hollow(enf_soup *soup, double inside, double wall) {
    double far = inside + wall;
    fixture_add_box(soup, (const double[]){-wall, -wall, -wall}, (const double[]){0, far, far}, "west");
    fixture_add_box(soup, (const double[]){inside, -wall, -wall}, (const double[]){far, far, far}, "east");
    fixture_add_box(soup, (const double[]){0, -wall, -wall}, (const double[]){inside, 0, far}, "south");
    fixture_add_box(soup, (const double[]){0, inside, -wall}, (const double[]){inside, far, far}, "north");
    fixture_add_box(soup, (const double[]){0, 0, -wall}, (const double[]){inside, inside, 0}, "floor");
    fixture_add_box(soup, (const double[]){0, 0, inside}, (const double[]){inside, inside, far}, "ceiling");
}

static void a_hollow_between_solids_is_air_without_any_spawn(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_build build;
    add_hollow(&soup, 8, 1);
    fixture_add_box(&soup, (const double[]){20, 0, 0}, (const double[]){21, 1, 1}, "outpost");
    build_soup(&build, &soup, ENF_KEEP_AUTO);
    assert_int_equal(kind_of_volume(&build, 512), ENF_KIND_AIR);
    assert_near(kept_volume(&build), 512, 1e-6);
    assert_false(build.regions.leak);
    enf_build_free(&build);
}

static void the_gap_between_two_shells_is_rock(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_build build;
    add_room(&soup, (const double[]){1, 1, 1}, (const double[]){3, 3, 3});
    fixture_add_box(&soup, (const double[]){0, 0, 0}, (const double[]){4, 4, 4}, "skin");
    build_soup(&build, &soup, ENF_KEEP_AUTO);
    assert_int_equal(kind_of_volume(&build, 8), ENF_KIND_AIR);
    assert_int_equal(kind_of_volume(&build, 64 - 8), ENF_KIND_ROCK);
    enf_build_free(&build);
}

static void copies_of_a_solid_do_not_turn_it_inside_out(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_build build;
    add_hollow(&soup, 8, 1);
    for (int i = 0; i < 3; i++) {
        fixture_add_box(&soup, (const double[]){2, 2, 0}, (const double[]){4, 4, 2}, "crate");
    }
    fixture_add_box(&soup, (const double[]){2, 2, 0}, (const double[]){3, 4, 2},
                    "half"); // shares faces with it
    build_soup(&build, &soup, ENF_KEEP_ALL);
    assert_int_equal(kind_of_volume(&build, 512 - 8), ENF_KIND_AIR);
    assert_int_equal(kind_of_volume(&build, 4), ENF_KIND_ROCK);
    for (int32_t r = 0; r < build.regions.region_count; r++) assert_false(build.regions.ambiguous[r]);
    assert_int_equal(fixture_count_rejected(&build.soup, ENF_REJECT_DUPLICATE), 13);
    enf_build_free(&build);
}

static void a_spawn_keeps_its_region_only(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_build build;
    add_room(&soup, (const double[]){0, 0, 0}, (const double[]){2, 2, 2});
    add_room(&soup, (const double[]){5, 0, 0}, (const double[]){8, 3, 3});
    add_spawn(&soup, 6, 1, 1);
    build_soup(&build, &soup, ENF_KEEP_AUTO);
    assert_near(kept_volume(&build), 27, 1e-9);
    enf_build_free(&build);
}

static void a_spawn_on_a_wall_is_in_the_room(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_build build;
    add_hollow(&soup, 8, 1);
    add_spawn(&soup, 8, 4, 4); // on the east wall
    add_spawn(&soup, 0, 0, 0); // in a corner
    build_soup(&build, &soup, ENF_KEEP_SPAWN);
    assert_near(kept_volume(&build), 512, 1e-6);
    enf_build_free(&build);
}

static void keep_outside_and_all_keep_more(void **state) {
    (void)state;
    for (int keep = 0; keep < 2; keep++) {
        enf_soup soup = {0};
        enf_build build;
        add_hollow(&soup, 8, 1);
        fixture_add_box(&soup, (const double[]){20, 0, 0}, (const double[]){21, 1, 1}, "outpost");
        build_soup(&build, &soup, keep ? ENF_KEEP_ALL : ENF_KEEP_OUTSIDE);
        double hull = 0, step = build.mesh.frame.step, solids = 1000 - 512 + 1;
        for (int32_t r = 0; r < build.regions.region_count; r++)
            hull += build.regions.volume[r] * step * step * step;
        assert_near(kept_volume(&build), keep ? hull : hull - solids, 1e-6);
        enf_build_free(&build);
    }
}

static void no_spawn_to_keep_by_is_an_error(void **state) {
    (void)state;
    enf_build build = {0};
    enf_error error = {0};
    add_room(&build.soup, (const double[]){0, 0, 0}, (const double[]){2, 2, 2});
    add_spawn(&build.soup, 50, 1, 1); // outside the hull
    enf_build_options options = pipeline_options();
    options.keep = ENF_KEEP_SPAWN;
    assert_int_equal(enf_build_run(&build, &options, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "spawn"));
    enf_build_free(&build);
}

/// A room with a square hole of this width in its ceiling, and a far box so that the hull is well outside.
static void add_holed_room(enf_soup *soup, double width) {
    static const double quads[5][4][3] = {{{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}},
                                          {{0, 0, 0}, {0, 0, 8}, {8, 0, 8}, {8, 0, 0}},
                                          {{8, 8, 0}, {8, 8, 8}, {0, 8, 8}, {0, 8, 0}},
                                          {{0, 0, 0}, {0, 8, 0}, {0, 8, 8}, {0, 0, 8}},
                                          {{8, 0, 0}, {8, 0, 8}, {8, 8, 8}, {8, 8, 0}}};
    for (int q = 0; q < 5; q++) fixture_add_polygon(soup, 4, quads[q], "shell");
    double a = 4, b = 4 + width;
    const double ceiling[4][4][3] = {{{0, 0, 8}, {0, 8, 8}, {a, 8, 8}, {a, 0, 8}},
                                     {{b, 0, 8}, {b, 8, 8}, {8, 8, 8}, {8, 0, 8}},
                                     {{a, 0, 8}, {a, a, 8}, {b, a, 8}, {b, 0, 8}},
                                     {{a, b, 8}, {a, 8, 8}, {b, 8, 8}, {b, b, 8}}};
    for (int q = 0; q < 4; q++) fixture_add_polygon(soup, 4, ceiling[q], "ceiling");
    fixture_add_box(soup, (const double[]){-20, -20, 30}, (const double[]){-19, -19, 31}, "far");
    fixture_add_box(soup, (const double[]){20, 20, 30}, (const double[]){21, 21, 31}, "far");
    add_spawn(soup, 1, 1, 1);
}

static void a_hole_is_a_leak_and_the_path_goes_through_it(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_build build;
    add_holed_room(&soup, 0.5);
    build_soup(&build, &soup, ENF_KEEP_AUTO);
    assert_true(build.regions.leak);
    assert_int_equal(build.regions.kind[build.regions.cell_region[build.regions.spawn_cell[0]]],
                     ENF_KIND_OUTSIDE);
    double at[3];
    enf_frame_to_world(&build.mesh.frame, build.regions.leak_points[0], at);
    assert_near(at[0] + at[1] + at[2], 3, 1e-12);
    bool through = false;
    for (int32_t i = 1; i < build.regions.leak_point_count; i++) {
        double from[3], to[3];
        enf_frame_to_world(&build.mesh.frame, build.regions.leak_points[i - 1], from);
        enf_frame_to_world(&build.mesh.frame, build.regions.leak_points[i], to);
        if (from[2] > 8 || to[2] < 8) continue;
        double t = to[2] > from[2] ? (8 - from[2]) / (to[2] - from[2]) : 0;
        double x = from[0] + t * (to[0] - from[0]), y = from[1] + t * (to[1] - from[1]);
        through |= x >= 4 && x <= 4.5 && y >= 4 && y <= 4.5;
    }
    assert_true(through);
    assert_true(build.regions.leak_width * build.mesh.frame.step <= 0.5 + 1e-12);
    enf_frame_to_world(&build.mesh.frame, build.regions.leak_neck, at);
    assert_true(at[0] >= 4 && at[0] <= 4.5 && at[1] >= 4 && at[1] <= 4.5);
    enf_build_free(&build);
}

static void a_closed_room_does_not_leak(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_build build;
    add_room(&soup, (const double[]){0, 0, 0}, (const double[]){2, 2, 2});
    fixture_add_box(&soup, (const double[]){20, 20, 30}, (const double[]){21, 21, 31}, "far");
    add_spawn(&soup, 1, 1, 1);
    build_soup(&build, &soup, ENF_KEEP_AUTO);
    assert_false(build.regions.leak);
    assert_near(kept_volume(&build), 8, 1e-9);
    enf_build_free(&build);
}

/// A room whose walls end `gap` below its ceiling, which covers more than the room.
static void add_loose_ceiling(enf_soup *soup, double gap) {
    double top = 8 - gap;
    const double quads[6][4][3] = {{{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}},
                                   {{0, 0, 0}, {0, 0, top}, {8, 0, top}, {8, 0, 0}},
                                   {{8, 8, 0}, {8, 8, top}, {0, 8, top}, {0, 8, 0}},
                                   {{0, 0, 0}, {0, 8, 0}, {0, 8, top}, {0, 0, top}},
                                   {{8, 0, 0}, {8, 0, top}, {8, 8, top}, {8, 8, 0}},
                                   {{-2, -2, 8}, {-2, 10, 8}, {10, 10, 8}, {10, -2, 8}}};
    for (int q = 0; q < 6; q++) fixture_add_polygon(soup, 4, quads[q], "shell");
    fixture_add_box(soup, (const double[]){-20, -20, 30}, (const double[]){-19, -19, 31}, "far");
    fixture_add_box(soup, (const double[]){20, 20, -30}, (const double[]){21, 21, -29}, "far");
    add_spawn(soup, 1, 1, 1);
}

static void a_crack_narrower_than_the_weld_distance_is_sealed(void **state) {
    (void)state;
    static const struct {
        double gap, weld, plane_tolerance;
        bool leak, sealed;
    } cases[] = {{1e-8, 1e-6, 0, false, true},   // a crack
                 {1e-8, 1e-6, -1, false, false}, // flattened away before it can be one
                 {1e-8, 0, 0, true, false},      // without tolerances nothing is a crack
                 {1e-4, 1e-6, -1, true, false}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        enf_build build = {0};
        add_loose_ceiling(&build.soup, cases[i].gap);
        enf_build_options options = pipeline_options();
        options.clean.weld = cases[i].weld;
        options.clean.plane_tolerance = cases[i].plane_tolerance;
        pipeline_build(&build, &options);
        pipeline_check(&build);
        assert_int_equal(build.regions.leak, cases[i].leak);
        assert_int_equal(build.regions.sealed > 0, cases[i].sealed);
        if (!cases[i].leak) assert_near(kept_volume(&build), 512, 1e-5);
        enf_build_free(&build);
    }
}

/// A room under a slanting roof of six tiles that overlap, somehow, and whose corners lie up to `tear` off.
static void add_torn_roof(enf_soup *soup, double tear, uint64_t *seed) {
    static const double walls[5][4][3] = {{{0, 0, 0}, {8, 0, 0}, {8, 8, 0}, {0, 8, 0}},
                                          {{0, 0, 0}, {0, 0, 12}, {8, 0, 12}, {8, 0, 0}},
                                          {{8, 8, 0}, {8, 8, 12}, {0, 8, 12}, {0, 8, 0}},
                                          {{0, 0, 0}, {0, 8, 0}, {0, 8, 12}, {0, 0, 12}},
                                          {{8, 0, 0}, {8, 0, 12}, {8, 8, 12}, {8, 8, 0}}};
    for (int q = 0; q < 5; q++) fixture_add_polygon(soup, 4, walls[q], "shell");
    for (int tile = 0; tile < 6; tile++) {
        double low[2] = {tile % 3 * 3 - 1, tile / 3 * 4 - 1}, high[2] = {low[0] + 4, low[1] + 6}, at[4][3];
        for (int k = 0; k < 4; k++) {
            for (int a = 0; a < 2; a++)
                at[k][a] = ((k + (a == 0)) / 2 % 2 == (a == 0) ? high[a] : low[a]) +
                           (double)(fixture_random(seed) >> 11) * 0x1p-54;
            at[k][2] = 7 + at[k][0] / 7 + at[k][1] / 9 +
                       tear * (2 * (double)(fixture_random(seed) >> 11) * 0x1p-53 - 1);
        }
        fixture_add_polygon(soup, 4, (const double(*)[3])at, "shell");
    }
    fixture_add_box(soup, (const double[]){-20, -20, 30}, (const double[]){-19, -19, 31}, "far");
    fixture_add_box(soup, (const double[]){20, 20, -30}, (const double[]){21, 21, -212}, "far");
    add_spawn(soup, 1, 1, 1);
}

static void a_thin_layer_between_overlapping_polygons_is_no_opening(void **state) {
    (void)state;
    uint64_t seed = 5;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 60; round++) {
        enf_build build = {0};
        add_torn_roof(&build.soup, round % 2 ? 1e-7 : 1e-10, &seed);
        enf_build_options options = pipeline_options();
        options.clean.weld = round % 2 ? 1e-6 : 1e-9;
        options.clean.plane_tolerance = 0;
        pipeline_build(&build, &options);
        pipeline_check(&build);
        if (build.regions.leak) fail_msg("round %d leaks", round);
        enf_build_free(&build);
    }
}

/// A box of triangles; `turned` says which diagonal halves its sides.
static void add_halved_box(enf_soup *soup, const double low[3], const double high[3], int turned) {
    enf_soup whole = {0};
    fixture_add_box(&whole, low, high, "box");
    for (size_t p = 0; p < whole.polygon_count; p++) {
        const int32_t *corner = whole.corner_point + whole.polygon_corner[p];
        for (int half = 0; half < 2; half++) {
            double at[3][3];
            for (int k = 0; k < 3; k++) {
                int32_t point = corner[(turned + 2 * half + k) % 4];
                memcpy(at[k], whole.points + 3 * (size_t)point, sizeof at[k]);
            }
            fixture_add_polygon(soup, 3, (const double(*)[3])at, "box");
        }
    }
    enf_soup_free(&whole);
}

/// The centre of each half of one side lies on the line between the two halves of the other.
static void sides_in_common_may_be_halved_either_way(void **state) {
    (void)state;
    for (int first = 0; first < 2; first++) {
        for (int second = 0; second < 2; second++) {
            enf_soup soup = {0};
            enf_build build;
            add_room(&soup, (const double[]){0, 0, 0}, (const double[]){16, 16, 16});
            add_halved_box(&soup, (const double[]){4, 4, 4}, (const double[]){8, 9, 10}, first);
            add_halved_box(&soup, (const double[]){8, 4, 4}, (const double[]){11, 9, 10}, second);
            build_soup(&build, &soup, ENF_KEEP_AUTO);
            assert_int_equal(kind_of_volume(&build, 120), ENF_KIND_ROCK);
            assert_int_equal(kind_of_volume(&build, 90), ENF_KIND_ROCK);
            for (int32_t r = 0; r < build.regions.region_count; r++) assert_false(build.regions.ambiguous[r]);
            enf_build_free(&build);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_inside_of_a_shell_is_air_and_its_furniture_rock),
        cmocka_unit_test(overlapping_solids_are_rock_in_all_their_parts),
        cmocka_unit_test(a_hollow_between_solids_is_air_without_any_spawn),
        cmocka_unit_test(the_gap_between_two_shells_is_rock),
        cmocka_unit_test(copies_of_a_solid_do_not_turn_it_inside_out),
        cmocka_unit_test(a_spawn_keeps_its_region_only),
        cmocka_unit_test(a_spawn_on_a_wall_is_in_the_room),
        cmocka_unit_test(keep_outside_and_all_keep_more),
        cmocka_unit_test(no_spawn_to_keep_by_is_an_error),
        cmocka_unit_test(a_hole_is_a_leak_and_the_path_goes_through_it),
        cmocka_unit_test(a_closed_room_does_not_leak),
        cmocka_unit_test(a_crack_narrower_than_the_weld_distance_is_sealed),
        cmocka_unit_test(a_thin_layer_between_overlapping_polygons_is_no_opening),
        cmocka_unit_test(sides_in_common_may_be_halved_either_way),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
