// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/progress.h"

#include "base/timer.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static const double patience = 1.0, redraw_interval = 0.05; // seconds
enum { BAR_WIDTH = 40 };

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

static void draw_bar(cli_progress *progress, const char *stage, double fraction) {
    int filled = (int)(fraction * BAR_WIDTH);
    char bar[BAR_WIDTH + 1];
    for (int i = 0; i < BAR_WIDTH; i++) bar[i] = i < filled ? '#' : '.';
    bar[BAR_WIDTH] = 0;
    fprintf(stderr, "\r%-14s [%s] %3d %%\033[K", stage, bar, (int)(fraction * 100));
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
