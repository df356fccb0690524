// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/beams.h"

#include "base/array.h"
#include "visibility/facing.h"
#include "visibility/hull.h"
#include "visibility/separator.h"

#include <stdlib.h>
#include <string.h>

enum {
    KEPT_MOST = 24,  ///< corners of a merged window; beyond that it becomes the whole outline
    GROWTHS_MOST = 8 ///< how often a window may grow before it becomes the whole outline
};

typedef enum beam_state { BEAM_NONE, BEAM_REACHED, BEAM_WAITING } beam_state;

/// What is known of one directed portal. There are many, looked at in no order: windows are elsewhere.
typedef struct beam {
    int32_t kept;                    ///< its window; -1: none yet
    int16_t count;                   ///< corners of the window
    uint8_t state : 2, is_whole : 1; ///< the window is the outline
    uint8_t growths;
} beam;

/// The corners of a window, as an outline's.
typedef struct kept_window {
    double at[3][KEPT_MOST + ENF_OUTLINE_MORE];
} kept_window;

/// What beams come from: a directed portal, or a body.
typedef struct source {
    int32_t portal; ///< -1: a body
    enf_body body;
    const enf_bodies *bodies; ///< asked for; or null
    uint64_t *met;            ///< a row of their owners
} source;

typedef struct waiting {
    double depth; ///< how far from the source: nearer ones go first
    int32_t portal;
} waiting;

struct enf_beams {
    const enf_shapes *shapes;
    const enf_bits *facing;
    const enf_follows *follows;
    uint64_t *open; ///< a row of portals: those that the source may see and that are not reached as a whole
    size_t open_words;
    beam *beams;
    kept_window *kept; ///< those of this cast come first
    int32_t kept_count;
    int32_t *reached, reached_count, first_count; ///< the first ones are those of the cells of bodies
    int32_t facing_first;                         ///< one of the first
    waiting *heap;                                ///< portals that wait
    int32_t heap_count;
    int64_t visits;
    source source;
    enf_separators separators;
    enf_window window, merged;
};

enf_beams *enf_beams_new(const enf_shapes *shapes, const enf_bits *facing, const enf_follows *follows) {
    size_t portals = 2 * (size_t)shapes->graph->opening_count;
    enf_beams *beams = calloc(1, sizeof *beams);
    if (!beams) return NULL;
    beams->shapes = shapes;
    beams->facing = facing;
    beams->follows = follows;
    beams->open_words = portals / 64 + 1;
    if (facing) beams->open_words = facing->row_words;
    beams->open = enf_array_new(beams->open_words, sizeof *beams->open);
    beams->beams = enf_array_zeroed(portals, sizeof *beams->beams);
    beams->kept = enf_array_new(portals, sizeof *beams->kept);
    beams->reached = enf_array_new(portals, sizeof *beams->reached);
    beams->heap = enf_array_new(portals, sizeof *beams->heap);
    if (beams->open && beams->beams && beams->kept && beams->reached && beams->heap) return beams;
    enf_beams_free(beams);
    return NULL;
}

void enf_beams_free(enf_beams *beams) {
    if (!beams) return;
    free(beams->open);
    free(beams->beams);
    free(beams->kept);
    free(beams->reached);
    free(beams->heap);
    free(beams);
}

int64_t enf_beams_visits(const enf_beams *beams) {
    return beams->visits;
}

// ---------------------------------------------------------------------------------------------- the heap

/// A total order that does not depend on how portals are numbered: windows depend on it, a little.
static bool is_nearer(const enf_beams *beams, const waiting *a, const waiting *b) {
    if (a->depth != b->depth) return a->depth < b->depth;
    const enf_shape *shapes = beams->shapes->shapes;
    for (int axis = 0; axis < 3; axis++) {
        double at_a = shapes[a->portal >> 1].centre[axis], at_b = shapes[b->portal >> 1].centre[axis];
        if (at_a != at_b) return at_a < at_b;
    }
    return (a->portal & 1) < (b->portal & 1);
}

/// Are there bodies in a cell whose owners have not been met?
static bool has_bodies(const source *source, int32_t cell) {
    const enf_bodies *bodies = source->bodies;
    for (int32_t k = bodies->cell_first[cell]; k < bodies->cell_first[cell + 1]; k++)
        if (!enf_bit_get(source->met, bodies->owner[k])) return true;
    return false;
}

/// Is there anything to look at behind a portal?
static bool is_open_behind(const enf_beams *beams, int32_t portal) {
    const source *source = &beams->source;
    if (source->bodies && has_bodies(source, enf_portal_to(beams->shapes->graph, portal))) return true;
    const enf_follows *follows = beams->follows;
    for (int32_t k = follows->first[portal]; k < follows->first[portal + 1]; k++)
        if (enf_bit_get(beams->open, follows->portals[k])) return true;
    return false;
}

/// How far from the source a portal is: above its plane, or from the middle of a body, squared.
static double find_depth(const enf_beams *beams, int32_t portal) {
    const double *centre = beams->shapes->shapes[portal >> 1].centre;
    if (beams->source.portal >= 0) return enf_shape_height(beams->shapes, beams->source.portal, centre);
    const double *middle = beams->source.body.middle;
    const double way[3] = {centre[0] - middle[0], centre[1] - middle[1], centre[2] - middle[2]};
    return enf_dot(way, way);
}

static void push(enf_beams *beams, int32_t portal) {
    if (!is_open_behind(beams, portal)) {
        enf_bit_clear(beams->open, portal);
        return;
    }
    const waiting new = {find_depth(beams, portal), portal};
    int32_t at = beams->heap_count++;
    for (; at > 0 && is_nearer(beams, &new, &beams->heap[(at - 1) / 2]); at = (at - 1) / 2)
        beams->heap[at] = beams->heap[(at - 1) / 2];
    beams->heap[at] = new;
    beams->beams[portal].state = BEAM_WAITING;
}

static int32_t pop(enf_beams *beams) {
    waiting *heap = beams->heap;
    const waiting last = heap[--beams->heap_count];
    const int32_t top = heap[0].portal;
    int32_t at = 0;
    for (int32_t child; (child = 2 * at + 1) < beams->heap_count; at = child) {
        if (child + 1 < beams->heap_count && is_nearer(beams, &heap[child + 1], &heap[child])) child++;
        if (!is_nearer(beams, &heap[child], &last)) break;
        heap[at] = heap[child];
    }
    heap[at] = last;
    beams->beams[top].state = BEAM_REACHED;
    return top;
}

// ---------------------------------------------------------------------------------------------- windows

static enf_outline outline_of(const enf_beams *beams, int32_t portal) {
    const beam *beam = &beams->beams[portal];
    if (beam->is_whole) return enf_shape_outline(beams->shapes, portal >> 1);
    const kept_window *kept = &beams->kept[beam->kept];
    return (enf_outline){beam->count, {kept->at[0], kept->at[1], kept->at[2]}};
}

void enf_beams_window(const enf_beams *beams, int32_t portal, enf_window *window) {
    const enf_outline outline = outline_of(beams, portal);
    enf_window_take(window, &outline);
}

static void keep(enf_beams *beams, int32_t portal, const enf_window *window, enf_remains remains) {
    beam *beam = &beams->beams[portal];
    beam->is_whole =
        remains == ENF_REMAINS_WHOLE || window->count > KEPT_MOST || beam->growths >= GROWTHS_MOST;
    if (beam->is_whole) {
        enf_bit_clear(beams->open, portal);
        return;
    }
    if (beam->kept < 0) beam->kept = beams->kept_count++;
    beam->count = (int16_t)window->count;
    for (int axis = 0; axis < 3; axis++)
        enf_outline_copy(beams->kept[beam->kept].at[axis], window->at[axis], window->count);
}

/// A portal is reached for the first time.
static void reach(enf_beams *beams, int32_t portal, enf_remains remains) {
    beam *beam = &beams->beams[portal];
    beam->kept = -1;
    beam->growths = 0;
    keep(beams, portal, &beams->window, remains);
    beam->state = BEAM_REACHED;
    beams->reached[beams->reached_count++] = portal;
    push(beams, portal);
}

/// Merges the window into what was reached before.
static void merge(enf_beams *beams, int32_t portal, enf_remains remains) {
    beam *beam = &beams->beams[portal];
    const enf_shape *shape = &beams->shapes->shapes[portal >> 1];
    enf_window *merged = &beams->merged;
    if (beam->count + beams->window.count > ENF_WINDOW_MOST) remains = ENF_REMAINS_WHOLE;
    if (remains != ENF_REMAINS_WHOLE) {
        enf_beams_window(beams, portal, merged);
        if (!enf_hull_extend(merged, &beams->window, shape->axes, beams->shapes->tolerance)) return;
        beam->growths++;
    }
    keep(beams, portal, merged, remains);
    if (beam->state == BEAM_REACHED) push(beams, portal);
}

// ---------------------------------------------------------------------------------------------- casting

/// The separators between the source and what its beams reach of a portal.
static void find_separators(enf_beams *beams, int32_t via) {
    const enf_outline to = outline_of(beams, via);
    int32_t portal = beams->source.portal;
    if (via == portal) {
        enf_separators_begin(&beams->separators, beams->shapes, via);
    } else if (portal >= 0) {
        const enf_outline from = enf_shape_outline(beams->shapes, portal >> 1);
        enf_separators_between(&beams->separators, beams->shapes, &from, portal, &to, via);
    } else {
        enf_separators_from_body(&beams->separators, beams->shapes, &beams->source.body, &to, via);
    }
}

/// Notes the owners of bodies in the cell behind a portal that the separators leave something of.
static void meet_bodies(enf_beams *beams, int32_t via, bool *ready) {
    const enf_bodies *bodies = beams->source.bodies;
    int32_t cell = enf_portal_to(beams->shapes->graph, via);
    for (int32_t body = bodies->cell_first[cell]; body < bodies->cell_first[cell + 1]; body++) {
        if (enf_bit_get(beams->source.met, bodies->owner[body])) continue;
        if (!*ready) find_separators(beams, via);
        *ready = true;
        int32_t first = bodies->corner_first[body];
        if (enf_separators_meet(&beams->separators, bodies->middle[body], bodies->half[body],
                                (const double(*)[3])(bodies->corners + first),
                                bodies->corner_first[body + 1] - first))
            enf_bit_set(beams->source.met, bodies->owner[body]);
    }
}

/// Does some of the body that beams come from lie behind the portal?
static bool is_in_front(const enf_beams *beams, int32_t portal) {
    const enf_outline *corners = &beams->source.body.corners;
    for (int32_t i = 0; i < corners->count; i++) {
        double corner[3];
        enf_outline_corner(corners, i, corner);
        if (enf_shape_height(beams->shapes, portal, corner) < beams->shapes->tolerance) return true;
    }
    return false;
}

/// Can lines from the source pass the portal forwards? From a body they have passed one of the first portals.
/// (Between portals, `facing` says so.)
static bool is_passable(enf_beams *beams, int32_t portal) {
    if (beams->source.portal >= 0) return true;
    if (!is_in_front(beams, portal)) return false;
    for (int32_t i = 0; i < beams->first_count; i++) { // most are faced by the one that faced the last
        if (enf_portals_face(beams->shapes, beams->reached[beams->facing_first], portal)) return true;
        beams->facing_first = beams->facing_first + 1 < beams->first_count ? beams->facing_first + 1 : 0;
    }
    return false;
}

/// From one portal into its cell and out of the others.
static void spread(enf_beams *beams, int32_t via) {
    const enf_follows *follows = beams->follows;
    bool ready = false;
    if (beams->source.bodies) meet_bodies(beams, via, &ready);
    for (int32_t k = follows->first[via]; k < follows->first[via + 1]; k++) {
        int32_t next = follows->portals[k];
        if (!enf_bit_get(beams->open, next)) continue;
        if (!ready) find_separators(beams, via);
        ready = true;
        enf_remains remains = enf_separators_cut(&beams->separators, beams->shapes, next, &beams->window);
        if (remains == ENF_REMAINS_NOTHING) continue;
        if (beams->beams[next].state != BEAM_NONE)
            merge(beams, next, remains);
        else if (is_passable(beams, next))
            reach(beams, next, remains);
        else
            enf_bit_clear(beams->open, next);
    }
}

static void begin(enf_beams *beams) {
    for (int32_t i = 0; i < beams->reached_count; i++) beams->beams[beams->reached[i]].state = BEAM_NONE;
    beams->reached_count = beams->heap_count = beams->kept_count = 0;
}

static void spread_all(enf_beams *beams) {
    while (beams->heap_count > 0) {
        beams->visits++;
        spread(beams, pop(beams));
    }
}

int32_t enf_beams_cast(enf_beams *beams, int32_t source, const int32_t **portals) {
    begin(beams);
    beams->source.portal = source;
    beams->source.bodies = NULL;
    memcpy(beams->open, enf_bits_row(beams->facing, source), beams->open_words * sizeof *beams->open);
    spread(beams, source);
    spread_all(beams);
    *portals = beams->reached;
    return beams->reached_count;
}

/// From a cell out of all its portals.
static void leave(enf_beams *beams, int32_t cell) {
    const enf_portal_graph *graph = beams->shapes->graph;
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++)
        reach(beams, graph->cell_portals[k], ENF_REMAINS_WHOLE);
}

static void meet_cell(const source *source, int32_t cell) {
    for (int32_t k = source->bodies->cell_first[cell]; k < source->bodies->cell_first[cell + 1]; k++)
        enf_bit_set(source->met, source->bodies->owner[k]);
}

/// Begins with the bodies of an owner, in all their cells.
static void begin_owner(enf_beams *beams, const enf_bodies *bodies, int32_t owner, uint64_t *met) {
    const int32_t *first = &bodies->owner_first[owner], whole = bodies->whole_first[owner];
    begin(beams);
    if (first[0] == first[1]) return;
    beams->source.portal = -1;
    beams->source.bodies = bodies;
    beams->source.met = met;
    enf_body_make(&beams->source.body, (const double(*)[3])(bodies->wholes + whole),
                  bodies->whole_first[owner + 1] - whole, beams->shapes->tolerance / 8);
    memset(beams->open, -1, beams->open_words * sizeof *beams->open);
    for (int32_t k = first[0]; k < first[1]; k++) meet_cell(&beams->source, bodies->cells[k]);
    for (int32_t k = first[0]; k < first[1]; k++) leave(beams, bodies->cells[k]);
    beams->first_count = beams->reached_count;
    beams->facing_first = 0;
}

void enf_beams_cast_owner(enf_beams *beams, const enf_bodies *bodies, int32_t owner, uint64_t *met) {
    begin_owner(beams, bodies, owner, met);
    spread_all(beams);
}

void enf_beams_face_owner(enf_beams *beams, const enf_bodies *bodies, int32_t owner, uint64_t *met) {
    const enf_follows *follows = beams->follows;
    begin_owner(beams, bodies, owner, met);
    for (int32_t i = 0; i < beams->reached_count; i++) {
        const int32_t via = beams->reached[i];
        meet_cell(&beams->source, enf_portal_to(beams->shapes->graph, via));
        for (int32_t k = follows->first[via]; k < follows->first[via + 1]; k++) {
            const int32_t next = follows->portals[k];
            if (beams->beams[next].state != BEAM_NONE || !is_passable(beams, next)) continue;
            beams->beams[next].state = BEAM_REACHED;
            beams->reached[beams->reached_count++] = next;
        }
    }
}
