// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/progress.h"

#include "base/timer.h"

#include <inttypes.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const double patience = 1.0, redraw_interval = 0.05; // seconds
static const double telling = 0.01; // no time left is told before so much of a stage has been seen
enum { BAR_WIDTH = 30 };

const char *const cli_progress_modes[] = {"auto", "always", "never", NULL};

static volatile sig_atomic_t interrupted;

static void note_interrupt(int signal) {
    (void)signal;
    interrupted = 1;
}

bool cli_was_interrupted(void) {
    return interrupted != 0;
}

void cli_progress_start(cli_progress *progress, cli_progress_mode mode) {
    *progress = (cli_progress){.mode = mode, .terminal = isatty(STDERR_FILENO), .started = enf_timer_now()};
    struct sigaction action = {.sa_handler = note_interrupt, .sa_flags = (int)SA_RESETHAND};
    sigemptyset(&action.sa_mask);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

/// 1:23, or 4:05:00.
static void print_time(double seconds) {
    int64_t whole = (int64_t)(seconds + 0.5);
    if (whole >= 3600) fprintf(stderr, "%" PRId64 ":%02d:", whole / 3600, (int)(whole / 60 % 60));
    if (whole < 3600) fprintf(stderr, "%d:", (int)(whole / 60));
    fprintf(stderr, "%02d", (int)(whole % 60));
}

static void print_times(const cli_progress *progress, double fraction) {
    double seen = fraction - progress->stage_first, spent = progress->drawn - progress->stage_started;
    fputs("  ", stderr);
    print_time(progress->drawn - progress->started);
    if (seen < telling || spent < patience || fraction >= 1) return;
    fputs(", about ", stderr);
    print_time(spent * (1 - fraction) / seen);
    fputs(" left", stderr);
}

static void draw_bar(cli_progress *progress, const char *stage, double fraction) {
    int filled = (int)(fraction * BAR_WIDTH);
    char bar[BAR_WIDTH + 1];
    for (int i = 0; i < BAR_WIDTH; i++) bar[i] = i < filled ? '#' : '.';
    bar[BAR_WIDTH] = 0;
    fprintf(stderr, "\r%-14s [%s] %3d %%", stage, bar, (int)(fraction * 100));
    print_times(progress, fraction);
    fputs("\033[K", stderr);
    fflush(stderr);
    progress->visible = true;
}

bool cli_progress_report(void *user, const char *stage, double fraction) {
    cli_progress *progress = user;
    if (interrupted) return false;
    if (progress->mode == CLI_PROGRESS_NEVER) return true;
    fraction = fraction > 0 ? (fraction < 1 ? fraction : 1) : 0;
    bool new_stage = !progress->stage || strcmp(progress->stage, stage) != 0;
    if (!progress->terminal) {
        if (progress->mode == CLI_PROGRESS_ALWAYS && new_stage) {
            fprintf(stderr, "%s ...\n", stage);
            progress->stage = stage;
        }
        return true;
    }
    double now = enf_timer_now();
    if (!progress->timed || strcmp(progress->timed, stage) != 0) {
        progress->timed = stage;
        progress->stage_started = now;
        progress->stage_first = fraction;
    }
    if (progress->mode == CLI_PROGRESS_AUTO && now - progress->started < patience) return true;
    if (!new_stage && now - progress->drawn < redraw_interval) return true;
    progress->drawn = now;
    progress->stage = stage;
    draw_bar(progress, stage, fraction);
    return true;
}

void cli_progress_stop(cli_progress *progress) {
    if (progress->visible) fputs("\r\033[K", stderr);
    progress->visible = false;
}
