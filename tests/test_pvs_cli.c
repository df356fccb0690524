// SPDX-License-Identifier: GPL-3.0-or-later
// `enfilade pvs` as its users meet it: what it writes and says, what it refuses, and that it leaves nothing
// behind when it does.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>
#include <zlib.h>

#include "process.h"

/// Cells 0, 1, 2 in a row; 3 is alone.
#define PORTALS "4 0 1 (0 0 0)(0 8 0)(0 8 8)(0 0 8)\n4 1 2 (9 0 0)(9 8 0)(9 8 8)(9 0 8)\n"
#define ROW "PRT1\n4\n2\n" PORTALS
#define ROW_SETS "0 1 2\n0 1 2\n0 1 2\n3\n"
/// The same, its first portal turned round: cells 0 and 1 lie on the wrong sides, which shows in 1.
#define BENT "PRT1\n4\n2\n4 1 0 (0 0 0)(0 8 0)(0 8 8)(0 0 8)\n4 1 2 (9 0 0)(9 8 0)(9 8 8)(9 0 8)\n"

static int enter(void **state) {
    (void)state;
    if (!enter_test_folder()) return -1;
    write_text("row.prt", ROW);
    return 0;
}

static int leave(void **state) {
    (void)state;
    leave_test_folder();
    return 0;
}

static void assert_file(const char *path, const char *text) {
    size_t size;
    char *bytes = read_file(path, &size);
    if (!bytes) fail_msg("there is no %s", path);
    assert_string_equal(bytes, text);
    free(bytes);
}

/// Runs a line that must fail: status, a message with these words, nothing written.
static void expect_failure(const char *line, int status, const char *words) {
    process ran = run_enfilade(NULL, line);
    if (ran.status != status || !strstr(ran.err, words))
        print_error("`%s`: status %d, expected %d with '%s'; it said: %s\n", line, ran.status, status, words,
                    ran.err);
    assert_int_equal(ran.status, status);
    assert_non_null(strstr(ran.err, words));
    assert_string_equal(ran.out, "");
    assert_false(file_exists("out.txt"));
    assert_false(file_exists("out.json"));
    process_free(&ran);
}

static process expect_success(const char *input, const char *line) {
    process ran = run_enfilade(input, line);
    if (ran.status != 0) fail_msg("`%s`: status %d; it said: %s", line, ran.status, ran.err);
    return ran;
}

static void visible_sets_are_written_as_text(void **state) {
    (void)state;
    process ran = expect_success(NULL, "pvs row.prt -o out.txt --method reach");
    assert_string_equal(ran.out, "");
    assert_non_null(
        strstr(ran.err, "out.txt: 4 cells, 2 portals; by reach 10 pairs, a cell sees 2.5 on average"));
    assert_null(strstr(ran.err, "warning"));
    assert_file("out.txt", ROW_SETS);
    process_free(&ran);
    unlink("out.txt");
}

static void input_and_output_may_be_streams(void **state) {
    (void)state;
    process ran = expect_success(ROW, "pvs - -o - --method reach -q --progress never");
    assert_string_equal(ran.out, ROW_SETS);
    assert_string_equal(ran.err, "");
    process_free(&ran);
    ran = run_enfilade("PRT1\n4\n", "pvs - -o - --method reach");
    assert_int_equal(ran.status, 3);
    assert_non_null(
        strstr(ran.err, "standard input:3: the file ends where the number of portals should stand"));
    assert_string_equal(ran.out, "");
    process_free(&ran);
}

static void the_content_tells_what_file_it_is(void **state) {
    (void)state;
    gzFile packed = gzopen("row.txt", "wb");
    assert_non_null(packed);
    gzputs(packed, ROW);
    assert_int_equal(gzclose(packed), Z_OK);
    process ran = expect_success(NULL, "pvs row.txt -o - --method reach -q");
    assert_string_equal(ran.out, ROW_SETS);
    process_free(&ran);
    write_text("world.prt", "ENFILADE and so on");
    expect_failure("pvs world.prt -o out.txt", 3, "world.prt: this is not a world file");
}

/// The number after the first of some words.
static int count_of(const char *report, const char *words) {
    const char *at = strstr(report, words);
    assert_non_null(at);
    return atoi(at + strlen(words));
}

/// The sets in a world file are those that `pvs` finds in it, and check looks at them.
static void worlds_have_visible_sets(void **state) {
    (void)state;
    static const char *const methods[] = {"facing", "hourglass", "exact"};
    process made = expect_success(NULL, "gen four-rooms -o rooms.obj");
    process_free(&made);
    for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) {
        char line[256], words[64];
        snprintf(line, sizeof line, "compile rooms.obj -o rooms.enf --pvs %s --report rooms.json",
                 methods[i]);
        made = expect_success(NULL, line);
        process_free(&made);
        snprintf(line, sizeof line, "pvs rooms.enf -o - --method %s -q", methods[i]);
        process ran = expect_success(NULL, line);
        int pairs = 0, lines = 0;
        for (const char *at = ran.out; *at; at++) {
            pairs += *at == ' ' || *at == '\n';
            lines += *at == '\n';
        }
        process_free(&ran);
        size_t size;
        char *report = read_file("rooms.json", &size);
        assert_non_null(report);
        int cells = count_of(report, "\"cells\": ");
        assert_int_equal(lines, cells);
        assert_true(pairs > 3 * cells && pairs <= cells * cells);
        snprintf(words, sizeof words, "\"method\": \"%s\"", methods[i]);
        assert_non_null(strstr(report, words));
        snprintf(words, sizeof words, "\"pairs\": %d", pairs);
        assert_non_null(strstr(report, words));
        free(report);
        ran = expect_success(NULL, "check rooms.enf");
        assert_non_null(strstr(ran.out, "visibility: lines"));
        process_free(&ran);
    }
    expect_failure("pvs rooms.enf -o out.txt --witness lines.txt", 2,
                   "lines can be had for portal files only");
    assert_false(file_exists("lines.txt"));
}

static void the_report_has_the_fixed_keys(void **state) {
    (void)state;
    static const char *const keys[] = {
        "\"cells\": 4,",
        "\"portals\": 2,",
        "\"leafs\": 4,",
        "\"method\": \"reach\",",
        "\"pairs\": 10,",
        "\"mean_seen\": 2.5,",
        "\"threads\": 2,",
        "\"cells_budgeted\": 0",
        "\"portal_pairs\": ",
        "\"nodes\": ",
        "\"visits\": ",
        "\"lines\": ",
        "\"pairs_open\": ",
        "\"stabs\": {",
        "\"quadrics_hidden\": ",
        "\"orders_hidden\": ",
        "\"pairs_budgeted\": 0",
        "\"sequence_longest\": ",
        "\"sequence_lengths\": [",
        "\"seconds\": ",
        "\"cpu_seconds\":",
        "\"peak_bytes\": ",
        "\"options\": {",
        "\"budget\": 2.5",
        "\"file\": \"row.prt\"",
        "\"non_convex_cells\": 0",
        "\"witnesses\": 0",
    };
    process ran =
        expect_success(NULL, "pvs row.prt -o report.txt --method reach --threads 2 --budget 2.5s --report "
                             "report.json -v");
    size_t size;
    char *report = read_file("report.json", &size);
    assert_non_null(report);
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++)
        if (!strstr(report, keys[i])) fail_msg("no %s in %s", keys[i], report);
    assert_non_null(strstr(ran.err, "portal pairs"));
    free(report);
    process_free(&ran);
}

static void the_witness_file_is_there_when_asked_for(void **state) {
    (void)state;
    process ran = expect_success(NULL, "pvs row.prt -o w.txt --method reach --witness lines.txt -q");
    assert_file("lines.txt", ""); // reach proves nothing
    assert_string_equal(ran.err, "");
    process_free(&ran);
}

static void cells_that_are_not_convex_are_warned_of(void **state) {
    (void)state;
    write_text("bent.prt", BENT);
    process ran = expect_success(NULL, "pvs bent.prt -o bent.txt --method reach");
    assert_non_null(strstr(ran.err, "warning: cell 1 is not convex; it is handled conservatively\n"));
    process_free(&ran);
    ran = expect_success(NULL, "pvs bent.prt -o bent.txt --method reach -q");
    assert_string_equal(ran.err, "");
    process_free(&ran);
}

static void progress_is_told_when_asked_for(void **state) {
    (void)state;
    process ran = expect_success(NULL, "pvs row.prt -o p.txt --method reach --progress always -q");
    assert_non_null(strstr(ran.err, "read ...\n"));
    assert_non_null(strstr(ran.err, "write ...\n"));
    process_free(&ran);
}

static void bad_files_are_refused_with_their_line(void **state) {
    (void)state;
    static const char *const bad[][2] = {
        {"", "bad.prt:1: this is no portal file"},
        {"v 0 0 0\nf 1 2 3\n", "bad.prt:1: this is no portal file"},
        {"PRT1\n2\n3\n" PORTALS, "bad.prt:5: there is no leaf 2"},
        {"PRT1\n4\n3\n" PORTALS, "bad.prt:6: the file ends where a portal's number of corners should stand"},
        {ROW "x", "bad.prt:6: something stands after the end"},
        {"\x1f\x8b\x08", "bad.prt: the gzip data end early"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        write_text("bad.prt", bad[i][0]);
        expect_failure("pvs bad.prt -o out.txt --report out.json --method reach", 3, bad[i][1]);
    }
}

static void paths_that_do_not_work_are_told(void **state) {
    (void)state;
    expect_failure("pvs missing.prt -o out.txt", 4, "missing.prt: cannot be opened");
    expect_failure("pvs . -o out.txt", 4, ".: is a directory");
    expect_failure("pvs row.prt -o nowhere/out.txt", 4, "nowhere/out.txt: can't be written");
    expect_failure("pvs row.prt -o out.txt --report nowhere/out.json", 4,
                   "nowhere/out.json: can't be written");
    expect_failure("pvs row.prt -o out.txt --witness nowhere/out.w", 4, "nowhere/out.w: can't be written");
    expect_failure("pvs row.prt -o /dev/full --method reach", 4,
                   "/dev/full: can't be written: No space left");
    expect_failure("pvs row.prt -o out.txt --method reach --report /dev/full", 4, "No space left");
    expect_failure("pvs row.prt -o out.txt --method reach --witness . --report out.json", 4,
                   "Is a directory");
}

static void bad_options_are_refused_with_the_usage_line(void **state) {
    (void)state;
    static const char *const lines[][2] = {
        {"pvs", "the input file is missing\nusage: enfilade pvs"},
        {"pvs row.prt", "-o OUT is missing\nusage: enfilade pvs"},
        {"pvs row.prt row.prt -o out.txt", "one word too many"},
        {"pvs row.prt -o out.txt --method none", "choose one of reach, facing, hourglass, lp, exact"},
        {"pvs row.prt -o out.txt --threads 0", "whole number from 1"},
        {"pvs row.prt -o out.txt --budget -1", "is no time"},
        {"pvs row.prt -o out.txt --budget soon", "is no time"},
        {"pvs row.prt -o out.txt --budget 5ss", "is no time"},
        {"pvs row.prt -o out.txt --progress sometimes", "choose one of auto, always, never"},
        {"pvs row.prt -o out.txt -v -q", "contradict"},
        {"pvs row.prt -o row.prt", "'row.prt' would be written over"},
        {"pvs row.prt -o ./row.prt", "'./row.prt' would be written over"},
        {"pvs row.prt -o out.txt --report row.prt", "'row.prt' would be written over"},
        {"pvs row.prt -o out.txt --witness row.prt", "'row.prt' would be written over"},
        {"pvs row.prt -o out.txt --witness out.txt", "'out.txt' would be written over"},
        {"pvs row.prt -o - --report -", "'-' would be written over"},
    };
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) expect_failure(lines[i][0], 2, lines[i][1]);
    assert_file("row.prt", ROW);
    process ran = expect_success(NULL, "pvs --help");
    assert_non_null(strstr(ran.out, "--witness FILE"));
    process_free(&ran);
}

static void a_failure_leaves_the_old_output(void **state) {
    (void)state;
    write_text("old.txt", "old\n");
    write_text("short.prt", "PRT1\n4\n2\n");
    process ran = run_enfilade(NULL, "pvs short.prt -o old.txt --method reach");
    assert_int_equal(ran.status, 3);
    assert_file("old.txt", "old\n");
    process_free(&ran);
    ran = expect_success(NULL, "pvs row.prt -o old.txt --method reach");
    assert_file("old.txt", ROW_SETS);
    process_free(&ran);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(visible_sets_are_written_as_text),
        cmocka_unit_test(input_and_output_may_be_streams),
        cmocka_unit_test(the_content_tells_what_file_it_is),
        cmocka_unit_test(worlds_have_visible_sets),
        cmocka_unit_test(the_report_has_the_fixed_keys),
        cmocka_unit_test(the_witness_file_is_there_when_asked_for),
        cmocka_unit_test(cells_that_are_not_convex_are_warned_of),
        cmocka_unit_test(progress_is_told_when_asked_for),
        cmocka_unit_test(bad_files_are_refused_with_their_line),
        cmocka_unit_test(paths_that_do_not_work_are_told),
        cmocka_unit_test(bad_options_are_refused_with_the_usage_line),
        cmocka_unit_test(a_failure_leaves_the_old_output),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
