// SPDX-License-Identifier: GPL-3.0-or-later
// Depth first through the portals, from each cell in turn.
#include "visibility_check/check_hidden.h"

#include "base/array.h"
#include "base/timer.h"
#include "visibility_check/hidden_search.h"

#include <stdlib.h>
#include <string.h>

enum { CLOCK_MASK = 255 };

static bool has(const uint64_t *row, int32_t cell) {
    return row[cell >> 6] >> (cell & 63) & 1;
}

static void set(uint64_t *row, int32_t cell) {
    row[cell >> 6] |= UINT64_C(1) << (cell & 63);
}

static const uint64_t *visible_row(const hidden_search *search, int32_t cell) {
    return search->visible + (size_t)cell * search->words;
}

// ---------------------------------------------------------------------------------------------- search

/// May a shortest line go on to a cell? Not to one that it has been in.
static bool was_passed(const hidden_search *search, int32_t depth, int32_t cell) {
    if (enf_portal_from(search->graph, search->stack[0].portal) == cell) return true;
    for (int32_t d = 0; d <= depth; d++)
        if (enf_portal_to(search->graph, search->stack[d].portal) == cell) return true;
    return false;
}

/// The mask of a frame at `depth`: its parent's, without what its cell does not see or lies behind its
/// portal. False if nothing of interest is left.
static bool make_mask(hidden_search *search, int32_t depth, int32_t portal) {
    uint64_t *mask = search->masks + (size_t)depth * search->words, wanted = 0;
    const uint64_t *facing = search->facing.rows + (size_t)portal * search->words;
    const uint64_t *visible = visible_row(search, enf_portal_to(search->graph, portal));
    for (size_t w = 0; w < search->words; w++) {
        mask[w] = facing[w] & visible[w];
        if (depth > 0) mask[w] &= mask[w - search->words];
        wanted |= mask[w] & search->targets[w];
    }
    return wanted != 0;
}

static bool reserve_frame(hidden_search *search, int32_t depth) {
    if (enf_array_reserve(search->stack, search->stack_capacity, (size_t)depth + 1) &&
        enf_array_reserve(search->masks, search->mask_capacity, ((size_t)depth + 1) * search->words))
        return true;
    search->failed = true;
    return false;
}

static void add_open(hidden_search *search, const enf_hidden_pair *found) {
    enf_hidden_report *report = search->report;
    if (!enf_array_reserve(report->open, report->open_capacity, report->open_count + 1)) {
        search->failed = true;
        return;
    }
    enf_hidden_pair *pair = &report->open[report->open_count++];
    *pair = *found;
    if (pair->cell[0] > pair->cell[1]) {
        pair->cell[0] = found->cell[1];
        pair->cell[1] = found->cell[0];
    }
}

/// Steps through a portal, from the frame at depth - 1. True if the search goes on behind it.
static bool step(hidden_search *search, int32_t source, int32_t depth, int32_t portal) {
    int32_t cell = enf_portal_to(search->graph, portal);
    bool target = has(search->targets, cell);
    if (!reserve_frame(search, depth)) return false;
    if (!target && !has(visible_row(search, source), cell)) return false;
    if (depth > 0) {
        if (!has(search->masks + (size_t)(depth - 1) * search->words, cell)) return false;
        if (was_passed(search, depth - 1, cell)) return false;
    }
    if (!target && !make_mask(search, depth, portal)) return false;
    hidden_frame *frame = &search->stack[depth];
    if (depth > 0)
        *frame = search->stack[depth - 1];
    else
        frame->column_count = 0;
    frame->next = search->graph->cell_portal[cell];
    search->report->sequences++;
    if (!hidden_search_program(search, frame, portal)) return false;
    if (!target) return true;
    enf_hidden_pair pair = {.seen = false};
    if (hidden_search_pieces(search, frame, &pair)) return false;
    search->targets[cell >> 6] &= ~(UINT64_C(1) << (cell & 63));
    add_open(search, &pair);
    return false;
}

static bool time_is_up(const hidden_search *search, double start) {
    double limit = search->options->seconds;
    return limit > 0 && (search->report->sequences & CLOCK_MASK) == 0 && enf_timer_cpu() - start > limit;
}

/// False when the time is up.
static bool search_from(hidden_search *search, int32_t source, double start) {
    const enf_portal_graph *graph = search->graph;
    hidden_search_edges(search, source);
    for (int32_t k = graph->cell_portal[source]; k < graph->cell_portal[source + 1]; k++) {
        int32_t depth = 0;
        if (!step(search, source, 0, graph->cell_portals[k])) continue;
        while (depth >= 0 && !search->failed) {
            hidden_frame *frame = &search->stack[depth];
            int32_t cell = enf_portal_to(graph, frame->portal);
            if (time_is_up(search, start)) return false;
            if (frame->next == graph->cell_portal[cell + 1])
                depth--;
            else if (step(search, source, depth + 1, graph->cell_portals[frame->next++]))
                depth++;
        }
    }
    return true;
}

// ---------------------------------------------------------------------------------------------- all cells

/// Each pair is looked at from the end that sees less. Returns how many are this source's.
static uint64_t choose_targets(hidden_search *search, int32_t source) {
    uint64_t count = 0;
    const uint64_t *row = visible_row(search, source), *only = search->options->only;
    if (only) only += (size_t)source * search->only_words;
    memset(search->targets, 0, search->words * sizeof *search->targets);
    for (int32_t cell = 0; cell < search->graph->cell_count; cell++) {
        int32_t mine = search->seen_count[source], other = search->seen_count[cell];
        if (cell == source || has(row, cell) || (only && !has(only, cell))) continue;
        if (mine > other || (mine == other && source > cell)) continue;
        set(search->targets, cell);
        count++;
    }
    return count;
}

static bool make_rows(hidden_search *search, const uint64_t *visible, size_t row_words) {
    int32_t cells = search->graph->cell_count;
    search->words = ((size_t)cells + 63) / 64;
    search->visible = enf_array_zeroed((size_t)cells, search->words * sizeof *search->visible);
    search->seen_count = enf_array_zeroed((size_t)cells, sizeof *search->seen_count);
    search->targets = enf_array_new(search->words, sizeof *search->targets);
    if (!search->visible || !search->seen_count || !search->targets) return false;
    for (int32_t i = 0; i < cells; i++)
        for (int32_t j = 0; j < cells; j++) {
            if (!has(visible + (size_t)i * row_words, j) && !has(visible + (size_t)j * row_words, i))
                continue;
            set(search->visible + (size_t)i * search->words, j);
            search->seen_count[i]++;
        }
    return true;
}

static bool make_search(hidden_search *search, const uint64_t *visible, size_t row_words) {
    const enf_portal_graph *graph = search->graph;
    size_t corners = graph->opening_count ? (size_t)graph->opening_corner[graph->opening_count] : 0;
    search->edge = enf_array_new(corners, sizeof *search->edge);
    search->corner_opening = enf_array_new(corners, sizeof *search->corner_opening);
    search->pieces.graph = graph;
    if (!search->edge || !search->corner_opening) return false;
    for (int32_t k = 0; k < graph->opening_count; k++)
        for (int32_t c = graph->opening_corner[k]; c < graph->opening_corner[k + 1]; c++)
            search->corner_opening[c] = k;
    return make_rows(search, visible, row_words) && enf_facing_cells_make(&search->facing, graph) &&
           enf_hidden_proof_make(&search->proof, graph) && enf_witness_checker_make(&search->witness, graph);
}

static void free_search(hidden_search *search) {
    enf_facing_cells_free(&search->facing);
    enf_hidden_proof_free(&search->proof);
    enf_hidden_pieces_free(&search->pieces);
    enf_witness_checker_free(&search->witness);
    free(search->visible);
    free(search->seen_count);
    free(search->edge);
    free(search->corner_opening);
    free(search->targets);
    free(search->stack);
    free(search->masks);
    free(search->columns);
    free(search->column_edge);
    free(search->sides);
}

static void search_all(hidden_search *search, double start) {
    enf_hidden_report *report = search->report;
    int32_t cells = search->graph->cell_count;
    report->ended = true;
    for (int32_t source = 0; source < cells && !search->failed; source++) {
        uint64_t count = choose_targets(search, source);
        report->claimed += count;
        if (report->ended && count > 0) report->ended = search_from(search, source, start);
        if (!report->ended) report->left += count;
        if (report->ended && search->options->progress)
            search->options->progress(search->options->user, source + 1, cells);
    }
    report->proofs = search->proof.computed - search->proof.failed;
    report->unproved = search->proof.failed;
    report->pieces = search->pieces.pieces;
    report->seconds = enf_timer_cpu() - start;
}

enf_status enf_check_hidden(const enf_portal_graph *graph, const uint64_t *visible, size_t row_words,
                            const enf_hidden_options *options, enf_hidden_report *report, enf_error *error) {
    hidden_search search = {.graph = graph, .options = options, .report = report, .only_words = row_words};
    double start = enf_timer_cpu();
    memset(report, 0, sizeof *report);
    bool made = make_search(&search, visible, row_words);
    if (made) search_all(&search, start);
    bool failed = !made || search.failed;
    free_search(&search);
    if (!failed) return ENF_OK;
    enf_hidden_report_free(report);
    return enf_fail_memory(error, "the check of hidden pairs");
}

void enf_hidden_report_free(enf_hidden_report *report) {
    free(report->open);
    memset(report, 0, sizeof *report);
}
