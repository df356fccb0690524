// SPDX-License-Identifier: MIT
#include "run/view_queue.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Two regions become one if the hull is larger than both together by at most this share.
static const double join_waste = 1;

enum { GROWTHS_MAX = 3 };

bool enf_queue_create(enf_view_queue *q, const enf_view_options *options) {
    int32_t edges_max = options->edges_max;
    size_t n = (size_t)options->visit_capacity, slots = 16;
    while (slots < 2 * n) slots *= 2;
    *q = (enf_view_queue){.capacity = options->visit_capacity,
                          .edges_max = edges_max,
                          .regions_max = options->regions_max,
                          .rectangles = options->rectangles};
    if (n > SIZE_MAX / 2 / (((size_t)edges_max + 4) * sizeof *q->lines)) return false;
    q->slot_mask = (uint32_t)(slots - 1);
    q->visits = malloc(n * sizeof *q->visits);
    q->places = malloc(n * sizeof *q->places);
    q->waiting = malloc(n * sizeof *q->waiting);
    q->slots = calloc(slots, sizeof *q->slots);
    q->corners = malloc(n * (size_t)edges_max * sizeof *q->corners);
    q->lines = malloc(n * ((size_t)edges_max + 4) * sizeof *q->lines);
    return q->visits && q->places && q->waiting && q->slots && q->corners && q->lines;
}

void enf_queue_free(enf_view_queue *q) {
    free(q->visits);
    free(q->places);
    free(q->waiting);
    free(q->slots);
    free(q->corners);
    free(q->lines);
}

void enf_queue_clear(enf_view_queue *q) {
    q->visit_count = q->place_count = q->waiting_count = 0;
    if (++q->run) return;
    memset(q->slots, 0, ((size_t)q->slot_mask + 1) * sizeof *q->slots);
    q->run = 1;
}

// --- the heap
// ------------------------------------------------------------------------------------------------

static bool goes_before(const enf_view_queue *q, int32_t a, int32_t b) {
    const enf_view_visit *u = &q->visits[a], *v = &q->visits[b];
    return u->nearest < v->nearest || (u->nearest == v->nearest && a < b);
}

static void put(enf_view_queue *q, int32_t position, int32_t visit) {
    q->waiting[position] = visit;
    q->visits[visit].waiting = position;
}

static void move_up(enf_view_queue *q, int32_t position) {
    int32_t visit = q->waiting[position];
    while (position > 0) {
        int32_t above = (position - 1) / 2;
        if (!goes_before(q, visit, q->waiting[above])) break;
        put(q, position, q->waiting[above]);
        position = above;
    }
    put(q, position, visit);
}

static void move_down(enf_view_queue *q, int32_t visit) {
    int32_t position = 0;
    for (;;) {
        int32_t below = 2 * position + 1;
        if (below >= q->waiting_count) break;
        if (below + 1 < q->waiting_count && goes_before(q, q->waiting[below + 1], q->waiting[below])) below++;
        if (!goes_before(q, q->waiting[below], visit)) break;
        put(q, position, q->waiting[below]);
        position = below;
    }
    put(q, position, visit);
}

int32_t enf_queue_take(enf_view_queue *q) {
    if (q->waiting_count == 0) return -1;
    int32_t visit = q->waiting[0], last = q->waiting[--q->waiting_count];
    if (q->waiting_count > 0) move_down(q, last);
    q->visits[visit].waiting = -1;
    return visit;
}

/// Waits, or waits earlier.
static void wait(enf_view_queue *q, int32_t visit, double nearest) {
    enf_view_visit *v = &q->visits[visit];
    if (v->waiting >= 0) {
        if (nearest < v->nearest) {
            v->nearest = nearest;
            move_up(q, v->waiting);
        }
        return;
    }
    v->nearest = nearest;
    q->waiting[q->waiting_count] = visit;
    move_up(q, q->waiting_count++);
}

// --- places
// --------------------------------------------------------------------------------------------------

/// The place of a cell in a space; made if there is none. Null: no room.
static enf_view_place *find_place(enf_view_queue *q, int32_t cell, int32_t space) {
    uint32_t hash = (uint32_t)cell * UINT32_C(0x9e3779b1) ^ (uint32_t)space * UINT32_C(0x85ebca6b);
    hash ^= hash >> 15;
    for (uint32_t i = hash & q->slot_mask;; i = (i + 1) & q->slot_mask) { // half of the slots are free
        enf_view_slot *slot = &q->slots[i];
        if (slot->run == q->run) {
            enf_view_place *place = &q->places[slot->place];
            if (place->cell == cell && place->space == space) return place;
            continue;
        }
        if (q->place_count == q->capacity || q->visit_count == q->capacity) return NULL;
        *slot = (enf_view_slot){.run = q->run, .place = q->place_count};
        enf_view_place *place = &q->places[q->place_count++];
        *place = (enf_view_place){.cell = cell, .space = space, .first = -1, .entry = -1};
        return place;
    }
}

/// Keeps a region, with fewer edges if it has too many.
static void store(const enf_view_queue *q, enf_view_region *region, const enf_view_region *from,
                  enf_view_stats *stats) {
    if (from->count <= q->edges_max)
        enf_region_copy(region, from);
    else
        stats->edges_removed += enf_region_simplify(region, from, q->edges_max);
}

static void add_visit(enf_view_queue *q, enf_view_place *place, const enf_view_arrival *arrival,
                      enf_visible *visible) {
    int32_t number = q->visit_count++;
    size_t edges = (size_t)q->edges_max;
    enf_view_visit *visit = &q->visits[number];
    visit->region.corners = q->corners + (size_t)number * edges;
    visit->region.lines = q->lines + (size_t)number * (edges + 4);
    store(q, &visit->region, arrival->region, &visible->stats);
    visit->place = (int32_t)(place - q->places);
    visit->next = place->first;
    visit->parent = arrival->parent;
    visit->portal = arrival->portal;
    visit->depth = arrival->depth;
    visit->waiting = visit->entry = -1;
    place->first = number;
    place->visit_count++;
    wait(q, number, arrival->nearest);
}

int32_t enf_view_hull(const enf_view_region *a, const enf_view_region *b, double (*corners)[2]) {
    memcpy(corners, a->corners, (size_t)a->count * sizeof *corners);
    memcpy(corners + a->count, b->corners, (size_t)b->count * sizeof *corners);
    return enf_hull(corners, a->count + b->count);
}

static bool overlap(const double a[4], const double b[4]) {
    const double h = 2 * ENF_VIEW_SLACK;
    return a[0] <= b[2] + h && b[0] <= a[2] + h && a[1] <= b[3] + h && b[1] <= a[3] + h;
}

static void unite_rectangles(const double a[4], const double b[4], double united[4]) {
    for (int i = 0; i < 4; i++) united[i] = i < 2 ? fmin(a[i], b[i]) : fmax(a[i], b[i]);
}

/// The hull of a visit's region and another takes the visit's place if it is not much larger than both.
static bool unite(const enf_view_queue *q, enf_view_region *region, const enf_view_region *other,
                  enf_view_stats *stats) {
    double most = (region->area + other->area) * (1 + join_waste), united[4];
    if (q->rectangles) {
        unite_rectangles(region->rectangle, other->rectangle, united);
        if ((united[2] - united[0]) * (united[3] - united[1]) > most) return false;
        enf_region_make_rectangle(region, united);
        return true;
    }
    double corners[ENF_VIEW_CORNERS][2], hull_corners[ENF_VIEW_EDGES_MAX][2];
    enf_view_line hull_lines[ENF_VIEW_LINES];
    enf_view_region hull = {.corners = hull_corners, .lines = hull_lines};
    int32_t count = enf_view_hull(region, other, corners);
    if (count > 2 && enf_polygon_area((const double(*)[2])corners, count) > most) return false;
    enf_region_outline(&hull, corners, count);
    enf_region_draw(&hull, region, other);
    store(q, region, &hull, stats);
    return true;
}

/// Joins a visit that waits, if that costs little.
static bool join(enf_view_queue *q, int32_t number, const enf_view_arrival *arrival, enf_visible *visible) {
    enf_view_visit *visit = &q->visits[number];
    if (visit->waiting < 0 || !overlap(visit->region.rectangle, arrival->region->rectangle)) return false;
    if (!unite(q, &visit->region, arrival->region, &visible->stats)) return false;
    wait(q, number, arrival->nearest);
    visible->stats.joined++;
    return true;
}

/// Where sides of the rectangle lie on lines that are there, these stay as they are.
static void replace_by_rectangle(const enf_view_queue *q, enf_view_region *region, const double r[4],
                                 const enf_view_region *other) {
    if (q->rectangles) {
        enf_region_make_rectangle(region, r);
        return;
    }
    double corners[4][2] = {{r[0], r[1]}, {r[2], r[1]}, {r[2], r[3]}, {r[0], r[3]}}, kept_corners[4][2];
    enf_view_line kept_lines[ENF_VIEW_LINES];
    enf_view_region kept = {.corners = kept_corners, .lines = kept_lines};
    enf_region_outline(&kept, corners, 4);
    enf_region_draw(&kept, region, other);
    enf_region_copy(region, &kept);
}

/// Joins a visit whatever it costs: one that waits, if there is one. Rectangles grow less often.
static void grow(enf_view_queue *q, enf_view_place *place, const enf_view_arrival *arrival,
                 enf_visible *visible) {
    static const double screen[4] = {-1, -1, 1, 1};
    int32_t number = place->first;
    for (int32_t i = number; i >= 0; i = q->visits[i].next)
        if (q->visits[i].waiting >= 0) number = i;
    enf_view_region *region = &q->visits[number].region;
    if (q->visits[number].waiting < 0 && ++place->growths > GROWTHS_MAX) {
        enf_region_make_rectangle(region, screen);
        place->is_whole = true;
    } else {
        double r[4];
        unite_rectangles(region->rectangle, arrival->region->rectangle, r);
        replace_by_rectangle(q, region, r, arrival->region);
    }
    wait(q, number, arrival->nearest);
    visible->stats.grown++;
    visible->flags |= ENF_VIEW_GROWN;
}

bool enf_queue_add(enf_view_queue *q, const enf_view_arrival *arrival, enf_visible *visible) {
    enf_view_place *place = find_place(q, arrival->cell, arrival->space);
    if (!place) return false;
    visible->stats.passed++;
    for (int32_t i = place->first; i >= 0; i = q->visits[i].next) {
        if (!place->is_whole && !enf_region_contains(&q->visits[i].region, arrival->region)) continue;
        visible->stats.contained++;
        if (q->visits[i].waiting >= 0) wait(q, i, arrival->nearest);
        return true;
    }
    enf_region_draw(arrival->region, arrival->outer, NULL);
    for (int32_t i = place->first; i >= 0; i = q->visits[i].next)
        if (join(q, i, arrival, visible)) return true;
    if (place->visit_count < q->regions_max && q->visit_count < q->capacity)
        add_visit(q, place, arrival, visible);
    else
        grow(q, place, arrival, visible);
    return true;
}
