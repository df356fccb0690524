// SPDX-License-Identifier: GPL-3.0-or-later
// Sight lines and hidden pairs, checked by means of their own: wrong sight lines are refused, missing pairs
// are found, and only what is hidden is confirmed to be.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "visibility_check/check_hidden.h"
#include "visibility_check/check_witness.h"
#include "visibility_check/hidden_pieces.h"
#include "visibility_check/hidden_proof.h"
#include "visibility_check/sampler.h"
#include "witness_graphs.h"

// ---------------------------------------------------------------------------------------------- sight lines

static enf_witness_fault fault_of(const enf_portal_graph *graph, int32_t i, int32_t j, const double from[3],
                                  const double to[3]) {
    enf_witness_checker checker;
    enf_witness witness = {.cell = {i, j}};
    memcpy(witness.from, from, sizeof witness.from);
    memcpy(witness.to, to, sizeof witness.to);
    assert_true(enf_witness_checker_make(&checker, graph));
    enf_witness_outcome outcome = enf_witness_check(&checker, &witness);
    char text[128];
    enf_witness_describe(outcome, text, sizeof text);
    assert_true(strlen(text) > 10);
    enf_witness_checker_free(&checker);
    return outcome.fault;
}

#define POINT(x, y, z) ((const double[3]){x, y, z})

static void a_line_through_a_row_of_rooms_arrives(void **state) {
    (void)state;
    enf_portal_graph graph = row_of_rooms(6);
    const double *from = POINT(0.5, 1, 1), *to = POINT(5.5, 1.25, 0.75);
    assert_int_equal(fault_of(&graph, 0, 5, from, to), ENF_WITNESS_HOLDS);
    assert_int_equal(fault_of(&graph, 5, 0, from, to), ENF_WITNESS_HOLDS);
    assert_int_equal(fault_of(&graph, 0, 5, to, from), ENF_WITNESS_HOLDS);
    assert_int_equal(fault_of(&graph, 2, 3, from, to), ENF_WITNESS_HOLDS);
    assert_int_equal(fault_of(&graph, 0, 5, POINT(900, 1, 1), POINT(901, 1, 1)), ENF_WITNESS_HOLDS);
    enf_portal_graph_free(&graph);
}

static enf_witness_fault fault_of_decimals(const enf_portal_graph *graph, int32_t i, int32_t j,
                                           const char *decimals) {
    enf_witness_checker checker;
    char text[256];
    enf_witness witness = {.cell = {i, j}, .decimals = text};
    snprintf(text, sizeof text, "%s", decimals);
    assert_true(enf_witness_checker_make(&checker, graph));
    enf_witness_outcome outcome = enf_witness_check(&checker, &witness);
    enf_witness_checker_free(&checker);
    return outcome.fault;
}

/// A slit from 0 to the least double, 4.9e-324, in y: looked straight through it, only what is between them
/// passes.
static void decimals_are_meant_as_they_stand(void **state) {
    (void)state;
    enf_portal_graph graph = slit(0x1p-1074);
    const char *const through[] = {"0 1e-324 1.125 4 1e-324 1.125", "4 4.9e-324 1.125 -80 4.9e-324 1125e-3",
                                   "-8e1 .0000000001e-314 +1.125 40.e-1 1e-324 1.125"};
    const char *const beside[] = {"0 0 1.125 4 0 1.125", "0 5e-324 1.125 4 5e-324 1.125",
                                  "0 -1e-324 1.125 4 -1e-324 1.125", "0 1e-324 0.5 4 1e-324 0.5"};
    for (size_t k = 0; k < sizeof through / sizeof *through; k++) {
        assert_int_equal(fault_of_decimals(&graph, 0, 4, through[k]), ENF_WITNESS_HOLDS);
        assert_int_equal(fault_of_decimals(&graph, 4, 0, through[k]), ENF_WITNESS_HOLDS);
    }
    for (size_t k = 0; k < sizeof beside / sizeof *beside; k++)
        assert_int_equal(fault_of_decimals(&graph, 0, 4, beside[k]), ENF_WITNESS_STUCK);
    static const char *const none[] = {"0 1 1 0 1.0 1", "0 1 1 4 1", "0 1 1 4 1 x",
                                       "0 1 1 4 1 1 1", "",          "0 1 1 4 1 1e99999"};
    for (size_t k = 0; k < sizeof none / sizeof *none; k++)
        assert_int_equal(fault_of_decimals(&graph, 0, 4, none[k]), ENF_WITNESS_NO_LINE);
    enf_portal_graph_free(&graph);
}

static void a_line_into_the_wall_is_stuck(void **state) {
    (void)state;
    enf_portal_graph graph = row_of_rooms(6);
    assert_int_equal(fault_of(&graph, 0, 5, POINT(0.5, 1, 1), POINT(5.5, 3, 1)), ENF_WITNESS_STUCK);
    assert_int_equal(fault_of(&graph, 0, 5, POINT(0.5, 1, 1), POINT(0.5, 1, 2)), ENF_WITNESS_STUCK);
    enf_portal_graph_free(&graph);
}

static void an_edge_that_is_touched_is_not_passed(void **state) {
    (void)state;
    enf_portal_graph graph = row_of_rooms(6);
    double below = nextafter(2, 0), above = nextafter(2, 3);
    assert_int_equal(fault_of(&graph, 0, 5, POINT(0.5, 2, 1), POINT(5.5, 2, 1)), ENF_WITNESS_STUCK);
    assert_int_equal(fault_of(&graph, 0, 5, POINT(0.5, above, 1), POINT(5.5, above, 1)), ENF_WITNESS_STUCK);
    assert_int_equal(fault_of(&graph, 0, 5, POINT(0.5, below, 1), POINT(5.5, below, 1)), ENF_WITNESS_HOLDS);
    // Through (3, 2, 1), up to what doubles can tell.
    assert_int_equal(fault_of(&graph, 0, 5, POINT(0, 2.3, 1), POINT(30, -0.7, 1)), ENF_WITNESS_STUCK);
    enf_portal_graph_free(&graph);
}

/// Lines from (0, a) to (3, b) in the plane of x and y, which meet the edge x = 1, y = 2 if b = 6 - 2 a, and
/// those that miss it by the last bit of b.
static void lines_that_nearly_touch_are_decided_exactly(void **state) {
    (void)state;
    uint64_t seed = 271828;
    enf_portal_graph graph = row_of_rooms(2);
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 3000; ++round) {
        double a = 1 + random_unit(&seed), b = 6 - 2 * a, z = 0.25 + random_unit(&seed);
        const double *from = POINT(0, a, z);
        assert_int_equal(fault_of(&graph, 0, 1, from, POINT(3, b, 0.75)), ENF_WITNESS_STUCK);
        assert_int_equal(fault_of(&graph, 0, 1, from, POINT(3, nextafter(b, 9), 0.75)), ENF_WITNESS_STUCK);
        assert_int_equal(fault_of(&graph, 0, 1, from, POINT(3, nextafter(b, 0), 0.75)), ENF_WITNESS_HOLDS);
    }
    enf_portal_graph_free(&graph);
}

static void of_two_ways_out_of_one_cell_both_are_taken(void **state) {
    (void)state;
    enf_portal_graph fork = {.cell_count = 4};
    add_square(&fork, 0, 1, 1);
    add_square(&fork, 0, 2, 1.5);
    finish(&fork);
    for (int32_t to = 1; to <= 3; ++to)
        assert_int_equal(fault_of(&fork, 0, to, POINT(0, 1, 1), POINT(9, 1, 1)),
                         to == 3 ? ENF_WITNESS_STUCK : ENF_WITNESS_HOLDS);
    enf_portal_graph_free(&fork);
}

static void a_line_that_goes_in_circles_ends(void **state) {
    (void)state;
    enf_portal_graph graph = {.cell_count = 3};
    add_square(&graph, 0, 1, 1);
    add_square(&graph, 1, 0, 2);
    finish(&graph);
    assert_int_equal(fault_of(&graph, 0, 2, POINT(0, 1, 1), POINT(9, 1, 1)), ENF_WITNESS_STUCK);
    enf_portal_graph_free(&graph);
}

static void no_line_and_no_cell_are_told(void **state) {
    (void)state;
    enf_portal_graph graph = row_of_rooms(3);
    const double *from = POINT(0.5, 1, 1), *to = POINT(2.5, 1, 1);
    assert_int_equal(fault_of(&graph, 0, 2, from, from), ENF_WITNESS_NO_LINE);
    assert_int_equal(fault_of(&graph, 0, 2, POINT(NAN, 1, 1), to), ENF_WITNESS_NO_LINE);
    assert_int_equal(fault_of(&graph, 0, 2, from, POINT(1, INFINITY, 1)), ENF_WITNESS_NO_LINE);
    assert_int_equal(fault_of(&graph, 0, 3, from, to), ENF_WITNESS_NO_CELL);
    assert_int_equal(fault_of(&graph, -1, 2, from, to), ENF_WITNESS_NO_CELL);
    enf_portal_graph_free(&graph);
}

static void numbers_may_be_huge_or_tiny(void **state) {
    (void)state;
    const double scales[] = {1e-300, 1e-150, 1e-100, 1e100, 1e200, 1e300};
    for (size_t s = 0; s < sizeof scales / sizeof *scales; ++s) {
        enf_portal_graph graph = row_of_rooms(6);
        double from[3] = {0.5, 1, 1}, to[3] = {5.5, 1.25, 0.75}, wrong[3] = {5.5, 3, 1};
        scale_graph(&graph, scales[s]);
        for (int i = 0; i < 3; ++i) {
            from[i] *= scales[s];
            to[i] *= scales[s];
            wrong[i] *= scales[s];
        }
        assert_int_equal(fault_of(&graph, 0, 5, from, to), ENF_WITNESS_HOLDS);
        assert_int_equal(fault_of(&graph, 0, 5, from, wrong), ENF_WITNESS_STUCK);
        enf_portal_graph_free(&graph);
    }
}

// ---------------------------------------------------------------------------------------------- proofs

static void edges_that_face_each_other_are_a_proof(void **state) {
    (void)state;
    enf_portal_graph graph = {.cell_count = 4};
    enf_hidden_proof proof;
    add_square(&graph, 0, 1, 1);
    add_square(&graph, 1, 2, 1); // the same corners once more
    add_square(&graph, 2, 3, 2);
    finish(&graph);
    assert_true(enf_hidden_proof_make(&proof, &graph));
    for (int twice = 0; twice < 2; ++twice) { // the second time from memory
        assert_true(enf_hidden_proof_ask(&proof, (const int32_t[]){0, 1}, 2));
        assert_true(enf_hidden_proof_ask(&proof, (const int32_t[]){4, 0, 9}, 3));
        assert_true(enf_hidden_proof_ask(&proof, (const int32_t[]){0, 9}, 2));
        assert_false(enf_hidden_proof_ask(&proof, (const int32_t[]){0, 8}, 2));
        assert_false(enf_hidden_proof_ask(&proof, (const int32_t[]){0, 2, 4, 6}, 4));
        assert_false(enf_hidden_proof_ask(&proof, (const int32_t[]){0, 2, 4, 6, 16, 18, 20}, 7));
    }
    enf_hidden_proof_free(&proof);
    enf_portal_graph_free(&graph);
}

static void a_door_by_itself_hides_nothing(void **state) {
    (void)state;
    enf_portal_graph graph = row_of_rooms(2);
    enf_hidden_pieces work = {.graph = &graph, .limit = 100};
    const int32_t edges[] = {0, 2, 4, 6}, next[] = {1, 2, 3, 0};
    assert_int_equal(enf_hidden_pieces_ask(&work, 0, 0, edges, next, 4), ENF_PIECES_OPEN);
    enf_hidden_pieces_free(&work);
    enf_portal_graph_free(&graph);
}

// ---------------------------------------------------------------------------------------------- sampler

static enf_sampler sample(const enf_portal_graph *graph, uint64_t seed, uint64_t rays) {
    enf_sampler sampler;
    enf_error error;
    assert_int_equal(enf_sampler_make(&sampler, graph, seed, &error), ENF_OK);
    assert_int_equal(enf_sampler_run(&sampler, 0, rays, &error), ENF_OK);
    return sampler;
}

static bool sampler_found(const enf_sampler *sampler, const enf_portal_graph *graph, int32_t i, int32_t j) {
    enf_witness line;
    if (!enf_sampler_witness(sampler, i, j, &line)) return false;
    assert_int_equal(fault_of(graph, i, j, line.from, line.to), ENF_WITNESS_HOLDS);
    return true;
}

static void the_sampler_finds_a_slit_that_random_lines_miss(void **state) {
    (void)state;
    enf_portal_graph graph = slit(1e-4);
    enf_sampler sampler = sample(&graph, 1, 1000);
    assert_true(sampler_found(&sampler, &graph, 0, 4));
    // No line keeps clear of both sides of the slit by more than half its width.
    float clearance = sampler.pair_clearance[enf_sampler_pair(0, 4)];
    assert_true(clearance > 1e-5 && clearance <= 0.5e-4 * 1.001);
    enf_sampler_free(&sampler);
    enf_portal_graph_free(&graph);
}

static void the_same_seed_finds_the_same(void **state) {
    (void)state;
    enf_portal_graph graph = row_of_rooms(6);
    enf_sampler a = sample(&graph, 7, 3000), b = sample(&graph, 7, 3000);
    assert_int_equal(a.pair_count, 15);
    assert_int_equal(a.crossings, b.crossings);
    assert_int_equal(a.line_count, b.line_count);
    assert_memory_equal(a.lines, b.lines, a.line_count * sizeof *a.lines);
    enf_sampler_free(&a);
    enf_sampler_free(&b);
    enf_portal_graph_free(&graph);
}

static void the_sampler_does_not_see_around_a_bend(void **state) {
    (void)state;
    enf_portal_graph graph = bend();
    enf_sampler sampler = sample(&graph, 3, 20000);
    assert_true(sampler_found(&sampler, &graph, 0, 2));
    assert_false(sampler_found(&sampler, &graph, 0, 3));
    enf_sampler_free(&sampler);
    enf_portal_graph_free(&graph);
}

// ---------------------------------------------------------------------------------------------- hidden pairs

/// All pairs of up to 64 cells are claimed visible but for one.
static enf_hidden_report claim_hidden(const enf_portal_graph *graph, int32_t i, int32_t j) {
    uint64_t rows[64];
    const enf_hidden_options options = {0};
    enf_hidden_report report;
    enf_error error;
    memset(rows, 0xff, sizeof rows);
    rows[i] &= ~(UINT64_C(1) << j);
    rows[j] &= ~(UINT64_C(1) << i);
    assert_int_equal(enf_check_hidden(graph, rows, 1, &options, &report, &error), ENF_OK);
    assert_true(report.ended);
    assert_int_equal(report.claimed, 1);
    return report;
}

static void the_far_end_of_a_bend_is_confirmed_hidden(void **state) {
    (void)state;
    enf_portal_graph graph = bend();
    enf_hidden_report report = claim_hidden(&graph, 0, 3);
    assert_int_equal(report.open_count, 0);
    enf_hidden_report_free(&report);
    enf_portal_graph_free(&graph);
}

static void a_pair_that_sees_each_other_is_not_confirmed(void **state) {
    (void)state;
    const double widths[] = {1, 1e-3, 1e-6, 1e-9};
    for (size_t w = 0; w < sizeof widths / sizeof *widths; ++w) {
        enf_portal_graph graph = slit(widths[w]);
        enf_hidden_report report = claim_hidden(&graph, 0, 4);
        assert_int_equal(report.open_count, 1);
        assert_int_equal(report.open[0].cell[0], 0);
        assert_int_equal(report.open[0].cell[1], 4);
        assert_true(report.open[0].seen);
        assert_true(report.open[0].verified);
        enf_hidden_report_free(&report);
        enf_portal_graph_free(&graph);
    }
}

static void neighbours_are_never_confirmed_hidden(void **state) {
    (void)state;
    enf_portal_graph graph = row_of_rooms(3);
    enf_hidden_report report = claim_hidden(&graph, 1, 2);
    assert_int_equal(report.open_count, 1);
    assert_true(report.open[0].seen && report.open[0].verified);
    enf_hidden_report_free(&report);
    enf_portal_graph_free(&graph);
}

static void a_slit_that_is_closed_is_confirmed_hidden(void **state) {
    (void)state;
    const double widths[] = {0, -1e-9, -1};
    for (size_t w = 0; w < sizeof widths / sizeof *widths; ++w) {
        enf_portal_graph graph = slit(widths[w]);
        enf_hidden_report report = claim_hidden(&graph, 0, 4);
        assert_int_equal(report.open_count, 0);
        enf_hidden_report_free(&report);
        enf_portal_graph_free(&graph);
    }
}

/// Three doors, one square to each axis, as in a staircase: line space has a point on the inner side of all
/// edges, but this point is no line, and no line is there.
static void what_only_line_space_sees_is_confirmed_hidden(void **state) {
    (void)state;
    enf_portal_graph graph = three_doors();
    enf_hidden_report report = claim_hidden(&graph, 0, 3);
    assert_int_equal(report.asked, 1); // no certificate of a linear program
    assert_int_equal(report.unproved, 0);
    assert_int_equal(report.open_count, 0);
    enf_hidden_report_free(&report);
    enf_sampler sampler = sample(&graph, 5, 20000);
    assert_false(sampler_found(&sampler, &graph, 0, 3));
    enf_sampler_free(&sampler);
    enf_portal_graph_free(&graph);
}

/// A few pieces do, if the weights of their edges are right.
static void a_near_miss_is_confirmed_hidden(void **state) {
    (void)state;
    enf_portal_graph graph = six_doors();
    enf_hidden_report report = claim_hidden(&graph, 0, 6);
    assert_int_equal(report.open_count, 0);
    assert_in_range(report.pieces, 1, 100);
    enf_hidden_report_free(&report);
    enf_portal_graph_free(&graph);
}

/// Chains of doors at random: what the sampler finds is never confirmed hidden, and the other way round.
static void the_sampler_and_the_hidden_check_agree(void **state) {
    (void)state;
    uint64_t seed = 20261126;
    int seen = 0, hidden = 0, late = 0;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 400; ++round) {
        enf_portal_graph graph = random_chain(&seed);
        int32_t last = graph.cell_count - 1;
        enf_sampler sampler = sample(&graph, seed, 4000);
        bool found = sampler_found(&sampler, &graph, 0, last);
        enf_hidden_report report = claim_hidden(&graph, 0, last);
        if (report.open_count > 0) {
            assert_true(report.open[0].seen && report.open[0].verified);
            late += !found;
        }
        assert_false(found && report.open_count == 0);
        seen += found;
        hidden += report.open_count == 0;
        enf_hidden_report_free(&report);
        enf_sampler_free(&sampler);
        enf_portal_graph_free(&graph);
    }
    print_message("%d found, %d confirmed hidden, %d seen but not found\n", seen, hidden, late);
    assert_true(seen > 50 && hidden > 50);
    assert_true(late <= seen / 20);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_line_through_a_row_of_rooms_arrives),
        cmocka_unit_test(decimals_are_meant_as_they_stand),
        cmocka_unit_test(a_line_into_the_wall_is_stuck),
        cmocka_unit_test(an_edge_that_is_touched_is_not_passed),
        cmocka_unit_test(lines_that_nearly_touch_are_decided_exactly),
        cmocka_unit_test(of_two_ways_out_of_one_cell_both_are_taken),
        cmocka_unit_test(a_line_that_goes_in_circles_ends),
        cmocka_unit_test(no_line_and_no_cell_are_told),
        cmocka_unit_test(numbers_may_be_huge_or_tiny),
        cmocka_unit_test(edges_that_face_each_other_are_a_proof),
        cmocka_unit_test(a_door_by_itself_hides_nothing),
        cmocka_unit_test(the_sampler_finds_a_slit_that_random_lines_miss),
        cmocka_unit_test(the_same_seed_finds_the_same),
        cmocka_unit_test(the_sampler_does_not_see_around_a_bend),
        cmocka_unit_test(the_far_end_of_a_bend_is_confirmed_hidden),
        cmocka_unit_test(a_pair_that_sees_each_other_is_not_confirmed),
        cmocka_unit_test(neighbours_are_never_confirmed_hidden),
        cmocka_unit_test(a_slit_that_is_closed_is_confirmed_hidden),
        cmocka_unit_test(what_only_line_space_sees_is_confirmed_hidden),
        cmocka_unit_test(a_near_miss_is_confirmed_hidden),
        cmocka_unit_test(the_sampler_and_the_hidden_check_agree),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
