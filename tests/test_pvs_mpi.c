// SPDX-License-Identifier: GPL-3.0-or-later
// `mpirun -n N enfilade pvs`: the same bytes as one process writes, one voice, and a checkpoint that outlives
// a killed process.
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include "base/hash.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <cmocka.h>
#include <dirent.h>
#include <signal.h>

#include "maze_fixture.h"
#include "process.h"

enum { SIDE = 20 };

static int enter(void **state) {
    (void)state;
    char *text = maze_print(SIDE, 7);
    if (!enter_test_folder()) return -1;
    write_text("maze.prt", text);
    free(text);
    // More processes than cores, and, in a container, as root.
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
    setenv("OMPI_MCA_mpi_yield_when_idle", "1", 1);
    return 0;
}

static int leave(void **state) {
    (void)state;
    leave_test_folder();
    return 0;
}

/// Runs `mpirun -n ranks enfilade ...` in a shell, with its input and outputs redirected in `line`: its
/// status.
static int run_ranks(int ranks, const char *line) {
    char command[1024];
    snprintf(command, sizeof command, "%s -n %d %s %s", ENFILADE_MPIRUN, ranks, ENFILADE_CLI, line);
    int outcome = system(command); // NOLINT: a test
    return WIFEXITED(outcome) ? WEXITSTATUS(outcome) : -1;
}

static void assert_same_file(const char *a, const char *b) {
    size_t size_a, size_b;
    char *bytes_a = read_file(a, &size_a), *bytes_b = read_file(b, &size_b);
    if (!bytes_a || !bytes_b || size_a != size_b || memcmp(bytes_a, bytes_b, size_a) != 0)
        fail_msg("%s and %s differ", a, b);
    free(bytes_a);
    free(bytes_b);
}

static void run_alone(const char *method) {
    char line[256];
    snprintf(line, sizeof line, "pvs maze.prt -o alone.txt --witness alone.w --method %s -q", method);
    process ran = run_enfilade(NULL, line);
    assert_int_equal(ran.status, 0);
    process_free(&ran);
}

static void all_ranks_come_to_what_one_process_comes_to(void **state) {
    (void)state;
    static const char *const methods[] = {"facing", "hourglass", "lp", "exact"};
    for (size_t m = 0; m < sizeof methods / sizeof *methods; m++) {
        run_alone(methods[m]);
        for (int ranks = 1; ranks <= 4; ranks *= 2) {
            char line[256];
            unlink("team.txt");
            snprintf(line, sizeof line,
                     "pvs maze.prt -o team.txt --witness team.w --method %s --threads %d -q", methods[m],
                     1 + ranks % 3);
            assert_int_equal(run_ranks(ranks, line), 0);
            assert_same_file("alone.txt", "team.txt");
            assert_same_file("alone.w", "team.w");
        }
    }
}

static void a_level_comes_out_the_same(void **state) {
    (void)state;
#ifdef ENFILADE_SHARED_DIR
#define LEVEL ENFILADE_SHARED_DIR "/quake/prt/dm4.prt"
    if (!file_exists(LEVEL)) skip();
    process ran = run_enfilade(NULL, "pvs " LEVEL " -o alone.txt -q");
    assert_int_equal(ran.status, 0);
    process_free(&ran);
    for (int ranks = 2; ranks <= 4; ranks *= 2) {
        assert_int_equal(run_ranks(ranks, "pvs - -o - -q <" LEVEL " >team.txt"), 0);
        assert_same_file("alone.txt", "team.txt");
    }
#else
    print_message("no shared levels here\n");
    skip();
#endif
}

static void a_world_comes_out_the_same(void **state) {
    (void)state;
    static const char *const lines[] = {"gen furnished -o world.obj",
                                        "compile world.obj -o world.enf --pvs none -q",
                                        "pvs world.enf -o alone.txt --method hourglass -q"};
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        process ran = run_enfilade(NULL, lines[i]);
        assert_int_equal(ran.status, 0);
        process_free(&ran);
    }
    for (int ranks = 2; ranks <= 4; ranks *= 2) {
        unlink("team.txt");
        assert_int_equal(run_ranks(ranks, "pvs world.enf -o team.txt --method hourglass -q"), 0);
        assert_same_file("alone.txt", "team.txt");
    }
}

/// How often a text stands in a file.
static int count_text(const char *path, const char *text) {
    size_t size;
    int count = 0;
    char *bytes = read_file(path, &size);
    for (char *at = bytes; at && (at = strstr(at, text)); at++) count++;
    free(bytes);
    return count;
}

static void only_one_rank_speaks(void **state) {
    (void)state;
    assert_int_equal(run_ranks(3, "pvs maze.prt 2>err.txt"), 2);
    assert_int_equal(count_text("err.txt", "-o OUT is missing"), 1);
    assert_int_equal(run_ranks(3, "pvs missing.prt -o no.txt 2>err.txt"), 4);
    assert_int_equal(count_text("err.txt", "missing.prt: cannot be opened"), 1);
    write_text("bad.prt", "PRT1\n4\n");
    assert_int_equal(run_ranks(3, "pvs bad.prt -o no.txt 2>err.txt"), 3);
    assert_int_equal(count_text("err.txt", "bad.prt:3: "), 1);
    assert_int_equal(run_ranks(3, "pvs maze.prt -o no.txt --checkpoint bad.prt 2>err.txt"), 3);
    assert_int_equal(count_text("err.txt", "bad.prt: this is no checkpoint"), 1);
    assert_int_equal(run_ranks(3, "pvs maze.prt -o nowhere/no.txt 2>err.txt"), 4);
    assert_int_equal(count_text("err.txt", "nowhere/no.txt: can't be written"), 1);
    assert_false(file_exists("no.txt"));
    assert_int_equal(run_ranks(3, "pvs --help >out.txt"), 0);
    assert_int_equal(count_text("out.txt", "--checkpoint FILE"), 1);
    assert_int_equal(run_ranks(3, "pvs maze.prt -o late.txt --budget 0.000001 2>err.txt"), 0);
    assert_int_equal(count_text("err.txt", "the budget of 1e-06 s ran out for the beams of 400 cells"), 1);
}

/// A process of `enfilade` that a process started; 0 if there is none (yet).
static pid_t find_child(pid_t parent, int which) {
    DIR *processes = opendir("/proc");
    pid_t found = 0;
    struct dirent *entry;
    while (processes && !found && (entry = readdir(processes))) {
        char path[300], name[64];
        int of;
        snprintf(path, sizeof path, "/proc/%s/stat", entry->d_name);
        FILE *file = strtol(entry->d_name, NULL, 10) > 0 ? fopen(path, "r") : NULL;
        if (!file) continue;
        if (fscanf(file, "%*d (%63[^)]) %*c %d", name, &of) == 2 && of == parent &&
            strcmp(name, "enfilade") == 0 && which-- == 0)
            found = (pid_t)strtol(entry->d_name, NULL, 10);
        fclose(file);
    }
    if (processes) closedir(processes);
    return found;
}

static void wait_a_little(long milliseconds) {
    const struct timespec delay = {milliseconds / 1000, milliseconds % 1000 * 1000000};
    nanosleep(&delay, NULL);
}

/// Starts four ranks, kills one of them as soon as the checkpoint has so many bytes; the status of the run.
static int kill_one(int which, size_t least) {
    static const char line[] = "exec " ENFILADE_MPIRUN " -n 4 " ENFILADE_CLI
                               " pvs maze.prt -o team.txt --witness team.w --threads 1 --checkpoint team.ck"
                               " >team.log 2>&1";
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        execl("/bin/sh", "sh", "-c", line, (char *)NULL);
        _exit(126);
    }
    int outcome;
    for (pid_t ended = 0; ended == 0; ended = waitpid(child, &outcome, WNOHANG)) {
        size_t size = 0;
        wait_a_little(2);
        if (file_exists("team.ck")) free(read_file("team.ck", &size));
        pid_t victim = size >= least ? find_child(child, which) : 0;
        if (victim > 0) kill(victim, SIGKILL);
    }
    return WIFEXITED(outcome) ? WEXITSTATUS(outcome) : 128 + WTERMSIG(outcome);
}

static void a_killed_rank_ends_the_run_and_the_next_goes_on(void **state) {
    (void)state;
    run_alone("exact");
    for (int which = 0; which < 4; which++) {
        unlink("team.txt");
        int status = kill_one(which, 20000);
        if (status == 0) continue; // it was faster
        assert_false(file_exists("team.txt"));
        assert_true(file_exists("team.ck"));
        assert_true(count_text("team.log", "signal 9") + count_text("team.log", "a process was lost") > 0);
        assert_int_equal(run_ranks(2, "pvs maze.prt -o team.txt --witness team.w --checkpoint team.ck"
                                      " -v --threads 1 2>err.txt"),
                         0);
        assert_int_equal(count_text("err.txt", "checkpoint            0 results"), 0);
        assert_int_equal(count_text("err.txt", "results were there already"), 1);
        assert_same_file("alone.txt", "team.txt");
        assert_same_file("alone.w", "team.w");
        assert_false(file_exists("team.ck"));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_ranks_come_to_what_one_process_comes_to),
        cmocka_unit_test(a_level_comes_out_the_same),
        cmocka_unit_test(a_world_comes_out_the_same),
        cmocka_unit_test(only_one_rank_speaks),
        cmocka_unit_test(a_killed_rank_ends_the_run_and_the_next_goes_on),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
