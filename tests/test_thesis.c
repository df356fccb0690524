// SPDX-License-Identifier: GPL-3.0-or-later
// The worlds of the thesis (4.3): about its counts, and a stop at which every room is a cell of its own.
// `enfilade bench thesis` prints the whole table.
#include "pipeline_fixture.h"

#include "build/gen.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static void generate(enf_soup *soup, const char *name, const char *setting) {
    char path[] = "thesis-XXXXXX.obj";
    int file = mkstemps(path, 4);
    assert_true(file >= 0);
    FILE *out = fdopen(file, "w");
    enf_error error = {0};
    assert_int_equal(enf_gen_write(name, &setting, setting != NULL, out, &error), ENF_OK);
    fclose(out);
    memset(soup, 0, sizeof *soup);
    enf_status status = enf_soup_read(soup, path, &error);
    remove(path);
    if (status != ENF_OK) fail_msg("%s", error.text);
}

static void build_world(enf_build *build, const char *name, const char *setting, enf_heuristic heuristic,
                        int cells) {
    memset(build, 0, sizeof *build);
    generate(&build->soup, name, setting);
    enf_build_options options = pipeline_options();
    options.heuristic = heuristic;
    options.stop = (enf_stop){.rule = ENF_STOP_CELLS, .cells = cells};
    pipeline_build(build, &options);
}

static int32_t room_of(const enf_build *build, int32_t spawn) {
    return build->cell_of[build->regions.spawn_cell[spawn]];
}

static void assert_rooms_apart(const enf_build *build, int32_t rooms, int32_t most_cells) {
    assert_int_equal(build->regions.spawn_count, rooms);
    assert_true(build->cell_count <= most_cells);
    for (int32_t a = 0; a < rooms; a++) {
        for (int32_t b = 0; b < a; b++) assert_int_not_equal(room_of(build, a), room_of(build, b));
    }
}

static void assert_between(double low, double value, double high) {
    if (!(value >= low && value <= high)) fail_msg("%g is not in %g .. %g", value, low, high);
}

/// Extra cells by splitting, if none are joined: that is what the thesis counts.
static double split_share(const char *name) {
    enf_build plain;
    memset(&plain, 0, sizeof plain);
    generate(&plain.soup, name, NULL);
    enf_build_options options = pipeline_options();
    options.plain_cells = true;
    options.stages = ENF_STAGE_COLOUR + 1;
    pipeline_build(&plain, &options);
    const enf_complex *complex = &plain.complex;
    assert_int_equal(complex->cells_joined, 0);
    double share = (complex->cell_count - complex->tetrahedron_count) / (double)complex->tetrahedron_count;
    print_message("%s: %d tetrahedra, %+.1f %% by splitting\n", name, complex->tetrahedron_count,
                  100 * share);
    enf_build_free(&plain);
    return share;
}

static int32_t active_cells(const enf_build *build) {
    int32_t active = 0;
    for (int32_t c = 0; c < build->complex.cell_count; c++) active += build->cell_of[c] >= 0;
    return active;
}

static void four_rooms_become_four_cells(void **state) {
    (void)state;
    enf_build build;
    build_world(&build, "four-rooms", NULL, ENF_HEURISTIC_ASPECT, 4);
    assert_between(150, build.complex.tetrahedron_count, 170);
    assert_between(0.10, split_share("four-rooms"), 0.12);
    assert_rooms_apart(&build, 4, 4);
    assert_int_equal(build.portals.opening_count, 4);
    enf_build_free(&build);
}

static void tessellated_rooms_become_four_cells_by_the_scaled_heuristic(void **state) {
    (void)state;
    enf_build build;
    build_world(&build, "four-rooms-tessellated", NULL, ENF_HEURISTIC_ASPECT_SCALED, 4);
    assert_between(500, build.complex.tetrahedron_count, 540);
    assert_between(0, split_share("four-rooms-tessellated"), 0);
    assert_rooms_apart(&build, 4, 4);
    enf_build_free(&build);
}

static void distorted_rooms_come_apart_with_few_spikes(void **state) {
    (void)state;
    enf_build build;
    build_world(&build, "four-rooms-distorted", NULL, ENF_HEURISTIC_ASPECT, 24);
    assert_between(285, build.complex.tetrahedron_count, 315);
    assert_between(0.33, split_share("four-rooms-distorted"), 0.41);
    assert_rooms_apart(&build, 4, 24);
    enf_build_free(&build);
}

static void the_cavern_becomes_six_cells_and_seven_portals(void **state) {
    (void)state;
    for (int heuristic = 0; heuristic < ENF_HEURISTIC_COUNT; heuristic++) {
        enf_build build;
        build_world(&build, "cavern", NULL, (enf_heuristic)heuristic, 6);
        assert_between(1075, build.complex.tetrahedron_count, 1185);
        assert_int_equal(build.complex.tetrahedra_cut, 0);
        assert_between(547, active_cells(&build), 615);
        assert_rooms_apart(&build, 6, 6);
        assert_int_equal(build.portals.opening_count, 7);
        enf_build_free(&build);
    }
}

/// The passage of an opening: the two rooms it joins, by spawn number.
static void passage(const enf_build *build, int32_t opening, int32_t rooms[2]) {
    for (int side = 0; side < 2; side++) {
        rooms[side] = -1;
        for (int32_t s = 0; s < build->regions.spawn_count; s++) {
            if (room_of(build, s) == build->portals.opening_cell[opening][side]) rooms[side] = s;
        }
    }
    if (rooms[0] > rooms[1]) {
        int32_t swap = rooms[0];
        rooms[0] = rooms[1];
        rooms[1] = swap;
    }
}

static double opening_area(const enf_build *build, int32_t opening) {
    double area = 0, step = build->mesh.frame.step;
    for (int32_t p = build->portals.opening_polygon[opening]; p < build->portals.opening_polygon[opening + 1];
         p++) {
        area += build->portals.polygon_area[p] * step * step;
    }
    return area;
}

static void a_turned_cavern_has_the_same_seven_passages(void **state) {
    (void)state;
    enf_build plain, turned;
    build_world(&plain, "cavern", NULL, ENF_HEURISTIC_ASPECT, 6);
    build_world(&turned, "cavern", "rotate=10,20,30", ENF_HEURISTIC_ASPECT, 6);
    assert_rooms_apart(&turned, 6, 6);
    assert_int_equal(turned.portals.opening_count, 7);
    for (int32_t a = 0; a < 7; a++) {
        int32_t rooms[2], other[2], b = 0;
        passage(&plain, a, rooms);
        for (; b < 7; b++) {
            passage(&turned, b, other);
            if (memcmp(rooms, other, sizeof rooms) == 0) break;
        }
        if (b == 7) fail_msg("no passage between rooms %d and %d when turned", rooms[0], rooms[1]);
        double radius = plain.portals.opening_radius[a] * plain.mesh.frame.step;
        double radius_turned = turned.portals.opening_radius[b] * turned.mesh.frame.step;
        print_message("rooms %d - %d: area %.4f and %.4f, radius %.4f and %.4f\n", rooms[0], rooms[1],
                      opening_area(&plain, a), opening_area(&turned, b), radius, radius_turned);
        // A turn by odd angles may break ties among cospherical points differently, in the portal's triangles
        // too.
        assert_between(0.9, opening_area(&turned, b) / opening_area(&plain, a), 1.1);
    }
    enf_build_free(&plain);
    enf_build_free(&turned);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(four_rooms_become_four_cells),
        cmocka_unit_test(tessellated_rooms_become_four_cells_by_the_scaled_heuristic),
        cmocka_unit_test(distorted_rooms_come_apart_with_few_spikes),
        cmocka_unit_test(the_cavern_becomes_six_cells_and_seven_portals),
        cmocka_unit_test(a_turned_cavern_has_the_same_seven_passages),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
