// SPDX-License-Identifier: GPL-3.0-or-later
// Each stage's invariants in order. A stage whose foundations are broken is skipped: its answers would mean
// nothing.
#include "build/check.h"

#include "base/array.h"
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

// ---------------------------------------------------------------------------------------------- lists

static bool list_faces(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    checker->face_cell = enf_array_new((size_t)view->face_count, sizeof *checker->face_cell);
    int32_t *next = checker->facet_first = enf_array_zeroed((size_t)view->facet_count + 2, sizeof *next);
    checker->facet_faces = enf_array_new((size_t)view->face_count, sizeof *checker->facet_faces);
    if (!checker->face_cell || !next || !checker->facet_faces) return false;
    for (int32_t c = 0; c < view->fine_count; c++) {
        for (int32_t f = view->fine_face[c]; f < view->fine_face[c + 1]; f++) checker->face_cell[f] = c;
    }
    for (int32_t f = 0; f < view->face_count; f++) next[view->face_facet[f] + 2]++;
    for (int32_t f = 0; f < view->facet_count; f++) next[f + 2] += next[f + 1];
    for (int32_t f = 0; f < view->face_count; f++) checker->facet_faces[next[view->face_facet[f] + 1]++] = f;
    return true;
}

static bool list_cells(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    int32_t *next = checker->cell_first = enf_array_zeroed((size_t)view->tetrahedron_count + 2, sizeof *next);
    checker->tetrahedron_cells = enf_array_new((size_t)view->fine_count, sizeof *checker->tetrahedron_cells);
    checker->tetrahedron_facet =
        enf_array_new((size_t)view->tetrahedron_count, sizeof *checker->tetrahedron_facet);
    checker->facet_node = enf_array_new((size_t)view->facet_count, sizeof *checker->facet_node);
    if (!next || !checker->tetrahedron_cells || !checker->tetrahedron_facet || !checker->facet_node)
        return false;
    for (int32_t c = 0; c < view->fine_count; c++) next[view->fine_tetrahedron[c] + 2]++;
    for (int32_t t = 0; t < view->tetrahedron_count; t++) next[t + 2] += next[t + 1];
    for (int32_t c = 0; c < view->fine_count; c++)
        checker->tetrahedron_cells[next[view->fine_tetrahedron[c] + 1]++] = c;
    for (int32_t t = 0; t < view->tetrahedron_count; t++) {
        for (int k = 0; k < 4; k++) checker->tetrahedron_facet[t][k] = -1;
    }
    for (int32_t f = 0; f < view->facet_count; f++) checker->facet_node[f] = -1;
    for (int32_t n = 0; n < view->node_count; n++) {
        if (view->node_facet[n] >= 0) checker->facet_node[view->node_facet[n]] = n;
    }
    return true;
}

static void free_checker(enf_checker *checker) {
    enf_check_exact_free(&checker->exact);
    enf_check_chain_free(&checker->chain);
    free(checker->face_cell);
    free(checker->facet_first);
    free(checker->facet_faces);
    free(checker->facet_node);
    free(checker->cell_first);
    free(checker->tetrahedron_cells);
    free(checker->tetrahedron_facet);
}

// ---------------------------------------------------------------------------------------------- all stages

static bool whole_so_far(const enf_checker *checker) {
    return checker->report->broken_count == 0 && !checker->failed;
}

static void run_stages(enf_checker *checker) {
    enf_check_numbers(checker);
    if (!enf_check_holds(checker)) return; // "file: numbers": nothing else can be decided
    typedef void stage(enf_checker *);
    static stage *const stages[] = {
        enf_check_clean, enf_check_tetrahedra, enf_check_split,    enf_check_covers, enf_check_connect,
        enf_check_seen,  enf_check_colour,     enf_check_decimate, enf_check_drawn,  enf_check_portals};
    for (size_t i = 0; i < sizeof stages / sizeof *stages && whole_so_far(checker); i++) stages[i](checker);
    if (!checker->failed) enf_check_file(checker);
}

enf_status enf_world_check(const enf_file_view *view, enf_check_report *report, enf_error *error) {
    memset(report, 0, sizeof *report);
    if (!view->has_exact)
        return enf_fail(error, ENF_BAD_INPUT, "the world has no exact part to check; compile it again");
    enf_checker checker = {.view = view, .report = report};
    if (list_faces(&checker) && list_cells(&checker)) {
        run_stages(&checker);
    } else {
        checker.failed = true;
    }
    bool failed = checker.failed;
    free_checker(&checker);
    if (failed) return enf_fail_memory(error, "checking the world");
    if (report->broken_count > 0) return enf_fail(error, ENF_CHECK_FAILED, "%s", report->first);
    return ENF_OK;
}
