// SPDX-License-Identifier: GPL-3.0-or-later
// Rock or air, against the truth: the shared Quake levels name their brushes ("# brush N"), each convex and
// closed, so a point is solid exactly if it is behind all planes of one of them. Points are located in the
// finished world.
#include "pipeline_fixture.h"

#include "build/write.h"
#include "cli/brushes.h"
#include "format/locate.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

static int points_per_level(void) {
    const char *scale = getenv("ENFILADE_TEST_SCALE");
    return (int)fmax(200, 4000 * (scale ? atof(scale) : 1));
}

static void check_kinds(const char *path, const char *name, const cli_brushes *all, bool with_spawns) {
    static const char *const exclude[] = {"*liquid*"};
    enf_build build = {0};
    enf_error error = {0};
    enf_build_image image;
    if (enf_soup_read(&build.soup, path, &error) != ENF_OK) fail_msg("%s", error.text);
    if (!with_spawns) build.soup.spawn_count = 0;
    enf_build_options options = pipeline_options();
    options.clean.exclude = exclude;
    options.clean.exclude_count = 1;
    options.keep = ENF_KEEP_ALL;
    options.stop = (enf_stop){.rule = ENF_STOP_WEIGHT, .weight = 1};
    pipeline_build(&build, &options);
    if (enf_build_image_make(&image, &build, NULL, &error) != ENF_OK) fail_msg("%s", error.text);
    uint64_t seed = 11;
    int wrong = 0, asked = 0, solid = 0;
    for (int i = 0; i < points_per_level(); i++) {
        double at[3];
        cli_brushes_random_point(all, &seed, at);
        int truth = cli_brushes_side(all, at, 1e-3);
        if (truth == 0) continue;
        asked++;
        solid += truth > 0;
        wrong += (enf_view_locate(&image.view, at, -1).kind == ENF_WORLD_ROCK) != (truth > 0);
    }
    for (size_t s = 0; s < build.soup.spawn_count; s++) {
        if (cli_brushes_side(all, build.soup.spawns + 3 * s, 1e-3) == 0) continue;
        wrong += enf_view_locate(&image.view, build.soup.spawns + 3 * s, -1).kind == ENF_WORLD_ROCK;
    }
    print_message("%s %s spawns: %d points, %d solid, %d wrong\n", name, with_spawns ? "with" : "without",
                  asked, solid, wrong);
    assert_int_equal(wrong, 0);
    assert_true(solid > 0);
    enf_build_image_free(&image);
    enf_build_free(&build);
}

static void check_level(const char *path, const char *name) {
    cli_brushes all;
    enf_error error = {0};
    if (cli_brushes_read(&all, path, &error) != ENF_OK) fail_msg("%s", error.text);
    check_kinds(path, name, &all, true);
    check_kinds(path, name, &all, false);
    cli_brushes_free(&all);
}

static void rock_is_what_brushes_hold(void **state) {
    (void)state;
    pipeline_visit_levels(check_level);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(rock_is_what_brushes_hold)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
