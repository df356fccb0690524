// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/body_beams.h"

#include "base/array.h"
#include "visibility/bits.h"
#include "visibility/coplanar.h"
#include "visibility/facing.h"
#include "visibility/hull.h"
#include "visibility/kept.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Windows are put together if their hull is no larger than this, as a part of what they are by themselves.
/// (Together with the order it takes off a third of the visits, and adds two to six pairs in a thousand.)
static const double join_most = 1.1;

typedef struct waiting {
    double depth; ///< nearer ones go first
    int32_t cell;
} waiting;

/// What beams reach of one portal, or of some in one plane.
typedef struct gap {
    int32_t portal; ///< one of them
    enf_outline outline;
    double area;               ///< twice its area, seen along an axis; -1: not known yet
    double middle[3], half[3]; ///< the box around their openings
} gap;

struct enf_body_beams {
    const enf_body_ways *ways;
    enf_air_ranks ranks;
    enf_kept kept;
    uint64_t *open;     ///< a bit per portal: not reached as a whole, and nothing is known against it
    uint64_t *passable; ///< likewise: lines from the body can pass it forwards
    size_t open_words;
    int32_t *reached, reached_count, first_count; ///< the first ones are those of the cells of the source
    int32_t facing_first;                         ///< one of the first
    bool *waits;                                  ///< per cell
    waiting *heap;                                ///< cells that wait
    int32_t heap_count;
    int64_t visits;
    enf_body body;
    uint64_t *met; ///< a row of owners
    enf_separators separators;
    enf_window window;
    enf_window gaps[2]; ///< one is being put together; the other is scratch
};

static bool can_follow(const void *user, int32_t portal, int32_t next) {
    return enf_portals_face(user, portal, next);
}

bool enf_body_ways_make(enf_body_ways *ways, const enf_shapes *shapes, const enf_bodies *bodies,
                        const enf_air_order *order) {
    *ways = (enf_body_ways){.shapes = shapes, .bodies = bodies, .order = order};
    if (!enf_sources_make(&ways->sources, bodies) ||
        !enf_follows_make(&ways->follows, shapes->graph, can_follow, shapes))
        return false;
    ways->coplanar = enf_coplanar_make(shapes, &ways->follows);
    return ways->coplanar != NULL;
}

void enf_body_ways_free(enf_body_ways *ways) {
    enf_sources_free(&ways->sources);
    enf_follows_free(&ways->follows);
    free(ways->coplanar);
    ways->coplanar = NULL;
}

enf_body_beams *enf_body_beams_new(const enf_body_ways *ways) {
    const enf_portal_graph *graph = ways->shapes->graph;
    const size_t portals = 2 * (size_t)graph->opening_count, cells = (size_t)graph->cell_count;
    enf_body_beams *beams = calloc(1, sizeof *beams);
    if (!beams) return NULL;
    beams->ways = ways;
    beams->open_words = portals / 64 + 1;
    beams->open = enf_array_new(beams->open_words, sizeof *beams->open);
    beams->passable = enf_array_new(beams->open_words, sizeof *beams->passable);
    beams->reached = enf_array_new(portals, sizeof *beams->reached);
    beams->waits = enf_array_zeroed(cells, sizeof *beams->waits);
    beams->heap = enf_array_new(cells, sizeof *beams->heap);
    const bool is_ordered = !ways->order || enf_air_ranks_make(&beams->ranks, ways->order);
    if (enf_kept_make(&beams->kept, ways->shapes) && is_ordered && beams->open && beams->passable &&
        beams->reached && beams->waits && beams->heap)
        return beams;
    enf_body_beams_free(beams);
    return NULL;
}

void enf_body_beams_free(enf_body_beams *beams) {
    if (!beams) return;
    enf_air_ranks_free(&beams->ranks);
    enf_kept_free(&beams->kept);
    free(beams->open);
    free(beams->passable);
    free(beams->reached);
    free(beams->waits);
    free(beams->heap);
    free(beams);
}

int64_t enf_body_beams_visits(const enf_body_beams *beams) {
    return beams->visits;
}

// ---------------------------------------------------------------------------------------------- the heap

static bool is_nearer(const waiting *a, const waiting *b) {
    return a->depth < b->depth || (a->depth == b->depth && a->cell < b->cell);
}

/// How far the portal's cell is: its rank, or how far the portal is from the middle of the body, squared.
static double find_depth(enf_body_beams *beams, int32_t portal) {
    const enf_shapes *shapes = beams->ways->shapes;
    if (beams->ways->order) return enf_air_ranks_find(&beams->ranks, enf_portal_to(shapes->graph, portal));
    const double *centre = shapes->shapes[portal >> 1].centre, *middle = beams->body.middle;
    const double way[3] = {centre[0] - middle[0], centre[1] - middle[1], centre[2] - middle[2]};
    return enf_dot(way, way);
}

/// The cell behind a portal that was reached is to be looked at.
static void push(enf_body_beams *beams, int32_t portal) {
    const int32_t cell = enf_portal_to(beams->ways->shapes->graph, portal);
    beams->kept.beams[portal].state = ENF_BEAM_WAITING;
    if (beams->waits[cell]) return;
    beams->waits[cell] = true;
    const waiting new = {find_depth(beams, portal), cell};
    int32_t at = beams->heap_count++;
    for (; at > 0 && is_nearer(&new, &beams->heap[(at - 1) / 2]); at = (at - 1) / 2)
        beams->heap[at] = beams->heap[(at - 1) / 2];
    beams->heap[at] = new;
}

static int32_t pop(enf_body_beams *beams) {
    waiting *heap = beams->heap;
    const waiting last = heap[--beams->heap_count];
    const int32_t top = heap[0].cell;
    int32_t at = 0;
    for (int32_t child; (child = 2 * at + 1) < beams->heap_count; at = child) {
        if (child + 1 < beams->heap_count && is_nearer(&heap[child + 1], &heap[child])) child++;
        if (!is_nearer(&heap[child], &last)) break;
        heap[at] = heap[child];
    }
    heap[at] = last;
    beams->waits[top] = false;
    return top;
}

// ---------------------------------------------------------------------------------------------- portals

/// Is it faced by a portal that lines from the body begin with? Where the body's middle is behind the portal,
/// that is not asked: it takes off next to nothing.
static bool is_faced(enf_body_beams *beams, int32_t portal) {
    if (enf_shape_height(beams->ways->shapes, portal, beams->body.middle) < 0) return true;
    for (int32_t i = 0; i < beams->first_count; i++) { // most are faced by the one that faced the last
        if (enf_portals_face(beams->ways->shapes, beams->reached[beams->facing_first], portal)) return true;
        beams->facing_first = beams->facing_first + 1 < beams->first_count ? beams->facing_first + 1 : 0;
    }
    return false;
}

/// Can lines from the body pass the portal forwards? Some of it has to lie behind: its middle, or a corner;
/// the box around it may tell that there is none.
static bool is_passable(const enf_body_beams *beams, int32_t portal) {
    const enf_shapes *shapes = beams->ways->shapes;
    const enf_body *body = &beams->body;
    const double middle = enf_shape_height(shapes, portal, body->middle);
    if (middle < 0) return true;
    const double *normal = shapes->shapes[portal >> 1].normal;
    double reach = 0;
    for (int axis = 0; axis < 3; axis++) reach += body->half[axis] * fabs(normal[axis]);
    if (middle - reach >= shapes->tolerance) return false;
    for (int32_t i = 0; i < body->corners.count; i++) {
        double corner[3];
        enf_outline_corner(&body->corners, i, corner);
        if (enf_shape_height(shapes, portal, corner) < shapes->tolerance) return true;
    }
    return false;
}

/// A portal is reached for the first time.
static void reach(enf_body_beams *beams, int32_t portal, enf_remains remains) {
    enf_kept_begin(&beams->kept, portal, &beams->window, remains);
    if (beams->kept.beams[portal].is_whole) enf_bit_clear(beams->open, portal);
    beams->reached[beams->reached_count++] = portal;
    push(beams, portal);
}

static void reach_again(enf_body_beams *beams, int32_t portal, enf_remains remains) {
    if (!enf_kept_grow(&beams->kept, portal, &beams->window, remains)) return;
    if (beams->kept.beams[portal].is_whole) enf_bit_clear(beams->open, portal);
    push(beams, portal);
}

// ---------------------------------------------------------------------------------------------- gaps

/// Twice the area of a window, seen along the axis that its opening is seen best along.
static double find_area(const enf_outline *outline, const int32_t axes[2]) {
    const double *u = outline->at[axes[0]], *v = outline->at[axes[1]];
    double area = 0;
    for (int32_t i = 1; i + 1 < outline->count; i++)
        area += (u[i] - u[0]) * (v[i + 1] - v[0]) - (u[i + 1] - u[0]) * (v[i] - v[0]);
    return area;
}

static void extend_box(gap *gap, const enf_shape *shape) {
    for (int axis = 0; axis < 3; axis++) {
        const double low = fmin(gap->middle[axis] - gap->half[axis], shape->middle[axis] - shape->half[axis]);
        const double high =
            fmax(gap->middle[axis] + gap->half[axis], shape->middle[axis] + shape->half[axis]);
        gap->middle[axis] = low / 2 + high / 2;
        gap->half[axis] = (high / 2 - low / 2) * (1 + 0x1p-40) + fabs(gap->middle[axis]) * 0x1p-46;
    }
}

/// Do the boxes of a gap and of an opening touch each other?
static bool is_next_to(const gap *gap, const enf_shape *shape, double tolerance) {
    for (int axis = 0; axis < 3; axis++)
        if (fabs(gap->middle[axis] - shape->middle[axis]) > gap->half[axis] + shape->half[axis] + tolerance)
            return false;
    return true;
}

/// Puts the window of one more portal and the gap together, if that adds next to nothing.
static bool join(enf_body_beams *beams, gap *gap, int32_t portal) {
    const enf_shapes *shapes = beams->ways->shapes;
    const int32_t *axes = shapes->shapes[portal >> 1].axes;
    const enf_outline other = enf_kept_outline(&beams->kept, portal);
    if (gap->outline.count + other.count > ENF_WINDOW_MOST / 2) return false;
    enf_window *window = &beams->gaps[gap->outline.at[0] == beams->gaps[0].at[0]];
    enf_window_take(window, &gap->outline);
    enf_hull_extend(window, &other, axes, shapes->tolerance);
    const enf_outline joined = enf_window_outline(window);
    const double area = find_area(&joined, axes);
    if (gap->area < 0) gap->area = find_area(&gap->outline, axes);
    if (!(area <= join_most * (gap->area + find_area(&other, axes)))) return false;
    gap->outline = joined;
    gap->area = area;
    extend_box(gap, &shapes->shapes[portal >> 1]);
    return true;
}

/// What beams reach of a portal that waits, and of those that wait in its plane and lie next to it. None of
/// them wait any more.
static void take_gap(enf_body_beams *beams, int32_t portal, gap *gap) {
    const int32_t *next = beams->ways->coplanar;
    const enf_shapes *shapes = beams->ways->shapes;
    const enf_shape *shape = &shapes->shapes[portal >> 1];
    gap->portal = portal;
    gap->outline = enf_kept_outline(&beams->kept, portal);
    gap->area = -1;
    memcpy(gap->middle, shape->middle, sizeof gap->middle);
    memcpy(gap->half, shape->half, sizeof gap->half);
    beams->kept.beams[portal].state = ENF_BEAM_REACHED;
    for (bool grows = next[portal] != portal; grows;) {
        grows = false;
        for (int32_t other = next[portal]; other != portal; other = next[other]) {
            if (beams->kept.beams[other].state != ENF_BEAM_WAITING) continue;
            if (!is_next_to(gap, &shapes->shapes[other >> 1], shapes->tolerance)) continue;
            if (!join(beams, gap, other)) continue;
            grows = true;
            beams->kept.beams[other].state = ENF_BEAM_REACHED;
        }
    }
}

// ---------------------------------------------------------------------------------------------- casting

/// The separators between the body and a gap, once for all that asks.
static void need_separators(enf_body_beams *beams, const gap *gap, bool *ready) {
    if (!*ready)
        enf_separators_from_body(&beams->separators, beams->ways->shapes, &beams->body, &gap->outline,
                                 gap->portal);
    *ready = true;
}

/// Notes the owners of bodies in a cell that the separators leave something of.
static void meet_bodies(enf_body_beams *beams, int32_t cell, const gap *gap, bool *ready) {
    const enf_bodies *bodies = beams->ways->bodies;
    for (int32_t body = bodies->cell_first[cell]; body < bodies->cell_first[cell + 1]; body++) {
        if (enf_bit_get(beams->met, bodies->owner[body])) continue;
        need_separators(beams, gap, ready);
        int32_t first = bodies->corner_first[body];
        if (enf_separators_meet(&beams->separators, bodies->middle[body], bodies->half[body],
                                (const double(*)[3])(bodies->corners + first),
                                bodies->corner_first[body + 1] - first))
            enf_bit_set(beams->met, bodies->owner[body]);
    }
}

/// From a gap into its cell and out of the others.
static void spread(enf_body_beams *beams, int32_t cell, const gap *gap) {
    const enf_follows *follows = &beams->ways->follows;
    bool ready = false;
    meet_bodies(beams, cell, gap, &ready);
    for (int32_t k = follows->first[gap->portal]; k < follows->first[gap->portal + 1]; k++) {
        int32_t next = follows->portals[k];
        if (!enf_bit_get(beams->open, next)) continue;
        if (!enf_bit_get(beams->passable, next)) {
            if (!is_passable(beams, next)) {
                enf_bit_clear(beams->open, next);
                continue;
            }
            enf_bit_set(beams->passable, next);
        }
        need_separators(beams, gap, &ready);
        enf_remains remains =
            enf_separators_cut(&beams->separators, beams->ways->shapes, next, &beams->window);
        if (remains == ENF_REMAINS_NOTHING) continue;
        if (beams->kept.beams[next].state != ENF_BEAM_NONE)
            reach_again(beams, next, remains);
        else if (is_faced(beams, next))
            reach(beams, next, remains);
        else
            enf_bit_clear(beams->open, next);
    }
    beams->visits += ready;
}

/// Through all portals into a cell that wait.
static void spread_cell(enf_body_beams *beams, int32_t cell) {
    const enf_portal_graph *graph = beams->ways->shapes->graph;
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++) {
        const int32_t via = graph->cell_portals[k] ^ 1;
        if (beams->kept.beams[via].state != ENF_BEAM_WAITING) continue;
        gap gap;
        take_gap(beams, via, &gap);
        spread(beams, cell, &gap);
    }
}

/// From a cell out of all its portals.
static void leave(enf_body_beams *beams, int32_t cell) {
    const enf_portal_graph *graph = beams->ways->shapes->graph;
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++)
        reach(beams, graph->cell_portals[k], ENF_REMAINS_WHOLE);
}

static void meet_cell(enf_body_beams *beams, int32_t cell) {
    const enf_bodies *bodies = beams->ways->bodies;
    for (int32_t k = bodies->cell_first[cell]; k < bodies->cell_first[cell + 1]; k++)
        enf_bit_set(beams->met, bodies->owner[k]);
}

/// Begins with the bodies of a source, in all their cells.
static void begin(enf_body_beams *beams, int32_t source, uint64_t *met) {
    const enf_sources *sources = &beams->ways->sources;
    const int32_t *first = &sources->cell_first[source], *corner = &sources->corner_first[source];
    for (int32_t i = 0; i < beams->reached_count; i++)
        beams->kept.beams[beams->reached[i]].state = ENF_BEAM_NONE;
    while (beams->heap_count > 0) beams->waits[beams->heap[--beams->heap_count].cell] = false;
    beams->reached_count = beams->first_count = beams->facing_first = beams->kept.window_count = 0;
    beams->met = met;
    enf_body_make(&beams->body, (const double(*)[3])(sources->corners + corner[0]), corner[1] - corner[0],
                  beams->ways->shapes->tolerance / 8);
    if (beams->ways->order) enf_air_ranks_begin(&beams->ranks, beams->body.middle);
    memset(beams->open, -1, beams->open_words * sizeof *beams->open);
    memset(beams->passable, 0, beams->open_words * sizeof *beams->passable);
    for (int32_t k = first[0]; k < first[1]; k++) meet_cell(beams, sources->cells[k]);
    for (int32_t k = first[0]; k < first[1]; k++) leave(beams, sources->cells[k]);
    beams->first_count = beams->reached_count;
}

void enf_body_beams_cast(enf_body_beams *beams, int32_t source, uint64_t *met) {
    begin(beams, source, met);
    while (beams->heap_count > 0) spread_cell(beams, pop(beams));
}

void enf_body_beams_face(enf_body_beams *beams, int32_t source, uint64_t *met) {
    const enf_follows *follows = &beams->ways->follows;
    begin(beams, source, met);
    for (int32_t i = 0; i < beams->reached_count; i++) {
        const int32_t via = beams->reached[i];
        meet_cell(beams, enf_portal_to(beams->ways->shapes->graph, via));
        for (int32_t k = follows->first[via]; k < follows->first[via + 1]; k++) {
            const int32_t next = follows->portals[k];
            if (beams->kept.beams[next].state != ENF_BEAM_NONE || !is_passable(beams, next) ||
                !is_faced(beams, next))
                continue;
            beams->kept.beams[next].state = ENF_BEAM_REACHED;
            beams->reached[beams->reached_count++] = next;
        }
    }
}
