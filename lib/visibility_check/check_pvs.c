// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility_check/check_pvs.h"

#include "base/array.h"
#include "visibility_check/check_hidden.h"
#include "visibility_check/sampler.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct pvs_checker {
    const enf_portal_graph *graph;
    const enf_pvs *pvs;
    const enf_pvs_check_options *options;
    enf_check_report *report;
    enf_check_row *row; ///< the one being filled
    uint64_t *unshown;  ///< rows like the set's: listed pairs without a sight line
    uint64_t unshown_count;
} pvs_checker;

// ---------------------------------------------------------------------------------------------- rows

static void begin(pvs_checker *checker, const char *name, const char *truth) {
    checker->row = &checker->report->rows[checker->report->row_count++];
    *checker->row = (enf_check_row){.name = name, .held = true};
    snprintf(checker->row->detail, sizeof checker->row->detail, "%s", truth);
}

static void skip(pvs_checker *checker, const char *name, const char *why) {
    begin(checker, name, why);
    checker->row->skipped = true;
}

/// Breaks the row; later words are dropped.
static void break_row(pvs_checker *checker, const char *format, ...) ENF_PRINTF(2, 3);
static void break_row(pvs_checker *checker, const char *format, ...) {
    enf_check_row *row = checker->row;
    if (!row->held) return;
    va_list words;
    row->held = false;
    va_start(words, format);
    vsnprintf(row->detail, sizeof row->detail, format, words);
    va_end(words);
    if (checker->report->broken_count++ == 0)
        snprintf(checker->report->first, sizeof checker->report->first, "%s: %s", row->name, row->detail);
}

static void check_rows(pvs_checker *checker) {
    const enf_pvs *pvs = checker->pvs;
    begin(checker, "visible: each cell sees itself", "every row lists its own cell");
    for (int32_t i = 0; i < pvs->cell_count; i++) {
        checker->row->tested++;
        if (!enf_pvs_get(pvs, i, i)) break_row(checker, "cell %" PRId32 " does not", i);
    }
    begin(checker, "visible: rows are symmetric", "who sees is seen");
    for (int32_t i = 0; i < pvs->cell_count; i++)
        for (int32_t j = 0; j < i; j++) {
            bool there = enf_pvs_get(pvs, i, j), back = enf_pvs_get(pvs, j, i);
            checker->row->tested += there || back;
            if (there != back)
                break_row(checker, "cell %" PRId32 " lists %" PRId32 " but not the other way round",
                          there ? i : j, there ? j : i);
        }
}

// ---------------------------------------------------------------------------------------------- visible

static bool is_listed(const enf_pvs *pvs, int32_t i, int32_t j) {
    return enf_pvs_get(pvs, i, j) || enf_pvs_get(pvs, j, i);
}

static void set_pair(uint64_t *rows, size_t row_words, int32_t i, int32_t j, bool value) {
    uint64_t *one = &rows[(size_t)i * row_words + (j >> 6)], *two = &rows[(size_t)j * row_words + (i >> 6)];
    *one = (*one & ~(UINT64_C(1) << (j & 63))) | (uint64_t)value << (j & 63);
    *two = (*two & ~(UINT64_C(1) << (i & 63))) | (uint64_t)value << (i & 63);
}

/// Both are sorted: a walk along both. Notes the pairs without a sight line.
static void check_complete(pvs_checker *checker) {
    const enf_witness_list *list = checker->options->witnesses;
    size_t at = 0;
    begin(checker, "visible: sight lines of listed pairs only", "");
    for (int32_t i = 0; i < checker->pvs->cell_count; i++)
        for (int32_t j = i + 1; j < checker->pvs->cell_count; j++) {
            bool listed = is_listed(checker->pvs, i, j);
            bool shown = at < list->count && list->items[at].cell[0] == i && list->items[at].cell[1] == j;
            at += shown;
            checker->row->tested += shown;
            checker->unshown_count += listed && !shown;
            if (listed && !shown) set_pair(checker->unshown, checker->pvs->row_words, i, j, true);
            if (shown && !listed)
                break_row(checker, "one of cells %" PRId32 " and %" PRId32 ", which are not listed", i, j);
        }
    if (checker->row->held)
        snprintf(checker->row->detail, sizeof checker->row->detail, "%" PRIu64 " pairs have none",
                 checker->unshown_count);
}

/// Which of the pairs without a sight line are proved otherwise? Claimed hidden, they must come out as seen.
/// The checker of hidden pairs finds those first that others rest on: again and again, until it finds none.
static enf_status prove_unshown(pvs_checker *checker, uint64_t *claims, enf_error *error) {
    size_t words = checker->pvs->row_words;
    for (size_t found = 1; found > 0 && checker->unshown_count > 0;) {
        const enf_hidden_options how = {.only = checker->unshown};
        enf_hidden_report hidden;
        enf_status status = enf_check_hidden(checker->graph, claims, words, &how, &hidden, error);
        if (status) return status;
        found = 0;
        for (size_t k = 0; k < hidden.open_count; k++) {
            const int32_t *cell = hidden.open[k].cell;
            if (!hidden.open[k].seen) continue;
            set_pair(claims, words, cell[0], cell[1], true);
            set_pair(checker->unshown, words, cell[0], cell[1], false);
            checker->unshown_count--;
            found++;
        }
        enf_hidden_report_free(&hidden);
    }
    return ENF_OK;
}

static void name_unshown(pvs_checker *checker) {
    for (int32_t i = 0; i < checker->pvs->cell_count; i++)
        for (int32_t j = i + 1; j < checker->pvs->cell_count; j++)
            if (checker->unshown[(size_t)i * checker->pvs->row_words + (j >> 6)] >> (j & 63) & 1)
                break_row(checker, "cells %" PRId32 " and %" PRId32 " are not; %" PRIu64 " such pairs", i, j,
                          checker->unshown_count);
}

static enf_status check_unshown(pvs_checker *checker, enf_error *error) {
    size_t size = (size_t)checker->pvs->cell_count * checker->pvs->row_words;
    uint64_t *claims = enf_array_new(size, sizeof *claims);
    enf_status status = claims ? ENF_OK : enf_fail_memory(error, "the check of a visible set");
    begin(checker, "visible: pairs without one are proved", "each by a line that needs more than doubles");
    checker->row->tested = checker->unshown_count;
    for (size_t w = 0; !status && w < size; w++) claims[w] = checker->pvs->rows[w] & ~checker->unshown[w];
    if (!status) status = prove_unshown(checker, claims, error);
    if (!status) name_unshown(checker);
    free(claims);
    return status;
}

static bool check_lines(pvs_checker *checker) {
    const enf_witness_list *list = checker->options->witnesses;
    enf_witness_checker walker;
    begin(checker, "visible: every sight line arrives", "each passes a portal sequence, strictly");
    bool made = enf_witness_checker_make(&walker, checker->graph);
    for (size_t k = 0; made && k < list->count; k++) {
        const enf_witness *witness = &list->items[k];
        enf_witness_outcome outcome = enf_witness_check(&walker, witness);
        char text[128];
        checker->row->tested++;
        if (!outcome.fault) continue;
        enf_witness_describe(outcome, text, sizeof text);
        break_row(checker, "cells %" PRId32 " and %" PRId32 ": %s", witness->cell[0], witness->cell[1], text);
    }
    enf_witness_checker_free(&walker);
    return made;
}

// ---------------------------------------------------------------------------------------------- hidden

static void judge_hidden(pvs_checker *checker, const enf_hidden_report *hidden) {
    const enf_hidden_pair *pair = hidden->open;
    size_t seen = 0;
    for (size_t k = 0; k < hidden->open_count; k++) seen += hidden->open[k].seen;
    checker->row->tested = hidden->claimed;
    for (size_t k = 0; seen > 0 && !pair->seen && k < hidden->open_count; k++) pair++;
    if (seen > 0)
        break_row(checker, "cells %" PRId32 " and %" PRId32 " see each other%s; %zu such pairs",
                  pair->cell[0], pair->cell[1], pair->verified ? "" : ", by less than doubles can show",
                  seen);
    else if (hidden->open_count > 0)
        break_row(checker, "cells %" PRId32 " and %" PRId32 " could not be confirmed; %zu such pairs",
                  pair->cell[0], pair->cell[1], hidden->open_count);
    else if (!hidden->ended)
        break_row(checker, "the time was up with %" PRIu64 " pairs left", hidden->left);
}

static enf_status check_hidden(pvs_checker *checker, enf_error *error) {
    const enf_pvs_check_options *options = checker->options;
    const enf_hidden_options how = {
        .seconds = options->hidden_seconds, .progress = options->progress, .user = options->user};
    enf_hidden_report hidden;
    begin(checker, "hidden: no other pair sees each other", "all are confirmed");
    enf_status status =
        enf_check_hidden(checker->graph, checker->pvs->rows, checker->pvs->row_words, &how, &hidden, error);
    if (status) return status;
    judge_hidden(checker, &hidden);
    enf_hidden_report_free(&hidden);
    return ENF_OK;
}

// ---------------------------------------------------------------------------------------------- sample

static bool judge_sample(pvs_checker *checker, const enf_sampler *sampler) {
    enf_witness_checker walker;
    bool made = enf_witness_checker_make(&walker, checker->graph);
    checker->row->tested = sampler->pair_count;
    for (int32_t i = 0; made && i < checker->pvs->cell_count; i++)
        for (int32_t j = i + 1; j < checker->pvs->cell_count; j++) {
            enf_witness line;
            if (is_listed(checker->pvs, i, j) || !enf_sampler_witness(sampler, i, j, &line)) continue;
            if (enf_witness_check(&walker, &line).fault) continue;
            const double *a = line.from, *b = line.to;
            break_row(checker,
                      "cells %" PRId32 " and %" PRId32
                      " see each other from %.17g %.17g %.17g to %.17g %.17g "
                      "%.17g, clear of edges by %g",
                      i, j, a[0], a[1], a[2], b[0], b[1], b[2],
                      (double)sampler->pair_clearance[enf_sampler_pair(i, j)]);
        }
    enf_witness_checker_free(&walker);
    return made;
}

static enf_status check_sample(pvs_checker *checker, enf_error *error) {
    enf_sampler sampler;
    begin(checker, "sample: no line joins another pair", "pairs that lines found");
    enf_status status = enf_sampler_make(&sampler, checker->graph, checker->options->seed, error);
    if (status) return status;
    status = enf_sampler_run(&sampler, checker->options->sample_seconds, 0, error);
    if (!status && !judge_sample(checker, &sampler)) status = enf_fail_memory(error, "the sampler");
    enf_sampler_free(&sampler);
    return status;
}

// ---------------------------------------------------------------------------------------------- check

static enf_status check_visible(pvs_checker *checker, enf_error *error) {
    const enf_pvs *pvs = checker->pvs;
    if (!checker->options->witnesses) {
        skip(checker, "visible: sight lines of listed pairs only", "no sight lines are given");
        return ENF_OK;
    }
    checker->unshown = enf_array_zeroed((size_t)pvs->cell_count, pvs->row_words * sizeof *checker->unshown);
    if (!checker->unshown) return enf_fail_memory(error, "the check of a visible set");
    check_complete(checker);
    enf_status status = check_lines(checker) ? ENF_OK : enf_fail_memory(error, "the check of sight lines");
    if (!status) status = check_unshown(checker, error);
    free(checker->unshown);
    return status;
}

enf_status enf_pvs_check(const enf_portal_graph *graph, const enf_pvs *pvs,
                         const enf_pvs_check_options *options, enf_check_report *report, enf_error *error) {
    pvs_checker checker = {.graph = graph, .pvs = pvs, .options = options, .report = report};
    enf_status status = ENF_OK;
    memset(report, 0, sizeof *report);
    if (pvs->cell_count != graph->cell_count)
        return enf_fail(error, ENF_BAD_USAGE,
                        "the visible set is about %" PRId32 " cells, the graph has %" PRId32, pvs->cell_count,
                        graph->cell_count);
    check_rows(&checker);
    status = check_visible(&checker, error);
    if (status) return status;
    if (options->hidden)
        status = check_hidden(&checker, error);
    else
        skip(&checker, "hidden: no other pair sees each other", "not asked for");
    if (!status && options->sample_seconds > 0)
        status = check_sample(&checker, error);
    else if (!status)
        skip(&checker, "sample: no line joins another pair", "not asked for");
    if (status || report->broken_count == 0) return status;
    return enf_fail(error, ENF_CHECK_FAILED, "%s", report->first);
}
