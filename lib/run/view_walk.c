// SPDX-License-Identifier: MIT
// The traversal: takes the nearest cell that waits and looks through its portals.
#include "run/instance.h"
#include "run/view_parts.h"

#include <math.h>
#include <string.h>

/// The distance from a plane is right up to a few roundings.
static const double facing_share = 1e-10;

/// The pieces of a portal's polygons become one region if that is larger by at most this share.
static const double join_waste = 1;

/// A visit's portal that is looked at.
typedef struct look {
    int32_t visit, portal, space; ///< the space before it
    enf_passage passage;
    enf_view_clipping clipping;
    double area, nearest;
} look;

static bool is_left_out(const enf_view *view, enf_view_test test) {
    return view->options.without & test;
}

static enf_view_clipping prepare_clipping(const enf_view *view, const enf_view_visit *visit, int32_t space) {
    return (enf_view_clipping){.lens = &view->spaces.lenses[space],
                               .region = &visit->region,
                               .near_distance = ENF_VIEW_NEAR_SHARE * view->reach,
                               .facing_tolerance = facing_share * view->reach,
                               .without = view->options.without};
}

/// Which of a portal's polygons face the eye, or may: of the first 64 as bits. Later ones count as facing.
static uint64_t find_facing(const enf_view *view, const enf_file_portal *portal,
                            const enf_view_clipping *clipping) {
    const enf_file_portal_polygon *polygon = &view->file->portal_polygons[portal->polygon_first];
    const double *eye = clipping->lens->eye;
    uint64_t facing = portal->polygon_count > 64 ? UINT64_C(1) << 63 : 0;
    for (int32_t i = 0; i < portal->polygon_count && i < 64; i++) {
        const double *p = polygon[i].plane;
        double side = p[0] * eye[0] + p[1] * eye[1] + p[2] * eye[2] + p[3];
        if (!(side < -clipping->facing_tolerance)) facing |= UINT64_C(1) << i;
    }
    return facing;
}

static void make_region(enf_view *view, double (*corners)[2], int32_t count, const look *look) {
    enf_region_outline(&view->region, corners, count);
    if (!view->options.rectangles) return;
    const double *outer = look->clipping.region->rectangle;
    double r[4];
    for (int i = 0; i < 4; i++) { // the slack that lines have may have led beyond
        double x = view->region.rectangle[i];
        r[i] = (i < 2 ? x < outer[i] : x > outer[i]) ? outer[i] : x;
    }
    enf_region_make_rectangle(&view->region, r);
}

/// A region passes. False: no room.
static bool pass(enf_view *view, const look *look, enf_view_region *region, double nearest) {
    const enf_view_visit *visit = &view->queue.visits[look->visit];
    enf_view_arrival arrival = {.region = region,
                                .outer = look->clipping.region,
                                .nearest = fmax(nearest, visit->nearest),
                                .cell = look->passage.to,
                                .space = look->space,
                                .parent = look->visit,
                                .portal = look->portal,
                                .depth = visit->depth + 1};
    if (look->passage.matrix) {
        const enf_view_space *space = &view->spaces.spaces[look->space];
        if (space->transforms >= view->options.transforms_max) {
            view->visible.flags |= ENF_VIEW_DEPTH;
            return true;
        }
        arrival.space =
            enf_spaces_pass(&view->spaces, look->space, view->file, look->portal, look->passage.matrix);
    }
    if (arrival.space >= 0 && enf_queue_add(&view->queue, &arrival, &view->visible)) return true;
    view->visible.flags |= ENF_VIEW_INCOMPLETE;
    return look->space != 0 || look->passage.matrix;
}

/// One region around all pieces, if they are one, up to a little.
static bool join_pieces(enf_view *view, const look *look) {
    int32_t count = 0;
    double sum = 0;
    for (int32_t i = 0; i < view->piece_count; i++) {
        const enf_view_piece *piece = &view->pieces[i];
        if (count + piece->count > ENF_VIEW_CORNERS) return false;
        memcpy(view->corners + count, piece->corners, (size_t)piece->count * sizeof *piece->corners);
        count += piece->count;
        sum += enf_polygon_area((const double(*)[2])piece->corners, piece->count);
    }
    if (view->piece_count > 1) {
        count = enf_hull(view->corners, count);
        if (count > 2 && enf_polygon_area((const double(*)[2])view->corners, count) > (1 + join_waste) * sum)
            return false;
    }
    make_region(view, view->corners, count, look);
    return true;
}

static bool pass_pieces(enf_view *view, const look *look) {
    if (view->piece_count == 0) return true;
    if (join_pieces(view, look)) return pass(view, look, &view->region, look->nearest);
    bool fits = true;
    for (int32_t i = 0; i < view->piece_count && fits; i++) {
        enf_view_piece *piece = &view->pieces[i];
        make_region(view, piece->corners, piece->count, look);
        fits = pass(view, look, &view->region, piece->nearest);
    }
    return fits;
}

/// May it be passed, as the caller wishes?
static bool is_wanted(enf_view *view, const look *look) {
    const enf_view_options *options = &view->options;
    if (look->area * view->pixels < options->pixels_min) {
        view->visible.stats.by_area++;
        return false;
    }
    if (!options->decide) return true;
    const enf_view_visit *visit = &view->queue.visits[look->visit];
    enf_view_step step = {.portal = look->portal,
                          .from = view->queue.places[visit->place].cell,
                          .to = look->passage.to,
                          .depth = visit->depth + 1,
                          .transforms = view->spaces.spaces[look->space].transforms + !!look->passage.matrix,
                          .pixels = look->area * view->pixels,
                          .nearest = fmax(look->nearest, visit->nearest)};
    if (options->decide(options->user, &step)) return true;
    view->visible.stats.by_decision++;
    return false;
}

/// Clips a polygon. False: the region passes as it is, nothing more to find out.
static bool clip_polygon(enf_view *view, look *look, const enf_file_portal_polygon *polygon) {
    enf_view_stats *stats = &view->visible.stats;
    enf_view_piece *piece = &view->pieces[view->piece_count];
    const double(*vertices)[3] = view->file->portal_vertices + polygon->vertex_first;
    switch (enf_view_clip(&look->clipping, polygon->plane, vertices, polygon->vertex_count, piece)) {
    case ENF_CLIP_WHOLE:
        stats->near++;
        return false;
    case ENF_CLIP_OUT_RECTANGLE:
        stats->by_rectangle++;
        return true;
    case ENF_CLIP_OUT_POLYGON:
        stats->by_polygon++;
        return true;
    case ENF_CLIP_SEEN:
        break;
    }
    view->piece_count++;
    look->area += enf_polygon_area((const double(*)[2])piece->corners, piece->count);
    look->nearest = fmin(look->nearest, piece->nearest);
    return true;
}

/// Looks at the polygons; passes on what is seen. False: no room.
static bool look_through(enf_view *view, look *look, uint64_t facing) {
    const enf_file_portal *portal = &view->file->portals[look->portal];
    enf_view_visit *visit = &view->queue.visits[look->visit];
    bool fits = true;
    view->piece_count = 0;
    look->area = 0;
    look->nearest = INFINITY;
    for (int32_t i = 0; i < portal->polygon_count; i++) {
        view->visible.stats.polygons++;
        if (!(facing >> (i < 63 ? i : 63) & 1)) {
            view->visible.stats.by_facing++;
            continue;
        }
        if (!clip_polygon(view, look, &view->file->portal_polygons[portal->polygon_first + i])) {
            look->area = visit->region.area;
            look->nearest = visit->nearest;
            if (!is_wanted(view, look)) return true;
            return pass(view, look, &visit->region, visit->nearest);
        }
        if (view->piece_count < ENF_VIEW_PIECES) continue;
        fits = fits && (!is_wanted(view, look) || pass_pieces(view, look));
        view->piece_count = 0;
        look->area = 0;
    }
    if (view->piece_count > 0 && is_wanted(view, look)) fits = fits && pass_pieces(view, look);
    return fits;
}

/// The early outs, cheap ones first.
static bool look_at(enf_view *view, look *look) {
    enf_view_stats *stats = &view->visible.stats;
    const enf_file_portal *portal = &view->file->portals[look->portal];
    const enf_view_visit *visit = &view->queue.visits[look->visit];
    stats->portals++;
    if (view->instance)
        look->passage = enf_instance_passage(view->instance, view->file, look->portal);
    else
        look->passage.to = portal->to;
    if (look->passage.to < 0) {
        stats->closed++;
        return true;
    }
    if (view->use_seen && look->space == 0 && !look->passage.matrix &&
        !enf_seen_has(&view->seen, look->passage.to)) {
        stats->by_pvs++;
        return true;
    }
    if (!is_left_out(view, ENF_VIEW_SPHERE) &&
        enf_region_misses_sphere(&visit->region, look->clipping.lens, portal->centre,
                                 portal->radius + look->clipping.near_distance)) {
        stats->by_sphere++;
        return true;
    }
    uint64_t facing = UINT64_MAX;
    if (!is_left_out(view, ENF_VIEW_FACING)) facing = find_facing(view, portal, &look->clipping);
    if (!facing) {
        stats->polygons += portal->polygon_count;
        stats->by_facing += portal->polygon_count;
        return true;
    }
    look->clipping.planes[0] = look->passage.cut ? look->passage.plane : NULL;
    return look_through(view, look, facing);
}

/// Gives a visit its place in the list, if it has none yet.
static void list(enf_view *view, int32_t number) {
    enf_view_visit *visit = &view->queue.visits[number];
    enf_view_place *place = &view->queue.places[visit->place];
    int32_t *entry = view->options.every_region ? &visit->entry : &place->entry;
    if (*entry >= 0) return;
    *entry = view->visible.entry_count++;
    view->order[*entry] = number;
    view->entries[*entry].nearest = visit->nearest;
}

/// Looks through all portals of a visit's cell. False: no room.
static bool look_around(enf_view *view, int32_t number) {
    enf_view_visit *visit = &view->queue.visits[number];
    const enf_view_place *place = &view->queue.places[visit->place];
    const enf_view_space *space = &view->spaces.spaces[place->space];
    const enf_file_cell *from = &view->file->cells[place->cell];
    look look = {.visit = number, .space = place->space};
    double far_side[4];
    look.clipping = prepare_clipping(view, visit, place->space);
    if (space->has_plane) {
        for (int a = 0; a < 4; a++) far_side[a] = -space->plane[a];
        far_side[3] += look.clipping.near_distance; // times the normal's length, which is about 1
        look.clipping.planes[1] = far_side;
    }
    enf_region_measure(&visit->region, look.clipping.lens);
    view->visible.stats.visits++;
    for (int32_t i = 0; i < from->portal_count; i++) {
        look.portal = view->file->cell_portals[from->portal_first + i];
        if (!look_at(view, &look)) return false;
    }
    return true;
}

bool enf_view_walk(enf_view *view, int32_t cell) {
    static const double screen[4] = {-1, -1, 1, 1};
    enf_view_arrival start = {.region = &view->region, .cell = cell, .parent = -1, .portal = -1};
    view->region.corners = view->region_corners;
    view->region.lines = view->region_lines;
    enf_region_make_rectangle(&view->region, screen);
    if (!enf_queue_add(&view->queue, &start, &view->visible)) return false;
    for (int32_t number; (number = enf_queue_take(&view->queue)) >= 0;) {
        list(view, number);
        if (!look_around(view, number)) return false;
    }
    return true;
}
