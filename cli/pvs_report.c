// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/pvs_report.h"

#include "build/json.h"

#include <inttypes.h>

static void put_input(enf_json *json, const cli_pvs_result *result) {
    char hash[24];
    snprintf(hash, sizeof hash, "%016" PRIx64, result->input_hash);
    enf_json_begin_object(json, "input");
    enf_json_text(json, "file", result->input);
    enf_json_text(json, "hash", hash);
    enf_json_end_object(json);
}

/// Counts of sequences, up to the longest that there is.
static void put_lengths(enf_json *json, const enf_visibility *visibility) {
    int count = (int)(sizeof visibility->sequence_lengths / sizeof *visibility->sequence_lengths);
    while (count > 0 && visibility->sequence_lengths[count - 1] == 0) count--;
    enf_json_begin_array(json, "sequence_lengths");
    json->one_line = true;
    for (int i = 0; i < count; i++) enf_json_whole(json, NULL, visibility->sequence_lengths[i]);
    enf_json_end_array(json);
    json->one_line = false;
}

/// What it took to decide sequences.
static void put_stabs(enf_json *json, const enf_stab_counts *stabs) {
    enf_json_begin_object(json, "stabs");
    enf_json_whole(json, "calls", stabs->calls);
    enf_json_whole(json, "hints", stabs->hints);
    enf_json_whole(json, "zero_by_double", stabs->zero_by_double);
    enf_json_whole(json, "zero_by_whole", stabs->zero_by_whole);
    enf_json_whole(json, "programs", stabs->programs);
    enf_json_whole(json, "searched", stabs->searched);
    enf_json_whole(json, "quadrics", stabs->quadrics);
    enf_json_whole(json, "quadrics_hidden", stabs->quadrics_hidden);
    enf_json_whole(json, "undecided", stabs->undecided);
    enf_json_whole(json, "lines_fine", stabs->lines_fine);
    enf_json_whole(json, "lines_long", stabs->lines_long);
    enf_json_whole(json, "lines_missing", stabs->lines_missing);
    enf_json_whole(json, "orders", stabs->orders);
    enf_json_whole(json, "orders_hidden", stabs->orders_hidden);
    enf_json_whole(json, "orders_open", stabs->orders_open);
    enf_json_begin_array(json, "program_sizes");
    json->one_line = true;
    for (int i = 0; i < ENF_STAB_SIZES; i++) enf_json_whole(json, NULL, stabs->sizes[i]);
    enf_json_end_array(json);
    json->one_line = false;
    enf_json_end_object(json);
}

static void put_visibility(enf_json *json, const enf_visibility *visibility) {
    enf_json_begin_object(json, "pvs");
    enf_json_text(json, "method", enf_method_name(visibility->method));
    enf_json_whole(json, "pairs", enf_pvs_pairs(&visibility->pvs));
    enf_json_number(json, "mean_seen", enf_pvs_mean_seen(&visibility->pvs));
    enf_json_whole(json, "witnesses", visibility->witness_count);
    enf_json_whole(json, "portal_pairs", visibility->portal_pairs);
    enf_json_whole(json, "visits", visibility->visits);
    enf_json_whole(json, "lines", visibility->lines);
    enf_json_whole(json, "body_visits", visibility->body_visits);
    enf_json_whole(json, "pairs_open", visibility->pairs_open);
    enf_json_whole(json, "nodes", visibility->nodes);
    put_stabs(json, &visibility->stabs);
    enf_json_whole(json, "jobs_stored", visibility->jobs_stored);
    enf_json_whole(json, "cells_budgeted", visibility->cells_budgeted);
    enf_json_whole(json, "pairs_budgeted", visibility->pairs_budgeted);
    enf_json_whole(json, "sequence_longest", visibility->sequence_longest);
    put_lengths(json, visibility);
    enf_json_number(json, "seconds", visibility->seconds);
    enf_json_number(json, "cpu_seconds", visibility->cpu_seconds);
    enf_json_end_object(json);
}

static void put_options(enf_json *json, const enf_visibility_options *options) {
    enf_json_begin_object(json, "options");
    enf_json_text(json, "method", enf_method_name(options->method));
    enf_json_bool(json, "witness", options->want_witnesses);
    if (options->budget_seconds > 0)
        enf_json_number(json, "budget", options->budget_seconds);
    else
        enf_json_null(json, "budget");
    enf_json_end_object(json);
}

void cli_pvs_report_json(const cli_pvs_result *result, FILE *out) {
    enf_json json = {.file = out};
    enf_json_begin_object(&json, NULL);
    enf_json_text(&json, "program", "enfilade " ENF_VERSION_TEXT);
    put_input(&json, result);
    enf_json_whole(&json, "leafs", result->leaf_count);
    enf_json_whole(&json, "cells", result->cell_count);
    enf_json_whole(&json, "portals", result->portal_count);
    enf_json_whole(&json, "non_convex_cells", result->graph.non_convex_cells);
    put_visibility(&json, &result->visibility);
    enf_json_number(&json, "seconds", result->seconds);
    enf_json_whole(&json, "peak_bytes", (int64_t)result->peak_bytes);
    enf_json_whole(&json, "threads", result->options.threads);
    enf_json_whole(&json, "processes", result->processes);
    put_options(&json, &result->options);
    enf_json_end_object(&json);
    enf_json_finish(&json);
}

bool cli_pvs_is_late(const cli_pvs_result *result) {
    return result->visibility.cells_budgeted + result->visibility.pairs_budgeted > 0;
}

void cli_pvs_report_summary(const cli_pvs_result *result, const char *output, FILE *out) {
    const enf_visibility *visibility = &result->visibility;
    const char *checkpoint = result->options.checkpoint;
    fprintf(out,
            "%s: %" PRId32 " cells, %" PRId32 " portals; by %s %" PRId64
            " pairs, a cell sees %.1f on average; %.2f s, %.0f MB\n",
            output, result->cell_count, result->portal_count, enf_method_name(visibility->method),
            enf_pvs_pairs(&visibility->pvs), enf_pvs_mean_seen(&visibility->pvs), result->seconds,
            (double)result->peak_bytes / 1e6);
    if (cli_pvs_is_late(result))
        fprintf(out,
                "the budget of %g s ran out for the beams of %" PRId64 " cells and for %" PRId64
                " pairs: what might be seen counts as seen; a larger --budget tells more%s%s\n",
                result->options.budget_seconds, visibility->cells_budgeted, visibility->pairs_budgeted,
                checkpoint ? ", and goes on from " : "", checkpoint ? checkpoint : "");
}

void cli_pvs_report_verbose(const cli_pvs_result *result, FILE *out) {
    const enf_visibility *visibility = &result->visibility;
    fprintf(out, "visibility     %8.3f s, %.3f s of processor time on %d threads", visibility->seconds,
            visibility->cpu_seconds, result->options.threads);
    fprintf(out, result->processes > 1 ? " of rank 0 of %d\n" : "\n", result->processes);
    if (result->options.checkpoint)
        fprintf(out, "checkpoint     %8" PRId64 " results were there already\n", visibility->jobs_stored);
    fprintf(out, "beams          %8" PRId64 " portal pairs by %" PRId64 " visits; %" PRId64 " sight lines\n",
            visibility->portal_pairs, visibility->visits + visibility->body_visits, visibility->lines);
    fprintf(out,
            "sequences      %8" PRId64 " open pairs of cells by %" PRId64 " nodes, of which %" PRId64
            " were decided, %" PRId64 " in whole numbers; the longest line passes %" PRId32 " portals\n",
            visibility->pairs_open, visibility->nodes, visibility->stabs.calls,
            visibility->stabs.zero_by_whole + visibility->stabs.programs + visibility->stabs.quadrics,
            visibility->sequence_longest);
    if (result->options.want_witnesses)
        fprintf(out, "witnesses      %8" PRId64 "\n", visibility->witness_count);
}
