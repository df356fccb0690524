// SPDX-License-Identifier: GPL-3.0-or-later
// Points, each once in a run of them.
#ifndef ENF_VISIBILITY_DISTINCT_H
#define ENF_VISIBILITY_DISTINCT_H

#include <stdbool.h>
#include <stdint.h>

/// Points in runs, one after the other.
typedef struct enf_distinct_runs {
    double (*points)[3];
    int32_t *first; ///< count + 1 offsets
    int32_t count;  ///< of runs

    /// Fills a run with its points, on any thread; null: they are there.
    void (*fill)(const void *user, int32_t run, double (*points)[3]);
    const void *user;
} enf_distinct_runs;

/// Drops the points that have the same bits as one before them in their run, on some threads; the others stay
/// in their order, and move together. False without memory.
bool enf_distinct_keep_runs(const enf_distinct_runs *runs, int threads);

#endif
