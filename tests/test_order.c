// SPDX-License-Identifier: GPL-3.0-or-later
// Portals in one plane, but for rounding: lines that come to them in order. Solver against checker.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <string.h>

#include "visibility/stab.h"
#include "visibility/visibility.h"
#include "visibility_check/check_hidden.h"
#include "visibility_check/check_witness.h"
#include "witness_graphs.h"

enum { PORTALS_MOST = 5, CHAINS = 800, LINES = 60 };

/// Cells 0, 1, ... with one opening from each to the next, that is, portals 0, 2, ...
typedef struct chain {
    enf_portal_graph graph;
    enf_shapes shapes;
    enf_pluecker pluecker;
    enf_stabber *stabber;
    int32_t sequence[PORTALS_MOST];
    int32_t count;
} chain;

static void chain_begin(chain *chain) {
    *chain = (struct chain){.graph = {.cell_count = 1}};
}

/// The box of x and y, corners at these heights: (low, low), (high, low), (high, high), (low, high).
static void chain_add(chain *chain, const double low[2], const double high[2], const double height[4]) {
    const double corners[4][3] = {{low[0], low[1], height[0]},
                                  {high[0], low[1], height[1]},
                                  {high[0], high[1], height[2]},
                                  {low[0], high[1], height[3]}};
    assert_true(enf_portal_graph_add(&chain->graph, chain->count, chain->count + 1, corners, 4));
    chain->sequence[chain->count] = 2 * chain->count;
    chain->count++;
    chain->graph.cell_count++;
}

static void chain_end(chain *chain) {
    finish(&chain->graph);
    assert_true(enf_shapes_make(&chain->shapes, &chain->graph));
    assert_true(enf_pluecker_make(&chain->pluecker, &chain->graph));
    chain->stabber = enf_stabber_new(&chain->pluecker);
    assert_non_null(chain->stabber);
}

static void chain_free(chain *chain) {
    enf_stabber_free(chain->stabber);
    enf_pluecker_free(&chain->pluecker);
    enf_shapes_free(&chain->shapes);
    enf_portal_graph_free(&chain->graph);
}

static enf_stab ask(chain *chain, const enf_line *hint) {
    enf_stab stab;
    enf_error error = {0};
    if (enf_stab_in_order(chain->stabber, &chain->shapes, chain->sequence, chain->count, hint, &stab, &error))
        fail_msg("%s", error.text);
    return stab;
}

/// Does the checker's walk take the line from the first cell to the last?
static bool arrives(const chain *chain, const enf_line *line, const char *decimals) {
    enf_witness_checker checker;
    enf_witness witness = {.cell = {0, chain->count}, .decimals = (char *)(uintptr_t)decimals};
    memcpy(witness.from, line->from, sizeof witness.from);
    memcpy(witness.to, line->to, sizeof witness.to);
    if (decimals) { // the doubles do not count, but must differ
        memset(witness.from, 0, sizeof witness.from);
        witness.to[0] = witness.from[0] + 1;
    }
    assert_true(enf_witness_checker_make(&checker, &chain->graph));
    const bool holds = enf_witness_check(&checker, &witness).fault == ENF_WITNESS_HOLDS;
    enf_witness_checker_free(&checker);
    return holds;
}

static bool is_shown(const chain *chain, const enf_stab *stab) {
    return stab->answer == ENF_STAB_VISIBLE && (stab->has_line || stab->long_line) &&
           arrives(chain, &stab->line, stab->has_line ? NULL : stab->long_line);
}

// ---------------------------------------------------------------------------------------------- two planes

/// A flat door at height 0, x from 0 to `end`, and one that rises through it at x = 2; both y from 0 to 4.
static void add_flat(chain *chain, double end) {
    chain_add(chain, (const double[2]){0, 0}, (const double[2]){end, 4}, (const double[4]){0, 0, 0, 0});
}

static void add_rising(chain *chain, double end, double rise) {
    chain_add(chain, (const double[2]){1, 0}, (const double[2]){end, 4},
              (const double[4]){-rise, (end - 2) * rise, (end - 2) * rise, -rise});
}

/// Upwards, so high above the plane as it is wide.
static enf_line upright(double x) {
    return (enf_line){{x, 2, -8}, {x, 2, 8}};
}

static void a_line_in_the_wrong_order_is_turned_right(void **state) {
    (void)state;
    const enf_line early = upright(1.5), late = upright(3);
    for (double rise = 1; rise > 1e-12; rise /= 8)
        for (int flat_first = 0; flat_first < 2; flat_first++) {
            chain chain;
            chain_begin(&chain);
            if (flat_first) add_flat(&chain, 4);
            add_rising(&chain, 5, rise);
            if (!flat_first) add_flat(&chain, 4);
            chain_end(&chain);
            const enf_line *right = flat_first ? &late : &early, *wrong = flat_first ? &early : &late;
            assert_int_equal(enf_line_disorder(&chain.shapes, right, NULL, chain.sequence, 2), 0);
            assert_int_equal(enf_line_disorder(&chain.shapes, wrong, NULL, chain.sequence, 2), 1);
            assert_true(arrives(&chain, right, NULL));
            assert_false(arrives(&chain, wrong, NULL));
            enf_stab stab = ask(&chain, wrong);
            assert_true(is_shown(&chain, &stab));
            assert_int_equal(enf_stabber_counts(chain.stabber)->orders, 1);
            chain_free(&chain);
        }
}

/// The flat door ends where the other one rises through it: all lines through both come to the other first.
static void what_only_the_wrong_order_shows_is_hidden(void **state) {
    (void)state;
    const enf_line wrong = upright(1.5);
    for (double rise = 1; rise > 1e-12; rise /= 8)
        for (int ends = 0; ends < 2; ends++) { // at the hinge, or a little after
            chain chain;
            chain_begin(&chain);
            add_flat(&chain, ends ? 2 : 2 + 0x1p-40);
            add_rising(&chain, 5, rise);
            chain_end(&chain);
            enf_stab stab;
            enf_error error;
            assert_false(enf_stab_exact(chain.stabber, chain.sequence, 2, &wrong, &stab, &error));
            assert_int_equal(stab.answer, ENF_STAB_VISIBLE);
            stab = ask(&chain, &wrong);
            assert_int_equal(stab.answer, ends ? ENF_STAB_HIDDEN : ENF_STAB_VISIBLE);
            if (!ends) assert_true(is_shown(&chain, &stab));
            assert_int_equal(enf_stabber_counts(chain.stabber)->orders_hidden, ends);
            assert_int_equal(enf_stabber_counts(chain.stabber)->orders_open, 0);
            chain_free(&chain);
        }
}

static void doors_in_one_plane_are_in_no_order(void **state) {
    (void)state;
    chain chain;
    chain_begin(&chain);
    add_flat(&chain, 4);
    add_rising(&chain, 5, 0);
    chain_end(&chain);
    const enf_line upwards = upright(3);
    assert_int_equal(enf_line_disorder(&chain.shapes, &upwards, NULL, chain.sequence, 2), 1);
    assert_false(arrives(&chain, &upwards, NULL));
    assert_int_equal(ask(&chain, NULL).answer, ENF_STAB_HIDDEN);
    chain_free(&chain);
}

/// A door bent along the diagonal from its first corner, and a flat one over its lower part: the plane of a
/// triangle says nothing beyond the triangle.
static void a_bent_door_is_where_the_line_goes_through(void **state) {
    (void)state;
    chain chain;
    chain_begin(&chain);
    chain_add(&chain, (const double[2]){0, 0}, (const double[2]){4, 4}, (const double[4]){0, 0, 1, 0});
    chain_add(&chain, (const double[2]){0, 0}, (const double[2]){4, 4},
              (const double[4]){0.125, 0.125, 0.125, 0.125});
    chain_end(&chain);
    const enf_line low = {{3, 0.25, -8}, {3, 0.25, 8}}; // at 1/16; the other triangle's plane is at 3/4
    const enf_line high = {{3, 2, -8}, {3, 2, 8}};      // at 1/2
    assert_int_equal(enf_line_disorder(&chain.shapes, &low, NULL, chain.sequence, 2), 0);
    assert_int_equal(enf_line_disorder(&chain.shapes, &high, NULL, chain.sequence, 2), 1);
    assert_true(arrives(&chain, &low, NULL));
    assert_false(arrives(&chain, &high, NULL));
    enf_stab stab = ask(&chain, &high);
    assert_true(is_shown(&chain, &stab));
    chain_free(&chain);
}

// ---------------------------------------------------------------------------------------------- at random

static double whole(uint64_t *seed, int count) {
    return (int)(random_unit(seed) * count);
}

/// Doors that overlap, flat or bent, all within a few units of one plane; so torn, times `tear`.
static void make_chain(chain *chain, uint64_t *seed, double tear) {
    const int32_t count = 2 + (int32_t)whole(seed, PORTALS_MOST - 1);
    chain_begin(chain);
    for (int32_t k = 0; k < count; k++) {
        double low[2], high[2], height[4];
        const double base = whole(seed, 3), slope = whole(seed, 3) - 1;
        const bool bent = whole(seed, 2) > 0;
        for (int i = 0; i < 2; i++) {
            low[i] = whole(seed, 9);
            high[i] = low[i] + 1 + whole(seed, 8);
        }
        for (int c = 0; c < 4; c++) {
            height[c] = base + slope * (c == 1 || c == 2 ? high[0] - low[0] : 0) / 4;
            height[c] = tear * (bent ? base + whole(seed, 3) : height[c]);
        }
        chain_add(chain, low, high, height);
    }
    chain_end(chain);
}

/// Lines between points of the first door's box and the last one's: does any of them arrive?
static bool any_arrives(const chain *chain, uint64_t *seed) {
    for (int n = 0; n < LINES; n++) {
        enf_line line;
        for (int end = 0; end < 2; end++) {
            const enf_shape *shape = &chain->shapes.shapes[end ? chain->count - 1 : 0];
            double *point = end ? line.to : line.from;
            for (int i = 0; i < 3; i++)
                point[i] = shape->low[i] + random_unit(seed) * (shape->high[i] - shape->low[i]);
            point[2] += end ? 4 : -4;
        }
        if (arrives(chain, &line, NULL)) return true;
    }
    return false;
}

/// The whole ladder, and both checks of what it says. Returns how many pairs the checker leaves open.
static size_t assert_set_is_right(const chain *chain, bool sees) {
    const enf_visibility_options options = {.method = ENF_METHOD_EXACT, .threads = 1, .want_witnesses = true};
    enf_visibility visibility;
    enf_hidden_report hidden;
    enf_error error = {0};
    if (enf_visibility_run(&visibility, &chain->graph, &options, &error)) fail_msg("%s", error.text);
    assert_int_equal(enf_pvs_get(&visibility.pvs, 0, chain->count), sees);
    assert_int_equal(visibility.stabs.lines_missing + visibility.stabs.orders_open, 0);
    const enf_hidden_options how = {0};
    assert_int_equal(
        enf_check_hidden(&chain->graph, visibility.pvs.rows, visibility.pvs.row_words, &how, &hidden, &error),
        ENF_OK);
    const size_t open = hidden.open_count;
    for (size_t k = 0; k < open; k++) assert_false(hidden.open[k].seen);
    enf_hidden_report_free(&hidden);
    enf_visibility_free(&visibility);
    return open;
}

static void solver_and_checker_agree(double tear, uint64_t seed) {
    enf_stab_counts sum = {0};
    size_t open = 0;
    for (int n = 0; n < CHAINS; n++) {
        chain chain;
        make_chain(&chain, &seed, tear);
        enf_stab stab = ask(&chain, NULL);
        assert_int_not_equal(stab.answer, ENF_STAB_OPEN);
        const bool sees = stab.answer == ENF_STAB_VISIBLE;
        if (sees && !is_shown(&chain, &stab)) fail_msg("chain %d: the line does not arrive", n);
        if (!sees && any_arrives(&chain, &seed)) fail_msg("chain %d: it is not hidden", n);
        open += assert_set_is_right(&chain, sees);
        sum.orders += enf_stabber_counts(chain.stabber)->orders;
        sum.orders_hidden += enf_stabber_counts(chain.stabber)->orders_hidden;
        chain_free(&chain);
    }
    print_message("%d chains, order matters to %d, hides %d; the checker leaves %zu open\n", CHAINS,
                  (int)sum.orders, (int)sum.orders_hidden, open);
    assert_true(sum.orders > CHAINS / 50 && sum.orders_hidden > CHAINS / 100);
    assert_true(sum.orders_hidden < sum.orders && open < CHAINS / 100);
}

static void bent_doors_are_decided(void **state) {
    (void)state;
    solver_and_checker_agree(1, 1);
}

static void doors_torn_by_rounding_are_decided(void **state) {
    (void)state;
    solver_and_checker_agree(0x1p-44, 2);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_in_the_wrong_order_is_turned_right),
        cmocka_unit_test(what_only_the_wrong_order_shows_is_hidden),
        cmocka_unit_test(doors_in_one_plane_are_in_no_order),
        cmocka_unit_test(a_bent_door_is_where_the_line_goes_through),
        cmocka_unit_test(bent_doors_are_decided),
        cmocka_unit_test(doors_torn_by_rounding_are_decided),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
