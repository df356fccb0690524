// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/beyond.h"

#include "base/array.h"
#include "visibility/exact_double.h"
#include "visibility/line.h"

#include <stdlib.h>
#include <string.h>

enum { BITS = 61 }; ///< differences of two have one more, products of these 124, sums of two of those 125

__extension__ typedef __int128 wide;

bool enf_whole_corners_make(enf_whole_corners *whole, const enf_portal_graph *graph) {
    *whole = (enf_whole_corners){.graph = graph};
    int32_t count = graph->opening_corner[graph->opening_count];
    int unit = ENF_NO_UNIT;
    double largest = 0;
    for (int32_t i = 0; i < count; i++) {
        unit = enf_point_unit(graph->corners[i], unit);
        for (int axis = 0; axis < 3; axis++) largest = fmax(largest, fabs(graph->corners[i][axis]));
    }
    if (unit != ENF_NO_UNIT && !(ldexp(largest, -unit) < (double)(INT64_C(1) << BITS))) return true;
    whole->corners = enf_array_zeroed((size_t)count, sizeof *whole->corners);
    if (!whole->corners) return false;
    for (int32_t i = 0; i < count && unit != ENF_NO_UNIT; i++)
        for (int axis = 0; axis < 3; axis++)
            whole->corners[i][axis] = (int64_t)ldexp(graph->corners[i][axis], -unit);
    return true;
}

void enf_whole_corners_free(enf_whole_corners *whole) {
    free(whole->corners);
    memset(whole, 0, sizeof *whole);
}

/// A number of 192 bits: high * 2^64 + low.
typedef struct sum {
    wide high;
    uint64_t low;
} sum;

static void add_product(sum *sum, wide factor, int64_t other) {
    wide low = (wide)(uint64_t)factor * other, high = (factor >> 64) * other;
    wide carried = (wide)sum->low + (uint64_t)low;
    sum->low = (uint64_t)carried;
    sum->high += high + (low >> 64) + (carried >> 64);
}

/// Sign of det(b - a, c - a, d - a).
static int orient(const int64_t *a, const int64_t *b, const int64_t *c, const int64_t *d) {
    int64_t u[3], v[3], w[3];
    for (int i = 0; i < 3; i++) u[i] = b[i] - a[i], v[i] = c[i] - a[i], w[i] = d[i] - a[i];
    sum sum = {0, 0};
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        add_product(&sum, (wide)u[j] * v[k] - (wide)u[k] * v[j], w[i]);
    }
    return sum.high < 0 ? -1 : sum.high > 0 || sum.low > 0;
}

static int orient_corners(const enf_whole_corners *whole, int32_t a, int32_t b, int32_t c, int32_t d) {
    if (whole->corners)
        return orient(whole->corners[a], whole->corners[b], whole->corners[c], whole->corners[d]);
    const double(*corners)[3] = (const double(*)[3])whole->graph->corners;
    enf_line line;
    memcpy(line.from, corners[a], sizeof line.from);
    memcpy(line.to, corners[b], sizeof line.to);
    return enf_line_side(&line, corners[c], corners[d]);
}

bool enf_opening_is_beyond(const enf_whole_corners *whole, int32_t opening, int32_t other, int side) {
    const int32_t *plane = &whole->graph->opening_corner[opening],
                  *corners = &whole->graph->opening_corner[other];
    for (int32_t i = plane[0] + 1; i + 1 < plane[1]; i++)
        for (int32_t k = corners[0]; k < corners[1]; k++)
            if (orient_corners(whole, plane[0], i, i + 1, k) == side) return true;
    return false;
}
