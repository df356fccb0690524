// SPDX-License-Identifier: GPL-3.0-or-later
// Lines of numbers on standard input, for commands that answer each with a line.
#ifndef ENF_CLI_POINTS_H
#define ENF_CLI_POINTS_H

/// Reads lines of `count` (at most 6) finite numbers and nothing else until standard input ends, and hands
/// them to `answer`, which returns an exit status; the first that is not 0 ends it. `wanted` tells the user
/// what a line should be: "... is no WANTED on each line". Returns the exit status.
int cli_read_numbers(int count, const char *wanted, int (*answer)(const double *numbers, void *user),
                     void *user);

#endif
