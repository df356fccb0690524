// SPDX-License-Identifier: GPL-3.0-or-later
// Check, the visible set: it is a relation of the kind it should be, and lines thrown through the fine cells
// join no two cells that it says are hidden from each other. Lines can't prove it complete; they find what is
// badly wrong.
#ifndef ENF_VISIBILITY_CHECK_WORLD_PVS_H
#define ENF_VISIBILITY_CHECK_WORLD_PVS_H

#include "build/check.h"

/// Adds its rows to the report of a world that enf_world_check has found to hold; none if the world has no
/// visible set. ENF_OK, ENF_CHECK_FAILED (the error is report->first), or ENF_NO_RESOURCES.
enf_status enf_world_check_pvs(const enf_file_view *view, enf_check_report *report, enf_error *error);

#endif
