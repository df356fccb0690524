// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/check_world_pvs.h"

#include "base/array.h"
#include "build/check_rows.h"
#include "format/pvs_row.h"
#include "visibility/pvs.h"
#include "visibility/world_lines.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { LINES = 20000 };

/// Decodes all rows. (That they can be decoded was seen when the file was opened.)
static bool take_rows(const enf_file_view *view, enf_pvs *pvs) {
    enf_error error;
    size_t bytes = enf_pvs_row_bytes(view->cell_count);
    uint8_t *row = enf_array_new(bytes, 1);
    bool good = row && !enf_pvs_new(pvs, view->cell_count, &error);
    for (int32_t i = 0; good && i < view->cell_count; i++) {
        const int64_t *offset = &view->pvs_offset[i];
        uint64_t *words = enf_pvs_row(pvs, i);
        good = enf_pvs_row_decode(view->pvs_rows + offset[0], (size_t)(offset[1] - offset[0]), row,
                                  view->cell_count);
        memset(words, 0, pvs->row_words * sizeof *words);
        for (size_t k = 0; good && k < bytes; k++) words[k / 8] |= (uint64_t)row[k] << k % 8 * 8;
    }
    free(row);
    return good;
}

static void check_relation(enf_checker *checker, const enf_pvs *pvs) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "visibility: sets",
                    "each cell sees itself, its neighbours, and what sees it; pairs are counted right");
    for (int32_t i = 0; i < pvs->cell_count; i++, checker->row->tested++) {
        if (!enf_pvs_get(pvs, i, i)) enf_check_break(checker, "cell %" PRId32 " does not see itself", i);
        for (int32_t j = 0; j < i; j++)
            if (enf_pvs_get(pvs, i, j) != enf_pvs_get(pvs, j, i))
                enf_check_break(checker, "cells %" PRId32 " and %" PRId32 " do not agree", j, i);
    }
    for (int32_t i = 0; i < view->portal_count; i++) {
        const enf_file_portal *portal = &view->portals[i];
        if (!enf_pvs_get(pvs, portal->from, portal->to))
            enf_check_break(checker, "cell %" PRId32 " does not see its neighbour %" PRId32, portal->from,
                            portal->to);
    }
    if (enf_pvs_pairs(pvs) != view->pvs->pairs)
        enf_check_break(checker, "there are %" PRId64 " pairs, not %" PRId64, enf_pvs_pairs(pvs),
                        view->pvs->pairs);
}

/// The pairs that lines have seen must be in the sets.
static void compare(enf_checker *checker, const enf_world_lines *lines, const enf_pvs *pvs) {
    for (int32_t i = 0; i < pvs->cell_count; i++)
        for (int32_t j = i + 1; j < pvs->cell_count; j++) {
            if (!enf_pvs_get(&lines->seen, i, j)) continue;
            checker->row->tested++;
            if (!enf_pvs_get(pvs, i, j))
                enf_check_break(checker, "a line leads from cell %" PRId32 " to cell %" PRId32, i, j);
        }
}

static void check_lines(enf_checker *checker, const enf_pvs *pvs) {
    enf_world_lines lines;
    enf_error error;
    enf_check_begin(checker, "visibility: lines", "no line joins two cells that do not see each other");
    bool good = !enf_world_lines_make(&lines, checker->view, 1, &error);
    for (int i = 0; good && i < LINES; i++) enf_world_lines_throw_any(&lines);
    if (good)
        compare(checker, &lines, pvs);
    else
        enf_check_no_memory(checker);
    enf_world_lines_free(&lines);
}

enf_status enf_world_check_pvs(const enf_file_view *view, enf_check_report *report, enf_error *error) {
    if (!view->pvs) return ENF_OK;
    enf_checker checker = {.view = view, .report = report};
    enf_pvs pvs = {0};
    if (take_rows(view, &pvs)) {
        check_relation(&checker, &pvs);
        if (enf_check_holds(&checker)) check_lines(&checker, &pvs);
    } else {
        enf_check_no_memory(&checker);
    }
    enf_pvs_free(&pvs);
    if (checker.failed) return enf_fail_memory(error, "checking the visible set");
    return report->broken_count > 0 ? enf_fail(error, ENF_CHECK_FAILED, "%s", report->first) : ENF_OK;
}
