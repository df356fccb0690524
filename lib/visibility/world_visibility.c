// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/world_visibility.h"

#include "visibility/body_cast.h"
#include "visibility/facing.h"

#include <math.h>

/// Cells see each other if parts of them do.
static void join_bodies(enf_pvs *cells, const enf_bits *met, const enf_bodies *bodies) {
    for (int32_t i = 0; i < bodies->count; i++) {
        const uint64_t *row = enf_bits_row(met, i);
        for (int32_t k = -1; (k = enf_bit_next(row, met->row_words, k + 1)) >= 0;)
            enf_pvs_set(cells, bodies->owner[i], bodies->owner[k]);
    }
}

static void see_neighbours(enf_pvs *cells, const enf_file_view *view) {
    for (int32_t i = 0; i < view->portal_count; i++)
        enf_pvs_set(cells, view->portals[i].from, view->portals[i].to);
}

/// Cells too thin to be in a leaf see what their neighbours see, as all that comes to them comes through
/// those. Neighbours that are lost themselves have it from theirs, so it is done until nothing changes.
static void see_for_lost(enf_pvs *cells, const enf_world_air *air, const enf_file_view *view) {
    for (bool changes = true; changes;) {
        changes = false;
        for (int32_t i = 0; i < air->parts.lost_count; i++) {
            const enf_file_cell *cell = &view->cells[air->parts.lost[i]];
            uint64_t *row = enf_pvs_row(cells, air->parts.lost[i]);
            for (int32_t k = 0; k < cell->portal_count; k++) {
                int32_t to = view->portals[view->cell_portals[cell->portal_first + k]].to;
                for (size_t w = 0; w < cells->row_words; w++) {
                    uint64_t more = enf_pvs_row(cells, to)[w] & ~row[w];
                    row[w] |= more;
                    changes = changes || more;
                }
            }
        }
    }
    for (int32_t i = 0; i < air->parts.lost_count; i++)
        for (int32_t other = 0; other < cells->cell_count; other++)
            if (enf_pvs_get(cells, air->parts.lost[i], other)) enf_pvs_set(cells, other, air->parts.lost[i]);
}

static enf_status cast(enf_visibility *found, const enf_world_air *air, const enf_visibility_options *options,
                       enf_bits *met, enf_error *error) {
    enf_shapes shapes;
    enf_bits facing = {0};
    enf_workplace place = {.crew = {.threads = options->threads}, .deadline = INFINITY};
    enf_body_cast cast = {.shapes = &shapes, .facing = &facing, .bodies = &air->parts.bodies};
    enf_status status =
        enf_shapes_make(&shapes, &air->graph) ? ENF_OK : enf_fail_memory(error, "the portals");
    if (!status) status = enf_facing_find(&facing, &shapes, &place.crew, error);
    if (!status) status = enf_body_cast_run(&cast, &place, error);
    found->visits = cast.visits;
    *met = cast.met;
    enf_bits_free(&facing);
    enf_shapes_free(&shapes);
    return status;
}

enf_status enf_world_visibility_run(enf_visibility *visibility, const enf_world_air *air,
                                    const enf_file_view *view, const enf_visibility_options *options,
                                    enf_error *error) {
    if (!air->is_partitioned) return enf_visibility_run(visibility, &air->graph, options, error);
    enf_bits met = {0};
    *visibility = (enf_visibility){.method = options->method};
    enf_status status = enf_pvs_new(&visibility->pvs, view->cell_count, error);
    if (!status) status = cast(visibility, air, options, &met, error);
    if (!status) {
        join_bodies(&visibility->pvs, &met, &air->parts.bodies);
        see_neighbours(&visibility->pvs, view);
        see_for_lost(&visibility->pvs, air, view);
    }
    enf_bits_free(&met);
    return status;
}
