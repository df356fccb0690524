// SPDX-License-Identifier: MIT
// Views: cameras in, lists out.
#include "enfilade/view.h"

#include "run/instance.h"
#include "run/view_parts.h"

#include <string.h>

static const double screen_corners[4][2] = {{-1, -1}, {1, -1}, {1, 1}, {-1, 1}};

/// Cells with the whole screen: those of the visible set, or all.
static void list_cells(enf_view *view, bool seen_only) {
    const double grown = 1 + ENF_VIEW_SLACK;
    enf_visible *visible = &view->visible;
    visible->entry_count = 0;
    for (int32_t i = 0; i < view->file->cell_count; i++) {
        if (seen_only && !enf_seen_has(&view->seen, i)) continue;
        view->entries[visible->entry_count++] = (enf_view_entry){.cell = i,
                                                                 .parent = -1,
                                                                 .portal = -1,
                                                                 .vertex_count = 4,
                                                                 .vertices = screen_corners,
                                                                 .rectangle = {-grown, -grown, grown, grown}};
    }
}

/// One region around all those of a place, in the memory of the first.
static void unite_regions(enf_view *view, const enf_view_place *place, enf_view_visit *first) {
    enf_view_region *region = &first->region;
    for (int32_t i = place->first; i >= 0; i = view->queue.visits[i].next) {
        const enf_view_visit *visit = &view->queue.visits[i];
        if (visit == first) continue;
        double corners[ENF_VIEW_CORNERS][2];
        int32_t count = enf_view_hull(region, &visit->region, corners);
        for (int k = 0; k < 4; k++) {
            double x = region->rectangle[k], y = visit->region.rectangle[k];
            region->rectangle[k] = (k < 2 ? x < y : x > y) ? x : y;
        }
        region->count = enf_polygon_simplify(corners, count, view->queue.edges_max);
        if (region->count > view->queue.edges_max) // not convex
            enf_region_make_rectangle(region, region->rectangle);
        else
            memcpy(region->corners, corners, (size_t)region->count * sizeof *corners);
    }
}

static void list_entry(enf_view *view, int32_t number) {
    enf_view_queue *queue = &view->queue;
    enf_view_visit *visit = &queue->visits[view->order[number]];
    const enf_view_place *place = &queue->places[visit->place];
    if (!view->options.every_region && place->visit_count > 1) unite_regions(view, place, visit);
    visit->region.count = enf_polygon_tidy(visit->region.corners, visit->region.count, ENF_VIEW_SHORTEST);
    int32_t parent = -1;
    if (visit->parent >= 0) {
        const enf_view_visit *from = &queue->visits[visit->parent];
        parent = view->options.every_region ? from->entry : queue->places[from->place].entry;
    }
    enf_view_entry *entry = &view->entries[number];
    *entry = (enf_view_entry){.cell = place->cell,
                              .parent = parent,
                              .portal = visit->portal,
                              .depth = visit->depth,
                              .space = place->space,
                              .vertex_count = visit->region.count,
                              .vertices = (const double(*)[2])visit->region.corners,
                              .nearest = view->entries[number].nearest};
    for (int i = 0; i < 4; i++)
        entry->rectangle[i] = visit->region.rectangle[i] + (i < 2 ? -ENF_VIEW_SLACK : ENF_VIEW_SLACK);
}

/// Fills in the lens of the world; false if the camera can't be used.
static bool set_camera(enf_view *view, const enf_camera *camera) {
    enf_view_lens lens;
    double rows[3][3];
    const double *m = camera->matrix;
    for (int i = 0; i < 3; i++) memcpy(rows[i], m + (i == 2 ? 12 : 4 * i), sizeof rows[i]);
    if (!enf_lens_make(&lens, camera->eye, (const double(*)[3])rows)) return false;
    enf_spaces_clear(&view->spaces, &lens);
    view->camera = camera;
    view->pixels = 1;
    if (camera->viewport[0] > 0 && camera->viewport[1] > 0)
        view->pixels = 0.25 * camera->viewport[0] * camera->viewport[1];
    return true;
}

static int32_t find_cell(enf_view *view) {
    if (view->camera->place) {
        int32_t cell = view->camera->place->cell;
        return cell >= 0 && cell < view->file->cell_count ? cell : -1;
    }
    enf_place place = enf_world_locate(view->world, view->camera->eye, view->hint);
    view->hint = place.tetrahedron;
    return place.cell;
}

/// The visible set of all cells that the eye touches.
static bool find_seen(enf_view *view, int32_t cell) {
    int32_t cells[ENF_SEEN_CELLS] = {cell};
    int32_t count = enf_seen_touch(view->file, view->camera->eye, ENF_VIEW_NEAR_SHARE * view->reach, cells);
    return count > 0 && enf_seen_join(&view->seen, view->file, cells, count);
}

static void look_around(enf_view *view, int32_t cell) {
    enf_visible *visible = &view->visible;
    bool has_seen = find_seen(view, cell);
    view->use_seen = has_seen && !(view->options.without & ENF_VIEW_PVS);
    enf_queue_clear(&view->queue);
    if (enf_view_walk(view, cell)) {
        for (int32_t i = 0; i < visible->entry_count; i++) list_entry(view, i);
    } else {
        visible->flags |= ENF_VIEW_OVERFLOW;
        if (!view->instance) visible->flags &= ~(uint32_t)ENF_VIEW_INCOMPLETE; // no portal transforms
        list_cells(view, has_seen);
    }
}

const enf_visible *enf_view_run(enf_view *view, const enf_instance *instance, const enf_camera *camera) {
    enf_visible *visible = &view->visible;
    *visible = (enf_visible){.cell = -1, .entries = view->entries, .spaces = view->spaces.spaces};
    view->instance = enf_instance_is_changed(instance) ? instance : NULL;
    if (!set_camera(view, camera)) {
        visible->flags = ENF_VIEW_NO_CAMERA;
        return visible;
    }
    visible->cell = find_cell(view);
    if (visible->cell >= 0) {
        look_around(view, visible->cell);
    } else {
        visible->flags = ENF_VIEW_OUTSIDE;
        if (view->options.outside == ENF_VIEW_OUTSIDE_ALL) list_cells(view, false);
    }
    visible->space_count = view->spaces.count;
    return visible;
}
