// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/cast.h"

#include "base/array.h"
#include "base/timer.h"
#include "visibility/beams.h"
#include "visibility/facing.h"

#include <stdlib.h>
#include <string.h>

enum { PASSED_MOST = 4096 };

/// What one thread has.
typedef struct caster {
    enf_beams *beams;
    int64_t lines;
    int32_t cells_budgeted;
    bool failed;
    int32_t passed[PASSED_MOST];
} caster;

typedef struct casting {
    enf_cast *cast;
    enf_sightings *sightings;
    caster *casters;
} casting;

/// Sends a line through the middle of the portal and of what its beams reach of another; notes which cells it
/// comes through.
static bool send_line(const casting *casting, caster *caster, int32_t source, int32_t target) {
    const enf_sight *sight = casting->cast->sight;
    const enf_portal_graph *graph = sight->shapes->graph;
    int32_t cell = enf_portal_from(graph, source);
    enf_window window;
    enf_line line;
    enf_beams_window(caster->beams, target, &window);
    memcpy(line.from, sight->shapes->shapes[source >> 1].centre, sizeof line.from);
    enf_window_middle(&window, line.to);
    caster->lines++;
    int32_t count = enf_sight_walk(sight, &line, source, caster->passed, PASSED_MOST);
    for (int32_t i = -1; i < count; i++) {
        enf_sighting seen = {enf_portal_to(graph, i < 0 ? source : caster->passed[i]), i + 2};
        if (seen.cell == cell || enf_bit_get(enf_bits_row(&casting->sightings->seen, cell), seen.cell))
            continue;
        if (!enf_sightings_add(casting->sightings, cell, &seen, &line)) return false;
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
        if (!send_line(casting, caster, source, reached[i])) return false;
    }
    return true;
}

static void cast_job(void *user, int32_t cell, int thread) {
    const casting *casting = user;
    caster *caster = &casting->casters[thread];
    enf_cast *cast = casting->cast;
    const enf_portal_graph *graph = cast->sight->shapes->graph;
    bool late = enf_timer_now() > cast->deadline;
    caster->cells_budgeted += late;
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1] && !caster->failed; k++) {
        int32_t portal = graph->cell_portals[k];
        if (late)
            memcpy(enf_bits_row(&cast->beams, portal), enf_bits_row(cast->facing, portal),
                   cast->beams.row_words * sizeof(uint64_t));
        else
            caster->failed = !cast_portal(casting, caster, portal);
    }
}

static bool make_casters(casting *casting, int threads) {
    casting->casters = enf_array_zeroed((size_t)threads, sizeof *casting->casters);
    if (!casting->casters) return false;
    for (int i = 0; i < threads; i++) {
        casting->casters[i].beams = enf_beams_new(casting->cast->sight->shapes, casting->cast->facing);
        if (!casting->casters[i].beams) return false;
    }
    return true;
}

/// Sums up, and frees them. False if one has failed.
static bool end_casters(casting *casting, int threads) {
    bool good = true;
    for (int i = 0; casting->casters && i < threads; i++) {
        caster *caster = &casting->casters[i];
        casting->cast->lines += caster->lines;
        casting->cast->cells_budgeted += caster->cells_budgeted;
        if (caster->beams) casting->cast->visits += enf_beams_visits(caster->beams);
        good = good && !caster->failed;
        enf_beams_free(caster->beams);
    }
    free(casting->casters);
    return good;
}

enf_status enf_cast_run(enf_cast *cast, enf_sightings *sightings, const enf_crew *crew, enf_error *error) {
    const enf_portal_graph *graph = cast->sight->shapes->graph;
    casting casting = {.cast = cast, .sightings = sightings};
    int32_t portals = 2 * graph->opening_count;
    bool good = enf_bits_new(&cast->beams, portals, portals) && make_casters(&casting, crew->threads),
         done = true;
    if (good) done = enf_parallel_for(crew, graph->cell_count, cast_job, &casting);
    good = end_casters(&casting, crew->threads) && good;
    if (!done) return enf_fail(error, ENF_NO_RESOURCES, "cancelled");
    if (!good) return enf_fail_memory(error, "the beams");
    enf_facing_symmetrise(&cast->beams);
    return ENF_OK;
}
