// SPDX-License-Identifier: GPL-3.0-or-later
// Long runs of `enfilade pvs`: killed and gone on with, and cut short by a budget.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "base/hash.h"
#include "base/timer.h"
#include "visibility/pvs.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>
#include <signal.h>

#include "maze_fixture.h"
#include "process.h"

enum { SIDE = 20, HEADER = 64, RECORD = 32 };

static uint64_t seed = 1;

static int enter(void **state) {
    (void)state;
    if (!enter_test_folder()) return -1;
    char *text = maze_print(SIDE, 7);
    write_text("maze.prt", text);
    free(text);
    text = maze_print(SIDE, 8);
    write_text("other.prt", text);
    free(text);
    return 0;
}

static int leave(void **state) {
    (void)state;
    leave_test_folder();
    return 0;
}

static void expect(const char *line, int status, const char *words) {
    process ran = run_enfilade(NULL, line);
    if (ran.status != status || !strstr(ran.err, words))
        fail_msg("`%s`: status %d, expected %d with '%s'; it said: %s", line, ran.status, status, words,
                 ran.err);
    process_free(&ran);
}

static bool is_same_file(const char *a, const char *b) {
    size_t size_a, size_b;
    char *bytes_a = read_file(a, &size_a), *bytes_b = read_file(b, &size_b);
    bool same = bytes_a && bytes_b && size_a == size_b && memcmp(bytes_a, bytes_b, size_a) == 0;
    free(bytes_a);
    free(bytes_b);
    return same;
}

static void assert_same_file(const char *a, const char *b) {
    if (!is_same_file(a, b)) fail_msg("%s and %s differ", a, b);
}

/// A number in a report.
static long report_value(const char *path, const char *key) {
    size_t size;
    char *text = read_file(path, &size), name[64];
    snprintf(name, sizeof name, "\"%s\": ", key);
    const char *at = text ? strstr(text, name) : NULL;
    if (!at) fail_msg("no %s in %s", key, path);
    long value = strtol(at + strlen(name), NULL, 10);
    free(text);
    return value;
}

static void sleep_for(double seconds) {
    const struct timespec delay = {(time_t)seconds, (long)((seconds - (double)(time_t)seconds) * 1e9)};
    nanosleep(&delay, NULL);
}

/// Starts a run, ends it with a signal after a while. False if it was done before.
static bool run_and_stop(const char *line, double seconds, int signal_number) {
    int outcome;
    pid_t child = start_enfilade(line);
    assert_true(child > 0);
    sleep_for(seconds);
    kill(child, signal_number);
    assert_int_equal(waitpid(child, &outcome, 0), child);
    if (WIFEXITED(outcome) && WEXITSTATUS(outcome) == 0) return false;
    assert_true(WIFSIGNALED(outcome) || WEXITSTATUS(outcome) == 4);
    return true;
}

/// A run that nobody disturbs, and how long it takes. Worlds have no witnesses.
static double run_undisturbed(const char *input, bool is_world) {
    char line[512];
    double started = enf_timer_now();
    snprintf(line, sizeof line, "pvs %s -o whole.txt %s --threads 2 -q", input,
             is_world ? "--method hourglass" : "--witness whole.w");
    expect(line, 0, "");
    return enf_timer_now() - started;
}

// ---------------------------------------------------------------------------------------------- checkpoints

/// Kills at random moments until one run comes through: what it writes is what an undisturbed one writes.
static void kill_until_done(const char *input, bool is_world, int rounds) {
    double whole = run_undisturbed(input, is_world);
    char line[512];
    for (int round = 0; round < rounds; round++) {
        int kills = 0, threads = 1 + round % 3;
        unlink("killed.txt");
        snprintf(line, sizeof line,
                 "pvs %s -o killed.txt %s --checkpoint killed.ck --threads %d --progress never", input,
                 is_world ? "--method hourglass" : "--witness killed.w", threads);
        for (;; kills++) {
            seed = enf_hash_mix(seed + 1);
            double most = whole * (0.3 + 0.1 * kills); // comes through in the end even if nothing were kept
            if (!run_and_stop(line, most * (double)(seed % 1000) / 1000, SIGKILL)) break;
            if (file_exists("killed.txt")) assert_same_file("whole.txt", "killed.txt"); // whole or not at all
        }
        assert_same_file("whole.txt", "killed.txt");
        if (!is_world) assert_same_file("whole.w", "killed.w");
        assert_false(file_exists("killed.ck"));
    }
}

static void a_killed_run_goes_on_where_it_was(void **state) {
    (void)state;
    kill_until_done("maze.prt", false, 4);
}

static void a_killed_run_of_a_world_goes_on_where_it_was(void **state) {
    (void)state;
    expect("gen furnished -o world.obj", 0, "");
    expect("compile world.obj -o world.enf -q", 0, "");
    kill_until_done("world.enf", true, 3);
}

static void a_killed_run_of_a_level_goes_on_where_it_was(void **state) {
    (void)state;
#ifdef ENFILADE_SHARED_DIR
    if (!file_exists(ENFILADE_SHARED_DIR "/quake/prt/dm4.prt")) skip();
    kill_until_done(ENFILADE_SHARED_DIR "/quake/prt/dm4.prt", false, 2);
#else
    print_message("no shared levels here\n");
    skip();
#endif
}

/// Leaves a checkpoint of a run that did not end, with at least so many bytes.
static void leave_checkpoint(const char *line, const char *path, size_t least) {
    double whole = run_undisturbed("maze.prt", false);
    for (double part = 0.4;; part = part < 0.9 ? part + 0.05 : 0.4) {
        size_t size = 0;
        if (run_and_stop(line, whole * part, SIGKILL)) free(read_file(path, &size));
        if (size >= least) return;
    }
}

#define KEPT "pvs maze.prt -o kept.txt --witness kept.w --checkpoint kept.ck --report kept.json --threads 2"

static void a_damaged_checkpoint_costs_only_what_is_damaged(void **state) {
    (void)state;
    size_t size;
    leave_checkpoint(KEPT, "kept.ck", 4000);
    char *bytes = read_file("kept.ck", &size);
    for (int i = 0; i < 6; i++) {
        seed = enf_hash_mix(seed + 1);
        size_t at = HEADER + (size_t)(seed >> 8) % (size - HEADER);
        bytes[at] ^= (char)(1 + seed % 255);
        write_file("kept.ck", bytes, i % 2 ? at : size); // torn there, or only damaged
        bytes[at] ^= (char)(1 + seed % 255);
        expect(KEPT, 0, "kept.txt: ");
        assert_same_file("whole.txt", "kept.txt");
        assert_same_file("whole.w", "kept.w");
        assert_true(i % 2 || report_value("kept.json", "jobs_stored") > 0);
        assert_false(file_exists("kept.ck"));
    }
    free(bytes);
}

static void sign(char *record) {
    uint32_t length;
    memcpy(&length, record + 20, sizeof length);
    uint64_t hash = enf_hash64(record, 24, enf_hash64(record + RECORD, length, 0));
    for (int k = 0; k < 8; k++) record[24 + k] = (char)(hash >> 8 * k);
}

/// Results that went by other beams, even if they made sense, are not taken.
static void results_with_another_key_are_passed_over(void **state) {
    (void)state;
    size_t size;
    int records = 0;
    leave_checkpoint(KEPT, "kept.ck", 4000);
    char *bytes = read_file("kept.ck", &size);
    for (char *at = bytes + HEADER; at < bytes + size; records++) {
        uint32_t length;
        memcpy(&length, at + 20, sizeof length);
        at[8] ^= 1;
        if (length > 0) at[RECORD] ^= 1;
        sign(at);
        at += RECORD + length;
    }
    assert_true(records > 10);
    write_file("kept.ck", bytes, size);
    expect(KEPT, 0, "kept.txt: ");
    assert_int_equal(report_value("kept.json", "jobs_stored"), 0);
    assert_same_file("whole.txt", "kept.txt");
    free(bytes);
}

/// Damages results and signs them anew: nonsense is told from sense, or at least does no harm.
static void results_that_make_no_sense_are_refused(void **state) {
    (void)state;
    size_t size;
    int refused = 0;
    leave_checkpoint(KEPT, "kept.ck", 4000);
    char *bytes = read_file("kept.ck", &size);
    for (int i = 0; i < 40; i++) {
        char *record = bytes + HEADER;
        uint32_t length;
        memcpy(&length, record + 20, sizeof length);
        size_t at = RECORD + (size_t)i % length;
        char kept = record[at];
        record[at] ^= (char)(0x80 >> i % 3);
        sign(record);
        write_file("kept.ck", bytes, size);
        process ran = run_enfilade(NULL, KEPT);
        assert_true(ran.status == 0 || ran.status == 3);
        if (ran.status == 3) assert_non_null(strstr(ran.err, "makes no sense; remove it"));
        refused += ran.status == 3;
        process_free(&ran);
        record[at] = kept;
    }
    assert_true(refused > 0);
    unlink("kept.ck");
    free(bytes);
}

static void a_checkpoint_of_something_else_is_left_alone(void **state) {
    (void)state;
    unlink("kept.ck");
    leave_checkpoint(KEPT, "kept.ck", HEADER);
    size_t size;
    char *bytes = read_file("kept.ck", &size);
    write_file("copy.ck", bytes, size);
    free(bytes);
    expect("pvs other.prt -o o.txt --witness o.w --checkpoint kept.ck", 3,
           "kept.ck: the checkpoint is of another input");
    expect("pvs maze.prt -o o.txt --checkpoint kept.ck", 3, "another --method, or with --witness");
    expect("pvs maze.prt -o o.txt --witness o.w --checkpoint kept.ck --method lp", 3, "another --method");
    expect("pvs maze.prt -o o.txt --checkpoint whole.txt", 3, "whole.txt: this is no checkpoint");
    expect("pvs maze.prt -o o.txt --checkpoint .", 4, "must be a file");
    expect("pvs maze.prt -o o.txt --checkpoint nowhere/a", 4, "nowhere/a: can't be written");
    expect("pvs maze.prt -o o.txt --checkpoint -", 2, "'-' is no file");
    expect("pvs maze.prt -o o.txt --checkpoint o.txt", 2, "would be written over");
    expect("pvs maze.prt -o o.txt --checkpoint maze.prt", 2, "would be written over");
    assert_false(file_exists("o.txt"));
    assert_same_file("kept.ck", "copy.ck");
    unlink("kept.ck");
}

static void the_path_and_the_threads_do_not_matter(void **state) {
    (void)state;
    leave_checkpoint(KEPT, "kept.ck", 4000);
    assert_int_equal(rename("maze.prt", "moved.prt"), 0);
    expect("pvs moved.prt -o kept.txt --witness k.w --checkpoint kept.ck --report kept.json --threads 1 -v",
           0, "results were there already");
    assert_true(report_value("kept.json", "jobs_stored") > 0);
    assert_same_file("whole.txt", "kept.txt");
    assert_int_equal(rename("moved.prt", "maze.prt"), 0);
}

static void an_interrupted_run_keeps_its_checkpoint(void **state) {
    (void)state;
    double whole = run_undisturbed("maze.prt", false);
    bool stopped = false;
    for (int tries = 0; !stopped; tries++) { // too early or too late, once in a while
        unlink("kept.ck");
        unlink("kept.txt");
        stopped = run_and_stop(KEPT, whole * 0.4, SIGINT) && file_exists("kept.ck");
        assert_true(tries < 20);
    }
    assert_false(file_exists("kept.txt"));
    expect(KEPT, 0, "kept.txt: ");
    assert_same_file("whole.txt", "kept.txt");
}

// ---------------------------------------------------------------------------------------------- budget

static bool contains(const enf_pvs *large, const enf_pvs *small) {
    size_t words = (size_t)large->cell_count * large->row_words;
    for (size_t i = 0; i < words; i++)
        if (small->rows[i] & ~large->rows[i]) return false;
    return true;
}

static enf_pvs read_sets(const char *path, int32_t cells) {
    enf_pvs pvs;
    enf_error error = {0};
    if (enf_pvs_read(&pvs, path, cells, &error) != ENF_OK) fail_msg("%s", error.text);
    return pvs;
}

static enf_pvs find_sets(const char *input, const char *method, double budget, int32_t *cells) {
    char line[512];
    snprintf(line, sizeof line,
             "pvs %s -o sets.txt --method %s --budget %g --report sets.json --threads 2 --progress never",
             input, method, budget);
    double started = enf_timer_now();
    process ran = run_enfilade(NULL, line);
    double took = enf_timer_now() - started;
    if (ran.status != 0) fail_msg("`%s`: %s", line, ran.err);
    bool late = report_value("sets.json", "cells_budgeted") + report_value("sets.json", "pairs_budgeted") > 0;
    assert_true(late == (strstr(ran.err, "ran out for the beams of") != NULL));
    if (budget > 0 && took > budget + 20) fail_msg("`%s` took %.1f s", line, took);
    process_free(&ran);
    *cells = (int32_t)report_value("sets.json", "cells");
    return read_sets("sets.txt", *cells);
}

/// Whatever the budget: the truth is in the answer, and the answer in the rung below.
static void try_budgets(const char *input) {
    static const double budgets[] = {1e-6, 0.001, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8};
    int32_t cells;
    int late = 0;
    enf_pvs facing = find_sets(input, "facing", 0, &cells), beams = find_sets(input, "hourglass", 0, &cells),
            exact = find_sets(input, "exact", 0, &cells);
    for (size_t i = 0; i < sizeof budgets / sizeof *budgets; i++) {
        enf_pvs sets = find_sets(input, "exact", budgets[i], &cells);
        long cells_late = report_value("sets.json", "cells_budgeted"),
             pairs_late = report_value("sets.json", "pairs_budgeted");
        late += cells_late + pairs_late > 0;
        assert_true(contains(&sets, &exact));
        assert_true(contains(&facing, &sets));
        if (cells_late == 0) assert_true(contains(&beams, &sets));
        if (cells_late + pairs_late == 0) assert_true(contains(&exact, &sets));
        enf_pvs_free(&sets);
    }
    assert_true(late > 0);
    enf_pvs_free(&facing);
    enf_pvs_free(&beams);
    enf_pvs_free(&exact);
}

static void a_budget_never_hides_what_is_seen(void **state) {
    (void)state;
    try_budgets("maze.prt");
}

static void a_budget_never_hides_what_is_seen_in_a_level(void **state) {
    (void)state;
#ifdef ENFILADE_SHARED_DIR
    if (!file_exists(ENFILADE_SHARED_DIR "/quake/prt/dm2.prt")) skip();
    try_budgets(ENFILADE_SHARED_DIR "/quake/prt/dm2.prt");
#else
    print_message("no shared levels here\n");
    skip();
#endif
}

/// Many small budgets come to what one run without any comes to.
static void a_budget_can_be_gone_on_from(void **state) {
    (void)state;
    run_undisturbed("maze.prt", false);
    unlink("kept.ck");
    int runs = 0;
    for (bool late = true; late; runs++) {
        assert_true(runs < 1000);
        process ran = run_enfilade(NULL, KEPT " --budget 0.05");
        assert_int_equal(ran.status, 0);
        late = file_exists("kept.ck");
        assert_true(late == (strstr(ran.err, ", and goes on from kept.ck") != NULL));
        if (late && runs > 20) { // a slow machine: enough of it
            process_free(&ran);
            ran = run_enfilade(NULL, KEPT);
            late = false;
        }
        process_free(&ran);
    }
    assert_false(file_exists("kept.ck"));
    assert_same_file("whole.txt", "kept.txt");
    assert_same_file("whole.w", "kept.w");
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_killed_run_goes_on_where_it_was),
        cmocka_unit_test(a_killed_run_of_a_world_goes_on_where_it_was),
        cmocka_unit_test(a_killed_run_of_a_level_goes_on_where_it_was),
        cmocka_unit_test(a_damaged_checkpoint_costs_only_what_is_damaged),
        cmocka_unit_test(results_with_another_key_are_passed_over),
        cmocka_unit_test(results_that_make_no_sense_are_refused),
        cmocka_unit_test(a_checkpoint_of_something_else_is_left_alone),
        cmocka_unit_test(the_path_and_the_threads_do_not_matter),
        cmocka_unit_test(an_interrupted_run_keeps_its_checkpoint),
        cmocka_unit_test(a_budget_never_hides_what_is_seen),
        cmocka_unit_test(a_budget_never_hides_what_is_seen_in_a_level),
        cmocka_unit_test(a_budget_can_be_gone_on_from),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
