// SPDX-License-Identifier: GPL-3.0-or-later
// Floods from each portal, as level compilers do for a first bound (J. Carmack's vis, 1996). A second flood
// through the pairs that are left takes off some 5 in 100, and costs more than the beams gain by it.
#include "visibility/facing.h"

#include "base/array.h"
#include "visibility/beyond.h"
#include "visibility/follows.h"
#include "visibility/symmetry.h"

#include <stdlib.h>
#include <string.h>

/// What one thread has.
typedef struct flooder {
    int32_t *queue;
    uint64_t *done; ///< a row of portals: looked at
} flooder;

/// What is looked at first, side by side: a line of the cache. For planes along the axes, which most are in
/// buildings, it is enough.
typedef struct face {
    double ends[6]; ///< of the box: how far it goes up each axis, and down
    double end[2];  ///< portal 2k, and its twin: the opening is in front as far as it goes further than this,
    int8_t towards[2]; ///< this way: an index into ends; -1: the plane is not along the axes
} face;

typedef struct search {
    const enf_shapes *shapes;
    bool exactly;
    enf_whole_corners whole; ///< if so
    enf_bits *found;
    face *faces; ///< per opening
    enf_follows follows;
    flooder *flooders;
} search;

typedef enum answer { NO, UNSURE, YES } answer;

/// Is some of the opening higher than the portal's plane (side 1), or lower (side -1)?
static answer has_corner(const enf_shapes *shapes, int32_t portal, int32_t opening, double side) {
    const enf_shape *shape = &shapes->shapes[opening];
    double middle = side * enf_shape_height(shapes, portal, shape->centre), highest = middle;
    if (middle > shapes->tolerance) return YES;
    if (middle + shape->radius < -shapes->tolerance) return NO;
    const double(*corners)[3] = enf_shape_corners(shapes, opening);
    for (int32_t i = 0; i < shape->count; i++) {
        double height = side * enf_shape_height(shapes, portal, corners[i]);
        if (height > highest) highest = height;
    }
    return highest > shapes->tolerance ? YES : highest < -shapes->tolerance ? NO : UNSURE;
}

bool enf_portals_face(const enf_shapes *shapes, int32_t portal, int32_t other) {
    return portal >> 1 != other >> 1 && has_corner(shapes, portal, other >> 1, 1) == YES &&
           has_corner(shapes, other, portal >> 1, -1) == YES;
}

/// The same, decided: in front, or behind, of a portal.
static bool reaches(const search *search, int32_t portal, int32_t opening, bool in_front) {
    const face *plane = &search->faces[portal >> 1], *face = &search->faces[opening];
    const int side = (portal & 1) == in_front;
    if (plane->towards[0] >= 0) return face->ends[plane->towards[side]] > plane->end[side];
    const answer quick = has_corner(search->shapes, portal, opening, in_front ? 1 : -1);
    if (quick != UNSURE || !search->exactly) return quick == YES;
    return enf_opening_is_beyond(&search->whole, portal >> 1, opening, side ? -1 : 1);
}

/// Could a line pass the one portal and then the other?
static bool is_facing(const search *search, int32_t portal, int32_t other) {
    const face *one = &search->faces[portal >> 1], *two = &search->faces[other >> 1];
    const int front = portal & 1, back = !(other & 1);
    if (one == two) return false;
    if (one->towards[0] >= 0 && two->towards[0] >= 0)
        return (two->ends[one->towards[front]] > one->end[front]) &
               (one->ends[two->towards[back]] > two->end[back]);
    return reaches(search, portal, other >> 1, true) && reaches(search, other, portal >> 1, false);
}

/// Each portal is looked at once.
static void flood(const search *search, int32_t source, const flooder *flooder) {
    const enf_follows *follows = &search->follows;
    uint64_t *row = enf_bits_row(search->found, source);
    int32_t count = 0;
    memset(flooder->done, 0, search->found->row_words * sizeof *row);
    flooder->queue[count++] = source;
    for (int32_t at = 0; at < count; at++) {
        const int32_t via = flooder->queue[at];
        for (int32_t k = follows->first[via]; k < follows->first[via + 1]; k++) {
            const int32_t next = follows->portals[k];
            if (enf_bit_get(flooder->done, next)) continue;
            enf_bit_set(flooder->done, next);
            if (!is_facing(search, source, next)) continue;
            enf_bit_set(row, next);
            flooder->queue[count++] = next;
        }
    }
}

static void flood_job(void *user, int32_t index, int thread) {
    const search *search = user;
    flood(search, index, &search->flooders[thread]);
}

static bool follows(const void *user, int32_t portal, int32_t next) {
    return is_facing(user, portal, next);
}

static bool make_faces(search *search) {
    const enf_shapes *shapes = search->shapes;
    search->faces = enf_array_new((size_t)shapes->graph->opening_count, sizeof *search->faces);
    for (int32_t k = 0; search->faces && k < shapes->graph->opening_count; k++) {
        const enf_shape *shape = &shapes->shapes[k];
        face *face = &search->faces[k];
        for (int axis = 0; axis < 3; axis++) {
            face->ends[axis] = shape->high[axis];
            face->ends[3 + axis] = -shape->low[axis];
        }
        const int axis = shape->flat_axis, down = axis >= 0 && shape->normal[axis] < 0;
        for (int twin = 0; twin < 2; twin++) {
            face->towards[twin] = (int8_t)(axis < 0 ? -1 : twin == down ? axis : 3 + axis);
            face->end[twin] = axis < 0 ? 0 : twin == down ? shape->high[axis] : -shape->low[axis];
        }
    }
    return search->faces != NULL;
}

// ---------------------------------------------------------------------------------------------- all

static bool make_search(search *search, int threads) {
    size_t portals = 2 * (size_t)search->shapes->graph->opening_count;
    search->flooders = enf_array_zeroed((size_t)threads, sizeof *search->flooders);
    for (int i = 0; search->flooders && i < threads; i++) {
        flooder *flooder = &search->flooders[i];
        flooder->queue = enf_array_new(portals + 1, sizeof *flooder->queue);
        flooder->done = enf_array_new(search->found->row_words, sizeof *flooder->done);
        if (!flooder->queue || !flooder->done) return false;
    }
    if (search->exactly && !enf_whole_corners_make(&search->whole, search->shapes->graph)) return false;
    return search->flooders && make_faces(search) &&
           enf_follows_make(&search->follows, search->shapes->graph, follows, search);
}

static void free_search(search *search, int threads) {
    for (int i = 0; search->flooders && i < threads; i++) {
        free(search->flooders[i].queue);
        free(search->flooders[i].done);
    }
    free(search->flooders);
    free(search->faces);
    enf_follows_free(&search->follows);
    enf_whole_corners_free(&search->whole);
}

enf_status enf_facing_find(enf_bits *facing, const enf_shapes *shapes, bool exactly, const enf_crew *crew,
                           enf_error *error) {
    int32_t portals = 2 * shapes->graph->opening_count;
    search search = {.shapes = shapes, .exactly = exactly, .found = facing};
    bool good = enf_bits_new(facing, portals, portals) && make_search(&search, crew->threads);
    bool done = good && enf_parallel_for(crew, portals, flood_job, &search);
    free_search(&search, crew->threads);
    if (!good) return enf_fail_memory(error, "the portals that face each other");
    if (!done) return enf_fail(error, ENF_NO_RESOURCES, "cancelled");
    enf_symmetry_keep_twins(facing);
    return ENF_OK;
}
