// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/settle.h"

#include "base/array.h"
#include "base/hash.h"
#include "visibility/coding.h"
#include "visibility/flow.h"

#include <stdlib.h>
#include <string.h>

/// What one thread has.
typedef struct settler {
    enf_flow *flow;
    enf_sightings *sightings;
    bool failed; ///< no memory for a sighting
} settler;

/// What it took to settle a cell.
typedef struct settle_result {
    int64_t nodes;
    enf_stab_counts stabs;
} settle_result;

enum { RESULT_COUNTS = sizeof(settle_result) / sizeof(int64_t) };
_Static_assert(sizeof(settle_result) == RESULT_COUNTS * sizeof(int64_t), "a result is made of counts");

typedef struct settling {
    enf_settlement *settlement;
    enf_sightings *sightings;
    enf_bits targets;       ///< bit j of row i: whether cells i and j see each other is for i to find out
    int64_t *work;          ///< per cell: how much of that there may be
    int64_t *cost;          ///< per cell: how much there is
    int32_t *first;         ///< per cell: sightings that were there before
    settle_result *results; ///< per cell
    bool *begun;            ///< per cell
    bool *late;             ///< per cell: it was begun, but targets were left when time was over
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

/// A cell takes the longer the more it may see, and the more of it is to be found out.
static void find_cost(settling *settling) {
    for (int32_t i = 0; i < settling->targets.row_count; i++) {
        int64_t targets = enf_bits_count(enf_bits_row(&settling->targets, i), settling->targets.row_words);
        settling->cost[i] = targets * (settling->work[i] + 1);
        settling->first[i] = settling->sightings->cells[i].count;
    }
}

// ---------------------------------------------------------------------------------------------- jobs

static void note(void *user, int32_t from, int32_t to, const enf_stab *stab, int32_t portals) {
    settler *settler = user;
    const enf_sighting sighting = {to, portals};
    const enf_line *line = stab->has_line ? &stab->line : NULL;
    if (!enf_sightings_add_long(settler->sightings, from, &sighting, line, stab->long_line))
        settler->failed = true;
}

static void add_counts(settle_result *sum, const settle_result *counts, int sign) {
    int64_t numbers[RESULT_COUNTS], more[RESULT_COUNTS];
    memcpy(numbers, sum, sizeof numbers);
    memcpy(more, counts, sizeof more);
    for (int i = 0; i < RESULT_COUNTS; i++) numbers[i] += sign * more[i];
    memcpy(sum, numbers, sizeof numbers);
}

static settle_result counts_of(const enf_flow *flow) {
    return (settle_result){enf_flow_nodes(flow), *enf_flow_stabs(flow)};
}

static enf_status run_cell(void *user, int32_t cell, int thread, bool *late, enf_error *error) {
    const settling *settling = user;
    settler *settler = &settling->settlers[thread];
    settle_result before = counts_of(settler->flow), after;
    enf_status status =
        enf_flow_settle(settler->flow, cell, enf_bits_row(&settling->targets, cell), late, error);
    if (!status && settler->failed) status = enf_fail_memory(error, "the sight lines");
    after = counts_of(settler->flow);
    add_counts(&after, &before, -1);
    settling->results[cell] = after;
    settling->late[cell] = *late;
    return status;
}

static void encode_cell(void *user, int32_t cell, enf_bytes *bytes) {
    const settling *settling = user;
    int64_t counts[RESULT_COUNTS];
    memcpy(counts, &settling->results[cell], sizeof counts);
    enf_put_number(bytes, settling->late[cell]);
    enf_put_counts(bytes, counts, RESULT_COUNTS);
    enf_put_sightings(bytes, settling->sightings, cell, settling->first[cell]);
}

/// Only targets can have been seen.
static bool decode_cell(void *user, int32_t cell, enf_reader *reader) {
    const settling *settling = user;
    const enf_cell_sightings *of = &settling->sightings->cells[cell];
    uint64_t *targets = enf_bits_row(&settling->targets, cell);
    int64_t counts[RESULT_COUNTS];
    settling->late[cell] = enf_take_number(reader, 1);
    enf_take_counts(reader, counts, RESULT_COUNTS);
    memcpy(&settling->results[cell], counts, sizeof counts);
    if (!enf_take_sightings(reader, settling->sightings, cell)) return false;
    for (int32_t k = settling->first[cell]; k < of->count; k++) {
        if (!enf_bit_get(targets, of->sightings[k].cell)) reader->failed = true;
        enf_bit_clear(targets, of->sightings[k].cell);
    }
    return true;
}

// ---------------------------------------------------------------------------------------------- all

/// Targets that cells had no time for count as seen.
static bool add_late(settling *settling) {
    for (int32_t i = 0; i < settling->targets.row_count; i++) {
        const uint64_t *row = enf_bits_row(&settling->targets, i);
        if (settling->begun[i] && !settling->late[i]) continue; // what is left there is hidden
        for (int32_t j = -1; (j = enf_bit_next(row, settling->targets.row_words, j + 1)) >= 0;) {
            const enf_sighting sighting = {j, 0};
            settling->settlement->pairs_budgeted++;
            if (!enf_sightings_add(settling->sightings, i, &sighting, NULL)) return false;
        }
    }
    return true;
}

static bool make_settling(settling *settling, const enf_workplace *place) {
    int threads = place->crew.threads;
    const enf_settlement *settlement = settling->settlement;
    size_t cells = (size_t)settlement->shapes->graph->cell_count;
    settling->work = enf_array_zeroed(cells, sizeof *settling->work);
    settling->cost = enf_array_zeroed(cells, sizeof *settling->cost);
    settling->first = enf_array_zeroed(cells, sizeof *settling->first);
    settling->results = enf_array_zeroed(cells, sizeof *settling->results);
    settling->begun = enf_array_zeroed(cells, sizeof *settling->begun);
    settling->late = enf_array_zeroed(cells, sizeof *settling->late);
    settling->settlers = enf_array_zeroed((size_t)threads, sizeof *settling->settlers);
    if (!enf_bits_new(&settling->targets, (int32_t)cells, (int32_t)cells) || !settling->work ||
        !settling->cost || !settling->first || !settling->results || !settling->begun || !settling->late ||
        !settling->settlers)
        return false;
    for (int i = 0; i < threads; i++) {
        settler *settler = &settling->settlers[i];
        settler->sightings = settling->sightings;
        settler->flow = enf_flow_new(&(enf_flow_options){.shapes = settlement->shapes,
                                                         .beams = settlement->beams,
                                                         .pluecker = settlement->pluecker,
                                                         .exact = settlement->exact,
                                                         .deadline = place->deadline,
                                                         .seen = note,
                                                         .user = settler});
        if (!settler->flow) return false;
    }
    return true;
}

static void free_settling(settling *settling, int threads) {
    for (int i = 0; settling->settlers && i < threads; i++) enf_flow_free(settling->settlers[i].flow);
    free(settling->settlers);
    free(settling->work);
    free(settling->cost);
    free(settling->first);
    free(settling->results);
    free(settling->begun);
    free(settling->late);
    enf_bits_free(&settling->targets);
}

/// What jobs go by: other beams or other sightings make other jobs.
static uint64_t find_key(const settling *settling) {
    const enf_bits *beams = settling->settlement->beams, *seen = &settling->sightings->seen;
    uint64_t key = enf_hash64(beams->words, (size_t)beams->row_count * beams->row_words * 8, 0);
    return enf_hash64(seen->words, (size_t)seen->row_count * seen->row_words * 8, key);
}

static enf_status settle_all(settling *settling, enf_workplace *place, enf_error *error) {
    settle_result sum = {0};
    enf_settlement *settlement = settling->settlement;
    int32_t cells = settlement->shapes->graph->cell_count;
    count_work(settling);
    find_targets(settling);
    find_cost(settling);
    const enf_work work = {.stage = ENF_STAGE_SETTLE,
                           .key = find_key(settling),
                           .cell_count = cells,
                           .cost = settling->cost,
                           .user = settling,
                           .run = run_cell,
                           .encode = encode_cell,
                           .decode = decode_cell};
    enf_status status = enf_work_run(&work, place, settling->begun, error);
    if (status) return status;
    for (int32_t i = 0; i < cells; i++) add_counts(&sum, &settling->results[i], 1);
    settlement->nodes = sum.nodes;
    settlement->stabs = sum.stabs;
    return add_late(settling) ? ENF_OK : enf_fail_memory(error, "the sight lines");
}

enf_status enf_settle_run(enf_settlement *settlement, enf_sightings *sightings, enf_workplace *place,
                          enf_error *error) {
    settling settling = {.settlement = settlement, .sightings = sightings};
    enf_status status = make_settling(&settling, place) ? settle_all(&settling, place, error)
                                                        : enf_fail_memory(error, "the portal sequences");
    free_settling(&settling, place->crew.threads);
    return status;
}
