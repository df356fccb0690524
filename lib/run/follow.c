// SPDX-License-Identifier: MIT
#include "enfilade/sight.h"

#include "run/affine.h"
#include "run/way.h"

#include <math.h>
#include <string.h>

enum { DEPTH_DEFAULT = 16 };

static void take_matrix(double matrix[12], const double next[12]) {
    double product[12];
    enf_affine_multiply(product, next, matrix);
    memcpy(matrix, product, sizeof product);
}

/// Where a point is that a door has stopped: it may lie on the border to the cell behind, but is in `cell`.
static enf_place place_before(const enf_world *world, const double point[3], int32_t cell, int32_t hint) {
    const enf_file_view *view = enf_world_file(world);
    enf_place place = enf_world_locate(world, point, hint);
    if (place.cell == cell) return place;
    int32_t region = view->cells[cell].region;
    return (enf_place){cell, -1, region, hint, (enf_world_kind)view->regions[region].kind};
}

/// One straight part. True if the point is led elsewhere: from and to are the next part.
static bool follow_leg(const enf_world *world, enf_way *way, const enf_step *step, enf_stepped *stepped,
                       enf_passed *passed, double from[3], double to[3]) {
    enf_place place = enf_world_locate(world, to, stepped->place.tetrahedron);
    bool near = place.fine_cell >= 0 && place.fine_cell == stepped->place.fine_cell;
    bool wanted = passed->portals && passed->capacity > 0;
    int32_t cell = stepped->place.cell, hint = place.tetrahedron;
    memcpy(stepped->point, to, sizeof stepped->point);
    stepped->place = place;
    if (near || cell < 0 || !enf_way_set(way, from, to)) return false;
    int32_t portal;
    if (!wanted && enf_way_look_ahead(way, &portal) == ENF_WAY_CLEAR) return false;

    enf_way_end end = enf_way_pass(way, ENF_WAY_WHOLE, &cell, place.cell, passed);
    if (end.outcome == ENF_WAY_FREE) return false;
    int32_t most = step->depth_max > 0 ? step->depth_max : DEPTH_DEFAULT;
    enf_way_point(way, end.share, from);
    if (end.outcome == ENF_WAY_SHUT || stepped->depth >= most) {
        memcpy(stepped->point, from, sizeof stepped->point);
        stepped->place = place_before(world, from, cell, hint);
        stepped->portal = end.portal;
        return false;
    }
    stepped->depth++;
    take_matrix(stepped->matrix, end.passage.matrix);
    enf_affine_point(end.passage.matrix, from, from);
    enf_affine_point(end.passage.matrix, to, to);
    memcpy(stepped->point, to, sizeof stepped->point);
    int32_t region = way->view->cells[end.passage.to].region;
    stepped->place =
        (enf_place){end.passage.to, -1, region, hint, (enf_world_kind)way->view->regions[region].kind};
    return true;
}

enf_status enf_world_follow(const enf_world *world, const enf_instance *instance, const enf_step *step,
                            enf_stepped *stepped, enf_error *error) {
    const enf_file_view *view = enf_world_file(world);
    *stepped = (enf_stepped){.place = step->place, .portal = -1};
    for (int a = 0; a < 3; a++) stepped->matrix[5 * a] = 1;
    if (!view->sight) return enf_fail_sight(world, error);
    if (stepped->place.cell >= view->cell_count) stepped->place.cell = -1;
    enf_way way = {.view = view, .instance = instance};
    enf_passed passed = {step->portals, step->portal_capacity, 0};
    double from[3], to[3];
    memcpy(from, step->from, sizeof from);
    memcpy(to, step->to, sizeof to);
    while (follow_leg(world, &way, step, stepped, &passed, from, to)) continue;
    stepped->portal_count = passed.count;
    return ENF_OK;
}
