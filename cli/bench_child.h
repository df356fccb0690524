// SPDX-License-Identifier: GPL-3.0-or-later
// Work in a process of its own: what crashes or hangs there, or eats memory, ends one row of a table and no
// more.
#ifndef ENF_CLI_BENCH_CHILD_H
#define ENF_CLI_BENCH_CHILD_H

#include "enfilade/base.h"

typedef struct cli_child {
    bool timed_out;
    int signal;         ///< that ended it, or 0
    double cpu_seconds; ///< of the whole child
    uint64_t peak_bytes;
} cli_child;

/// Memory that a child and its parent share, zeroed; null without memory.
void *cli_shared_new(size_t size);
void cli_shared_free(void *shared, size_t size);

/// Runs work(shared) in a child, for at most so many CPU seconds (a part of one counts as one) and so much
/// address space (0: any). ENF_NO_RESOURCES if no process can be made.
enf_status cli_child_run(void (*work)(void *shared), void *shared, double seconds, uint64_t bytes,
                         cli_child *child, enf_error *error);

/// In the child: allows so many CPU seconds from now on.
void cli_child_extend(double seconds);

#endif
