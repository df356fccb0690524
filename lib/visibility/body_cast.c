// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/body_cast.h"

#include "base/array.h"
#include "base/hash.h"
#include "base/timer.h"
#include "visibility/body_beams.h"
#include "visibility/coding.h"
#include "visibility/symmetry.h"

#include <stdlib.h>
#include <string.h>

/// What is known of a source, besides the row.
typedef struct cast_result {
    bool late; ///< there was no time
    int64_t visits;
} cast_result;

typedef struct casting {
    enf_body_cast *cast;
    double deadline;
    enf_body_ways ways;
    enf_body_beams **beams; ///< per thread
    cast_result *results;   ///< per source
    int64_t *cost;          ///< per source: the portals of its cells
    bool *begun;            ///< per source
} casting;

/// Where the row of a source is made: it is that of its first owner.
static uint64_t *row_of(const casting *casting, int32_t source) {
    const enf_sources *sources = &casting->ways.sources;
    return enf_bits_row(&casting->cast->met, sources->owners[sources->owner_first[source]]);
}

// ---------------------------------------------------------------------------------------------- jobs

static enf_status run_source(void *user, int32_t source, int thread, bool *late, enf_error *error) {
    const casting *casting = user;
    const enf_body_cast *cast = casting->cast;
    enf_body_beams *beams = casting->beams[thread];
    cast_result *result = &casting->results[source];
    int64_t visits = enf_body_beams_visits(beams);
    *late = result->late = !cast->by_facing && enf_timer_now() > casting->deadline;
    if (result->late || cast->by_facing)
        enf_body_beams_face(beams, source, row_of(casting, source));
    else
        enf_body_beams_cast(beams, source, row_of(casting, source));
    result->visits = enf_body_beams_visits(beams) - visits;
    (void)error;
    return ENF_OK;
}

static void encode_source(void *user, int32_t source, enf_bytes *bytes) {
    const casting *casting = user;
    const enf_bits *met = &casting->cast->met;
    enf_put_number(bytes, casting->results[source].late);
    enf_put_number(bytes, (uint64_t)casting->results[source].visits);
    enf_put_row(bytes, row_of(casting, source), met->row_words);
}

static bool decode_source(void *user, int32_t source, enf_reader *reader) {
    const casting *casting = user;
    const enf_bits *met = &casting->cast->met;
    casting->results[source].late = enf_take_number(reader, 1);
    casting->results[source].visits = (int64_t)enf_take_number(reader, ENF_COUNT_MOST);
    enf_take_row(reader, row_of(casting, source), met->row_count);
    return true;
}

// ---------------------------------------------------------------------------------------------- all

static bool make_casting(casting *casting, int threads) {
    enf_body_cast *cast = casting->cast;
    const int32_t owners = cast->bodies->owner_count;
    if (!enf_bits_new(&cast->met, owners, owners) ||
        !enf_body_ways_make(&casting->ways, cast->shapes, cast->bodies, cast->order))
        return false;
    const size_t sources = (size_t)casting->ways.sources.count;
    casting->results = enf_array_zeroed(sources, sizeof *casting->results);
    casting->cost = enf_array_zeroed(sources, sizeof *casting->cost);
    casting->begun = enf_array_zeroed(sources, sizeof *casting->begun);
    casting->beams = enf_array_zeroed((size_t)threads, sizeof(enf_body_beams *));
    if (!casting->results || !casting->cost || !casting->begun || !casting->beams) return false;
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
    const enf_sources *sources = &casting->ways.sources;
    for (int32_t s = 0; s < sources->count; s++)
        for (int32_t k = sources->cell_first[s]; k < sources->cell_first[s + 1]; k++) {
            const int32_t *portals = &graph->cell_portal[sources->cells[k]];
            casting->cost[s] += 1 + portals[1] - portals[0];
        }
}

/// The owners of a source have all that it has met.
static void share_row(const casting *casting, int32_t source) {
    const enf_sources *sources = &casting->ways.sources;
    const enf_bits *met = &casting->cast->met;
    const uint64_t *row = row_of(casting, source);
    for (int32_t i = sources->owner_first[source] + 1; i < sources->owner_first[source + 1]; i++)
        memcpy(enf_bits_row(met, sources->owners[i]), row, (size_t)met->row_words * sizeof *row);
}

static void sum_up(const casting *casting) {
    enf_body_cast *cast = casting->cast;
    const enf_sources *sources = &casting->ways.sources;
    for (int32_t s = 0; s < sources->count; s++) {
        const bool none = !casting->begun[s];
        if (none) enf_body_beams_face(casting->beams[0], s, row_of(casting, s));
        share_row(casting, s);
        cast->visits += casting->results[s].visits;
        if (none || casting->results[s].late)
            cast->owners_budgeted += sources->owner_first[s + 1] - sources->owner_first[s];
    }
}

/// What the results depend on, besides the graph; for checkpoints.
static uint64_t find_key(const casting *casting) {
    const enf_body_cast *cast = casting->cast;
    const enf_bodies *bodies = cast->bodies;
    const enf_sources *sources = &casting->ways.sources;
    const size_t corners = (size_t)bodies->corner_first[bodies->count] * sizeof *bodies->corners;
    uint64_t key = enf_hash64(bodies->owner, (size_t)bodies->count * sizeof *bodies->owner, 0);
    key = enf_hash64(bodies->corners, corners, key);
    key = enf_hash64(sources->owners, (size_t)sources->owner_first[sources->count] * sizeof(int32_t), key);
    key = enf_hash64(sources->owner_first, (size_t)sources->count * sizeof(int32_t), key);
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
                               .key = place->checkpoint ? find_key(&casting) : 0,
                               .cell_count = casting.ways.sources.count,
                               .cost = casting.cost,
                               .user = &casting,
                               .run = run_source,
                               .encode = encode_source,
                               .decode = decode_source};
        status = enf_work_run(&work, place, casting.begun, error);
    }
    if (!status) sum_up(&casting);
    free_casting(&casting, threads);
    if (!status) enf_symmetry_keep(&cast->met);
    return status;
}
