// SPDX-License-Identifier: GPL-3.0-or-later
// Samples of pairs: all are decided if all are asked for; what is estimated from some is near to that, and
// bounds are Wilson's.
#include "build/build.h"
#include "build/gen.h"
#include "build/write.h"
#include "cli/bench_pairs.h"
#include "visibility/world_visibility.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include <cmocka.h>

static void expect(const cli_pair_sample *sample, double share, double bound) {
    double about, most;
    cli_pairs_estimate(sample, &about, &most);
    assert_true(fabs(about / (double)sample->unseen - share) < 1e-4);
    assert_true(fabs(most / (double)sample->unseen - bound) < 1e-4);
}

static void test_bounds_are_wilsons(void **unused) {
    (void)unused;
    // R. G. Newcombe, "Two-sided confidence intervals for the single proportion" (1998), table I, method 3.
    expect(&(cli_pair_sample){.unseen = 100000, .decided = 263, .seen = 182, .hidden = 80, .open = 1}, 0.3080,
           0.3662);
    expect(&(cli_pair_sample){.unseen = 100000, .decided = 148, .seen = 133, .hidden = 15}, 0.1014, 0.1605);
    expect(&(cli_pair_sample){.unseen = 100000, .decided = 20, .seen = 20}, 0, 0.1611);
    expect(&(cli_pair_sample){.unseen = 100000, .decided = 29, .seen = 28, .open = 1}, 0.0345, 0.1718);
    expect(&(cli_pair_sample){.unseen = 29, .decided = 29, .seen = 28, .open = 1}, 0.0345, 0.0345); // all
    expect(&(cli_pair_sample){.unseen = 7}, 1, 1);                                                  // none
}

typedef struct world {
    enf_build build;
    enf_build_image image;
    enf_world_air air;
    enf_visibility visibility;
} world;

static void make(world *world, const char *name) {
    char path[] = "bench-pairs-XXXXXX.obj";
    enf_error error = {0};
    const enf_build_options options = {.clean = {.weld = -1, .plane_tolerance = -1}, .threads = 1};
    const enf_visibility_options how = {.method = ENF_METHOD_HOURGLASS, .threads = 1};
    const int file = mkstemps(path, 4);
    assert_true(file >= 0);
    FILE *out = fdopen(file, "w");
    assert_int_equal(enf_gen_write(name, NULL, 0, out, &error), ENF_OK);
    fclose(out);
    *world = (struct world){0};
    enf_status status = enf_soup_read(&world->build.soup, path, &error);
    remove(path);
    if (!status) status = enf_build_run(&world->build, &options, &error);
    if (!status) status = enf_build_image_make(&world->image, &world->build, "{}", &error);
    if (!status) status = enf_world_air_make(&world->air, &world->image.view, false, 1, &error);
    if (!status)
        status = enf_world_visibility_run(&world->visibility, &world->air, &world->image.view, &how, &error);
    if (status) fail_msg("%s: %s", name, error.text);
}

static void drop(world *world) {
    enf_visibility_free(&world->visibility);
    enf_world_air_free(&world->air);
    enf_build_image_free(&world->image);
    enf_build_free(&world->build);
}

/// Before any line was thrown.
static cli_pair_sample take(const world *world, int32_t count, int64_t *seen) {
    enf_world_lines lines;
    enf_error error;
    cli_pair_sample sample;
    assert_int_equal(enf_world_lines_make(&lines, &world->image.view, 1, &error), ENF_OK);
    assert_int_equal(cli_pairs_sample(&lines, &world->air, &world->visibility.pvs, count, &sample, &error),
                     ENF_OK);
    *seen = (enf_pvs_pairs(&lines.seen) - lines.seen.cell_count) / 2;
    enf_world_lines_free(&lines);
    return sample;
}

static void test_a_sample_tells_of_all(void **unused) {
    (void)unused;
    world world;
    int64_t seen;
    double about, most;
    make(&world, "office");
    const enf_pvs *claimed = &world.visibility.pvs;
    const cli_pair_sample all = take(&world, INT32_MAX, &seen);
    assert_int_equal(all.unseen, (enf_pvs_pairs(claimed) - claimed->cell_count) / 2);
    assert_int_equal(all.decided, all.unseen);
    assert_int_equal(all.seen + all.hidden + all.open, all.decided);
    assert_int_equal(all.seen, seen);
    const cli_pair_sample some = take(&world, 200, &seen);
    assert_int_equal(some.unseen, all.unseen);
    assert_int_equal(some.decided, 200);
    cli_pairs_estimate(&some, &about, &most);
    assert_true(about <= most && all.hidden <= most && most < 0.1 * (double)all.unseen);
    drop(&world);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_bounds_are_wilsons),
                                       cmocka_unit_test(test_a_sample_tells_of_all)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
