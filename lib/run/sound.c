// SPDX-License-Identifier: MIT
// Two searches. The first spreads from the source over all portals in range and leaves the least cost of
// each. The second goes back from the listener, always on with the way whose whole cost, known exactly by the
// first search, is least: whole ways come out in their order (the k shortest paths as A* with a perfect
// bound).
#include "enfilade/sound.h"

#include "run/path_finder.h"
#include "run/path_pull.h"
#include "run/vector.h"

#include <string.h>

enum { SWEEPS = 100 };
#define TOLERANCE 1e-5

typedef struct hearing {
    enf_path_finder *finder;
    const enf_paths *paths;
    const enf_instance *instance;
    const enf_sound_query *query;
    enf_path_goal source, listener;
    int64_t range; ///< units
    bool is_plain; ///< no portal transforms, so no way to the listener is shorter than these say:
    enf_path_ranges ranges;
    enf_sound_path *out;
    int32_t trace_count, portal_count; ///< portal_count: of the query's room
    enf_sound sound;
} hearing;

static double clamp_factor(double factor) {
    return factor > 0 ? fmin(factor, 1) : 0; // 0 for what is no number
}

/// What a portal leaves of a sound, from 0 to 1.
static double factor_of(const hearing *h, int32_t portal, bool is_shut) {
    const enf_sound_query *query = h->query;
    double factor = 1;
    if (query->factors)
        factor = query->factors[portal / 2];
    else if (query->factor)
        factor = query->factor(query->user, portal);
    return clamp_factor(factor) * (is_shut ? clamp_factor(query->door_factor) : 1);
}

/// What passing a portal costs; ENF_PATH_NEVER: nothing passes.
static int64_t passing_cost(const hearing *h, int32_t portal, bool is_shut) {
    double factor = factor_of(h, portal, is_shut);
    if (factor == 0) return ENF_PATH_NEVER;
    double cost = -log(factor) * h->query->fade_length * h->paths->unit;
    return cost < h->paths->longest ? (int64_t)cost : (int64_t)h->paths->longest;
}

// ---------------------------------------------------------------------------------------------- from the
// source

/// No way from a portal's point to the listener is shorter.
static int64_t bound(const hearing *h, int32_t portal) {
    if (!h->is_plain) return 0;
    int64_t straight = enf_path_straight(h->paths, enf_path_place(h->paths, portal), h->listener.point);
    int32_t gate = h->paths->gate[portal / 2];
    int64_t other = gate >= 0 ? enf_path_landmarks_bound(h->paths, gate, &h->ranges) : 0;
    return straight > other ? straight : other;
}

/// Takes the cost of a portal, passed, if a way through it can end within the range.
static void reach(hearing *h, int32_t portal, int64_t cost) {
    if (enf_path_is_reached(&h->finder->search, portal) && cost >= h->finder->search.cost[portal]) return;
    bool is_shut;
    enf_instance_lead(h->instance, h->paths->view, portal, &is_shut);
    int64_t passing = passing_cost(h, portal, is_shut);
    if (passing == ENF_PATH_NEVER || cost > h->range - passing - bound(h, portal)) return;
    enf_path_search_reach(&h->finder->search, portal, cost + passing, cost + passing);
}

static void spread(hearing *h, int32_t cell, const double place[3], int64_t cost) {
    int32_t count;
    const int32_t *exits = enf_path_exits(h->paths, cell, &count);
    for (int32_t i = 0; i < count; i++)
        reach(h, exits[i], cost + enf_path_step(h->paths, place, enf_path_place(h->paths, exits[i])));
}

static void spread_from_source(hearing *h) {
    enf_path_search *search = &h->finder->search;
    enf_path_search_begin(search);
    spread(h, h->source.cell, h->source.point, 0);
    while (search->heap.count > 0) {
        int32_t portal = enf_path_heap_pop(&search->heap).node;
        bool is_shut;
        enf_passage passage = enf_instance_lead(h->instance, h->paths->view, portal, &is_shut);
        double out[3];
        enf_path_come_out(h->paths, portal, passage.matrix, out);
        spread(h, passage.to, out, search->cost[portal]);
    }
}

// ---------------------------------------------------------------------------------------------- back again

/// Notes a step; `rest`: the cost from the source up to it.
static void note(hearing *h, int32_t portal, int32_t behind, int64_t cost, int64_t rest) {
    if (cost > h->range - rest) return;
    if (h->trace_count == h->finder->trace_max) {
        h->sound.is_complete = false;
        return;
    }
    h->finder->traces[h->trace_count] = (enf_path_trace){cost, portal, behind};
    enf_path_heap_add(&h->finder->open, h->trace_count++, cost + rest);
}

/// Does the way behind a step go through a cell?
static bool passes(const hearing *h, int32_t step, int32_t cell) {
    for (; step >= 0; step = h->finder->traces[step].behind)
        if (h->paths->view->portals[h->finder->traces[step].portal].from == cell) return true;
    return h->listener.cell == cell;
}

/// A portal that may lead into a cell, before a place in it.
static void come_by(hearing *h, int32_t portal, int32_t cell, const double place[3], int32_t behind,
                    int64_t cost) {
    bool is_shut;
    if (!enf_path_is_reached(&h->finder->search, portal)) return;
    enf_passage passage = enf_instance_lead(h->instance, h->paths->view, portal, &is_shut);
    if (passage.to != cell || passes(h, behind, h->paths->view->portals[portal].from)) return;
    double out[3];
    enf_path_come_out(h->paths, portal, passage.matrix, out);
    note(h, portal, behind, cost + enf_path_step(h->paths, out, place), h->finder->search.cost[portal]);
}

/// From a place in a cell back to all portals that lead there, or to the source.
static void go_back(hearing *h, int32_t cell, const double place[3], int32_t behind, int64_t cost) {
    int32_t count;
    const int32_t *exits = enf_path_exits(h->paths, cell, &count), *transforms;
    if (cell == h->source.cell) {
        note(h, -1, behind, cost + enf_path_step(h->paths, h->source.point, place), 0);
        return;
    }
    for (int32_t i = 0; i < count; i++) {
        bool is_shut;
        if (!enf_instance_lead(h->instance, h->paths->view, exits[i] ^ 1, &is_shut).matrix)
            come_by(h, exits[i] ^ 1, cell, place, behind, cost);
    }
    count = enf_instance_transforms(h->instance, &transforms);
    for (int32_t i = 0; i < count; i++) come_by(h, transforms[i], cell, place, behind, cost);
}

// ---------------------------------------------------------------------------------------------- a whole way

static void keep_portals(hearing *h, enf_sound_path *path, const int32_t *route) {
    const enf_sound_query *query = h->query;
    path->portal_first = -1;
    if (!query->portals || path->portal_count > query->portal_capacity - h->portal_count) return;
    path->portal_first = h->portal_count;
    memcpy(query->portals + h->portal_count, route, (size_t)path->portal_count * sizeof *route);
    h->portal_count += path->portal_count;
}

/// Writes the way that begins with a step behind the source.
static void write_way(hearing *h, int32_t step, enf_sound_path *path) {
    enf_path_finder *finder = h->finder;
    int32_t *route = finder->search.route;
    *path = (enf_sound_path){.factor = 1, .portal = -1};
    for (; step >= 0; step = finder->traces[step].behind) {
        bool is_shut;
        path->portal = route[path->portal_count++] = finder->traces[step].portal;
        enf_instance_lead(h->instance, h->paths->view, path->portal, &is_shut);
        path->factor *= factor_of(h, path->portal, is_shut);
    }
    enf_path_line line = {h->paths,       h->instance, route, path->portal_count,
                          finder->points, TOLERANCE,   SWEEPS};
    enf_path_line_pull(&line, h->query->source, h->query->listener);
    path->length = enf_path_line_length(&line);
    path->cost = path->length - (h->query->fade_length > 0 ? h->query->fade_length * log(path->factor) : 0);
    memcpy(path->point, finder->points[enf_path_line_size(&line) - 2], sizeof path->point);
    double distance = enf_distance(path->point, h->query->listener);
    for (int a = 0; a < 3 && distance > 0; a++)
        path->direction[a] = (path->point[a] - h->query->listener[a]) / distance;
    keep_portals(h, path, route);
}

/// Into the order of costs, behind equal ones.
static void add_way(hearing *h, int32_t step) {
    enf_sound_path path;
    write_way(h, step, &path);
    int32_t at = h->sound.count++;
    for (; at > 0 && h->out[at - 1].cost > path.cost; at--) h->out[at] = h->out[at - 1];
    h->out[at] = path;
}

static void find_ways(hearing *h, int32_t capacity) {
    enf_path_heap *open = &h->finder->open;
    open->count = 0;
    go_back(h, h->listener.cell, h->listener.point, -1, 0);
    while (open->count > 0 && h->sound.count < capacity) {
        int32_t step = enf_path_heap_pop(open).node;
        const enf_path_trace *trace = &h->finder->traces[step];
        if (trace->portal < 0) {
            add_way(h, trace->behind);
            continue;
        }
        bool is_shut;
        enf_instance_lead(h->instance, h->paths->view, trace->portal, &is_shut);
        int64_t passing = passing_cost(h, trace->portal, is_shut);
        if (passing < ENF_PATH_NEVER)
            go_back(h, h->paths->view->portals[trace->portal].from, enf_path_place(h->paths, trace->portal),
                    step, trace->cost + passing);
    }
}

enf_status enf_sound_find(enf_path_finder *finder, const enf_instance *instance, const enf_sound_query *query,
                          enf_sound_path *out, int32_t capacity, enf_sound *sound, enf_error *error) {
    hearing h = {finder, finder->paths, instance, query, .out = out, .sound.is_complete = true};
    *sound = h.sound;
    if (!(query->range >= 0) || !(query->fade_length >= 0) || isinf(query->fade_length))
        return enf_fail(error, ENF_BAD_USAGE, "the range and the fading of a sound are lengths");
    enf_status status = enf_path_find_goal(h.paths, query->source_cell, query->source, &h.source, error);
    if (!status)
        status = enf_path_find_goal(h.paths, query->listener_cell, query->listener, &h.listener, error);
    if (status || h.source.cell < 0 || h.listener.cell < 0) return status;
    double units = query->range * h.paths->unit;
    h.range = units < 0x1p61 ? (int64_t)units : INT64_C(1) << 61;
    const int32_t *transforms;
    h.is_plain = enf_instance_transforms(instance, &transforms) == 0;
    if (h.is_plain && h.paths->component[h.source.cell] != h.paths->component[h.listener.cell]) return ENF_OK;
    enf_path_landmarks_look(h.paths, &h.listener, &h.ranges);
    spread_from_source(&h);
    find_ways(&h, capacity);
    *sound = h.sound;
    return ENF_OK;
}
