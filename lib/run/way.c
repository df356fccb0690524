// SPDX-License-Identifier: MIT
#include "run/way.h"

#include "run/crossings.h"
#include "run/open.h"
#include "run/walk.h"

bool enf_way_set(enf_way *way, const double from[3], const double to[3]) {
    for (int a = 0; a < 3; a++) {
        way->from[a] = from[a];
        way->to[a] = to[a];
    }
    return enf_fine_point(way->view, from, way->segment.from) &&
           enf_fine_point(way->view, to, way->segment.to);
}

void enf_way_point(const enf_way *way, double share, double point[3]) {
    for (int a = 0; a < 3; a++) point[a] = way->from[a] + share * (way->to[a] - way->from[a]);
}

static bool is_shut(const enf_way *way, const enf_crossing *crossing, const enf_passage *passage) {
    if (passage->to < 0 || (passage->matrix && way->transforms_stop)) return true;
    if (!passage->cut) return false;
    double point[3], height = passage->plane[3];
    enf_way_point(way, crossing->share, point);
    for (int a = 0; a < 3; a++) height += passage->plane[a] * point[a];
    return !(height >= 0);
}

/// The first crossing that is shut; as many as there are if none is.
static int32_t find_shut(const enf_way *way, const enf_crossings *crossings) {
    int32_t i = 0;
    for (; i < crossings->count; i++) {
        if (crossings->list[i].touches) continue;
        enf_passage passage = enf_instance_passage(way->instance, way->view, crossings->list[i].portal);
        if (is_shut(way, &crossings->list[i], &passage)) break;
    }
    return i;
}

/// What a portal on the way means for it. *shut: the nearest one that is shut so far.
static enf_way_look look_at(const enf_way *way, const enf_file_barrier *barrier, enf_crossing *shut) {
    enf_meeting meeting;
    if (barrier->kind != ENF_FILE_BARRIER_PORTAL) return ENF_WAY_CLEAR;
    if (!enf_instance_pair_is_changed(way->instance, barrier->index)) return ENF_WAY_CLEAR;
    if (!enf_segment_meets(way->view, &way->segment, barrier, &meeting)) return ENF_WAY_CLEAR;
    if (meeting.touches) return ENF_WAY_UNCLEAR;
    enf_crossing crossing = {meeting.share, barrier->index + !meeting.from_front, false};
    enf_passage passage = enf_instance_passage(way->instance, way->view, crossing.portal);
    if (!is_shut(way, &crossing, &passage)) return passage.matrix ? ENF_WAY_UNCLEAR : ENF_WAY_CLEAR;
    if (crossing.share < shut->share) *shut = crossing;
    return ENF_WAY_STOPPED;
}

enf_way_look enf_way_look_ahead(const enf_way *way, int32_t *portal) {
    *portal = -1;
    if (!enf_instance_is_changed(way->instance)) return ENF_WAY_CLEAR;
    enf_walk walk;
    enf_walk_begin(&walk, way->view, &way->segment, way->view->portal_nodes, way->view->portal_node_count);
    walk.below = enf_instance_changed_below(way->instance, way->view->portal_node_count);
    enf_crossing shut = {.share = ENF_WAY_WHOLE, .portal = -1};
    int32_t number;
    while ((number = enf_walk_next(&walk)) >= 0)
        if (look_at(way, &way->view->barriers[number], &shut) == ENF_WAY_UNCLEAR) return ENF_WAY_UNCLEAR;
    *portal = shut.portal;
    return shut.portal >= 0 ? ENF_WAY_STOPPED : ENF_WAY_CLEAR;
}

static void note(enf_passed *passed, int32_t portal) {
    if (passed->portals && passed->count < passed->capacity) passed->portals[passed->count] = portal;
    if (passed->count < INT32_MAX) passed->count++;
}

static enf_way_end end_at(enf_way_outcome outcome, const enf_crossing *crossing) {
    return (enf_way_end){.outcome = outcome, .share = crossing->share, .portal = crossing->portal};
}

/// Goes along the chain, up to the crossing that is shut.
static enf_way_end follow_chain(const enf_way *way, const enf_crossings *crossings, const enf_chain *chain,
                                int32_t shut, int32_t *cell, enf_passed *passed) {
    bool may_change = enf_instance_is_changed(way->instance);
    for (int32_t i = 0; i < chain->count && chain->links[i] < shut; i++) {
        const enf_crossing *crossing = &crossings->list[chain->links[i]];
        enf_way_end led = end_at(ENF_WAY_LED, crossing);
        if (may_change) {
            led.passage = enf_instance_passage(way->instance, way->view, crossing->portal);
            if (is_shut(way, crossing, &led.passage)) return end_at(ENF_WAY_SHUT, crossing);
        }
        note(passed, crossing->portal);
        if (led.passage.matrix) return led;
        *cell = way->view->portals[crossing->portal].to;
    }
    if (shut < crossings->count) return end_at(ENF_WAY_SHUT, &crossings->list[shut]);
    return (enf_way_end){.outcome = ENF_WAY_FREE, .portal = -1};
}

enf_way_end enf_way_pass(const enf_way *way, double end, int32_t *cell, int32_t goal, enf_passed *passed) {
    enf_way_end ended = {.outcome = ENF_WAY_FREE, .portal = -1};
    for (double begin = 0; begin < end && ended.outcome == ENF_WAY_FREE;) {
        enf_crossings crossings;
        enf_chain chain;
        enf_crossings_find(&crossings, way->view, &way->segment, begin, end);
        int32_t shut = crossings.count;
        if (enf_instance_is_changed(way->instance)) shut = find_shut(way, &crossings);
        bool last = shut == crossings.count && crossings.end >= end;
        enf_chain_find(&chain, &crossings, way->view, *cell, last ? goal : -1);
        ended = follow_chain(way, &crossings, &chain, shut, cell, passed);
        if (!(crossings.end > begin)) break;
        begin = crossings.end;
    }
    return ended;
}

enf_status enf_fail_sight(const enf_world *world, enf_error *error) {
    if (enf_world_has(world, ENF_LOAD_SIGHT))
        return enf_fail(error, ENF_BAD_USAGE,
                        "lines of sight are not loaded; call enf_world_load with ENF_LOAD_SIGHT");
    return enf_fail(error, ENF_BAD_INPUT,
                    "the world file has no part for lines of sight; compile the world again");
}
