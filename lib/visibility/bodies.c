// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/bodies.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>

/// For what rounding takes off a box.
static const double rounding = 0x1p-50;

bool enf_bodies_find_boxes(enf_bodies *bodies) {
    bodies->middle = enf_array_new((size_t)bodies->count, sizeof *bodies->middle);
    bodies->half = enf_array_new((size_t)bodies->count, sizeof *bodies->half);
    if (!bodies->middle || !bodies->half) return false;
    for (int32_t b = 0; b < bodies->count; b++)
        for (int axis = 0; axis < 3; axis++) {
            double low = INFINITY, high = -INFINITY;
            for (int32_t i = bodies->corner_first[b]; i < bodies->corner_first[b + 1]; i++) {
                low = fmin(low, bodies->corners[i][axis]);
                high = fmax(high, bodies->corners[i][axis]);
            }
            bodies->middle[b][axis] = (low + high) / 2;
            bodies->half[b][axis] = (high - low) / 2 + rounding * (fabs(low) + fabs(high));
        }
    return true;
}

void enf_bodies_free(enf_bodies *bodies) {
    free(bodies->cell_first);
    free(bodies->owner);
    free(bodies->corner_first);
    free(bodies->corners);
    free(bodies->middle);
    free(bodies->half);
    *bodies = (enf_bodies){0};
}
