// SPDX-License-Identifier: GPL-3.0-or-later
// A visible set against its portal graph: the rows of the check, the text of sight lines, the command, and
// the reference sets of real levels.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "process.h"
#include "visibility/decimal.h"
#include "visibility_check/check_hidden.h"
#include "visibility_check/check_pvs.h"
#include "visibility_check/sampler.h"
#include "witness_graphs.h"

// ---------------------------------------------------------------------------------------------- rows

typedef struct fixture {
    enf_portal_graph graph;
    enf_pvs pvs;
    enf_witness_list list;
    enf_check_report report;
} fixture;

static void see(enf_pvs *pvs, int32_t i, int32_t j, bool sees) {
    uint64_t bit = UINT64_C(1) << (j & 63), *word = &enf_pvs_row(pvs, i)[j >> 6];
    *word = sees ? *word | bit : *word & ~bit;
}

/// Six rooms in a row, all of which see each other along one line.
static int enter(void **state) {
    fixture *f = calloc(1, sizeof *f);
    enf_error error;
    assert_non_null(f);
    f->graph = row_of_rooms(6);
    assert_int_equal(enf_pvs_new(&f->pvs, 6, &error), ENF_OK);
    f->list.items = calloc(15, sizeof *f->list.items);
    assert_non_null(f->list.items);
    for (int32_t i = 0; i < 6; ++i)
        for (int32_t j = 0; j < 6; ++j) {
            see(&f->pvs, i, j, true);
            if (i < j) f->list.items[f->list.count++] = (enf_witness){{i, j}, {0, 1, 1}, {6, 1.5, 1}, NULL};
        }
    *state = f;
    return 0;
}

static int leave(void **state) {
    fixture *f = *state;
    enf_portal_graph_free(&f->graph);
    enf_pvs_free(&f->pvs);
    enf_witnesses_free(&f->list);
    free(f);
    return 0;
}

static enf_status check(fixture *f) {
    enf_error error;
    const enf_pvs_check_options options = {
        .witnesses = &f->list, .hidden = true, .sample_seconds = 0.05, .seed = 1};
    return enf_pvs_check(&f->graph, &f->pvs, &options, &f->report, &error);
}

/// The row of that name is the first broken one, and says so.
static void assert_broken(fixture *f, const char *row, const char *words) {
    assert_int_equal(check(f), ENF_CHECK_FAILED);
    assert_true(f->report.broken_count > 0);
    assert_int_equal(strncmp(f->report.first, row, strlen(row)), 0);
    if (!strstr(f->report.first, words)) fail_msg("'%s' lacks '%s'", f->report.first, words);
}

static void a_right_set_holds(void **state) {
    fixture *f = *state;
    assert_int_equal(check(f), ENF_OK);
    assert_int_equal(f->report.broken_count, 0);
    for (int r = 0; r < f->report.row_count; ++r) assert_true(f->report.rows[r].held);
}

static void rows_that_are_not_asked_for_are_skipped(void **state) {
    fixture *f = *state;
    const enf_pvs_check_options options = {0};
    assert_int_equal(enf_pvs_check(&f->graph, &f->pvs, &options, &f->report, NULL), ENF_OK);
    int skipped = 0;
    for (int r = 0; r < f->report.row_count; ++r) skipped += f->report.rows[r].skipped;
    assert_int_equal(skipped, 3);
}

static void a_cell_that_does_not_see_itself_breaks_it(void **state) {
    fixture *f = *state;
    see(&f->pvs, 3, 3, false);
    assert_broken(f, "visible: each cell sees itself", "cell 3");
}

static void one_way_only_breaks_it(void **state) {
    fixture *f = *state;
    see(&f->pvs, 4, 1, false);
    assert_broken(f, "visible: rows are symmetric", "cell 1 lists 4");
}

static void a_pair_without_a_sight_line_is_proved_otherwise(void **state) {
    fixture *f = *state;
    f->list.count -= 8;
    assert_int_equal(check(f), ENF_OK);
    assert_int_equal(f->report.rows[4].tested, 8);
}

/// A row of rooms in two parts: no line leads from one to the other.
static void a_pair_that_nothing_proves_breaks_it(void **state) {
    fixture *f = *state;
    for (int32_t c = f->graph.opening_corner[3]; c < f->graph.opening_corner[4]; ++c)
        f->graph.corners[c][1] += 100;
    f->list.count = 0;
    assert_broken(f, "visible: pairs without one are proved", "cells 0 and 4 are not; 5 such pairs");
}

static void a_sight_line_of_another_pair_breaks_it(void **state) {
    fixture *f = *state;
    see(&f->pvs, 1, 4, false);
    see(&f->pvs, 4, 1, false);
    assert_broken(f, "visible: sight lines of listed pairs only",
                  "one of cells 1 and 4, which are not listed");
    assert_int_equal(f->report.broken_count, 3); // the other two means find it too
}

static void a_wrong_sight_line_breaks_it(void **state) {
    fixture *f = *state;
    f->list.items[4].to[1] = 9;
    assert_broken(f, "visible: every sight line arrives", "cells 0 and 5");
}

static void a_missing_pair_is_found_by_other_means(void **state) {
    fixture *f = *state;
    see(&f->pvs, 0, 5, false);
    see(&f->pvs, 5, 0, false);
    memmove(&f->list.items[4], &f->list.items[5], (f->list.count - 5) * sizeof *f->list.items);
    f->list.count--;
    assert_broken(f, "hidden: no other pair sees each other", "cells 0 and 5 see each other; 1 such");
    assert_int_equal(f->report.broken_count, 2);
    assert_non_null(
        strstr(f->report.rows[f->report.row_count - 1].detail, "cells 0 and 5 see each other from"));
}

static void a_set_of_another_size_is_refused(void **state) {
    fixture *f = *state;
    f->graph.cell_count = 5;
    assert_int_equal(check(f), ENF_BAD_USAGE);
    f->graph.cell_count = 6;
}

// ---------------------------------------------------------------------------------------------- text

static int enter_folder(void **state) {
    (void)state;
    return enter_test_folder() ? 0 : -1;
}

static int leave_folder(void **state) {
    (void)state;
    leave_test_folder();
    return 0;
}

static void sight_lines_are_read(void **state) {
    (void)state;
    enf_witness_list list;
    write_text("w.txt", "0 1  1 2.5 -3e-2  4 5 6\n0 12 0.1 0 0 1 0 0\n2 3 0 0 0 0 0 1");
    assert_int_equal(enf_witnesses_read(&list, "w.txt", 13, NULL), ENF_OK);
    assert_int_equal(list.count, 3);
    assert_int_equal(list.items[1].cell[1], 12);
    assert_true(list.items[0].from[2] == -3e-2 && list.items[0].to[0] == 4 && list.items[1].from[0] == 0.1);
    enf_witnesses_free(&list);
    write_text("w.txt", "");
    assert_int_equal(enf_witnesses_read(&list, "w.txt", 13, NULL), ENF_OK);
    assert_int_equal(list.count, 0);
    enf_witnesses_free(&list);
}

static void long_numbers_are_kept_as_they_stand(void **state) {
    (void)state;
    enf_witness_list list;
    write_text("w.txt", "0 1 0.10000000000000001 12345678901234567 -1.0000000000000000e-300 4 5 6\n"
                        "0 2  1 2  3 4 5e0 0.123456789012345678 \n");
    assert_int_equal(enf_witnesses_read(&list, "w.txt", 13, NULL), ENF_OK);
    assert_null(list.items[0].decimals);
    const char *at = list.items[1].decimals;
    assert_non_null(at);
    assert_true(list.items[1].to[1] == 5 && list.items[1].to[2] == 0.123456789012345678);
    mpq_t number, wanted;
    mpq_inits(number, wanted, NULL);
    int digits;
    for (int k = 0; k < 6; k++) assert_true(enf_decimal_read(number, &at, &digits));
    assert_int_equal(digits, 18);
    mpq_set_str(wanted, "123456789012345678/1000000000000000000", 10);
    mpq_canonicalize(wanted);
    assert_true(mpq_equal(number, wanted));
    mpq_clears(number, wanted, NULL);
    enf_witnesses_free(&list);
}

static void bad_sight_lines_are_refused_with_their_line(void **state) {
    (void)state;
    static const char *const bad[][2] = {
        {"0 1 1 2 3 4 5\n", "w.txt:1: two points"},
        {"0 1 1 2 3 4 5 6 7\n", "w.txt:1: there is something behind"},
        {"0 1 1 2 3 4 5 nan\n", "w.txt:1: two points"},
        {"0 1 1 2 3 4 5 1e999\n", "w.txt:1: two points"},
        {"0 1 1 2 3 4 5 6x\n", "w.txt:1: two points"},
        {"0 1 1 2 0x1p-3 4 5 1.234567890123456789\n", "w.txt:1: numbers of more than 17 digits"},
        {"0 x 1 2 3 4 5 6\n", "w.txt:1: the number of a cell"},
        {"0 1.5 1 2 3 4 5 6\n", "w.txt:1: the number of a cell"},
        {"0 9 1 2 3 4 5 6\n", "w.txt:1: there is no cell 9"},
        {"-1 2 1 2 3 4 5 6\n", "w.txt:1: there is no cell -1"},
        {"2 1 1 2 3 4 5 6\n", "w.txt:1: the first cell should be less"},
        {"1 1 1 2 3 4 5 6\n", "w.txt:1: the first cell should be less"},
        {"0 2 1 2 3 4 5 6\n0 1 1 2 3 4 5 6\n", "w.txt:2: the pairs of cells do not ascend"},
        {"0 2 1 2 3 4 5 6\n0 2 1 2 3 4 5 6\n", "w.txt:2: the pairs of cells do not ascend"},
        {"0 1 1 2 3 4 5 6\n\n", "w.txt:2: the number of a cell"},
    };
    for (size_t k = 0; k < sizeof bad / sizeof *bad; ++k) {
        enf_witness_list list;
        enf_error error = {0};
        write_text("w.txt", bad[k][0]);
        assert_int_equal(enf_witnesses_read(&list, "w.txt", 9, &error), ENF_BAD_INPUT);
        if (!strstr(error.text, bad[k][1])) fail_msg("'%s' lacks '%s'", error.text, bad[k][1]);
        enf_witnesses_free(&list);
    }
}

// ---------------------------------------------------------------------------------------------- command

static void expect(const char *line, int status, const char *words) {
    process process = run_enfilade(NULL, line);
    assert_int_equal(process.status, status);
    if (!strstr(process.out, words) && !strstr(process.err, words))
        fail_msg("%s: '%s' is in neither '%s' nor '%s'", line, words, process.out, process.err);
    process_free(&process);
}

static void the_command_checks_a_portal_file(void **state) {
    (void)state;
    write_text("row.prt",
               "PRT1\n3\n2\n4 0 1 (1 0 0) (1 2 0) (1 2 2) (1 0 2)\n4 1 2 (2 0 0) (2 2 0) (2 2 2) (2 0 2)\n");
    write_text("right.txt", "0 1 2\n0 1 2\n0 1 2\n");
    write_text("wrong.txt", "0 1\n0 1 2\n1 2\n");
    write_text("lines.txt", "0 1 0 1 1 3 1 1\n0 2 0 1 1 3 1 1\n1 2 0 1 1 3 1 1\n");
    expect("check row.prt --pvs right.txt --witness lines.txt --hidden --sample 0.05", 0, "holds");
    expect("check row.prt --pvs right.txt --json", 0, "\"held\": true");
    expect("check row.prt --pvs wrong.txt --hidden", 1, "wrong.txt: hidden: no other pair sees each other");
    expect("check row.prt --pvs wrong.txt --sample 0.05", 1, "cells 0 and 2 see each other from");
    expect("check row.prt --pvs wrong.txt --witness lines.txt", 1, "which are not listed");
    expect("check row.prt", 2, "--pvs is missing");
    expect("check row.prt --hidden", 2, "--pvs is missing");
    expect("check row.prt --pvs none.txt", 4, "none.txt");
    expect("check row.prt --pvs lines.txt", 3, "lines.txt:1");
    expect("check none.enf", 4, "none.enf");
}

// ---------------------------------------------------------------------------------------------- levels

#ifdef ENFILADE_SHARED_DIR
/// The reference leaves pairs out that see each other through slits thinner than its tolerance of 0.1 units.
static const double reference_tolerance = 0.1;

static void sample_level(const enf_portal_graph *graph, const enf_pvs *pvs) {
    enf_sampler sampler;
    enf_witness_checker checker;
    int broken = 0;
    assert_int_equal(enf_sampler_make(&sampler, graph, 1, NULL), ENF_OK);
    assert_int_equal(enf_sampler_run(&sampler, 0, 300000, NULL), ENF_OK);
    assert_true(enf_witness_checker_make(&checker, graph));
    for (int32_t i = 0; i < graph->cell_count; ++i)
        for (int32_t j = i + 1; j < graph->cell_count; ++j) {
            enf_witness line;
            if (!enf_sampler_witness(&sampler, i, j, &line)) continue;
            broken += enf_witness_check(&checker, &line).fault != ENF_WITNESS_HOLDS;
            if (enf_pvs_get(pvs, i, j) || enf_pvs_get(pvs, j, i)) continue;
            assert_true((double)sampler.pair_clearance[enf_sampler_pair(i, j)] < reference_tolerance);
        }
    assert_true(sampler.pair_count > (uint64_t)(enf_pvs_pairs(pvs) - graph->cell_count) / 2 * 95 / 100);
    assert_true(broken < 10);
    enf_witness_checker_free(&checker);
    enf_sampler_free(&sampler);
}

/// Pairs left out of the reference that a line joins exactly, though most by less than doubles can show.
static void confirm_level(const enf_portal_graph *graph, const enf_pvs *pvs, size_t wrong) {
    const enf_hidden_options options = {0};
    enf_hidden_report report;
    assert_int_equal(enf_check_hidden(graph, pvs->rows, pvs->row_words, &options, &report, NULL), ENF_OK);
    assert_true(report.ended);
    assert_int_equal(report.open_count, wrong);
    for (size_t k = 0; k < report.open_count; ++k) assert_true(report.open[k].seen);
    enf_hidden_report_free(&report);
}
#endif

static void the_reference_sets_of_levels_are_nearly_right(void **state) {
    (void)state;
#ifdef ENFILADE_SHARED_DIR
    static const char *const levels[] = {"dm4", "e1m7", "dm1"};
    static const size_t wrong[] = {2, 18, 10};
    for (size_t k = 0; k < sizeof levels / sizeof *levels; ++k) {
        char path[1024];
        enf_portal_graph graph = {0};
        enf_pvs pvs = {0};
        snprintf(path, sizeof path, "%s/quake/prt/%s.prt", ENFILADE_SHARED_DIR, levels[k]);
        if (!file_exists(path)) {
            print_message("no %s: skipped\n", path);
            skip();
        }
        assert_int_equal(enf_portal_graph_read(&graph, path, NULL), ENF_OK);
        snprintf(path, sizeof path, "%s/quake/prt/%s.pvs.txt.gz", ENFILADE_SHARED_DIR, levels[k]);
        assert_int_equal(enf_pvs_read(&pvs, path, graph.cell_count, NULL), ENF_OK);
        sample_level(&graph, &pvs);
        confirm_level(&graph, &pvs, wrong[k]);
        enf_pvs_free(&pvs);
        enf_portal_graph_free(&graph);
    }
#else
    print_message("no shared data: skipped\n");
    skip();
#endif
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_right_set_holds, enter, leave),
        cmocka_unit_test_setup_teardown(rows_that_are_not_asked_for_are_skipped, enter, leave),
        cmocka_unit_test_setup_teardown(a_cell_that_does_not_see_itself_breaks_it, enter, leave),
        cmocka_unit_test_setup_teardown(one_way_only_breaks_it, enter, leave),
        cmocka_unit_test_setup_teardown(a_pair_without_a_sight_line_is_proved_otherwise, enter, leave),
        cmocka_unit_test_setup_teardown(a_pair_that_nothing_proves_breaks_it, enter, leave),
        cmocka_unit_test_setup_teardown(a_sight_line_of_another_pair_breaks_it, enter, leave),
        cmocka_unit_test_setup_teardown(a_wrong_sight_line_breaks_it, enter, leave),
        cmocka_unit_test_setup_teardown(a_missing_pair_is_found_by_other_means, enter, leave),
        cmocka_unit_test_setup_teardown(a_set_of_another_size_is_refused, enter, leave),
        cmocka_unit_test(sight_lines_are_read),
        cmocka_unit_test(long_numbers_are_kept_as_they_stand),
        cmocka_unit_test(bad_sight_lines_are_refused_with_their_line),
        cmocka_unit_test(the_command_checks_a_portal_file),
        cmocka_unit_test(the_reference_sets_of_levels_are_nearly_right),
    };
    return cmocka_run_group_tests(tests, enter_folder, leave_folder);
}
