// SPDX-License-Identifier: MIT
// A line of sight is decided by walls and doors alone, all of them at once: which cells it passes does not
// matter for that, and is only found out if somebody wants to know.
#include "enfilade/sight.h"

#include "run/crossings.h"
#include "run/instance.h"
#include "run/walk.h"

#include <math.h>

#define SHARE_END 2.0 ///< beyond all shares of a segment

/// Does something of the wall tree stop the segment? -1 or the barrier.
static int32_t find_wall(const enf_file_view *view, const enf_segment *segment, bool with_detail) {
    enf_walk walk;
    enf_walk_begin(&walk, view, segment, view->wall_nodes, view->wall_node_count);
    int32_t number;
    while ((number = enf_walk_next(&walk)) >= 0) {
        const enf_file_barrier *barrier = &view->barriers[number];
        if (barrier->kind == ENF_FILE_BARRIER_DETAIL && !with_detail) continue;
        if (enf_segment_passes(view, segment, barrier, NULL, NULL)) return number;
    }
    return -1;
}

/// Portals passed, as far as there is room to note them.
static void note_portals(const enf_sight_query *query, enf_sight *sight, const enf_crossings *crossings,
                         const enf_chain *chain) {
    for (int32_t i = 0; i < chain->count; i++, sight->portal_count++) {
        if (sight->portal_count < query->portal_capacity)
            query->portals[sight->portal_count] = crossings->list[chain->links[i]].portal;
    }
}

static bool is_shut(const enf_instance *instance, const enf_file_view *view, const enf_sight_query *query,
                    const enf_crossing *crossing) {
    enf_passage passage = enf_instance_passage(instance, view, crossing->portal);
    if (passage.to < 0 || passage.matrix) return true;
    if (!passage.cut) return false;
    double height = passage.plane[3];
    for (int a = 0; a < 3; a++)
        height += passage.plane[a] * (query->from[a] + crossing->share * (query->to[a] - query->from[a]));
    return !(height >= 0);
}

/// Looks at the portals on the way. False if one is shut.
static bool pass_portals(const enf_world *world, const enf_instance *instance, const enf_sight_query *query,
                         const enf_segment *segment, enf_sight *sight) {
    const enf_file_view *view = enf_world_file(world);
    bool wanted = query->portals && query->portal_capacity > 0,
         may_be_shut = enf_instance_is_changed(instance);
    if (!wanted && !may_be_shut) return true;
    int32_t cell = sight->from.cell;
    for (double begin = 0; begin < SHARE_END;) {
        enf_crossings crossings;
        enf_crossings_find(&crossings, view, segment, begin, SHARE_END);
        for (int32_t i = 0; may_be_shut && i < crossings.count; i++) {
            if (!is_shut(instance, view, query, &crossings.list[i])) continue;
            sight->portal = crossings.list[i].portal;
            sight->portal_count = 0;
            return false;
        }
        if (wanted) {
            enf_chain chain;
            enf_chain_find(&chain, &crossings, view, cell, crossings.end < SHARE_END ? -1 : sight->to.cell);
            note_portals(query, sight, &crossings, &chain);
            cell = chain.cell;
        }
        if (!(crossings.end > begin)) break;
        begin = crossings.end;
    }
    return true;
}

static bool is_finite(const double point[3]) {
    return isfinite(point[0]) && isfinite(point[1]) && isfinite(point[2]);
}

/// Finds both ends. False if one is in no cell.
static bool find_ends(const enf_world *world, const enf_sight_query *query, enf_sight *sight) {
    sight->from = query->from_place ? *query->from_place : enf_world_locate(world, query->from, -1);
    if (query->to_place)
        sight->to = *query->to_place;
    else
        sight->to = enf_world_locate(world, query->to, sight->from.tetrahedron);
    const enf_file_view *view = enf_world_file(world);
    return sight->from.cell >= 0 && sight->to.cell >= 0 && sight->from.cell < view->cell_count &&
           sight->to.cell < view->cell_count && is_finite(query->from) && is_finite(query->to);
}

enf_status enf_sight_between(const enf_world *world, const enf_instance *instance,
                             const enf_sight_query *query, enf_sight *sight, enf_error *error) {
    const enf_place nowhere = {-1, -1, -1, -1, ENF_WORLD_OUTSIDE};
    *sight = (enf_sight){.from = nowhere, .to = nowhere, .triangle = -1, .portal = -1};
    const enf_file_view *view = enf_world_file(world);
    if (!view->sight)
        return enf_fail(error, ENF_BAD_INPUT,
                        "the world file has no part for lines of sight; compile the world again");
    enf_segment segment;
    if (!find_ends(world, query, sight) || !enf_fine_point(view, query->from, segment.from) ||
        !enf_fine_point(view, query->to, segment.to))
        return ENF_OK;
    int32_t wall = find_wall(view, &segment, query->stopped_by_detail);
    if (wall < 0) {
        sight->is_free = pass_portals(world, instance, query, &segment, sight);
    } else if (view->has_geometry) {
        sight->triangle = view->barriers[wall].index;
    }
    return ENF_OK;
}
