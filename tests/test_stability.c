// SPDX-License-Identifier: GPL-3.0-or-later
// Soups as bad as they come: the families of `enfilade bench stability`, a few seeds each. Every invariant is
// checked exactly, and the oracles are asked. ENFILADE_TEST_SCALE multiplies the number of seeds.
#include "build/write.h"
#include "stress/stress_family.h"
#include "stress/stress_hard.h"
#include "stress/stress_run.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static int seeds_per_family(void) {
    const char *scale = getenv("ENFILADE_TEST_SCALE");
    double seeds = 12 * (scale ? atof(scale) : 1);
    return seeds >= 1 ? (int)seeds : 1;
}

static void every_soup_passes_check_and_oracles(void **state) {
    (void)state;
    const enf_stress_options harness = {.cells = 10, .points = 200};
    int wrong = 0;
    for (int family = 0; enf_stress_family(family, NULL); family++) {
        int64_t points = 0, segments = 0, cells = 0;
        for (int i = 0; i < seeds_per_family(); i++) {
            enf_stress_result result;
            enf_stress_run(family, (uint64_t)i, &harness, &result);
            points += result.verdict.points;
            segments += result.verdict.segments;
            cells += result.fine_cells;
            if (result.outcome == ENF_STRESS_FINE) continue;
            print_message("%s, seed %d: %s\n", enf_stress_family(family, NULL), i, result.reason);
            wrong++;
        }
        print_message("%s, seeds 0 to %d: %lld fine cells; %lld points, %lld segments asked\n",
                      enf_stress_family(family, NULL), seeds_per_family() - 1, (long long)cells,
                      (long long)points, (long long)segments);
        assert_true(segments > 0);
    }
    assert_int_equal(wrong, 0);
}

/// Overlapping boxes, compiled.
static void compile_boxes(enf_stress_case *made, enf_build *build, enf_build_image *image) {
    enf_error error = {0};
    assert_int_equal(enf_stress_make(made, 0, 2, &error), ENF_OK);
    enf_build_options options = enf_stress_build_options(made, 2, 0);
    *build = (enf_build){.soup = made->soup};
    if (enf_build_run(build, &options, &error) != ENF_OK) fail_msg("%s", error.text);
    made->soup = build->soup;
    if (enf_build_image_make(image, build, NULL, &error) != ENF_OK) fail_msg("%s", error.text);
}

static void free_boxes(enf_stress_case *made, enf_build *build, enf_build_image *image) {
    memset(&build->soup, 0, sizeof build->soup);
    enf_build_image_free(image);
    enf_build_free(build);
    enf_stress_case_free(made);
}

static void oracles_notice_what_is_wrong(void **state) {
    (void)state;
    enf_stress_case made;
    enf_build build;
    enf_build_image image;
    compile_boxes(&made, &build, &image);
    const enf_file_view *view = &image.view;
    enf_stress_verdict verdict = {0};
    enf_stress_ask_points(&made, view, 200, &verdict);
    enf_stress_ask_segments(&made, view, 200, &verdict);
    enf_stress_ask_surfaces(&made, view, 50, &verdict);
    assert_int_equal(verdict.disagreements, 0);

    // The largest rock is taken for air.
    enf_file_view wrong = *view;
    enf_file_region *regions = malloc((size_t)view->region_count * sizeof *regions);
    assert_non_null(regions);
    memcpy(regions, view->regions, (size_t)view->region_count * sizeof *regions);
    int32_t largest = -1;
    for (int32_t r = 0; r < view->region_count; r++) {
        if (regions[r].kind == ENF_WORLD_ROCK && (largest < 0 || regions[r].volume > regions[largest].volume))
            largest = r;
    }
    assert_true(largest >= 0);
    regions[largest].kind = ENF_WORLD_AIR;
    wrong.regions = regions;
    verdict = (enf_stress_verdict){0};
    enf_stress_ask_points(&made, &wrong, 1000, &verdict);
    assert_true(verdict.disagreements > 0);
    free(regions);

    // A tetrahedron that polygons cross is one cell.
    enf_file_view whole = *view;
    int32_t *roots = malloc((size_t)view->tetrahedron_count * sizeof *roots), cut = 0;
    assert_non_null(roots);
    for (int32_t t = 0; t < view->tetrahedron_count; t++) {
        roots[t] = view->tetrahedron_root[t];
        cut += roots[t] >= 0;
        while (roots[t] >= 0) roots[t] = view->node_child[roots[t]][0]; // one of its cells
    }
    assert_true(cut > 0);
    whole.tetrahedron_root = roots;
    verdict = (enf_stress_verdict){0};
    enf_stress_ask_segments(&made, &whole, 1000, &verdict);
    assert_true(verdict.disagreements > 0);
    free(roots);

    // A polygon that clean never saw.
    const double far[3][3] = {{50, 50, 50}, {60, 50, 50}, {50, 60, 50}};
    for (int i = 0; i < 20; i++) enf_stress_add_polygon(&made, 3, far);
    verdict = (enf_stress_verdict){0};
    enf_stress_ask_surfaces(&made, view, 50, &verdict);
    assert_true(verdict.disagreements > 0);
    free_boxes(&made, &build, &image);
}

static void crossings_of_three_polygons_are_counted(void **state) {
    (void)state;
    enf_stress_case made = {.state = 1};
    const double squares[3][4][3] = {{{0, -1, -1}, {0, 1, -1}, {0, 1, 1}, {0, -1, 1}},
                                     {{-1, 0.1, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0.1, 1}},
                                     {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0.2}, {-1, 1, 0.2}}};
    size_t used;
    for (int i = 0; i < 3; i++) enf_stress_add_polygon(&made, 4, squares[i]);
    assert_int_equal(enf_stress_count_crossings(&made, 3, 1, &used), 1);
    assert_int_equal(used, 3);
    assert_int_equal(enf_stress_count_crossings(&made, 3, 1000, &used), 1); // an affine map changes nothing
    assert_int_equal(enf_stress_count_crossings(&made, 2, 1, &used), 0);
    const double aside[4][3] = {{0.5, 2, -1}, {0.7, 2, 1}, {0.7, 4, 1}, {0.5, 4, -1}}; // reaches none of them
    enf_stress_add_polygon(&made, 4, aside);
    assert_int_equal(enf_stress_count_crossings(&made, 4, 1, &used), 1);
    enf_stress_case_free(&made);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_soup_passes_check_and_oracles),
                                       cmocka_unit_test(oracles_notice_what_is_wrong),
                                       cmocka_unit_test(crossings_of_three_polygons_are_counted)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
