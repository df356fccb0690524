// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // MAP_ANONYMOUS, wait4
#endif
#include "cli/bench_child.h"

#include "cli/heap.h"

#include <errno.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { PATIENCE = 20 }; ///< a child that sleeps is ended after so many times its CPU limit

void *cli_shared_new(size_t size) {
    void *shared = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    return shared == MAP_FAILED ? NULL : shared;
}

void cli_shared_free(void *shared, size_t size) {
    if (shared) munmap(shared, size);
}

void cli_child_extend(double seconds) {
    struct timespec used;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used);
    rlim_t limit = (rlim_t)(ceil(seconds) + (double)used.tv_sec);
    struct rlimit time = {limit, RLIM_INFINITY};
    getrlimit(RLIMIT_CPU, &time);
    if (time.rlim_max == RLIM_INFINITY || limit < time.rlim_max) time.rlim_cur = limit;
    setrlimit(RLIMIT_CPU, &time);
    alarm((unsigned)(PATIENCE * ceil(seconds)));
}

static void live(void (*work)(void *shared), void *shared, double seconds, uint64_t bytes) {
    const struct rlimit none = {0, 0}, space = {bytes, bytes};
    setrlimit(RLIMIT_CORE, &none);
    if (bytes > 0) {
        cli_heap_trim();
        setrlimit(RLIMIT_AS, &space);
        cli_heap_prepare();
    }
    signal(SIGXCPU, SIG_DFL);
    signal(SIGALRM, SIG_DFL);
    cli_child_extend(seconds);
    work(shared);
    _exit(0);
}

enf_status cli_child_run(void (*work)(void *shared), void *shared, double seconds, uint64_t bytes,
                         cli_child *child, enf_error *error) {
    memset(child, 0, sizeof *child);
    fflush(NULL);
    cli_heap_trim(); // what is free here would be copied there, and count as the child's
    cli_heap_prepare();
    pid_t number = fork();
    if (number == 0) live(work, shared, seconds, bytes);
    int outcome = 0;
    struct rusage usage;
    pid_t ended = -1;
    do {
        if (number > 0) ended = wait4(number, &outcome, 0, &usage);
    } while (number > 0 && ended < 0 && errno == EINTR);
    if (ended < 0) return enf_fail(error, ENF_NO_RESOURCES, "can't start a process: %s", strerror(errno));
    if (WIFSIGNALED(outcome)) child->signal = WTERMSIG(outcome);
    child->timed_out = child->signal == SIGXCPU || child->signal == SIGALRM;
    child->cpu_seconds = (double)usage.ru_utime.tv_sec + (double)usage.ru_stime.tv_sec +
                         1e-6 * (double)(usage.ru_utime.tv_usec + usage.ru_stime.tv_usec);
    child->peak_bytes = (uint64_t)usage.ru_maxrss * 1024;
    return ENF_OK;
}
