// SPDX-License-Identifier: GPL-3.0-or-later
// The recipe: each rung takes what the one above it has left. Sight lines prove most of what is visible on
// the way, so that the dear rungs have only the rest to settle.
#include "visibility/visibility.h"

#include "base/array.h"
#include "base/memory.h"
#include "base/timer.h"
#include "visibility/body_cast.h"
#include "visibility/cast.h"
#include "visibility/facing.h"
#include "visibility/settle.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char *const names[ENF_METHOD_COUNT] = {"reach", "facing", "hourglass", "lp", "exact"};

const char *enf_method_name(enf_method method) {
    return names[method];
}

bool enf_method_find(const char *name, enf_method *method) {
    for (int i = 0; i < ENF_METHOD_COUNT; i++) {
        if (strcmp(names[i], name) != 0) continue;
        *method = (enf_method)i;
        return true;
    }
    return false;
}

/// What the rungs leave for one another.
typedef struct ladder {
    const enf_portal_graph *graph;
    const enf_visibility_options *options;
    enf_visibility *visibility;
    enf_shapes shapes;
    enf_pluecker pluecker;
    enf_sight sight;
    enf_bits facing; ///< between portals
    enf_cast cast;
    enf_sightings sightings;
    enf_workplace place;
    const char *stage;
} ladder;

static bool watch(void *user, double fraction) {
    const ladder *ladder = user;
    return !ladder->options->progress ||
           ladder->options->progress(ladder->options->progress_user, ladder->stage, fraction);
}

static enf_workplace *place_for(ladder *ladder, const char *stage) {
    ladder->stage = stage;
    ladder->place.crew = (enf_crew){.threads = ladder->options->threads, .watch = watch, .user = ladder};
    return &ladder->place;
}

// ---------------------------------------------------------------------------------------------- reach

/// Gives every cell the number of its connected part.
static void number_parts(const enf_portal_graph *graph, int32_t *part, int32_t *queue) {
    for (int32_t c = 0; c < graph->cell_count; c++) part[c] = -1;
    for (int32_t first = 0; first < graph->cell_count; first++) {
        if (part[first] >= 0) continue;
        int32_t count = 0;
        part[first] = first;
        queue[count++] = first;
        for (int32_t at = 0; at < count; at++)
            for (int32_t k = graph->cell_portal[queue[at]]; k < graph->cell_portal[queue[at] + 1]; k++) {
                int32_t to = enf_portal_to(graph, graph->cell_portals[k]);
                if (part[to] >= 0) continue;
                part[to] = first;
                queue[count++] = to;
            }
    }
}

static enf_status reach(ladder *ladder, enf_error *error) {
    const enf_portal_graph *graph = ladder->graph;
    enf_pvs *pvs = &ladder->visibility->pvs;
    int32_t *part = enf_array_new(2 * (size_t)graph->cell_count, sizeof *part);
    if (!part) return enf_fail_memory(error, "the visible sets");
    number_parts(graph, part, part + graph->cell_count);
    for (int32_t i = 0; i < graph->cell_count; i++)
        for (int32_t j = 0; j < graph->cell_count; j++)
            if (part[i] == part[j]) enf_pvs_set(pvs, i, j);
    free(part);
    return ENF_OK;
}

// ---------------------------------------------------------------------------------------------- cells

/// A cell sees its neighbours, and what its portals see.
static void set_cells(const enf_portal_graph *graph, const enf_bits *portals, enf_pvs *pvs) {
    for (int32_t p = 0; p < 2 * graph->opening_count; p++) {
        int32_t from = enf_portal_from(graph, p);
        const uint64_t *row = enf_bits_row(portals, p);
        enf_pvs_set(pvs, from, enf_portal_to(graph, p));
        for (int32_t q = -1; (q = enf_bit_next(row, portals->row_words, q + 1)) >= 0;)
            enf_pvs_set(pvs, from, enf_portal_to(graph, q));
    }
}

static void set_seen(const enf_sightings *sightings, enf_pvs *pvs) {
    for (int32_t i = 0; i < pvs->cell_count; i++)
        for (int32_t k = 0; k < sightings->cells[i].count; k++)
            enf_pvs_set(pvs, i, sightings->cells[i].sightings[k].cell);
}

/// Neighbours see each other even where no line passes the portal between them.
static bool add_neighbours(enf_sightings *sightings, const enf_portal_graph *graph) {
    for (int32_t p = 0; p < 2 * graph->opening_count; p++) {
        int32_t from = enf_portal_from(graph, p);
        const enf_sighting sighting = {enf_portal_to(graph, p), 1};
        if (enf_bit_get(enf_bits_row(&sightings->seen, from), sighting.cell)) continue;
        if (!enf_sightings_add(sightings, from, &sighting, NULL)) return false;
    }
    return true;
}

// ---------------------------------------------------------------------------------------------- rungs

/// Two matrices of all portals at a time are most of what is needed; bodies that are not followed further
/// need one of their owners. A system that lends more memory than it has would kill us when they are filled.
static enf_status refuse_too_large(const enf_portal_graph *graph, const enf_visibility_options *options,
                                   enf_error *error) {
    const char *limiter;
    const bool is_by_owners = options->bodies && options->method <= ENF_METHOD_HOURGLASS;
    const double portals = 2.0 * graph->opening_count,
                 rows = is_by_owners ? options->bodies->owner_count : 2 * portals,
                 columns = is_by_owners ? options->bodies->owner_count : portals,
                 bytes = rows * columns / 8 + 2000 * portals * (is_by_owners ? options->threads : 1);
    if (bytes < (double)enf_memory_limit(&limiter)) return ENF_OK;
    return enf_fail(error, ENF_NO_RESOURCES,
                    "%" PRId32 " openings take %.3g MB, more than %s allows; split the world, or use reach",
                    graph->opening_count, bytes / 1e6, limiter);
}

static enf_status face(ladder *ladder, enf_error *error) {
    enf_workplace *place = place_for(ladder, "facing");
    if (!enf_pluecker_make(&ladder->pluecker, ladder->graph)) return enf_fail_memory(error, "the portals");
    const bool exactly = !ladder->options->bodies; // who asks for bodies has a partition, with a tolerance
    enf_status status = enf_facing_find(&ladder->facing, &ladder->shapes, exactly, &place->crew, error);
    if (!status && ladder->options->method == ENF_METHOD_FACING)
        set_cells(ladder->graph, &ladder->facing, &ladder->visibility->pvs);
    return status;
}

/// With bodies, beams come from those.
static enf_status cast_bodies(ladder *ladder, enf_error *error) {
    enf_visibility *visibility = ladder->visibility;
    const bool by_facing = ladder->options->method == ENF_METHOD_FACING;
    enf_workplace *place = place_for(ladder, by_facing ? "facing" : "hourglass");
    enf_body_cast cast = {.shapes = &ladder->shapes,
                          .bodies = ladder->options->bodies,
                          .order = ladder->options->order,
                          .by_facing = by_facing};
    enf_status status = enf_body_cast_run(&cast, place, error);
    visibility->met = cast.met;
    visibility->body_visits = cast.visits;
    visibility->cells_budgeted = cast.owners_budgeted;
    return status;
}

static bool wants_sightings(const enf_visibility_options *options) {
    return options->method > ENF_METHOD_HOURGLASS || options->want_witnesses;
}

static enf_status cast(ladder *ladder, enf_error *error) {
    const enf_visibility_options *options = ladder->options;
    enf_workplace *place = place_for(ladder, "hourglass");
    bool wants_lines = wants_sightings(options);
    if (!enf_sight_make(&ladder->sight, &ladder->shapes) ||
        !enf_sightings_new(&ladder->sightings, wants_lines ? ladder->graph->cell_count : 0,
                           options->want_witnesses))
        return enf_fail_memory(error, "the sight lines");
    ladder->cast = (enf_cast){.sight = &ladder->sight, .facing = &ladder->facing};
    enf_status status = enf_cast_run(&ladder->cast, wants_lines ? &ladder->sightings : NULL, place, error);
    enf_bits_free(&ladder->facing);
    if (status) return status;
    set_cells(ladder->graph, &ladder->cast.beams, &ladder->visibility->pvs);
    if (wants_lines && !enf_sightings_symmetrise(&ladder->sightings))
        return enf_fail_memory(error, "the sight lines");
    if (options->method == ENF_METHOD_HOURGLASS && wants_lines &&
        !add_neighbours(&ladder->sightings, ladder->graph))
        return enf_fail_memory(error, "the sight lines");
    return ENF_OK;
}

/// Leaves of the visible sets what has been seen.
static enf_status settle(ladder *ladder, enf_error *error) {
    enf_visibility *visibility = ladder->visibility;
    enf_pvs *pvs = &visibility->pvs;
    enf_workplace *place = place_for(ladder, enf_method_name(ladder->options->method));
    const enf_bits cells = {pvs->cell_count, pvs->row_words, pvs->rows};
    enf_settlement settlement = {.shapes = &ladder->shapes,
                                 .pluecker = &ladder->pluecker,
                                 .beams = &ladder->cast.beams,
                                 .cells = &cells,
                                 .exact = ladder->options->method == ENF_METHOD_EXACT};
    enf_status status = enf_settle_run(&settlement, &ladder->sightings, place, error);
    if (!status &&
        !(enf_sightings_symmetrise(&ladder->sightings) && add_neighbours(&ladder->sightings, ladder->graph)))
        status = enf_fail_memory(error, "the sight lines");
    if (status) return status;
    memset(pvs->rows, 0, (size_t)pvs->cell_count * pvs->row_words * sizeof *pvs->rows);
    for (int32_t i = 0; i < pvs->cell_count; i++) enf_pvs_set(pvs, i, i);
    set_seen(&ladder->sightings, pvs);
    visibility->pairs_open = settlement.pairs;
    visibility->pairs_budgeted = settlement.pairs_budgeted;
    visibility->nodes = settlement.nodes;
    visibility->stabs = settlement.stabs;
    return ENF_OK;
}

/// Takes the witnesses of pairs i < j, and counts the portals on the way.
static enf_status take_witnesses(ladder *ladder, enf_error *error) {
    enf_visibility *visibility = ladder->visibility;
    size_t capacity = 0, long_capacity = 0, cell_capacity = 0;
    for (int32_t i = 0; i < ladder->sightings.seen.row_count; i++) {
        const enf_cell_sightings *of = &ladder->sightings.cells[i];
        for (int32_t k = 0; k < of->count; k++) {
            if (of->sightings[k].cell < i || of->sightings[k].portals == 0) continue;
            int32_t portals = of->sightings[k].portals, most = ENF_SEQUENCE_LENGTHS - 1;
            if (visibility->sequence_longest < portals) visibility->sequence_longest = portals;
            visibility->sequence_lengths[portals < most ? portals : most]++;
            if (!ladder->sightings.keep_lines) continue;
            size_t count = (size_t)visibility->witness_count + 1;
            const enf_line *line = &of->lines[k];
            if (!of->long_lines[k] && memcmp(line->from, line->to, sizeof line->from) == 0) continue;
            if (!enf_array_reserve(visibility->witnesses, capacity, count) ||
                !enf_array_reserve(visibility->long_witnesses, long_capacity, count) ||
                !enf_array_reserve(visibility->witness_cells, cell_capacity, count))
                return enf_fail_memory(error, "the witnesses");
            visibility->witnesses[count - 1] = *line;
            visibility->long_witnesses[count - 1] = of->long_lines[k];
            of->long_lines[k] = NULL;
            visibility->witness_cells[count - 1][0] = i;
            visibility->witness_cells[count - 1][1] = of->sightings[k].cell;
            visibility->witness_count++;
        }
    }
    return ENF_OK;
}

static enf_status open_checkpoint(ladder *ladder, enf_error *error) {
    const enf_visibility_options *options = ladder->options;
    const enf_checkpoint_about about = {ladder->graph, options->method, options->want_witnesses};
    if (!options->checkpoint || (options->team && options->team->rank > 0)) return ENF_OK;
    return enf_checkpoint_open(&ladder->place.checkpoint, options->checkpoint, &about, error);
}

static enf_status climb(ladder *ladder, enf_error *error) {
    enf_method method = ladder->options->method;
    if (method == ENF_METHOD_REACH) return reach(ladder, error);
    const bool made = enf_shapes_make(&ladder->shapes, ladder->graph);
    enf_status status = made ? ENF_OK : enf_fail_memory(error, "the portals");
    if (!status && ladder->options->bodies) {
        status = cast_bodies(ladder, error);
        if (status || method <= ENF_METHOD_HOURGLASS) return status;
    }
    if (!status) status = face(ladder, error);
    if (!status && method >= ENF_METHOD_HOURGLASS) status = cast(ladder, error);
    if (!status && method >= ENF_METHOD_LP) status = settle(ladder, error);
    return status ? status : take_witnesses(ladder, error);
}

enf_status enf_visibility_run(enf_visibility *visibility, const enf_portal_graph *graph,
                              const enf_visibility_options *options, enf_error *error) {
    double started = enf_timer_now(), cpu_started = enf_timer_cpu();
    *visibility = (enf_visibility){.method = options->method};
    ladder ladder = {
        .graph = graph,
        .options = options,
        .visibility = visibility,
        .place = {.deadline = options->budget_seconds > 0 ? started + options->budget_seconds : INFINITY,
                  .team = options->team}};
    enf_status status = options->method > ENF_METHOD_REACH ? refuse_too_large(graph, options, error) : ENF_OK;
    if (!status) status = enf_pvs_new(&visibility->pvs, graph->cell_count, error);
    if (!status) status = open_checkpoint(&ladder, error);
    if (!status) status = climb(&ladder, error);
    visibility->portal_pairs = enf_bits_count(ladder.cast.beams.words, (size_t)ladder.cast.beams.row_count *
                                                                           ladder.cast.beams.row_words);
    visibility->visits = ladder.cast.visits;
    visibility->lines = ladder.cast.lines;
    visibility->jobs_stored = ladder.place.stored;
    visibility->cells_budgeted += ladder.cast.cells_budgeted;
    enf_checkpoint_close(ladder.place.checkpoint);
    enf_sightings_free(&ladder.sightings);
    enf_bits_free(&ladder.cast.beams);
    enf_bits_free(&ladder.facing);
    enf_sight_free(&ladder.sight);
    enf_pluecker_free(&ladder.pluecker);
    enf_shapes_free(&ladder.shapes);
    visibility->seconds = enf_timer_now() - started;
    visibility->cpu_seconds = enf_timer_cpu() - cpu_started;
    return status;
}

void enf_visibility_free(enf_visibility *visibility) {
    enf_pvs_free(&visibility->pvs);
    enf_bits_free(&visibility->met);
    for (int64_t i = 0; visibility->long_witnesses && i < visibility->witness_count; i++)
        free(visibility->long_witnesses[i]);
    free(visibility->long_witnesses);
    free(visibility->witnesses);
    free(visibility->witness_cells);
    *visibility = (enf_visibility){0};
}
