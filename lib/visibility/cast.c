// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/cast.h"

#include "base/array.h"
#include "base/timer.h"
#include "visibility/beams.h"
#include "visibility/coding.h"
#include "visibility/facing.h"
#include "visibility/symmetry.h"

#include <stdlib.h>
#include <string.h>

enum { PASSED_MOST = 4096, TRIES_MOST = 12 };

/// What one thread has.
typedef struct caster {
    enf_beams *beams;
    int32_t passed[PASSED_MOST];
} caster;

/// What is known of a cell's beams, besides their rows.
typedef struct cast_result {
    bool late; ///< not all portals had their turn
    int64_t visits, lines;
} cast_result;

typedef struct casting {
    enf_cast *cast;
    enf_sightings *sightings;
    double deadline;
    caster *casters;
    cast_result *results; ///< per cell
    int64_t *cost;        ///< per cell: portals that face its own
    bool *begun;          ///< per cell
    enf_follows follows;
} casting;

static const enf_portal_graph *graph_of(const casting *casting) {
    return casting->cast->sight->shapes->graph;
}

/// Sends a line through the source, and notes which cells it comes through after it.
static bool send_line(const casting *casting, caster *caster, int32_t source, const enf_line *line) {
    const enf_portal_graph *graph = graph_of(casting);
    int32_t cell = enf_portal_from(graph, source);
    casting->results[cell].lines++;
    int32_t count = enf_sight_walk(casting->cast->sight, line, source, caster->passed, PASSED_MOST);
    for (int32_t i = -1; i < count; i++) {
        enf_sighting seen = {enf_portal_to(graph, i < 0 ? source : caster->passed[i]), i + 2};
        if (seen.cell == cell || enf_bit_get(enf_bits_row(&casting->sightings->seen, cell), seen.cell))
            continue;
        if (!enf_sightings_add(casting->sightings, cell, &seen, line)) return false;
    }
    return true;
}

/// A point between the middle and a corner, near the corner. (Of 0.5, 0.75 and 0.9, this found most.)
static const double lean_share = 0.9;

static void lean(const double middle[3], const double corner[3], double point[3]) {
    for (int axis = 0; axis < 3; axis++)
        point[axis] = middle[axis] + lean_share * (corner[axis] - middle[axis]);
}

/// Sends lines until one arrives at a portal: from middle to middle of the source and of what its beams reach
/// of the portal, then, a few times, from near a corner to near a corner.
static bool send_lines(const casting *casting, caster *caster, int32_t source, int32_t target) {
    const enf_shapes *shapes = casting->cast->sight->shapes;
    const uint64_t *seen = enf_bits_row(&casting->sightings->seen, enf_portal_from(shapes->graph, source));
    const double(*corners)[3] = enf_shape_corners(shapes, source >> 1),
          *middle = shapes->shapes[source >> 1].centre;
    int32_t count = shapes->shapes[source >> 1].count, cell = enf_portal_to(shapes->graph, target);
    enf_window window;
    enf_line line;
    double goal[3], corner[3];
    enf_beams_window(caster->beams, target, &window);
    const enf_outline outline = enf_window_outline(&window);
    enf_window_middle(&window, goal);
    memcpy(line.from, middle, sizeof line.from);
    memcpy(line.to, goal, sizeof line.to);
    for (int32_t i = 0; i <= TRIES_MOST; i++) {
        if (!send_line(casting, caster, source, &line)) return false;
        if (enf_bit_get(seen, cell)) break;
        lean(middle, corners[i % count], line.from);
        enf_outline_corner(&outline, (i + i / count) % window.count, corner);
        lean(goal, corner, line.to);
    }
    return true;
}

static bool cast_portal(const casting *casting, caster *caster, int32_t source) {
    enf_cast *cast = casting->cast;
    const enf_portal_graph *graph = cast->sight->shapes->graph;
    const int32_t *reached;
    int32_t count = enf_beams_cast(caster->beams, source, &reached), cell = enf_portal_from(graph, source);
    uint64_t *row = enf_bits_row(&cast->beams, source);
    for (int32_t i = 0; i < count; i++) {
        int32_t to = enf_portal_to(graph, reached[i]);
        enf_bit_set(row, reached[i]);
        if (!casting->sightings || to == cell ||
            enf_bit_get(enf_bits_row(&casting->sightings->seen, cell), to))
            continue;
        if (!send_lines(casting, caster, source, reached[i])) return false;
    }
    return true;
}

// ---------------------------------------------------------------------------------------------- jobs

/// For portals that had no turn.
static void keep_facing(const casting *casting, int32_t portal) {
    enf_cast *cast = casting->cast;
    memcpy(enf_bits_row(&cast->beams, portal), enf_bits_row(cast->facing, portal),
           cast->beams.row_words * sizeof(uint64_t));
}

static enf_status run_cell(void *user, int32_t cell, int thread, bool *late, enf_error *error) {
    const casting *casting = user;
    const enf_portal_graph *graph = graph_of(casting);
    caster *caster = &casting->casters[thread];
    cast_result *result = &casting->results[cell];
    int64_t visits = enf_beams_visits(caster->beams);
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++) {
        result->late = result->late || enf_timer_now() > casting->deadline;
        if (result->late)
            keep_facing(casting, graph->cell_portals[k]);
        else if (!cast_portal(casting, caster, graph->cell_portals[k]))
            return enf_fail_memory(error, "the beams");
    }
    result->visits = enf_beams_visits(caster->beams) - visits;
    *late = result->late;
    return ENF_OK;
}

static void encode_cell(void *user, int32_t cell, enf_bytes *bytes) {
    const casting *casting = user;
    const enf_portal_graph *graph = graph_of(casting);
    const enf_bits *beams = &casting->cast->beams;
    const cast_result *result = &casting->results[cell];
    enf_put_number(bytes, result->late);
    enf_put_number(bytes, (uint64_t)result->visits);
    enf_put_number(bytes, (uint64_t)result->lines);
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++)
        enf_put_row(bytes, enf_bits_row(beams, graph->cell_portals[k]), beams->row_words);
    if (casting->sightings) enf_put_sightings(bytes, casting->sightings, cell, 0);
}

static bool decode_cell(void *user, int32_t cell, enf_reader *reader) {
    const casting *casting = user;
    const enf_portal_graph *graph = graph_of(casting);
    const enf_bits *beams = &casting->cast->beams;
    cast_result *result = &casting->results[cell];
    result->late = enf_take_number(reader, 1);
    result->visits = (int64_t)enf_take_number(reader, ENF_COUNT_MOST);
    result->lines = (int64_t)enf_take_number(reader, ENF_COUNT_MOST);
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++)
        enf_take_row(reader, enf_bits_row(beams, graph->cell_portals[k]), beams->row_count);
    return !casting->sightings || enf_take_sightings(reader, casting->sightings, cell);
}

// ---------------------------------------------------------------------------------------------- all

static bool faces(const void *user, int32_t portal, int32_t next) {
    const enf_bits *facing = user;
    return enf_bit_get(enf_bits_row(facing, portal), next);
}

static bool make_casting(casting *casting, int threads) {
    const enf_portal_graph *graph = graph_of(casting);
    size_t cells = (size_t)graph->cell_count;
    casting->results = enf_array_zeroed(cells, sizeof *casting->results);
    casting->cost = enf_array_zeroed(cells, sizeof *casting->cost);
    casting->begun = enf_array_zeroed(cells, sizeof *casting->begun);
    casting->casters = enf_array_zeroed((size_t)threads, sizeof *casting->casters);
    if (!enf_bits_new(&casting->cast->beams, 2 * graph->opening_count, 2 * graph->opening_count) ||
        !enf_follows_make(&casting->follows, graph, faces, casting->cast->facing) || !casting->results ||
        !casting->cost || !casting->begun || !casting->casters)
        return false;
    for (int i = 0; i < threads; i++) {
        casting->casters[i].beams =
            enf_beams_new(casting->cast->sight->shapes, casting->cast->facing, &casting->follows);
        if (!casting->casters[i].beams) return false;
    }
    return true;
}

static void free_casting(casting *casting, int threads) {
    for (int i = 0; casting->casters && i < threads; i++) enf_beams_free(casting->casters[i].beams);
    free(casting->casters);
    free(casting->results);
    free(casting->cost);
    free(casting->begun);
    enf_follows_free(&casting->follows);
}

static void find_cost(casting *casting) {
    const enf_portal_graph *graph = graph_of(casting);
    const enf_bits *facing = casting->cast->facing;
    for (int32_t p = 0; p < facing->row_count; p++)
        casting->cost[enf_portal_from(graph, p)] +=
            1 + enf_bits_count(enf_bits_row(facing, p), facing->row_words);
}

/// Sums up. Cells that had no turn see what faces them.
static void sum_up(casting *casting) {
    const enf_portal_graph *graph = graph_of(casting);
    enf_cast *cast = casting->cast;
    for (int32_t c = 0; c < graph->cell_count; c++) {
        bool none = casting->cost[c] > 0 && !casting->begun[c];
        for (int32_t k = graph->cell_portal[c]; none && k < graph->cell_portal[c + 1]; k++)
            keep_facing(casting, graph->cell_portals[k]);
        cast->visits += casting->results[c].visits;
        cast->lines += casting->results[c].lines;
        cast->cells_budgeted += none || casting->results[c].late;
    }
}

enf_status enf_cast_run(enf_cast *cast, enf_sightings *sightings, enf_workplace *place, enf_error *error) {
    casting casting = {.cast = cast, .sightings = sightings, .deadline = place->deadline};
    int threads = place->crew.threads;
    enf_status status = make_casting(&casting, threads) ? ENF_OK : enf_fail_memory(error, "the beams");
    if (!status) {
        find_cost(&casting);
        const enf_work work = {.stage = ENF_STAGE_CAST,
                               .cell_count = graph_of(&casting)->cell_count,
                               .cost = casting.cost,
                               .user = &casting,
                               .run = run_cell,
                               .encode = encode_cell,
                               .decode = decode_cell};
        status = enf_work_run(&work, place, casting.begun, error);
    }
    if (!status) sum_up(&casting);
    free_casting(&casting, threads);
    if (!status) enf_symmetry_keep_twins(&cast->beams);
    return status;
}
