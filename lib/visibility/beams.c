// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/beams.h"

#include "base/array.h"
#include "visibility/hull.h"
#include "visibility/separator.h"

#include <stdlib.h>
#include <string.h>

enum {
    KEPT_MOST = 24,  ///< corners of a merged window; beyond that it becomes the whole outline
    GROWTHS_MOST = 8 ///< how often a window may grow before it becomes the whole outline
};

typedef enum beam_state { BEAM_NONE, BEAM_REACHED, BEAM_WAITING } beam_state;

/// What is known of one directed portal.
typedef struct beam {
    double depth; ///< of its centre above the source's plane: nearer ones go first
    int32_t count;
    uint8_t state, growths;
    bool is_whole; ///< the window is the outline
    double corners[KEPT_MOST][3];
} beam;

struct enf_beams {
    const enf_shapes *shapes;
    const enf_bits *facing;
    const enf_bodies *bodies; ///< or null
    uint64_t *met;          ///< parts; or null
    beam *beams;
    int32_t *reached, reached_count;
    int32_t *heap, heap_count; ///< portals that wait
    int64_t visits;
    enf_separators separators;
    enf_window from, via, window, merged;
};

enf_beams *enf_beams_new(const enf_shapes *shapes, const enf_bits *facing, const enf_bodies *bodies) {
    size_t portals = 2 * (size_t)shapes->graph->opening_count;
    enf_beams *beams = calloc(1, sizeof *beams);
    if (!beams) return NULL;
    beams->shapes = shapes;
    beams->facing = facing;
    beams->bodies = bodies;
    beams->beams = enf_array_zeroed(portals, sizeof *beams->beams);
    beams->reached = enf_array_new(portals, sizeof *beams->reached);
    beams->heap = enf_array_new(portals, sizeof *beams->heap);
    if (beams->beams && beams->reached && beams->heap) return beams;
    enf_beams_free(beams);
    return NULL;
}

void enf_beams_free(enf_beams *beams) {
    if (!beams) return;
    free(beams->beams);
    free(beams->reached);
    free(beams->heap);
    free(beams);
}

int64_t enf_beams_visits(const enf_beams *beams) {
    return beams->visits;
}

// ---------------------------------------------------------------------------------------------- the heap

/// A total order that does not depend on how portals are numbered: windows depend on it, a little.
static bool is_nearer(const enf_beams *beams, int32_t a, int32_t b) {
    double depth_a = beams->beams[a].depth, depth_b = beams->beams[b].depth;
    if (depth_a != depth_b) return depth_a < depth_b;
    const enf_shape *shapes = beams->shapes->shapes;
    for (int axis = 0; axis < 3; axis++) {
        double at_a = shapes[a >> 1].centre[axis], at_b = shapes[b >> 1].centre[axis];
        if (at_a != at_b) return at_a < at_b;
    }
    return (a & 1) < (b & 1);
}

static void push(enf_beams *beams, int32_t portal) {
    int32_t at = beams->heap_count++;
    for (; at > 0 && is_nearer(beams, portal, beams->heap[(at - 1) / 2]); at = (at - 1) / 2)
        beams->heap[at] = beams->heap[(at - 1) / 2];
    beams->heap[at] = portal;
    beams->beams[portal].state = BEAM_WAITING;
}

static int32_t pop(enf_beams *beams) {
    int32_t *heap = beams->heap, top = heap[0], last = heap[--beams->heap_count], at = 0;
    for (int32_t child; (child = 2 * at + 1) < beams->heap_count; at = child) {
        if (child + 1 < beams->heap_count && is_nearer(beams, heap[child + 1], heap[child])) child++;
        if (!is_nearer(beams, heap[child], last)) break;
        heap[at] = heap[child];
    }
    heap[at] = last;
    beams->beams[top].state = BEAM_REACHED;
    return top;
}

// ---------------------------------------------------------------------------------------------- windows

void enf_beams_window(const enf_beams *beams, int32_t portal, enf_window *window) {
    const beam *beam = &beams->beams[portal];
    if (beam->is_whole)
        enf_shape_window(beams->shapes, portal, window);
    else
        enf_window_copy(window, (const double(*)[3])beam->corners, beam->count);
}

static void keep(beam *beam, const enf_window *window, enf_remains remains) {
    beam->is_whole =
        remains == ENF_REMAINS_WHOLE || window->count > KEPT_MOST || beam->growths >= GROWTHS_MOST;
    if (beam->is_whole) return;
    beam->count = window->count;
    memcpy(beam->corners, window->corners, (size_t)window->count * sizeof *window->corners);
}

/// A portal is reached for the first time.
static void reach(enf_beams *beams, int32_t source, int32_t portal, enf_remains remains) {
    beam *beam = &beams->beams[portal];
    beam->depth = enf_shape_height(beams->shapes, source, beams->shapes->shapes[portal >> 1].centre);
    beam->growths = 0;
    keep(beam, &beams->window, remains);
    beams->reached[beams->reached_count++] = portal;
    push(beams, portal);
}

/// Merges the window into what was reached before.
static void merge(enf_beams *beams, int32_t portal, enf_remains remains) {
    beam *beam = &beams->beams[portal];
    const enf_shape *shape = &beams->shapes->shapes[portal >> 1];
    enf_window *merged = &beams->merged;
    enf_beams_window(beams, portal, merged);
    if (merged->count + beams->window.count > ENF_WINDOW_MOST) remains = ENF_REMAINS_WHOLE;
    if (remains != ENF_REMAINS_WHOLE) {
        if (!enf_hull_extend(merged, &beams->window, shape->axes, beams->shapes->tolerance)) return;
        beam->growths++;
    }
    keep(beam, merged, remains);
    if (beam->state == BEAM_REACHED) push(beams, portal);
}

// ---------------------------------------------------------------------------------------------- casting

/// The separators from the source to what its beams leave of `via`.
static void find_separators(enf_beams *beams, int32_t source, int32_t via) {
    if (via == source) {
        enf_separators_begin(&beams->separators, beams->shapes, source);
        return;
    }
    enf_beams_window(beams, via, &beams->via);
    enf_separators_find(&beams->separators, beams->shapes, &beams->from, source, &beams->via, via);
}

/// Notes the parts in a cell that the separators leave something of.
static void meet_bodies(enf_beams *beams, int32_t source, int32_t via, int32_t cell, bool *ready) {
    const enf_bodies *parts = beams->bodies;
    for (int32_t part = parts->cell_first[cell]; part < parts->cell_first[cell + 1]; part++) {
        if (enf_bit_get(beams->met, part)) continue;
        if (!*ready) find_separators(beams, source, via);
        *ready = true;
        int32_t first = parts->corner_first[part];
        if (enf_separators_meet(&beams->separators, (const double(*)[3])(parts->corners + first),
                                parts->corner_first[part + 1] - first))
            enf_bit_set(beams->met, part);
    }
}

/// From one portal into its cell and out of the others.
static void spread(enf_beams *beams, int32_t source, int32_t via) {
    const enf_portal_graph *graph = beams->shapes->graph;
    const uint64_t *row = enf_bits_row(beams->facing, source), *via_row = enf_bits_row(beams->facing, via);
    int32_t cell = enf_portal_to(graph, via);
    bool ready = false;
    if (beams->met) meet_bodies(beams, source, via, cell, &ready);
    for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++) {
        int32_t next = graph->cell_portals[k];
        if (!enf_bit_get(row, next) || !enf_bit_get(via_row, next)) continue;
        bool is_new = beams->beams[next].state == BEAM_NONE;
        if (!is_new && beams->beams[next].is_whole) continue; // nothing to add
        if (!ready) find_separators(beams, source, via);
        ready = true;
        enf_remains remains = enf_separators_pass(&beams->separators, beams->shapes, next, &beams->window);
        if (remains == ENF_REMAINS_NOTHING) continue;
        if (is_new)
            reach(beams, source, next, remains);
        else
            merge(beams, next, remains);
    }
}

int32_t enf_beams_cast(enf_beams *beams, int32_t source, uint64_t *met, const int32_t **portals) {
    beams->met = beams->bodies ? met : NULL;
    for (int32_t i = 0; i < beams->reached_count; i++) beams->beams[beams->reached[i]].state = BEAM_NONE;
    beams->reached_count = beams->heap_count = 0;
    enf_shape_window(beams->shapes, source, &beams->from);
    spread(beams, source, source);
    while (beams->heap_count > 0) {
        beams->visits++;
        spread(beams, source, pop(beams));
    }
    *portals = beams->reached;
    return beams->reached_count;
}
