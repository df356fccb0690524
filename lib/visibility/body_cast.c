// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/body_cast.h"

#include "base/array.h"
#include "base/hash.h"
#include "base/timer.h"
#include "visibility/beams.h"
#include "visibility/coding.h"

#include <stdlib.h>

/// What is known of a cell's bodies, besides their rows.
typedef struct cast_result {
    bool late; ///< not all bodies had their turn
    int64_t visits;
} cast_result;

typedef struct casting {
    enf_body_cast *cast;
    double deadline;
    enf_beams **beams;    ///< per thread
    cast_result *results; ///< per cell
    int64_t *cost;        ///< per cell: its bodies, times the portals that face its own
    bool *begun;          ///< per cell
    enf_follows follows;
} casting;

static int32_t first_of(const casting *casting, int32_t cell) {
    return casting->cast->bodies->cell_first[cell];
}

// ---------------------------------------------------------------------------------------------- jobs

static void meet_cell(uint64_t *row, const enf_bodies *bodies, int32_t cell) {
    for (int32_t k = bodies->cell_first[cell]; k < bodies->cell_first[cell + 1]; k++) enf_bit_set(row, k);
}

/// For bodies that had no turn: they see what faces the portals of their cell.
static void meet_facing(const casting *casting, int32_t cell, int32_t body) {
    const enf_body_cast *cast = casting->cast;
    const enf_portal_graph *graph = cast->shapes->graph;
    uint64_t *met = enf_bits_row(&cast->met, body);
    meet_cell(met, cast->bodies, cell);
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++) {
        int32_t portal = graph->cell_portals[k];
        const uint64_t *row = enf_bits_row(cast->facing, portal);
        meet_cell(met, cast->bodies, enf_portal_to(graph, portal));
        for (int32_t q = -1; (q = enf_bit_next(row, cast->facing->row_words, q + 1)) >= 0;)
            meet_cell(met, cast->bodies, enf_portal_to(graph, q));
    }
}

static enf_status run_cell(void *user, int32_t cell, int thread, bool *late, enf_error *error) {
    const casting *casting = user;
    enf_beams *beams = casting->beams[thread];
    cast_result *result = &casting->results[cell];
    int64_t visits = enf_beams_visits(beams);
    for (int32_t k = first_of(casting, cell); k < first_of(casting, cell + 1); k++) {
        result->late = result->late || enf_timer_now() > casting->deadline;
        if (result->late)
            meet_facing(casting, cell, k);
        else
            enf_beams_cast_body(beams, casting->cast->bodies, cell, k, enf_bits_row(&casting->cast->met, k));
    }
    result->visits = enf_beams_visits(beams) - visits;
    *late = result->late;
    (void)error;
    return ENF_OK;
}

static void encode_cell(void *user, int32_t cell, enf_bytes *bytes) {
    const casting *casting = user;
    const enf_bits *met = &casting->cast->met;
    enf_put_number(bytes, casting->results[cell].late);
    enf_put_number(bytes, (uint64_t)casting->results[cell].visits);
    for (int32_t k = first_of(casting, cell); k < first_of(casting, cell + 1); k++)
        enf_put_row(bytes, enf_bits_row(met, k), met->row_words);
}

static bool decode_cell(void *user, int32_t cell, enf_reader *reader) {
    const casting *casting = user;
    const enf_bits *met = &casting->cast->met;
    casting->results[cell].late = enf_take_number(reader, 1);
    casting->results[cell].visits = (int64_t)enf_take_number(reader, ENF_COUNT_MOST);
    for (int32_t k = first_of(casting, cell); k < first_of(casting, cell + 1); k++)
        enf_take_row(reader, enf_bits_row(met, k), casting->cast->bodies->count);
    return true;
}

// ---------------------------------------------------------------------------------------------- all

static bool faces(const void *user, int32_t portal, int32_t next) {
    return enf_bit_get(enf_bits_row(user, portal), next);
}

static bool make_casting(casting *casting, int threads) {
    enf_body_cast *cast = casting->cast;
    const enf_portal_graph *graph = cast->shapes->graph;
    size_t cells = (size_t)graph->cell_count;
    casting->results = enf_array_zeroed(cells, sizeof *casting->results);
    casting->cost = enf_array_zeroed(cells, sizeof *casting->cost);
    casting->begun = enf_array_zeroed(cells, sizeof *casting->begun);
    casting->beams = enf_array_zeroed((size_t)threads, sizeof *casting->beams);
    if (!enf_bits_new(&cast->met, cast->bodies->count, cast->bodies->count) ||
        !enf_follows_make(&casting->follows, graph, faces, cast->facing) || !casting->results ||
        !casting->cost || !casting->begun || !casting->beams)
        return false;
    for (int i = 0; i < threads; i++) {
        casting->beams[i] = enf_beams_new(cast->shapes, cast->facing, &casting->follows);
        if (!casting->beams[i]) return false;
    }
    return true;
}

static void free_casting(casting *casting, int threads) {
    for (int i = 0; casting->beams && i < threads; i++) enf_beams_free(casting->beams[i]);
    free(casting->beams);
    free(casting->results);
    free(casting->cost);
    free(casting->begun);
    enf_follows_free(&casting->follows);
}

static void find_cost(casting *casting) {
    const enf_portal_graph *graph = casting->cast->shapes->graph;
    const enf_bits *facing = casting->cast->facing;
    for (int32_t p = 0; p < facing->row_count; p++)
        casting->cost[enf_portal_from(graph, p)] +=
            enf_bits_count(enf_bits_row(facing, p), facing->row_words);
    for (int32_t c = 0; c < graph->cell_count; c++)
        casting->cost[c] = (1 + casting->cost[c]) * (first_of(casting, c + 1) - first_of(casting, c));
}

static void sum_up(casting *casting) {
    enf_body_cast *cast = casting->cast;
    for (int32_t c = 0; c < cast->shapes->graph->cell_count; c++) {
        bool none = casting->cost[c] > 0 && !casting->begun[c];
        for (int32_t k = first_of(casting, c); none && k < first_of(casting, c + 1); k++)
            meet_facing(casting, c, k);
        cast->visits += casting->results[c].visits;
        cast->cells_budgeted += none || casting->results[c].late;
    }
}

/// Lines go both ways.
static void symmetrise(enf_bits *met) {
    for (int32_t i = 0; i < met->row_count; i++) {
        uint64_t *row = enf_bits_row(met, i);
        for (int32_t k = -1; (k = enf_bit_next(row, met->row_words, k + 1)) >= 0;)
            if (!enf_bit_get(enf_bits_row(met, k), i)) enf_bit_clear(row, k);
    }
}

enf_status enf_body_cast_run(enf_body_cast *cast, enf_workplace *place, enf_error *error) {
    casting casting = {.cast = cast, .deadline = place->deadline};
    int threads = place->crew.threads;
    enf_status status = make_casting(&casting, threads) ? ENF_OK : enf_fail_memory(error, "the beams");
    if (!status) {
        find_cost(&casting);
        const enf_bodies *bodies = cast->bodies;
        size_t size = (size_t)bodies->corner_first[bodies->count] * sizeof *bodies->corners;
        const enf_work work = {.stage = ENF_STAGE_BODIES,
                               .key = enf_hash64(bodies->corners, size, 0),
                               .cell_count = cast->shapes->graph->cell_count,
                               .cost = casting.cost,
                               .user = &casting,
                               .run = run_cell,
                               .encode = encode_cell,
                               .decode = decode_cell};
        status = enf_work_run(&work, place, casting.begun, error);
    }
    if (!status) sum_up(&casting);
    free_casting(&casting, threads);
    if (!status) symmetrise(&cast->met);
    return status;
}
