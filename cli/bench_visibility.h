// SPDX-License-Identifier: GPL-3.0-or-later
// What `bench visibility` measures, and its picture.
#ifndef ENF_CLI_BENCH_VISIBILITY_H
#define ENF_CLI_BENCH_VISIBILITY_H

#include "visibility/visibility.h"

#include <stdio.h>

/// One method on one level, or on all.
typedef struct cli_visibility_measure {
    double seconds; ///< of processor time, median over the runs
    int64_t pairs;  ///< directed, own ones included
    int64_t missed; ///< pairs i < j that the exact sets or a sampled line has, and these sets have not
    int64_t wrong;  ///< pairs i < j that these sets have, and the exact ones have not
    int64_t whole;  ///< sequences that took whole numbers to decide
} cli_visibility_measure;

/// Run time (logarithmic) against pairs that are wrongly visible, as shares of those that are visible: a dot
/// for each method, from reach to exact.
void cli_visibility_plot(const cli_visibility_measure measures[ENF_METHOD_COUNT], const char *title,
                         FILE *out);

#endif
