// SPDX-License-Identifier: GPL-3.0-or-later
// Check: every invariant of a compiled world, decided exactly from the world alone, by arithmetic that shares
// nothing with the stages that built it.
#ifndef ENF_BUILD_CHECK_H
#define ENF_BUILD_CHECK_H

#include "enfilade/format.h"

enum { ENF_CHECK_ROWS_MAX = 40 };

/// One invariant.
typedef struct enf_check_row {
    const char *name; ///< "stage: what"
    bool held;
    bool skipped;     ///< not looked at, because an invariant that it stands on is broken
    uint64_t tested;  ///< how many things were looked at
    char detail[256]; ///< what holds, or the first thing that is wrong, with its numbers
} enf_check_row;

typedef struct enf_check_report {
    int32_t broken_count;
    char first[512]; ///< name and detail of the first broken row; empty if all hold
    int row_count;
    enf_check_row rows[ENF_CHECK_ROWS_MAX];
} enf_check_report;

/// Checks a world whose counts and indices are right (enf_file_read or enf_view_check has passed it). ENF_OK:
/// all invariants hold; ENF_CHECK_FAILED: one does not, the error is report->first; ENF_BAD_INPUT: the file
/// has no exact part; ENF_NO_RESOURCES: no memory. The report is filled in the first two cases.
enf_status enf_world_check(const enf_file_view *view, enf_check_report *report, enf_error *error);

#endif
