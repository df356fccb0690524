// SPDX-License-Identifier: MIT
#include "run/view_queue.h"

#include <stdlib.h>
#include <string.h>

/// Two regions become one if the hull is larger than both together by at most this share.
static const double join_waste = 0.125;

enum { GROWTHS_MAX = 3 };

bool enf_queue_create(enf_view_queue *q, int32_t capacity, int32_t edges_max, int32_t regions_max) {
    size_t n = (size_t)capacity, slots = 16;
    while (slots < 2 * n) slots *= 2;
    *q = (enf_view_queue){.capacity = capacity, .edges_max = edges_max, .regions_max = regions_max};
    if (n > SIZE_MAX / 2 / ((size_t)edges_max * sizeof *q->lines)) return false;
    q->slot_mask = (uint32_t)(slots - 1);
    q->visits = malloc(n * sizeof *q->visits);
    q->places = malloc(n * sizeof *q->places);
    q->waiting = malloc(n * sizeof *q->waiting);
    q->slots = calloc(slots, sizeof *q->slots);
    q->corners = malloc(n * (size_t)edges_max * sizeof *q->corners);
    q->lines = malloc(n * (size_t)edges_max * sizeof *q->lines);
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

static void add_visit(enf_view_queue *q, enf_view_place *place, const enf_view_arrival *arrival) {
    int32_t number = q->visit_count++;
    size_t first = (size_t)number * (size_t)q->edges_max;
    enf_view_visit *visit = &q->visits[number];
    visit->region.corners = q->corners + first;
    visit->region.lines = q->lines + first;
    enf_region_copy(&visit->region, arrival->region);
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

/// Joins a visit that waits, if that costs little.
static bool join(enf_view_queue *q, int32_t number, const enf_view_arrival *arrival, enf_visible *visible) {
    enf_view_visit *visit = &q->visits[number];
    double corners[ENF_VIEW_CORNERS][2];
    if (visit->waiting < 0 || !overlap(visit->region.rectangle, arrival->region->rectangle)) return false;
    int32_t count = enf_view_hull(&visit->region, arrival->region, corners);
    double sum = visit->region.area + arrival->region->area;
    if (count > 2 && enf_polygon_area((const double(*)[2])corners, count) > sum * (1 + join_waste))
        return false;
    visible->stats.edges_removed += enf_region_make(&visit->region, corners, count, q->edges_max, NULL);
    wait(q, number, arrival->nearest);
    visible->stats.joined++;
    return true;
}

/// Joins the place's last visit, whatever it costs.
static void grow(enf_view_queue *q, enf_view_place *place, const enf_view_arrival *arrival,
                 enf_visible *visible) {
    static const double screen[4] = {-1, -1, 1, 1};
    enf_view_visit *visit = &q->visits[place->first];
    double corners[ENF_VIEW_CORNERS][2];
    if (visit->waiting < 0) place->growths++;
    if (place->growths > GROWTHS_MAX) {
        enf_region_make_rectangle(&visit->region, screen);
        place->is_whole = true;
    } else {
        int32_t count = enf_view_hull(&visit->region, arrival->region, corners);
        visible->stats.edges_removed += enf_region_make(&visit->region, corners, count, q->edges_max, NULL);
    }
    wait(q, place->first, arrival->nearest);
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
    for (int32_t i = place->first; i >= 0; i = q->visits[i].next)
        if (join(q, i, arrival, visible)) return true;
    if (place->visit_count < q->regions_max && q->visit_count < q->capacity)
        add_visit(q, place, arrival);
    else
        grow(q, place, arrival, visible);
    return true;
}
