// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/world_visibility.h"

#include <math.h>

/// Cells see each other if they have parts in leafs that do, and their parts may, too.
static void join_leafs(enf_pvs *cells, const enf_visibility *found, const enf_bodies *bodies, int32_t leaf,
                       int32_t other) {
    for (int32_t i = bodies->cell_first[leaf]; i < bodies->cell_first[leaf + 1]; i++) {
        const int32_t from = bodies->owner[i];
        const uint64_t *row = found->met.words ? enf_bits_row(&found->met, from) : NULL;
        for (int32_t k = bodies->cell_first[other]; k < bodies->cell_first[other + 1]; k++) {
            const int32_t to = bodies->owner[k];
            if (!row || enf_bit_get(row, to)) enf_pvs_set(cells, from, to);
        }
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

static void take_owners(enf_pvs *cells, const enf_bits *met) {
    for (int32_t i = 0; i < cells->cell_count; i++)
        for (size_t w = 0; w < cells->row_words; w++) enf_pvs_row(cells, i)[w] |= enf_bits_row(met, i)[w];
}

static void join_all_leafs(enf_pvs *cells, const enf_visibility *found, const enf_bodies *bodies) {
    for (int32_t leaf = 0; leaf < found->pvs.cell_count; leaf++)
        for (int32_t other = 0; other < found->pvs.cell_count; other++)
            if (enf_pvs_get(&found->pvs, leaf, other)) join_leafs(cells, found, bodies, leaf, other);
}

static enf_status find_cells(enf_visibility *found, const enf_world_air *air, const enf_file_view *view,
                             enf_error *error) {
    enf_pvs cells;
    enf_status status = enf_pvs_new(&cells, view->cell_count, error);
    if (!status) {
        if (found->method == ENF_METHOD_FACING || found->method == ENF_METHOD_HOURGLASS)
            take_owners(&cells, &found->met);
        else
            join_all_leafs(&cells, found, &air->parts.bodies);
        see_neighbours(&cells, view);
        see_for_lost(&cells, air, view);
    }
    enf_pvs_free(&found->pvs);
    found->pvs = cells;
    return status;
}

/// Leaves of the visible sets what the portals allow, too.
static void narrow(enf_pvs *pvs, const enf_pvs *portals) {
    for (size_t w = 0; w < (size_t)pvs->cell_count * pvs->row_words; w++) pvs->rows[w] &= portals->rows[w];
}

/// What of the budget is left; all of it, if there is none.
static double rest_of(double budget, double used) {
    static const double least = 1e-3; // 0 would be no end
    return budget > 0 ? fmax(budget - used, least) : 0;
}

enf_status enf_world_visibility_run(enf_visibility *visibility, const enf_world_air *air,
                                    const enf_file_view *view, const enf_visibility_options *options,
                                    enf_error *error) {
    enf_visibility portals = {0};
    enf_visibility_options own = *options;
    enf_status status = ENF_OK;
    *visibility = (enf_visibility){0};
    own.want_witnesses = false;
    if (!air->uses_leafs) return enf_visibility_run(visibility, &air->portals, &own, error);
    if (air->uses_portals) {
        own.checkpoint = NULL; // that is for the longer one
        status = enf_visibility_run(&portals, &air->portals, &own, error);
        own.budget_seconds = rest_of(options->budget_seconds, portals.seconds);
    }
    own.checkpoint = options->checkpoint;
    own.bodies = &air->parts.bodies;
    own.order = air->has_partition ? &air->order : NULL;
    if (!status) status = enf_visibility_run(visibility, &air->leafs, &own, error);
    if (!status) status = find_cells(visibility, air, view, error);
    if (!status && air->uses_portals) narrow(&visibility->pvs, &portals.pvs);
    visibility->seconds += portals.seconds;
    visibility->cpu_seconds += portals.cpu_seconds;
    enf_visibility_free(&portals);
    return status;
}
