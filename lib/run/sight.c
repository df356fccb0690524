// SPDX-License-Identifier: MIT
// A line of sight is decided by walls and doors alone, all of them at once: which cells it passes does not
// matter for that, and is only found out if somebody wants to know.
#include "enfilade/sight.h"

#include "run/vector.h"
#include "run/walk.h"
#include "run/way.h"

#include <math.h>

/// Does something of the wall tree stop the segment? -1 or the barrier.
static int32_t find_wall(const enf_file_view *view, const enf_segment *segment, bool with_detail) {
    enf_walk walk;
    enf_walk_begin(&walk, view, segment, view->wall_nodes, view->wall_node_count);
    int32_t number;
    while ((number = enf_walk_next(&walk)) >= 0) {
        const enf_file_barrier *barrier = &view->barriers[number];
        if (barrier->kind == ENF_FILE_BARRIER_DETAIL && !with_detail) continue;
        if (enf_segment_passes(view, segment, barrier, NULL)) return number;
    }
    return -1;
}

/// Looks at the portals on the way. False if one is shut.
static bool pass_portals(const enf_way *way, const enf_sight_query *query, enf_sight *sight) {
    enf_passed passed = {query->portals, query->portal_capacity, 0};
    bool wanted = query->portals && query->portal_capacity > 0;
    enf_way_look look = wanted ? ENF_WAY_UNCLEAR : enf_way_look_ahead(way, &sight->portal);
    if (look != ENF_WAY_UNCLEAR) return look == ENF_WAY_CLEAR;
    int32_t cell = sight->from.cell;
    enf_way_end end = enf_way_pass(way, ENF_WAY_WHOLE, &cell, sight->to.cell, &passed);
    sight->portal = end.portal;
    if (end.outcome == ENF_WAY_FREE && wanted) sight->portal_count = passed.count;
    return end.outcome == ENF_WAY_FREE;
}

/// Finds both ends. False if one is in no cell.
static bool find_ends(const enf_world *world, const enf_sight_query *query, enf_sight *sight) {
    sight->from = query->from_place ? *query->from_place : enf_world_locate(world, query->from, -1);
    if (query->to_place)
        sight->to = *query->to_place;
    else
        sight->to = enf_world_locate(world, query->to, -1);
    const enf_file_view *view = enf_world_file(world);
    return sight->from.cell >= 0 && sight->to.cell >= 0 && sight->from.cell < view->cell_count &&
           sight->to.cell < view->cell_count && enf_are_finite(query->from, 3) &&
           enf_are_finite(query->to, 3);
}

enf_status enf_sight_between(const enf_world *world, const enf_instance *instance,
                             const enf_sight_query *query, enf_sight *sight, enf_error *error) {
    const enf_place nowhere = {-1, -1, -1, -1, ENF_WORLD_OUTSIDE};
    *sight = (enf_sight){.from = nowhere, .to = nowhere, .triangle = -1, .portal = -1};
    const enf_file_view *view = enf_world_file(world);
    if (!view->sight) return enf_fail_sight(world, error);
    enf_way way = {.view = view, .instance = instance, .transforms_stop = true};
    if (!find_ends(world, query, sight) || !enf_way_set(&way, query->from, query->to)) return ENF_OK;
    int32_t wall = find_wall(view, &way.segment, query->stopped_by_detail);
    if (wall < 0) {
        sight->is_free = pass_portals(&way, query, sight);
    } else if (view->has_geometry) {
        sight->triangle = view->barriers[wall].index;
    }
    return ENF_OK;
}
