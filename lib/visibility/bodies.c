// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/bodies.h"

#include "base/array.h"
#include "visibility/distinct.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// For what rounding takes off a box.
static const double rounding = 0x1p-50;

static bool find_boxes(enf_bodies *bodies) {
    bodies->middle = enf_array_new((size_t)bodies->count, sizeof *bodies->middle);
    bodies->half = enf_array_new((size_t)bodies->count, sizeof *bodies->half);
    if (!bodies->middle || !bodies->half) return false;
    for (int32_t b = 0; b < bodies->count; b++)
        for (int axis = 0; axis < 3; axis++) {
            double low = INFINITY, high = -INFINITY;
            for (int32_t i = bodies->corner_first[b]; i < bodies->corner_first[b + 1]; i++) {
                const double at = bodies->corners[i][axis];
                low = at < low ? at : low;
                high = at > high ? at : high;
            }
            bodies->middle[b][axis] = (low + high) / 2;
            bodies->half[b][axis] = (high - low) / 2 + rounding * (fabs(low) + fabs(high));
        }
    return true;
}

/// Turns counts of entries 0..count-1 into offsets.
static void sum_up(int32_t *first, int32_t count) {
    int32_t sum = 0;
    for (int32_t i = 0; i <= count; i++) {
        int32_t own = i < count ? first[i] : 0;
        first[i] = sum;
        sum += own;
    }
}

/// Offsets moved on as far as each entry is full are the next entries' now.
static void move_back(int32_t *first, int32_t count) {
    memmove(first + 1, first, (size_t)count * sizeof *first);
    first[0] = 0;
}

static bool find_owners(enf_bodies *bodies) {
    const size_t owners = (size_t)bodies->owner_count + 1;
    int32_t *first = bodies->owner_first = enf_array_zeroed(owners, sizeof *first);
    int32_t *whole = bodies->whole_first = enf_array_zeroed(owners, sizeof *whole);
    bodies->cells = enf_array_new((size_t)bodies->count, sizeof *bodies->cells);
    bodies->wholes = enf_array_new((size_t)bodies->corner_first[bodies->count], sizeof *bodies->wholes);
    if (!first || !whole || !bodies->cells || !bodies->wholes) return false;
    for (int32_t b = 0; b < bodies->count; b++) {
        first[bodies->owner[b]]++;
        whole[bodies->owner[b]] += bodies->corner_first[b + 1] - bodies->corner_first[b];
    }
    sum_up(first, bodies->owner_count);
    sum_up(whole, bodies->owner_count);
    for (int32_t cell = 0; cell < bodies->cell_count; cell++)
        for (int32_t b = bodies->cell_first[cell]; b < bodies->cell_first[cell + 1]; b++) {
            const int32_t owner = bodies->owner[b];
            bodies->cells[first[owner]++] = cell;
            for (int32_t i = bodies->corner_first[b]; i < bodies->corner_first[b + 1]; i++)
                memcpy(bodies->wholes[whole[owner]++], bodies->corners[i], sizeof *bodies->wholes);
        }
    move_back(first, bodies->owner_count);
    move_back(whole, bodies->owner_count);
    return true;
}

bool enf_bodies_finish(enf_bodies *bodies, int threads) {
    return find_boxes(bodies) && find_owners(bodies) &&
           enf_distinct_keep_runs(&(enf_distinct_runs){.points = bodies->wholes,
                                                       .first = bodies->whole_first,
                                                       .count = bodies->owner_count},
                                  threads);
}

void enf_bodies_free(enf_bodies *bodies) {
    free(bodies->cell_first);
    free(bodies->owner);
    free(bodies->corner_first);
    free(bodies->corners);
    free(bodies->middle);
    free(bodies->half);
    free(bodies->owner_first);
    free(bodies->cells);
    free(bodies->whole_first);
    free(bodies->wholes);
    *bodies = (enf_bodies){0};
}
