// SPDX-License-Identifier: GPL-3.0-or-later
// What must not matter, does not: the order of the input, right-angled turns, mirrors, powers of two,
// threads. Results are compared bit by bit, in the canonical frame.
#include "pipeline_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static const char *const models[] = {
    "four-rooms", "four-rooms-tessellated", "four-rooms-distorted", "cavern", "furnished", "post", "office"};
static const char *const levels[] = {"quake/obj/end.obj.gz", "quake/obj/dm1.obj.gz"};

static uint64_t built(enf_soup *soup, enf_build *build, int threads) {
    memset(build, 0, sizeof *build);
    build->soup = *soup;
    enf_build_options options = pipeline_options();
    options.threads = threads;
    pipeline_build(build, &options);
    return pipeline_fingerprint(build);
}

static void read_world(enf_soup *soup, size_t world) {
    if (world < sizeof models / sizeof *models) {
        pipeline_read_model(soup, models[world]);
        return;
    }
    memset(soup, 0, sizeof *soup);
    const char *path = pipeline_shared(levels[world - sizeof models / sizeof *models]);
    enf_error error;
    if (path && enf_soup_read(soup, path, &error) != ENF_OK) fail_msg("%s", error.text);
}

static const size_t world_count = sizeof models / sizeof *models + sizeof levels / sizeof *levels;

static int32_t spawn_room(const enf_build *build, int32_t spawn) {
    int32_t cell = build->regions.spawn_cell[spawn];
    return cell < 0 ? -1 : build->cell_of[cell];
}

/// Two spawns share a cell in one result if they do in the other. (The cells themselves may be exchanged
/// where a world is its own mirror image.)
static void assert_same_partition(const enf_build *one, const enf_build *other) {
    for (int32_t a = 0; a < one->regions.spawn_count; a++) {
        for (int32_t b = 0; b < a; b++) {
            assert_int_equal(spawn_room(one, a) == spawn_room(one, b),
                             spawn_room(other, a) == spawn_room(other, b));
        }
    }
}

/// Builds every world as it is and as `change` leaves it: they must agree in everything.
static void assert_unchanged(void (*change)(enf_soup *soup, size_t world), int threads) {
    for (size_t w = 0; w < world_count; w++) {
        enf_soup plain, changed;
        enf_build one, other;
        read_world(&plain, w);
        if (plain.polygon_count == 0) continue; // not here
        read_world(&changed, w);
        if (change) change(&changed, w);
        uint64_t expected = built(&plain, &one, 1);
        uint64_t found = built(&changed, &other, threads);
        if (expected != found) {
            fail_msg("world %zu differs: %d and %d fine cells, %d and %d cells", w, one.complex.cell_count,
                     other.complex.cell_count, one.cell_count, other.cell_count);
        }
        assert_same_partition(&one, &other);
        enf_build_free(&one);
        enf_build_free(&other);
    }
}

static void shuffle(enf_soup *soup, size_t world) {
    enf_soup shuffled;
    uint64_t seed = 20261122 + world;
    print_message("world %zu, seed %llu\n", world, (unsigned long long)seed);
    pipeline_shuffle(soup, &shuffled, seed);
    enf_soup_free(soup);
    *soup = shuffled;
}

static void scale(enf_soup *soup, size_t world) {
    (void)world;
    pipeline_move(soup, (const int[3]){0, 1, 2}, (const int[3]){1, 1, 1}, 1024);
}

static void turn(enf_soup *soup, size_t world) { // all six permutations come up
    static const int axes[6][3] = {{1, 0, 2}, {2, 1, 0}, {0, 2, 1}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}};
    static const int signs[6][3] = {{-1, 1, 1}, {1, 1, -1}, {1, -1, 1}, {1, 1, 1}, {-1, -1, 1}, {1, -1, 1}};
    pipeline_move(soup, axes[world % 6], signs[world % 6], 1);
}

static void mirror(enf_soup *soup, size_t world) {
    int sign[3] = {1, 1, 1};
    sign[world % 3] = -1;
    pipeline_move(soup, (const int[3]){0, 1, 2}, sign, 1);
}

static void the_order_of_points_and_polygons_does_not_matter(void **state) {
    (void)state;
    assert_unchanged(shuffle, 1);
}

static void a_scale_by_a_power_of_two_does_not_matter(void **state) {
    (void)state;
    assert_unchanged(scale, 1);
}

static void turns_by_right_angles_do_not_matter(void **state) {
    (void)state;
    assert_unchanged(turn, 1);
}

static void mirrors_do_not_matter(void **state) {
    (void)state;
    assert_unchanged(mirror, 1);
}

static void the_number_of_threads_does_not_matter(void **state) {
    (void)state;
    assert_unchanged(NULL, 3);
}

/// Large enough to be split in many parts (see build/parts.h), some with cuts, some with none.
static void threads_that_share_many_parts_do_not_matter(void **state) {
    (void)state;
    const char *const settings[] = {"rooms=9", "detail=2"};
    uint64_t fingerprint[2];
    for (int i = 0; i < 2; i++) {
        enf_soup soup;
        enf_build build;
        pipeline_generate(&soup, "caverns", settings, 2);
        fingerprint[i] = built(&soup, &build, 1 + 2 * i);
        if (i == 1) pipeline_check(&build);
        enf_build_free(&build);
    }
    assert_true(fingerprint[0] == fingerprint[1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_order_of_points_and_polygons_does_not_matter),
        cmocka_unit_test(a_scale_by_a_power_of_two_does_not_matter),
        cmocka_unit_test(turns_by_right_angles_do_not_matter),
        cmocka_unit_test(mirrors_do_not_matter),
        cmocka_unit_test(the_number_of_threads_does_not_matter),
        cmocka_unit_test(threads_that_share_many_parts_do_not_matter),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
