// SPDX-License-Identifier: GPL-3.0-or-later
// How many of the pairs that visible sets claim, and lines have not shown, are true? A random sample says.
#ifndef ENF_CLI_BENCH_PAIRS_H
#define ENF_CLI_BENCH_PAIRS_H

#include "visibility/world_air.h"
#include "visibility/world_lines.h"

typedef struct cli_pair_sample {
    int64_t unseen;                      ///< pairs i < j that are claimed and were not seen
    int32_t decided, seen, hidden, open; ///< of those; the last three add up to the first
} cli_pair_sample;

/// Decides up to `count` of them, each as likely as any other (all, if there are no more); what is found to
/// be seen is seen by the lines from then on. Without leafs in the air, none is decided.
enf_status cli_pairs_sample(enf_world_lines *lines, const enf_world_air *air, const enf_pvs *claimed,
                            int32_t count, cli_pair_sample *sample, enf_error *error);

/// How many of the unseen pairs are hidden, if those that are open are: about, and, with 97.5 % confidence,
/// at most (E. B. Wilson, "Probable inference, the law of succession, and statistical inference", 1927).
void cli_pairs_estimate(const cli_pair_sample *sample, double *about, double *most);

#endif
