// SPDX-License-Identifier: GPL-3.0-or-later
// Real levels: every shared Quake level compiles, passes every check, keeps its spawns, leaks nowhere, and
// has the same regions whichever tetrahedralizer is used.
#include "pipeline_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/// The brushes of e1m5 (100 and 105) and e2m2 (517, 577 and 581) touch along faces, where rounding leaves a
/// layer of no thickness but tens of units wide. No level has a hole.
static void check_leak(const enf_build *build, const char *name) {
    double step = build->mesh.frame.step;
    if (build->regions.leak)
        fail_msg("%s: leak from spawn %d, narrowest %.4g units wide", name, (int)build->regions.leak_spawn,
                 build->regions.leak_width * step);
}

static void check_spawns(const enf_build *build, const char *name) {
    for (int32_t s = 0; s < build->regions.spawn_count; s++) {
        int32_t cell = build->regions.spawn_cell[s];
        if (cell < 0 || build->cell_of[cell] < 0) fail_msg("%s: spawn %d is in no kept cell", name, (int)s);
    }
}

static void check_same_regions(const enf_build *cgal, const enf_build *tetgen, const char *name) {
    size_t count, other;
    double *ours = pipeline_region_volumes(cgal, &count), *theirs = pipeline_region_volumes(tetgen, &other);
    if (count != other) fail_msg("%s: %zu regions with CGAL, %zu with TetGen", name, count, other);
    for (size_t i = 0; i < count; i++) {
        if (fabs(ours[i] - theirs[i]) > 1e-9 * ours[i]) {
            fail_msg("%s: region volumes %.17g and %.17g", name, ours[i], theirs[i]);
        }
    }
    free(ours);
    free(theirs);
}

static void check_level(const char *path, const char *name) {
    enf_build builds[2];
    for (int i = 0; i < 2; i++) {
        enf_error error = {0};
        memset(&builds[i], 0, sizeof builds[i]);
        if (enf_soup_read(&builds[i].soup, path, &error) != ENF_OK) fail_msg("%s", error.text);
        enf_build_options options = pipeline_options();
        options.tetrahedralizer = i == 0 ? ENF_TETRAHEDRALIZER_OWN : ENF_TETRAHEDRALIZER_TETGEN;
        if (enf_build_run(&builds[i], &options, &error) != ENF_OK) fail_msg("%s: %s", name, error.text);
    }
    check_leak(&builds[0], name);
    check_spawns(&builds[0], name);
    check_same_regions(&builds[0], &builds[1], name);
    pipeline_check(&builds[0]);
    print_message("%s: %d tetrahedra, %d fine cells, %d regions, %d cells, %d openings\n", name,
                  (int)builds[0].complex.tetrahedron_count, (int)builds[0].complex.cell_count,
                  (int)builds[0].regions.region_count, (int)builds[0].cell_count,
                  (int)builds[0].portals.opening_count);
    for (int i = 0; i < 2; i++) enf_build_free(&builds[i]);
}

static void levels_compile_and_both_tetrahedralizers_agree(void **state) {
    (void)state;
    pipeline_visit_levels(check_level);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(levels_compile_and_both_tetrahedralizers_agree)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
