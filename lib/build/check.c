// SPDX-License-Identifier: GPL-3.0-or-later
// Each stage's invariants in order. A stage whose foundations are broken is skipped: its answers would mean
// nothing.
#include "build/check.h"

#include "build/check_rows.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

// ---------------------------------------------------------------------------------------------- rows

void enf_check_begin(enf_checker *checker, const char *name, const char *truth) {
    enf_check_report *report = checker->report;
    if (report->row_count < ENF_CHECK_ROWS_MAX)
        report->row_count++; // the last one is written over, were there too many
    checker->row = &report->rows[report->row_count - 1];
    memset(checker->row, 0, sizeof *checker->row);
    checker->row->name = name;
    checker->row->held = true;
    snprintf(checker->row->detail, sizeof checker->row->detail, "%s", truth);
}

bool enf_check_break(enf_checker *checker, const char *format, ...) {
    enf_check_row *row = checker->row;
    if (!row->held) return false;
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(row->detail, sizeof row->detail, format, arguments);
    va_end(arguments);
    row->held = false;
    if (checker->report->broken_count++ == 0)
        snprintf(checker->report->first, sizeof checker->report->first, "%s: %s", row->name, row->detail);
    return false;
}

bool enf_check_no_memory(enf_checker *checker) {
    checker->failed = true;
    return false;
}

// ---------------------------------------------------------------------------------------------- all stages

static void free_checker(enf_checker *checker) {
    enf_check_exact_free(&checker->exact);
    enf_check_chain_free(&checker->chain);
}

static bool whole_so_far(const enf_checker *checker) {
    return checker->report->broken_count == 0 && !checker->failed;
}

static void run_stages(enf_checker *checker) {
    enf_check_numbers(checker);
    if (!enf_check_holds(checker)) return; // "file: numbers": nothing else can be decided
    typedef void stage(enf_checker *);
    static stage *const stages[] = {enf_check_clean, enf_check_tetrahedra, enf_check_split,
                                    enf_check_trees, enf_check_covers,     enf_check_connect,
                                    enf_check_seen,  enf_check_colour,     enf_check_decimate,
                                    enf_check_drawn, enf_check_portals};
    for (size_t i = 0; i < sizeof stages / sizeof *stages && whole_so_far(checker); i++) stages[i](checker);
    if (!checker->failed) enf_check_file(checker);
}

enf_status enf_world_check(const enf_file_view *view, enf_check_report *report, enf_error *error) {
    memset(report, 0, sizeof *report);
    if (!view->has_exact)
        return enf_fail(error, ENF_BAD_INPUT, "the world has no exact part to check; compile it again");
    enf_checker checker = {.view = view, .report = report};
    run_stages(&checker);
    bool failed = checker.failed;
    free_checker(&checker);
    if (failed) return enf_fail_memory(error, "checking the world");
    if (report->broken_count > 0) return enf_fail(error, ENF_CHECK_FAILED, "%s", report->first);
    return ENF_OK;
}
