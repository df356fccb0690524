// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/bench_pairs.h"

#include "base/array.h"
#include "cli/random.h"
#include "visibility/world_pairs.h"

#include <math.h>
#include <stdlib.h>

/// Separators that the search for one pair may make: a tenth of a second or so.
enum { STEPS = 20000 };

static bool is_unseen(const enf_world_lines *lines, const enf_pvs *claimed, int32_t i, int32_t j) {
    return enf_pvs_get(claimed, i, j) && !enf_pvs_get(&lines->seen, i, j);
}

static int64_t count_unseen(const enf_world_lines *lines, const enf_pvs *claimed) {
    int64_t count = 0;
    for (int32_t i = 0; i < claimed->cell_count; i++)
        for (int32_t j = i + 1; j < claimed->cell_count; j++) count += is_unseen(lines, claimed, i, j);
    return count;
}

/// A pair, and what is known of it.
typedef struct decision {
    int32_t pair[2];
    enf_squeeze_answer answer;
} decision;

/// Takes `count` of the unseen pairs, in order.
static void draw(const enf_world_lines *lines, const enf_pvs *claimed, int64_t unseen, int32_t count,
                 decision *decisions) {
    uint64_t state = 1;
    int32_t drawn = 0;
    for (int32_t i = 0; i < claimed->cell_count; i++)
        for (int32_t j = i + 1; j < claimed->cell_count && drawn < count; j++) {
            if (!is_unseen(lines, claimed, i, j)) continue;
            if (cli_random_share(&state) * (double)unseen-- >= count - drawn) continue;
            decisions[drawn++] = (decision){.pair = {i, j}, .answer = ENF_SQUEEZE_OPEN};
        }
}

/// What was open may have been on the way of a line for another pair since.
static void sum_up(const enf_world_lines *lines, const decision *decisions, cli_pair_sample *sample) {
    for (int32_t k = 0; k < sample->decided; k++) {
        const decision *one = &decisions[k];
        const bool is_seen = enf_pvs_get(&lines->seen, one->pair[0], one->pair[1]);
        sample->seen += is_seen;
        sample->hidden += !is_seen && one->answer == ENF_SQUEEZE_HIDDEN;
        sample->open += !is_seen && one->answer != ENF_SQUEEZE_HIDDEN;
    }
}

static enf_status decide(enf_world_lines *lines, const enf_world_air *air, decision *decisions, int32_t count,
                         enf_error *error) {
    enf_world_pairs decider;
    enf_status status = enf_world_pairs_make(&decider, air, lines, 1, error);
    for (int32_t k = 0; !status && k < count; k++) {
        decision *one = &decisions[k];
        if (enf_pvs_get(&lines->seen, one->pair[0], one->pair[1])) continue; // on the way of others
        status = enf_world_pairs_decide(&decider, one->pair[0], one->pair[1], STEPS, &one->answer, error);
    }
    enf_world_pairs_free(&decider);
    return status;
}

enf_status cli_pairs_sample(enf_world_lines *lines, const enf_world_air *air, const enf_pvs *claimed,
                            int32_t count, cli_pair_sample *sample, enf_error *error) {
    *sample = (cli_pair_sample){.unseen = count_unseen(lines, claimed)};
    if (!air->uses_leafs) return ENF_OK;
    if (count > sample->unseen) count = (int32_t)sample->unseen;
    decision *decisions = enf_array_zeroed((size_t)count, sizeof *decisions);
    if (!decisions) return enf_fail_memory(error, "the pairs");
    draw(lines, claimed, sample->unseen, count, decisions);
    enf_status status = decide(lines, air, decisions, count, error);
    if (!status) {
        sample->decided = count;
        sum_up(lines, decisions, sample);
    }
    free(decisions);
    return status;
}

void cli_pairs_estimate(const cli_pair_sample *sample, double *about, double *most) {
    static const double deviations = 1.96; // of which a normal variable stays below by 97.5 %
    const double count = sample->decided, unseen = (double)sample->unseen;
    *about = *most = unseen;
    if (count == 0) return;
    const double share = (sample->hidden + sample->open) / count, square = deviations * deviations / count;
    const double spread = deviations * sqrt(share * (1 - share) / count + square / (4 * count));
    *about = share * unseen;
    if (count < unseen)
        *most = fmin((share + square / 2 + spread) / (1 + square), 1) * unseen;
    else
        *most = *about; // all were decided
}
