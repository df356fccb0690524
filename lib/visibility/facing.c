// SPDX-License-Identifier: GPL-3.0-or-later
// Floods from each portal, as level compilers do for a first bound (J. Carmack's vis, 1996). A second flood,
// through pairs that the first found from both sides, takes off more.
#include "visibility/facing.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

typedef struct search {
    const enf_shapes *shapes;
    const enf_bits *before; ///< what an earlier flood found, or null
    enf_bits *found;
    int32_t **queues;
} search;

/// Is some of the opening higher than the portal's plane (side 1), or lower (side -1)?
static bool has_corner(const enf_shapes *shapes, int32_t portal, int32_t opening, double side) {
    const enf_shape *shape = &shapes->shapes[opening];
    double middle = side * enf_shape_height(shapes, portal, shape->centre);
    if (middle > shapes->tolerance) return true;
    if (middle + shape->radius <= shapes->tolerance) return false;
    const double(*corners)[3] = enf_shape_outline(shapes, opening);
    for (int32_t i = 0; i < shape->count; i++)
        if (side * enf_shape_height(shapes, portal, corners[i]) > shapes->tolerance) return true;
    return false;
}

/// Could a line pass the one portal and then the other?
static bool is_facing(const enf_shapes *shapes, int32_t portal, int32_t other) {
    return portal >> 1 != other >> 1 && has_corner(shapes, portal, other >> 1, 1) &&
           has_corner(shapes, other, portal >> 1, -1);
}

/// In the first flood each pair is looked at once: what fails is remembered, too.
static void flood(const search *search, int32_t portal, int32_t *queue) {
    const enf_portal_graph *graph = search->shapes->graph;
    uint64_t *row = enf_bits_row(search->found, portal);
    const uint64_t *before = search->before ? enf_bits_row(search->before, portal) : NULL;
    int32_t count = 0;
    queue[count++] = portal;
    for (int32_t at = 0; at < count; at++) {
        int32_t via = queue[at], cell = enf_portal_to(graph, via);
        const uint64_t *via_before = search->before ? enf_bits_row(search->before, via) : NULL;
        for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++) {
            int32_t next = graph->cell_portals[k];
            if (next >> 1 == via >> 1 || enf_bit_get(row, next)) continue;
            bool good = before ? enf_bit_get(before, next) && enf_bit_get(via_before, next)
                               : is_facing(search->shapes, portal, next) &&
                                     (via == portal || is_facing(search->shapes, via, next));
            if (!good) continue;
            enf_bit_set(row, next);
            queue[count++] = next;
        }
    }
}

static void flood_job(void *user, int32_t index, int thread) {
    const search *search = user;
    flood(search, index, search->queues[thread]);
}

void enf_facing_symmetrise(enf_bits *bits) {
    for (int32_t p = 0; p < bits->row_count; p++) {
        uint64_t *row = enf_bits_row(bits, p);
        for (int32_t q = -1; (q = enf_bit_next(row, bits->row_words, q + 1)) >= 0;)
            if (!enf_bit_get(enf_bits_row(bits, q ^ 1), p ^ 1)) enf_bit_clear(row, q);
    }
}

static enf_status flood_all(search *search, const enf_crew *crew, enf_error *error) {
    if (!enf_parallel_for(crew, search->found->row_count, flood_job, search))
        return enf_fail(error, ENF_NO_RESOURCES, "cancelled");
    enf_facing_symmetrise(search->found);
    return ENF_OK;
}

static bool make_queues(search *search, int threads) {
    size_t portals = 2 * (size_t)search->shapes->graph->opening_count;
    search->queues = enf_array_zeroed((size_t)threads, sizeof *search->queues);
    for (int i = 0; search->queues && i < threads; i++)
        if (!(search->queues[i] = enf_array_new(portals + 1, sizeof **search->queues))) return false;
    return search->queues != NULL;
}

static void free_queues(search *search, int threads) {
    for (int i = 0; search->queues && i < threads; i++) free(search->queues[i]);
    free(search->queues);
}

enf_status enf_facing_find(enf_bits *facing, const enf_shapes *shapes, const enf_crew *crew,
                           enf_error *error) {
    int32_t portals = 2 * shapes->graph->opening_count;
    enf_bits first = {0};
    search search = {.shapes = shapes, .found = &first};
    bool good = enf_bits_new(facing, portals, portals) && enf_bits_new(&first, portals, portals) &&
                make_queues(&search, crew->threads);
    enf_status status = good ? ENF_OK : enf_fail_memory(error, "the portals that face each other");
    if (!status) status = flood_all(&search, crew, error);
    search.before = &first;
    search.found = facing;
    if (!status) status = flood_all(&search, crew, error);
    free_queues(&search, crew->threads);
    enf_bits_free(&first);
    return status;
}
