// SPDX-License-Identifier: GPL-3.0-or-later
// The visible sets of compiled worlds: nothing that lines join is missing, little else is claimed, rungs lie
// within each other, and threads do not matter.
#include "build/build.h"
#include "build/gen.h"
#include "build/write.h"
#include "visibility/shapes.h"
#include "visibility/world_pairs.h"
#include "visibility/world_views.h"
#include "visibility/world_visibility.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "shared_data.h"

typedef struct world {
    enf_build build;
    enf_build_image image;
    enf_world_air air;
} world;

static void compile(world *world, const char *path) {
    enf_error error = {0};
    enf_build_options options = {.clean = {.weld = -1, .plane_tolerance = -1}, .threads = 1};
    memset(world, 0, sizeof *world);
    enf_status status = enf_soup_read(&world->build.soup, path, &error);
    if (!status) status = enf_build_run(&world->build, &options, &error);
    if (!status) status = enf_build_image_make(&world->image, &world->build, "{}", &error);
    if (!status) status = enf_world_air_make(&world->air, &world->image.view, false, 1, &error);
    if (status) fail_msg("%s: %s", path, error.text);
}

/// `text`: an OBJ; or null, for the built-in world of that name.
static void make(world *world, const char *name, const char *text) {
    char path[] = "world-pvs-XXXXXX.obj";
    int file = mkstemps(path, 4);
    assert_true(file >= 0);
    FILE *out = fdopen(file, "w");
    enf_error error = {0};
    if (text)
        fputs(text, out);
    else
        assert_int_equal(enf_gen_write(name, NULL, 0, out, &error), ENF_OK);
    fclose(out);
    compile(world, path);
    remove(path);
}

static void drop(world *world) {
    enf_world_air_free(&world->air);
    enf_build_image_free(&world->image);
    enf_build_free(&world->build);
}

static enf_pvs find(const world *world, enf_method method, int threads) {
    const enf_visibility_options options = {.method = method, .threads = threads};
    enf_visibility visibility;
    enf_error error = {0};
    if (enf_world_visibility_run(&visibility, &world->air, &world->image.view, &options, &error))
        fail_msg("%s", error.text);
    enf_pvs pvs = visibility.pvs;
    visibility.pvs = (enf_pvs){0};
    enf_visibility_free(&visibility);
    return pvs;
}

static size_t words_of(const enf_pvs *pvs) {
    return (size_t)pvs->cell_count * pvs->row_words;
}

static void assert_within(const enf_pvs *inner, const enf_pvs *outer) {
    for (size_t w = 0; w < words_of(inner); w++) assert_true((inner->rows[w] & ~outer->rows[w]) == 0);
}

static void assert_symmetric(const enf_pvs *pvs) {
    for (int32_t i = 0; i < pvs->cell_count; i++)
        for (int32_t j = 0; j <= i; j++) assert_int_equal(enf_pvs_get(pvs, i, j), enf_pvs_get(pvs, j, i));
}

static void aim_views(const world *world, enf_world_lines *lines, const enf_pvs *claimed, int points) {
    bool good;
    enf_world_views_aim(lines, &world->air, claimed, points, INT64_MAX, &good);
    assert_true(good);
}

/// Throws lines at all pairs that are not seen, claimed or not. No pair may be seen and not claimed; of those
/// seen, at most `excess` as many more may be claimed.
static void assert_near_truth(const world *world, const enf_pvs *claimed, const enf_pvs *all, int rounds,
                              double excess) {
    enf_world_lines lines;
    enf_error error = {0};
    assert_int_equal(enf_world_lines_make(&lines, &world->image.view, 7, &error), ENF_OK);
    for (int i = 0; i < 3; i++) enf_world_lines_aim(&lines, all, 4, INT64_MAX);
    for (int i = 0; i < rounds; i++) enf_world_lines_aim(&lines, claimed, 8, INT64_MAX);
    aim_views(world, &lines, all, 2);
    aim_views(world, &lines, claimed, rounds);
    assert_within(&lines.seen, claimed);
    double seen = (double)enf_pvs_pairs(&lines.seen), more = (double)enf_pvs_pairs(claimed) - seen;
    if (more > excess * seen) fail_msg("%g pairs more than the %g that lines have seen", more, seen);
    enf_world_lines_free(&lines);
}

/// All rungs up to one, one after the other.
static void check(const world *world, enf_method last, int rounds, double excess) {
    enf_pvs before = find(world, ENF_METHOD_REACH, 1), all = find(world, ENF_METHOD_REACH, 1);
    for (int m = ENF_METHOD_FACING; m <= (int)last; m++) {
        enf_pvs pvs = find(world, (enf_method)m, 1);
        assert_symmetric(&pvs);
        assert_within(&pvs, &before);
        assert_near_truth(world, &pvs, &all, m == ENF_METHOD_HOURGLASS ? rounds : 1,
                          m == ENF_METHOD_HOURGLASS ? excess : 1e9);
        enf_pvs_free(&before);
        before = pvs;
    }
    enf_pvs_free(&before);
    enf_pvs_free(&all);
}

static void test_built_in_worlds(void **unused) {
    (void)unused;
    static const char *const names[] = {"four-rooms", "four-rooms-distorted", "cavern", "post", "furnished",
                                        "office"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        world world;
        make(&world, names[i], NULL);
        check(&world, i < 4 ? ENF_METHOD_EXACT : ENF_METHOD_HOURGLASS, 40, 0.1);
        drop(&world);
    }
}

static void test_threads_do_not_matter(void **unused) {
    (void)unused;
    world world;
    make(&world, "office", NULL);
    enf_pvs one = find(&world, ENF_METHOD_HOURGLASS, 1);
    for (int threads = 2; threads <= 8; threads += 3) {
        enf_error error;
        enf_world_air_free(&world.air);
        assert_int_equal(enf_world_air_make(&world.air, &world.image.view, false, threads, &error), ENF_OK);
        enf_pvs other = find(&world, ENF_METHOD_HOURGLASS, threads);
        assert_memory_equal(one.rows, other.rows, words_of(&one) * sizeof *one.rows);
        enf_pvs_free(&other);
    }
    enf_pvs_free(&one);
    drop(&world);
}

static void assert_ranks_are_all_there(enf_air_ranks *ranks, int32_t leaf_count) {
    bool *taken = calloc((size_t)leaf_count, sizeof *taken);
    assert_non_null(taken);
    for (int32_t leaf = 0; leaf < leaf_count; leaf++) {
        const int32_t rank = enf_air_ranks_find(ranks, leaf);
        assert_true(rank >= 0 && rank < leaf_count && !taken[rank]);
        taken[rank] = true;
    }
    free(taken);
}

/// Lines from a point come to leafs of lower ranks first: at each opening the leaf on the point's side has
/// the lower one.
static void test_ranks_are_in_the_order_of_lines(void **unused) {
    (void)unused;
    world world;
    enf_shapes shapes;
    enf_air_ranks ranks;
    int64_t compared = 0;
    make(&world, "office", NULL);
    assert_true(world.air.has_partition);
    const enf_portal_graph *graph = &world.air.leafs;
    assert_true(enf_shapes_make(&shapes, graph) && enf_air_ranks_make(&ranks, &world.air.order));
    for (int32_t c = 0; c < graph->opening_corner[graph->opening_count]; c += 7) {
        double point[3];
        for (int axis = 0; axis < 3; axis++)
            point[axis] = 0.7 * graph->corners[c][axis] + 0.3 * graph->corners[(c * 5) % (c + 1)][axis];
        enf_air_ranks_begin(&ranks, point);
        assert_ranks_are_all_there(&ranks, graph->cell_count);
        for (int32_t portal = 0; portal < 2 * graph->opening_count; portal++) {
            if (enf_shape_height(&shapes, portal, point) > -1e-6) continue;
            assert_true(enf_air_ranks_find(&ranks, enf_portal_from(graph, portal)) <
                        enf_air_ranks_find(&ranks, enf_portal_to(graph, portal)));
            compared++;
        }
    }
    assert_true(compared > 1000);
    enf_air_ranks_free(&ranks);
    enf_shapes_free(&shapes);
    drop(&world);
}

/// A hall, 12 long, 4 wide, 3 high, that two walls without thickness part, across x; each has a door, 1 wide
/// and 2 high, at opposite ends: from beyond the one wall only a part of what is beyond the other can be
/// seen.
static const char hall[] = "# spawn 1 2 1\n# spawn 6 2 1\n# spawn 11 2 1\n"
                           "v 0 0 0\nv 12 0 0\nv 12 4 0\nv 0 4 0\nv 0 0 3\nv 12 0 3\nv 12 4 3\nv 0 4 3\n"
                           "f 1 2 3 4\nf 8 7 6 5\nf 5 6 2 1\nf 6 7 3 2\nf 7 8 4 3\nf 8 5 1 4\n"
                           "v 5 1 0\nv 5 4 0\nv 5 4 3\nv 5 1 3\nv 5 0 2\nv 5 1 2\nv 5 0 3\n" // 9 to 15
                           "f 9 10 11 12\nf 13 14 12 15\n"
                           "v 7 0 0\nv 7 3 0\nv 7 3 3\nv 7 0 3\nv 7 3 2\nv 7 4 2\nv 7 4 3\n" // 16 to 22
                           "f 16 17 18 19\nf 20 21 22 18\n";

static int32_t count_thin_openings(const enf_portal_graph *graph, double x, double *width) {
    int32_t count = 0;
    *width = 0;
    for (int32_t k = 0; k < graph->opening_count; k++) {
        bool is_there = true;
        double low = 1e9, high = -1e9;
        for (int32_t i = graph->opening_corner[k]; i < graph->opening_corner[k + 1]; i++) {
            is_there = is_there && graph->corners[i][0] > x - 1e-6 && graph->corners[i][0] < x + 1e-6;
            low = graph->corners[i][1] < low ? graph->corners[i][1] : low;
            high = graph->corners[i][1] > high ? graph->corners[i][1] : high;
        }
        if (!is_there) continue;
        count++;
        *width += high - low;
    }
    return count;
}

static void assert_planes(const enf_file_view *view, int32_t count) {
    enf_walls walls;
    enf_error error;
    assert_int_equal(enf_air_walls_make(&walls, view, 1, &error), ENF_OK);
    assert_true(walls.count > count);
    assert_int_equal(enf_walls_count_planes(&walls, 12), count);
    enf_walls_free(&walls);
}

static void test_walls_without_thickness(void **unused) {
    (void)unused;
    world world;
    double width;
    make(&world, NULL, hall);
    assert_true(world.air.uses_leafs);
    assert_planes(&world.image.view, 8);
    for (int x = 5; x <= 7; x += 2) {
        assert_true(count_thin_openings(&world.air.leafs, x, &width) >= 1);
        assert_true(width < 1 + 1e-6); // the door is left of the wall
    }
    check(&world, ENF_METHOD_EXACT, 100, 0.1);
    drop(&world);
}

/// From few points views show more than many lines do.
static void test_views_show_more_than_lines(void **unused) {
    (void)unused;
    world world;
    enf_world_lines lines, aimed;
    enf_error error = {0};
    bool good;
    make(&world, "furnished", NULL);
    enf_pvs claimed = find(&world, ENF_METHOD_HOURGLASS, 1);
    assert_int_equal(enf_world_lines_make(&lines, &world.image.view, 3, &error), ENF_OK);
    assert_int_equal(enf_world_lines_make(&aimed, &world.image.view, 3, &error), ENF_OK);
    enf_world_views_aim(&aimed, &world.air, &claimed, 5, INT64_MAX, &good);
    assert_true(good);
    while (lines.count < aimed.count && enf_world_lines_aim(&lines, &claimed, 1, aimed.count) > 0) {
    }
    assert_within(&aimed.seen, &claimed);
    assert_true(enf_pvs_pairs(&aimed.seen) > enf_pvs_pairs(&lines.seen));
    enf_world_lines_free(&lines);
    enf_world_lines_free(&aimed);
    enf_pvs_free(&claimed);
    drop(&world);
}

/// Decides the pairs that are claimed, or one in so many. What lines have seen is not hidden, and nearly all
/// of it is found again; little is left open.
static void check_pairs(const world *world, const enf_pvs *claimed, const enf_pvs *seen, int one_in) {
    enf_world_lines lines;
    enf_world_pairs pairs;
    enf_error error = {0};
    int counts[2][3] = {{0}};
    assert_int_equal(enf_world_lines_make(&lines, &world->image.view, 5, &error), ENF_OK);
    assert_int_equal(enf_world_pairs_make(&pairs, &world->air, &lines, 1, &error), ENF_OK);
    for (int32_t i = 0; i < claimed->cell_count; i++)
        for (int32_t j = 0; j < claimed->cell_count; j++) {
            enf_squeeze_answer answer;
            if (i == j || !enf_pvs_get(claimed, i, j) || (i + 3 * j) % one_in != 0) continue;
            enf_bit_clear(enf_pvs_row(&lines.seen, i), j); // each by itself
            assert_int_equal(enf_world_pairs_decide(&pairs, i, j, 5000, &answer, &error), ENF_OK);
            if (enf_pvs_get(seen, i, j) && answer == ENF_SQUEEZE_HIDDEN) fail_msg("%d sees %d", i, j);
            counts[enf_pvs_get(seen, i, j)][answer]++;
        }
    const int all = counts[1][ENF_SQUEEZE_SEEN] + counts[1][ENF_SQUEEZE_OPEN];
    assert_true(all > 0 && counts[1][ENF_SQUEEZE_OPEN] <= all / 50);
    assert_true(counts[0][ENF_SQUEEZE_OPEN] <= 1 + all / 50);
    enf_world_pairs_free(&pairs);
    enf_world_lines_free(&lines);
}

static void test_pairs_are_decided_one_by_one(void **unused) {
    (void)unused;
    static const char *const names[] = {"four-rooms", "furnished", NULL};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        world world;
        enf_world_lines lines;
        enf_error error = {0};
        make(&world, names[i], names[i] ? NULL : hall);
        enf_pvs claimed = find(&world, ENF_METHOD_HOURGLASS, 1);
        assert_int_equal(enf_world_lines_make(&lines, &world.image.view, 3, &error), ENF_OK);
        enf_world_lines_aim(&lines, &claimed, 8, INT64_MAX);
        aim_views(&world, &lines, &claimed, 25);
        check_pairs(&world, &claimed, &lines.seen, i == 1 ? 16 : 1);
        enf_world_lines_free(&lines);
        enf_pvs_free(&claimed);
        drop(&world);
    }
}

/// Where rounding has made a cell flat, the planes of its two openings say nothing of which comes first.
static void test_lines_go_on_through_flat_cells(void **unused) {
    (void)unused;
    enf_portal_graph graph = {.cell_count = 4};
    enf_shapes shapes;
    enf_sight sight;
    enf_error error;
    const double planes[3] = {1, 1, 2};
    for (int k = 0; k < 3; k++) {
        const double x = planes[k], square[4][3] = {{x, 0, 0}, {x, 1, 0}, {x, 1, 1}, {x, 0, 1}};
        assert_true(enf_portal_graph_add(&graph, k, k + 1, square, 4));
    }
    assert_int_equal(enf_portal_graph_finish(&graph, &error), ENF_OK);
    assert_true(enf_shapes_make(&shapes, &graph) && enf_sight_make(&sight, &shapes));
    const enf_line line = {{0, 0.3, 0.4}, {3, 0.6, 0.5}};
    int32_t passed[4];
    assert_int_equal(enf_sight_walk(&sight, &line, 0, passed, 4), 0);
    sight.trusts_order = true;
    assert_int_equal(enf_sight_walk(&sight, &line, 0, passed, 4), 2);
    assert_int_equal(passed[0], 2);
    assert_int_equal(passed[1], 4);
    enf_sight_free(&sight);
    enf_shapes_free(&shapes);
    enf_portal_graph_free(&graph);
}

static void test_a_level(void **unused) {
    (void)unused;
    char path[4096];
    world world;
    snprintf(path, sizeof path, "%s/quake/obj/dm4.obj.gz", shared_data());
    compile(&world, path);
    enf_pvs all = find(&world, ENF_METHOD_FACING, 2), pvs = find(&world, ENF_METHOD_HOURGLASS, 2);
    assert_within(&pvs, &all);
    assert_symmetric(&pvs);
    assert_near_truth(&world, &pvs, &all, 5, 0.1);
    enf_pvs_free(&all);
    enf_pvs_free(&pvs);
    drop(&world);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_built_in_worlds),
                                       cmocka_unit_test(test_threads_do_not_matter),
                                       cmocka_unit_test(test_ranks_are_in_the_order_of_lines),
                                       cmocka_unit_test(test_views_show_more_than_lines),
                                       cmocka_unit_test(test_walls_without_thickness),
                                       cmocka_unit_test(test_pairs_are_decided_one_by_one),
                                       cmocka_unit_test(test_lines_go_on_through_flat_cells),
                                       cmocka_unit_test(test_a_level)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
