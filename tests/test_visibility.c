// SPDX-License-Identifier: GPL-3.0-or-later
// The ladder of visibility: each rung contains the next, results do not depend on threads, on how portals are
// numbered or on scale, sets are symmetric, and witnesses pass what they should.
#include "visibility/visibility.h"
#include "visibility_check/check_witness.h"

#include "visibility/line_order.h"
#include "visibility_check/check_hidden.h"
#include "visibility_check/check_witness.h"

#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/shared_data.h"

static enf_visibility run(const enf_portal_graph *graph, enf_method method, int threads, bool witnesses) {
    const enf_visibility_options options = {
        .method = method, .threads = threads, .want_witnesses = witnesses};
    enf_visibility visibility;
    enf_error error = {0};
    if (enf_visibility_run(&visibility, graph, &options, &error)) fail_msg("%s", error.text);
    return visibility;
}

static void assert_same_sets(const enf_pvs *a, const enf_pvs *b) {
    assert_int_equal(a->cell_count, b->cell_count);
    assert_memory_equal(a->rows, b->rows, (size_t)a->cell_count * a->row_words * sizeof *a->rows);
}

/// Bit rows: whatever `inner` has, `outer` has.
static void assert_contains(const enf_pvs *outer, const enf_pvs *inner, const char *what) {
    for (size_t i = 0; i < (size_t)outer->cell_count * outer->row_words; i++)
        if (inner->rows[i] & ~outer->rows[i])
            fail_msg("%s: cell %zu sees more by the dearer method", what, i / outer->row_words);
}

static void assert_symmetric(const enf_pvs *pvs) {
    for (int32_t i = 0; i < pvs->cell_count; i++) {
        assert_true(enf_pvs_get(pvs, i, i));
        for (int32_t j = 0; j < i; j++)
            if (enf_pvs_get(pvs, i, j) != enf_pvs_get(pvs, j, i))
                fail_msg("%" PRId32 " and %" PRId32 " do not agree", i, j);
    }
}

// ---------------------------------------------------------------------------------------------- by hand

/// A rectangle in the plane x = at, from (y, z) to (y, z); its normal points along x.
static void add_wall(enf_portal_graph *graph, int32_t from, int32_t to, double at, const double low[2],
                     const double high[2]) {
    const double corners[4][3] = {
        {at, low[0], low[1]}, {at, high[0], low[1]}, {at, high[0], high[1]}, {at, low[0], high[1]}};
    assert_true(enf_portal_graph_add(graph, from, to, corners, 4));
}

static void finish(enf_portal_graph *graph) {
    enf_error error = {0};
    assert_int_equal(enf_portal_graph_finish(graph, &error), ENF_OK);
}

static void a_row_of_doors_is_seen_through(void **state) {
    (void)state;
    enf_portal_graph graph = {.cell_count = 6};
    for (int32_t i = 0; i < 5; i++)
        add_wall(&graph, i, i + 1, 8 * i, (const double[2]){0, 0}, (const double[2]){1, 2});
    finish(&graph);
    for (int method = 0; method < ENF_METHOD_COUNT; method++) {
        enf_visibility visibility = run(&graph, (enf_method)method, 1, false);
        assert_int_equal(enf_pvs_pairs(&visibility.pvs), 36);
        enf_visibility_free(&visibility);
    }
    enf_portal_graph_free(&graph);
}

/// Three doors, each beside the one before: the first cell does not see the last. Planes know that.
static void doors_side_by_side_hide(void **state) {
    (void)state;
    enf_portal_graph graph = {.cell_count = 4};
    for (int32_t i = 0; i < 3; i++)
        add_wall(&graph, i, i + 1, 8 * i, (const double[2]){(i & 1) * 2, 0},
                 (const double[2]){(i & 1) * 2 + 1, 2});
    finish(&graph);
    enf_visibility facing = run(&graph, ENF_METHOD_FACING, 1, false);
    enf_visibility hourglass = run(&graph, ENF_METHOD_HOURGLASS, 1, false);
    enf_visibility exact = run(&graph, ENF_METHOD_EXACT, 1, false);
    assert_true(enf_pvs_get(&facing.pvs, 0, 3));
    assert_false(enf_pvs_get(&hourglass.pvs, 0, 3));
    assert_same_sets(&hourglass.pvs, &exact.pvs);
    assert_true(enf_pvs_get(&exact.pvs, 0, 2));
    enf_visibility_free(&facing);
    enf_visibility_free(&hourglass);
    enf_visibility_free(&exact);
    enf_portal_graph_free(&graph);
}

/// Doors that leave a slit of this width between them when one looks along x.
static bool sees_through_slit(double width) {
    enf_portal_graph graph = {.cell_count = 4};
    add_wall(&graph, 0, 1, 0, (const double[2]){0, 0}, (const double[2]){1, 2});
    add_wall(&graph, 1, 2, 4096, (const double[2]){1 - width, 0}, (const double[2]){2, 2});
    add_wall(&graph, 2, 3, 8192, (const double[2]){0, 0}, (const double[2]){1, 2});
    finish(&graph);
    enf_visibility exact = run(&graph, ENF_METHOD_EXACT, 1, true);
    bool sees = enf_pvs_get(&exact.pvs, 0, 3);
    int64_t witnesses = 0;
    for (int64_t i = 0; i < exact.witness_count; i++)
        witnesses += exact.witness_cells[i][0] == 0 && exact.witness_cells[i][1] == 3;
    assert_int_equal(witnesses, sees);
    enf_visibility_free(&exact);
    enf_portal_graph_free(&graph);
    return sees;
}

static void slits_are_decided_exactly(void **state) {
    (void)state;
    for (double width = 1; width > 1e-12; width /= 4) assert_true(sees_through_slit(width));
    assert_false(sees_through_slit(0));
    assert_false(sees_through_slit(-1e-9));
    assert_false(sees_through_slit(-1e-3));
}

/// Two openings of a level in one slanted plane, but for rounding: a line passes the edges of both, and comes
/// to the wrong one first. It shows nothing.
static void order_along_the_line_counts(void **state) {
    (void)state;
    static const double one[4][3] = {{288, 688, 128.00000000000017},
                                     {192, 688, 128.00000000000017},
                                     {192, 692, 129.357142857143},
                                     {288, 692, 129.357142857143}};
    static const double two[4][3] = {{160, 688, 128.00000000000017},
                                     {-72, 688, 128.0000000000002},
                                     {-72, 692, 129.35714285714303},
                                     {160, 692, 129.357142857143}};
    enf_portal_graph graph = {.cell_count = 3};
    assert_true(enf_portal_graph_add(&graph, 0, 1, one, 4) && enf_portal_graph_add(&graph, 2, 1, two, 4));
    finish(&graph);
    const enf_line line = {{-139.75761067929312, 689.43176621212024, 128.48577782196955},
                           {207.99784404816833, 689.59661747543248, 128.54170950059333}};
    static const int32_t sequence[2] = {0, 3}, other[2] = {3, 0};
    assert_true(enf_line_passes(&line, &graph, sequence[0]) && enf_line_passes(&line, &graph, sequence[1]));
    enf_shapes shapes;
    assert_true(enf_shapes_make(&shapes, &graph));
    assert_int_equal(enf_line_disorder(&shapes, &line, NULL, sequence, 2), 1);
    assert_int_equal(enf_line_disorder(&shapes, &line, NULL, sequence, 1), 0);
    assert_int_equal(enf_line_disorder(&shapes, &line, NULL, other, 2), 0);
    enf_shapes_free(&shapes);
    enf_witness_checker checker;
    const enf_witness witness = {.cell = {0, 2},
                                 .from = {line.from[0], line.from[1], line.from[2]},
                                 .to = {line.to[0], line.to[1], line.to[2]}};
    assert_true(enf_witness_checker_make(&checker, &graph));
    assert_int_equal(enf_witness_check(&checker, &witness).fault, ENF_WITNESS_STUCK);
    enf_witness_checker_free(&checker);
    enf_visibility exact = run(&graph, ENF_METHOD_EXACT, 1, true);
    assert_false(enf_pvs_get(&exact.pvs, 0, 2));
    assert_true(enf_pvs_get(&exact.pvs, 0, 1) && enf_pvs_get(&exact.pvs, 1, 2));
    enf_visibility_free(&exact);
    enf_portal_graph_free(&graph);
}

/// Two square matrices of eight million portals: refused with words, before anything is done.
static void what_does_not_fit_is_refused(void **state) {
    (void)state;
    enum { MANY = 4000000 };
    enf_portal_graph graph = {.cell_count = 2, .opening_count = MANY};
    const enf_visibility_options options = {.method = ENF_METHOD_EXACT, .threads = 1};
    enf_visibility visibility;
    enf_error error = {0};
    assert_int_equal(enf_visibility_run(&visibility, &graph, &options, &error), ENF_NO_RESOURCES);
    assert_non_null(strstr(error.text, "4000000 openings"));
    enf_visibility_free(&visibility);
}

static void cells_without_portals_see_themselves(void **state) {
    (void)state;
    enf_portal_graph graph = {.cell_count = 3};
    finish(&graph);
    for (int method = 0; method < ENF_METHOD_COUNT; method++) {
        enf_visibility visibility = run(&graph, (enf_method)method, 2, true);
        assert_int_equal(enf_pvs_pairs(&visibility.pvs), 3);
        enf_visibility_free(&visibility);
    }
    enf_portal_graph_free(&graph);
}

// ---------------------------------------------------------------------------------------------- levels

static enf_portal_graph read_level(const char *level) {
    char path[1024];
    snprintf(path, sizeof path, "%s/quake/prt/%s.prt", shared_data(), level);
    enf_portal_graph graph;
    enf_error error = {0};
    if (enf_portal_graph_read(&graph, path, &error)) fail_msg("%s", error.text);
    return graph;
}

static void each_rung_contains_the_next(void **state) {
    (void)state;
    static const char *const levels[] = {"dm1", "dm4", "e1m7", "end"};
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
        enf_portal_graph graph = read_level(levels[i]);
        enf_visibility outer = run(&graph, ENF_METHOD_REACH, 1, false);
        for (int method = 1; method < ENF_METHOD_COUNT; method++) {
            enf_visibility inner = run(&graph, (enf_method)method, 2, false);
            assert_symmetric(&inner.pvs);
            assert_contains(&outer.pvs, &inner.pvs, levels[i]);
            assert_true(enf_pvs_pairs(&inner.pvs) < enf_pvs_pairs(&outer.pvs));
            enf_visibility_free(&outer);
            outer = inner;
        }
        enf_visibility_free(&outer);
        enf_portal_graph_free(&graph);
    }
}

static void threads_do_not_matter(void **state) {
    (void)state;
    enf_portal_graph graph = read_level("e1m7");
    for (int method = ENF_METHOD_FACING; method < ENF_METHOD_COUNT; method++) {
        enf_visibility one = run(&graph, (enf_method)method, 1, true);
        for (int threads = 2; threads <= 8; threads += threads == 2 ? 1 : 5) {
            enf_visibility more = run(&graph, (enf_method)method, threads, true);
            assert_same_sets(&one.pvs, &more.pvs);
            assert_int_equal(one.witness_count, more.witness_count);
            assert_memory_equal(one.witnesses, more.witnesses,
                                (size_t)one.witness_count * sizeof *one.witnesses);
            for (int64_t i = 0; i < one.witness_count; i++) {
                const char *a = one.long_witnesses[i], *b = more.long_witnesses[i];
                assert_true(a == b || (a && b && strcmp(a, b) == 0));
            }
            enf_visibility_free(&more);
        }
        enf_visibility_free(&one);
    }
    enf_portal_graph_free(&graph);
}

static uint64_t next_random(uint64_t *seed) {
    *seed = *seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return *seed >> 33;
}

static void shuffle(int32_t *numbers, int32_t count, uint64_t *seed) {
    for (int32_t i = 0; i < count; i++) numbers[i] = i;
    for (int32_t i = count - 1; i > 0; i--) {
        int32_t k = (int32_t)(next_random(seed) % (uint64_t)(i + 1)), swapped = numbers[i];
        numbers[i] = numbers[k];
        numbers[k] = swapped;
    }
}

/// The same openings in another order, cells renamed, everything scaled.
static enf_portal_graph rearrange(const enf_portal_graph *graph, const int32_t *cells,
                                  const int32_t *openings, double scale) {
    enf_portal_graph made = {.cell_count = graph->cell_count};
    for (int32_t i = 0; i < graph->opening_count; i++) {
        int32_t k = openings[i], first = graph->opening_corner[k],
                count = graph->opening_corner[k + 1] - first;
        double corners[64][3];
        for (int32_t c = 0; c < count; c++)
            for (int axis = 0; axis < 3; axis++) corners[c][axis] = scale * graph->corners[first + c][axis];
        assert_true(enf_portal_graph_add(&made, cells[graph->opening_cell[k][0]],
                                         cells[graph->opening_cell[k][1]], (const double(*)[3])corners,
                                         count));
    }
    finish(&made);
    return made;
}

static void numbers_and_scale_do_not_matter(void **state) {
    (void)state;
    uint64_t seed = 20261126;
    enf_portal_graph graph = read_level("dm1");
    int32_t *cells = malloc((size_t)graph.cell_count * sizeof *cells);
    int32_t *openings = malloc((size_t)graph.opening_count * sizeof *openings);
    assert_true(cells && openings);
    for (int round = 0; round < 3; round++) {
        printf("seed %" PRIu64 "\n", seed);
        shuffle(cells, graph.cell_count, &seed);
        shuffle(openings, graph.opening_count, &seed);
        enf_portal_graph other = rearrange(&graph, cells, openings, round ? 0x1p-70 * round * round : 1024);
        for (int method = ENF_METHOD_FACING; method < ENF_METHOD_COUNT; method++) {
            if (round == 2 && method < ENF_METHOD_EXACT)
                continue; // times 4 is a power of two, times 2^-68 too
            enf_visibility one = run(&graph, (enf_method)method, 1, false);
            enf_visibility two = run(&other, (enf_method)method, 2, false);
            for (int32_t i = 0; i < graph.cell_count; i++)
                for (int32_t j = 0; j < graph.cell_count; j++)
                    if (enf_pvs_get(&one.pvs, i, j) != enf_pvs_get(&two.pvs, cells[i], cells[j]))
                        fail_msg("%s: cells %" PRId32 " and %" PRId32, enf_method_name((enf_method)method), i,
                                 j);
            enf_visibility_free(&one);
            enf_visibility_free(&two);
        }
        enf_portal_graph_free(&other);
    }
    free(cells);
    free(openings);
    enf_portal_graph_free(&graph);
}

/// One for each pair; and by the checker's arithmetic, too, every line leads from one cell to the other.
/// Returns how many lines are not between doubles.
static int64_t check_witnesses(const enf_portal_graph *graph, const enf_visibility *visibility) {
    enf_witness_checker checker;
    int64_t longer = 0;
    assert_int_equal(2 * visibility->witness_count + graph->cell_count, enf_pvs_pairs(&visibility->pvs));
    assert_true(enf_witness_checker_make(&checker, graph));
    for (int64_t i = 0; i < visibility->witness_count; i++) {
        const int32_t *cell = visibility->witness_cells[i];
        enf_witness witness = {.cell = {cell[0], cell[1]}, .decimals = visibility->long_witnesses[i]};
        memcpy(witness.from, visibility->witnesses[i].from, sizeof witness.from);
        memcpy(witness.to, visibility->witnesses[i].to, sizeof witness.to);
        if (enf_witness_check(&checker, &witness).fault)
            fail_msg("cells %" PRId32 " and %" PRId32, cell[0], cell[1]);
        longer += witness.decimals != NULL;
    }
    enf_witness_checker_free(&checker);
    return longer;
}

static void each_pair_has_its_witness(void **state) {
    (void)state;
    static const char *const levels[] = {"dm4", "e1m7"};
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
        enf_portal_graph graph = read_level(levels[i]);
        enf_visibility exact = run(&graph, ENF_METHOD_EXACT, 1, true);
        assert_int_equal(exact.stabs.lines_missing, 0);
        assert_int_equal(exact.stabs.orders_open, 0);
        const int64_t longer = check_witnesses(&graph, &exact);
        printf("%s: %" PRId64 " lines, %" PRId64 " by way of a longer one, %" PRId64 " longer\n", levels[i],
               exact.witness_count, exact.stabs.lines_fine, longer);
        assert_true(i == 0 || longer > 0);
        enf_visibility_free(&exact);
        enf_portal_graph_free(&graph);
    }
}

/// Every line between doubles passes one portal out of its first cell and one into its last, exactly.
static void witnesses_leave_and_arrive(void **state) {
    (void)state;
    enf_portal_graph graph = read_level("dm4");
    enf_visibility exact = run(&graph, ENF_METHOD_EXACT, 1, true);
    for (int64_t i = 0; i < exact.witness_count; i++) {
        int32_t from = exact.witness_cells[i][0], to = exact.witness_cells[i][1], out = 0, in = 0;
        if (exact.long_witnesses[i]) continue;
        for (int32_t k = graph.cell_portal[from]; k < graph.cell_portal[from + 1]; k++)
            out += enf_line_passes(&exact.witnesses[i], &graph, graph.cell_portals[k]);
        for (int32_t k = graph.cell_portal[to]; k < graph.cell_portal[to + 1]; k++)
            in += enf_line_passes(&exact.witnesses[i], &graph, graph.cell_portals[k] ^ 1);
        if (out != 1 || in != 1) fail_msg("cells %" PRId32 " and %" PRId32, from, to);
    }
    enf_visibility_free(&exact);
    enf_portal_graph_free(&graph);
}

/// Another way, which shares no code with the solver and is exact in the end, finds no pair that should not
/// be hidden. In "end" portals lie in one plane up to rounding, and lines squeeze through between them.
static void what_is_hidden_is_confirmed(void **state) {
    (void)state;
    static const char *const levels[] = {"dm4", "e1m7", "end"};
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
        enf_portal_graph graph = read_level(levels[i]);
        enf_visibility exact = run(&graph, ENF_METHOD_EXACT, 2, false);
        const enf_hidden_options options = {0};
        enf_hidden_report report;
        enf_error error = {0};
        assert_int_equal(
            enf_check_hidden(&graph, exact.pvs.rows, exact.pvs.row_words, &options, &report, &error), ENF_OK);
        printf("%s: %" PRIu64 " pairs hidden, %zu open\n", levels[i], report.claimed, report.open_count);
        if (report.open_count > 0)
            fail_msg("%s: %" PRId32 " and %" PRId32, levels[i], report.open[0].cell[0],
                     report.open[0].cell[1]);
        enf_hidden_report_free(&report);
        enf_visibility_free(&exact);
        enf_portal_graph_free(&graph);
    }
}

/// A level compiler's sets, tight but for some 2 in 100 (rays say so), hold all but a few of ours.
static void agrees_with_another_program(void **state) {
    (void)state;
    char path[1024];
    snprintf(path, sizeof path, "%s/quake/prt/dm1.pvs.txt.gz", shared_data());
    enf_portal_graph graph = read_level("dm1");
    enf_visibility exact = run(&graph, ENF_METHOD_EXACT, 2, false);
    enf_pvs other;
    enf_error error = {0};
    if (enf_pvs_read(&other, path, graph.cell_count, &error)) fail_msg("%s", error.text);
    int64_t ours = 0, theirs = 0, both = 0;
    for (int32_t i = 0; i < graph.cell_count; i++)
        for (int32_t j = 0; j < graph.cell_count; j++) {
            bool mine = enf_pvs_get(&exact.pvs, i, j), its = enf_pvs_get(&other, i, j);
            ours += mine && !its;
            theirs += its && !mine;
            both += mine && its;
        }
    printf("dm1: both %" PRId64 ", only ours %" PRId64 ", only the other's %" PRId64 "\n", both, ours,
           theirs);
    assert_true(ours * 100 < both);
    assert_true(theirs * 40 < both);
    enf_pvs_free(&other);
    enf_visibility_free(&exact);
    enf_portal_graph_free(&graph);
}

int main(int argc, char **argv) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_row_of_doors_is_seen_through),
        cmocka_unit_test(doors_side_by_side_hide),
        cmocka_unit_test(slits_are_decided_exactly),
        cmocka_unit_test(order_along_the_line_counts),
        cmocka_unit_test(what_does_not_fit_is_refused),
        cmocka_unit_test(cells_without_portals_see_themselves),
        cmocka_unit_test(each_rung_contains_the_next),
        cmocka_unit_test(threads_do_not_matter),
        cmocka_unit_test(numbers_and_scale_do_not_matter),
        cmocka_unit_test(each_pair_has_its_witness),
        cmocka_unit_test(witnesses_leave_and_arrive),
        cmocka_unit_test(what_is_hidden_is_confirmed),
        cmocka_unit_test(agrees_with_another_program),
    };
    if (argc > 1) cmocka_set_test_filter(argv[1]);
    return cmocka_run_group_tests_name("visibility", tests, NULL, NULL);
}
