// SPDX-License-Identifier: GPL-3.0-or-later
// Check: a visible set against the portal graph that it is about. What it lists is proved by sight lines,
// what it leaves out by the checker of hidden pairs; lines thrown at random look for what is missing.
#ifndef ENF_VISIBILITY_CHECK_PVS_H
#define ENF_VISIBILITY_CHECK_PVS_H

#include "build/check.h"
#include "visibility/pvs.h"
#include "visibility_check/read_witness.h"

typedef struct enf_pvs_check_options {
    const enf_witness_list *witnesses; ///< sorted; null: that row is skipped
    bool hidden;                       ///< confirm that what is left out is hidden
    double hidden_seconds;             ///< of processor time for that; 0: no limit
    double sample_seconds;             ///< of processor time for lines thrown at random; 0: none
    uint64_t seed;                     ///< for these
    void (*progress)(void *user, int32_t cells_done, int32_t cells); ///< may be null
    void *user;
} enf_pvs_check_options;

/// ENF_OK: every row holds; ENF_CHECK_FAILED: one does not, the error is report->first; the report is filled
/// in both cases. ENF_NO_RESOURCES: no memory. ENF_BAD_USAGE: the set is about another number of cells.
enf_status enf_pvs_check(const enf_portal_graph *graph, const enf_pvs *pvs,
                         const enf_pvs_check_options *options, enf_check_report *report, enf_error *error);

#endif
