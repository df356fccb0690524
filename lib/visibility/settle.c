// SPDX-License-Identifier: GPL-3.0-or-later
#ifndef _GNU_SOURCE
#define _GNU_SOURCE // qsort_r
#endif
#include "visibility/settle.h"

#include "base/array.h"
#include "base/timer.h"
#include "visibility/flow.h"

#include <stdlib.h>
#include <string.h>

/// What one thread has.
typedef struct settler {
    enf_flow *flow;
    enf_sightings *sightings;
    enf_error error;
    bool failed;
} settler;

typedef struct settling {
    enf_settlement *settlement;
    enf_sightings *sightings;
    enf_bits targets; ///< bit j of row i: whether cells i and j see each other is for i to find out
    int64_t *work;    ///< per cell: how much of that there is
    int32_t *order;   ///< cells, the longest work first
    bool *done;       ///< per cell
    settler *settlers;
} settling;

// ---------------------------------------------------------------------------------------------- whose turn

/// How much work a cell is: portals that it may see, its targets.
static void count_work(settling *settling) {
    const enf_portal_graph *graph = settling->settlement->shapes->graph;
    const enf_bits *beams = settling->settlement->beams;
    for (int32_t c = 0; c < graph->cell_count; c++)
        for (int32_t k = graph->cell_portal[c]; k < graph->cell_portal[c + 1]; k++)
            settling->work[c] +=
                enf_bits_count(enf_bits_row(beams, graph->cell_portals[k]), beams->row_words);
}

/// The lowest corner of the cell's portals: a way to tell cells apart that does not depend on their numbers.
static void find_lowest(const enf_portal_graph *graph, int32_t cell, const double **lowest) {
    *lowest = NULL;
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++) {
        int32_t opening = graph->cell_portals[k] >> 1;
        for (int32_t i = graph->opening_corner[opening]; i < graph->opening_corner[opening + 1]; i++) {
            const double *corner = graph->corners[i];
            int axis = 0;
            while (*lowest && axis < 2 && corner[axis] == (*lowest)[axis]) axis++;
            if (!*lowest || corner[axis] < (*lowest)[axis]) *lowest = corner;
        }
    }
}

/// Which of two cells finds out? The one with less to look at.
static bool is_asker(const settling *settling, int32_t cell, int32_t other) {
    if (settling->work[cell] != settling->work[other]) return settling->work[cell] < settling->work[other];
    const double *mine, *theirs;
    find_lowest(settling->settlement->shapes->graph, cell, &mine);
    find_lowest(settling->settlement->shapes->graph, other, &theirs);
    for (int axis = 0; mine && theirs && axis < 3; axis++)
        if (mine[axis] != theirs[axis]) return mine[axis] < theirs[axis];
    return cell < other;
}

static void find_targets(settling *settling) {
    enf_settlement *settlement = settling->settlement;
    for (int32_t i = 0; i < settling->targets.row_count; i++) {
        const uint64_t *may = enf_bits_row(settlement->cells, i),
                       *seen = enf_bits_row(&settling->sightings->seen, i);
        for (int32_t j = -1; (j = enf_bit_next(may, settlement->cells->row_words, j + 1)) >= 0;) {
            if (j == i || enf_bit_get(seen, j) || !is_asker(settling, i, j)) continue;
            enf_bit_set(enf_bits_row(&settling->targets, i), j);
            settlement->pairs++;
        }
    }
}

static int compare_work(const void *a, const void *b, void *user) {
    const int64_t *work = user;
    int32_t cell_a = *(const int32_t *)a, cell_b = *(const int32_t *)b;
    if (work[cell_a] != work[cell_b]) return work[cell_a] > work[cell_b] ? -1 : 1;
    return cell_a < cell_b ? -1 : 1;
}

// ---------------------------------------------------------------------------------------------- jobs

static void note(void *user, int32_t from, int32_t to, const enf_stab *stab, int32_t portals) {
    settler *settler = user;
    const enf_sighting sighting = {to, portals};
    const enf_line *line = stab->has_line ? &stab->line : NULL;
    if (!enf_sightings_add_long(settler->sightings, from, &sighting, line, stab->long_line))
        settler->failed = true;
}

static void settle_job(void *user, int32_t index, int thread) {
    const settling *settling = user;
    settler *settler = &settling->settlers[thread];
    int32_t cell = settling->order[index];
    if (settler->failed || enf_timer_now() > settling->settlement->deadline) return;
    if (enf_flow_settle(settler->flow, cell, enf_bits_row(&settling->targets, cell), &settler->error))
        settler->failed = true;
    settling->done[cell] = true;
}

/// Cells that were too late still have their targets: all of them count as seen.
static bool add_late(settling *settling) {
    for (int32_t i = 0; i < settling->targets.row_count; i++) {
        const uint64_t *row = enf_bits_row(&settling->targets, i);
        for (int32_t j = -1;
             !settling->done[i] && (j = enf_bit_next(row, settling->targets.row_words, j + 1)) >= 0;) {
            const enf_sighting sighting = {j, 0};
            settling->settlement->pairs_budgeted++;
            if (!enf_sightings_add(settling->sightings, i, &sighting, NULL)) return false;
        }
    }
    return true;
}

static void add_stabs(enf_stab_counts *sum, const enf_stab_counts *counts) {
    sum->calls += counts->calls;
    sum->hints += counts->hints;
    sum->zero_by_double += counts->zero_by_double;
    sum->zero_by_whole += counts->zero_by_whole;
    sum->programs += counts->programs;
    sum->pivots += counts->pivots;
    sum->searched += counts->searched;
    sum->quadrics += counts->quadrics;
    sum->quadrics_hidden += counts->quadrics_hidden;
    sum->undecided += counts->undecided;
    sum->lines_fine += counts->lines_fine;
    sum->lines_long += counts->lines_long;
    sum->lines_missing += counts->lines_missing;
}

static bool make_settling(settling *settling, int threads) {
    const enf_settlement *settlement = settling->settlement;
    int32_t cells = settlement->shapes->graph->cell_count;
    settling->work = enf_array_zeroed((size_t)cells, sizeof *settling->work);
    settling->order = enf_array_new((size_t)cells, sizeof *settling->order);
    settling->done = enf_array_zeroed((size_t)cells, sizeof *settling->done);
    settling->settlers = enf_array_zeroed((size_t)threads, sizeof *settling->settlers);
    if (!enf_bits_new(&settling->targets, cells, cells) || !settling->work || !settling->order ||
        !settling->done || !settling->settlers)
        return false;
    for (int i = 0; i < threads; i++) {
        settler *settler = &settling->settlers[i];
        settler->sightings = settling->sightings;
        settler->flow = enf_flow_new(&(enf_flow_options){.shapes = settlement->shapes,
                                                         .beams = settlement->beams,
                                                         .pluecker = settlement->pluecker,
                                                         .exact = settlement->exact,
                                                         .seen = note,
                                                         .user = settler});
        if (!settler->flow) return false;
    }
    return true;
}

/// Sums up, and frees everything. False if a thread has failed; *error says why, if it does.
static bool end_settling(settling *settling, int threads, enf_error *error) {
    bool good = true;
    for (int i = 0; settling->settlers && i < threads; i++) {
        settler *settler = &settling->settlers[i];
        if (settler->flow) {
            settling->settlement->nodes += enf_flow_nodes(settler->flow);
            add_stabs(&settling->settlement->stabs, enf_flow_stabs(settler->flow));
        }
        if (settler->failed && good && error) *error = settler->error;
        good = good && !settler->failed;
        enf_flow_free(settler->flow);
    }
    free(settling->settlers);
    free(settling->work);
    free(settling->order);
    free(settling->done);
    enf_bits_free(&settling->targets);
    return good;
}

enf_status enf_settle_run(enf_settlement *settlement, enf_sightings *sightings, const enf_crew *crew,
                          enf_error *error) {
    settling settling = {.settlement = settlement, .sightings = sightings};
    int32_t cells = settlement->shapes->graph->cell_count;
    bool good = make_settling(&settling, crew->threads), done = true;
    if (good) {
        count_work(&settling);
        find_targets(&settling);
        for (int32_t i = 0; i < cells; i++) settling.order[i] = i;
        qsort_r(settling.order, (size_t)cells, sizeof *settling.order, compare_work, settling.work);
        done = enf_parallel_for(crew, cells, settle_job, &settling);
        good = !done || add_late(&settling);
    }
    enf_error failure = {0};
    good = end_settling(&settling, crew->threads, &failure) && good;
    if (!done) return enf_fail(error, ENF_NO_RESOURCES, "cancelled");
    if (good) return ENF_OK;
    return failure.status ? enf_fail(error, failure.status, "%s", failure.text)
                          : enf_fail_memory(error, "the portal sequences");
}
