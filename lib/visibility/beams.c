// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/beams.h"

#include "base/array.h"
#include "visibility/kept.h"

#include <stdlib.h>
#include <string.h>

typedef struct waiting {
    double depth; ///< how high above the source's plane: nearer ones go first
    int32_t portal;
} waiting;

struct enf_beams {
    const enf_shapes *shapes;
    const enf_bits *facing;
    const enf_follows *follows;
    int32_t source;
    uint64_t *open; ///< a row of portals: those that the source may see and that are not reached as a whole
    enf_kept kept;
    int32_t *reached, reached_count;
    waiting *heap; ///< portals that wait
    int32_t heap_count;
    int64_t visits;
    enf_separators separators;
    enf_window window;
};

enf_beams *enf_beams_new(const enf_shapes *shapes, const enf_bits *facing, const enf_follows *follows) {
    size_t portals = 2 * (size_t)shapes->graph->opening_count;
    enf_beams *beams = calloc(1, sizeof *beams);
    if (!beams) return NULL;
    beams->shapes = shapes;
    beams->facing = facing;
    beams->follows = follows;
    beams->open = enf_array_new(facing->row_words, sizeof *beams->open);
    beams->reached = enf_array_new(portals, sizeof *beams->reached);
    beams->heap = enf_array_new(portals, sizeof *beams->heap);
    if (enf_kept_make(&beams->kept, shapes) && beams->open && beams->reached && beams->heap) return beams;
    enf_beams_free(beams);
    return NULL;
}

void enf_beams_free(enf_beams *beams) {
    if (!beams) return;
    enf_kept_free(&beams->kept);
    free(beams->open);
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

/// Is there anything to look at behind a portal?
static bool is_open_behind(const enf_beams *beams, int32_t portal) {
    const enf_follows *follows = beams->follows;
    for (int32_t k = follows->first[portal]; k < follows->first[portal + 1]; k++)
        if (enf_bit_get(beams->open, follows->portals[k])) return true;
    return false;
}

static void push(enf_beams *beams, int32_t portal) {
    if (!is_open_behind(beams, portal)) {
        enf_bit_clear(beams->open, portal);
        return;
    }
    const double *centre = beams->shapes->shapes[portal >> 1].centre;
    const waiting new = {enf_shape_height(beams->shapes, beams->source, centre), portal};
    int32_t at = beams->heap_count++;
    for (; at > 0 && is_nearer(beams, &new, &beams->heap[(at - 1) / 2]); at = (at - 1) / 2)
        beams->heap[at] = beams->heap[(at - 1) / 2];
    beams->heap[at] = new;
    beams->kept.beams[portal].state = ENF_BEAM_WAITING;
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
    beams->kept.beams[top].state = ENF_BEAM_REACHED;
    return top;
}

// ---------------------------------------------------------------------------------------------- casting

void enf_beams_window(const enf_beams *beams, int32_t portal, enf_window *window) {
    const enf_outline outline = enf_kept_outline(&beams->kept, portal);
    enf_window_take(window, &outline);
}

/// A portal is reached for the first time.
static void reach(enf_beams *beams, int32_t portal, enf_remains remains) {
    enf_kept_begin(&beams->kept, portal, &beams->window, remains);
    if (beams->kept.beams[portal].is_whole) enf_bit_clear(beams->open, portal);
    beams->kept.beams[portal].state = ENF_BEAM_REACHED;
    beams->reached[beams->reached_count++] = portal;
    push(beams, portal);
}

static void reach_again(enf_beams *beams, int32_t portal, enf_remains remains) {
    if (!enf_kept_grow(&beams->kept, portal, &beams->window, remains)) return;
    if (beams->kept.beams[portal].is_whole) enf_bit_clear(beams->open, portal);
    if (beams->kept.beams[portal].state == ENF_BEAM_REACHED) push(beams, portal);
}

/// The separators between the source and what its beams reach of a portal.
static void find_separators(enf_beams *beams, int32_t via) {
    const int32_t source = beams->source;
    if (via == source) {
        enf_separators_begin(&beams->separators, beams->shapes, via);
        return;
    }
    const enf_outline from = enf_shape_outline(beams->shapes, source >> 1),
                      to = enf_kept_outline(&beams->kept, via);
    enf_separators_between(&beams->separators, beams->shapes, &from, source, &to, via);
}

/// From one portal into its cell and out of the others.
static void spread(enf_beams *beams, int32_t via) {
    const enf_follows *follows = beams->follows;
    bool ready = false;
    for (int32_t k = follows->first[via]; k < follows->first[via + 1]; k++) {
        int32_t next = follows->portals[k];
        if (!enf_bit_get(beams->open, next)) continue;
        if (!ready) find_separators(beams, via);
        ready = true;
        enf_remains remains = enf_separators_cut(&beams->separators, beams->shapes, next, &beams->window);
        if (remains == ENF_REMAINS_NOTHING) continue;
        if (beams->kept.beams[next].state == ENF_BEAM_NONE)
            reach(beams, next, remains);
        else
            reach_again(beams, next, remains);
    }
}

static void begin(enf_beams *beams) {
    for (int32_t i = 0; i < beams->reached_count; i++)
        beams->kept.beams[beams->reached[i]].state = ENF_BEAM_NONE;
    beams->reached_count = beams->heap_count = beams->kept.window_count = 0;
}

int32_t enf_beams_cast(enf_beams *beams, int32_t source, const int32_t **portals) {
    begin(beams);
    beams->source = source;
    memcpy(beams->open, enf_bits_row(beams->facing, source), beams->facing->row_words * sizeof *beams->open);
    spread(beams, source);
    while (beams->heap_count > 0) {
        beams->visits++;
        spread(beams, pop(beams));
    }
    *portals = beams->reached;
    return beams->reached_count;
}
