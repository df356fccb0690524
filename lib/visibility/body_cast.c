// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/body_cast.h"

#include "base/array.h"
#include "base/hash.h"
#include "base/timer.h"
#include "visibility/body_beams.h"
#include "visibility/coding.h"

#include <stdlib.h>

/// What is known of an owner, besides the row.
typedef struct cast_result {
    bool late; ///< there was no time
    int64_t visits;
} cast_result;

typedef struct casting {
    enf_body_cast *cast;
    double deadline;
    enf_body_ways ways;
    enf_body_beams **beams; ///< per thread
    cast_result *results;   ///< per owner
    int64_t *cost;          ///< per owner: the portals of its cells
    bool *begun;            ///< per owner
} casting;

// ---------------------------------------------------------------------------------------------- jobs

static enf_status run_owner(void *user, int32_t owner, int thread, bool *late, enf_error *error) {
    const casting *casting = user;
    const enf_body_cast *cast = casting->cast;
    enf_body_beams *beams = casting->beams[thread];
    cast_result *result = &casting->results[owner];
    int64_t visits = enf_body_beams_visits(beams);
    *late = result->late = !cast->by_facing && enf_timer_now() > casting->deadline;
    if (result->late || cast->by_facing)
        enf_body_beams_face(beams, owner, enf_bits_row(&cast->met, owner));
    else
        enf_body_beams_cast(beams, owner, enf_bits_row(&cast->met, owner));
    result->visits = enf_body_beams_visits(beams) - visits;
    (void)error;
    return ENF_OK;
}

static void encode_owner(void *user, int32_t owner, enf_bytes *bytes) {
    const casting *casting = user;
    const enf_bits *met = &casting->cast->met;
    enf_put_number(bytes, casting->results[owner].late);
    enf_put_number(bytes, (uint64_t)casting->results[owner].visits);
    enf_put_row(bytes, enf_bits_row(met, owner), met->row_words);
}

static bool decode_owner(void *user, int32_t owner, enf_reader *reader) {
    const casting *casting = user;
    const enf_bits *met = &casting->cast->met;
    casting->results[owner].late = enf_take_number(reader, 1);
    casting->results[owner].visits = (int64_t)enf_take_number(reader, ENF_COUNT_MOST);
    enf_take_row(reader, enf_bits_row(met, owner), met->row_count);
    return true;
}

// ---------------------------------------------------------------------------------------------- all

static bool make_casting(casting *casting, int threads) {
    enf_body_cast *cast = casting->cast;
    const int32_t owners = cast->bodies->owner_count;
    casting->results = enf_array_zeroed((size_t)owners, sizeof *casting->results);
    casting->cost = enf_array_zeroed((size_t)owners, sizeof *casting->cost);
    casting->begun = enf_array_zeroed((size_t)owners, sizeof *casting->begun);
    casting->beams = enf_array_zeroed((size_t)threads, sizeof(enf_body_beams *));
    if (!enf_bits_new(&cast->met, owners, owners) ||
        !enf_body_ways_make(&casting->ways, cast->shapes, cast->bodies, cast->order) || !casting->results ||
        !casting->cost || !casting->begun || !casting->beams)
        return false;
    for (int i = 0; i < threads; i++) {
        casting->beams[i] = enf_body_beams_new(&casting->ways);
        if (!casting->beams[i]) return false;
    }
    return true;
}

static void free_casting(casting *casting, int threads) {
    for (int i = 0; casting->beams && i < threads; i++) enf_body_beams_free(casting->beams[i]);
    free(casting->beams);
    free(casting->results);
    free(casting->cost);
    free(casting->begun);
    enf_body_ways_free(&casting->ways);
}

static void find_cost(const casting *casting) {
    const enf_portal_graph *graph = casting->cast->shapes->graph;
    const enf_bodies *bodies = casting->cast->bodies;
    for (int32_t o = 0; o < bodies->owner_count; o++)
        for (int32_t k = bodies->owner_first[o]; k < bodies->owner_first[o + 1]; k++) {
            const int32_t *portals = &graph->cell_portal[bodies->cells[k]];
            casting->cost[o] += 1 + portals[1] - portals[0];
        }
}

static void sum_up(const casting *casting) {
    enf_body_cast *cast = casting->cast;
    for (int32_t o = 0; o < cast->bodies->owner_count; o++) {
        bool none = casting->cost[o] > 0 && !casting->begun[o];
        if (none) enf_body_beams_face(casting->beams[0], o, enf_bits_row(&cast->met, o));
        cast->visits += casting->results[o].visits;
        cast->owners_budgeted += none || casting->results[o].late;
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

/// What the results depend on, besides the graph.
static uint64_t find_key(const enf_body_cast *cast) {
    const enf_bodies *bodies = cast->bodies;
    const size_t corners = (size_t)bodies->corner_first[bodies->count] * sizeof *bodies->corners;
    uint64_t key = enf_hash64(bodies->owner, (size_t)bodies->count * sizeof *bodies->owner, 0);
    key = enf_hash64(bodies->corners, corners, key);
    for (int32_t i = 0; cast->order && i < cast->order->node_count; i++) {
        const enf_air_order_node *node = &cast->order->nodes[i];
        key = enf_hash64(node->normal, sizeof node->normal, key);
        key = enf_hash64(&node->above, sizeof node->above, key);
    }
    return key;
}

enf_status enf_body_cast_run(enf_body_cast *cast, enf_workplace *place, enf_error *error) {
    casting casting = {.cast = cast, .deadline = place->deadline};
    int threads = place->crew.threads;
    bool made = make_casting(&casting, threads);
    enf_status status = made ? ENF_OK : enf_fail_memory(error, "the beams");
    if (!status) {
        find_cost(&casting);
        const enf_work work = {.stage = ENF_STAGE_BODIES,
                               .key = find_key(cast),
                               .cell_count = cast->bodies->owner_count,
                               .cost = casting.cost,
                               .user = &casting,
                               .run = run_owner,
                               .encode = encode_owner,
                               .decode = decode_owner};
        status = enf_work_run(&work, place, casting.begun, error);
    }
    if (!status) sum_up(&casting);
    free_casting(&casting, threads);
    if (!status) symmetrise(&cast->met);
    return status;
}
