// SPDX-License-Identifier: GPL-3.0-or-later
// G. M. Morton's order (1966): interleaved bits of the coordinates.
#include "build/tet_order.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

typedef struct placed {
    uint64_t key;
    int32_t point;
} placed;

static int compare_placed(const void *a, const void *b) {
    const placed *x = a, *y = b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return (x->point > y->point) - (x->point < y->point);
}

/// The lowest 21 bits, two zeros between any two of them.
static uint64_t spread(uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
    x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
    x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
    return (x | x << 2) & UINT64_C(0x1249249249249249);
}

/// Each point's rank along the curve (free() it), or null without memory.
static int32_t *rank_points(const double *points, size_t count) {
    placed *order = enf_array_new(count, sizeof *order);
    int32_t *rank = enf_array_new(count, sizeof *rank);
    if (!order || !rank) {
        free(order);
        free(rank);
        return NULL;
    }
    for (size_t i = 0; i < count; i++) {
        order[i] = (placed){.point = (int32_t)i};
        for (int k = 0; k < 3; k++) { // |x| <= 2^53: 55 bits, of which the first 21 count
            uint64_t x = (uint64_t)((int64_t)points[3 * i + (size_t)k] + (INT64_C(1) << 54));
            order[i].key |= spread(x >> 34) << k;
        }
    }
    qsort(order, count, sizeof *order, compare_placed);
    for (size_t i = 0; i < count; i++) rank[order[i].point] = (int32_t)i;
    free(order);
    return rank;
}

static int32_t first_rank(const int32_t *rank, const int32_t corner[4]) {
    int32_t first = rank[corner[0]];
    for (int k = 1; k < 4; k++) first = rank[corner[k]] < first ? rank[corner[k]] : first;
    return first;
}

bool enf_tetrahedra_sort(int32_t (*corners)[4], size_t count, const double *points, size_t point_count) {
    int32_t *rank = rank_points(points, point_count);
    int32_t(*sorted)[4] = enf_array_new(count, sizeof *sorted);
    size_t *next = enf_array_zeroed(point_count + 1, sizeof *next);
    bool good = rank && sorted && next;
    if (good) {
        for (size_t t = 0; t < count; t++) next[first_rank(rank, corners[t]) + 1]++;
        for (size_t i = 0; i < point_count; i++) next[i + 1] += next[i];
        for (size_t t = 0; t < count; t++)
            memcpy(sorted[next[first_rank(rank, corners[t])]++], corners[t], sizeof *corners);
        memcpy(corners, sorted, count * sizeof *corners);
    }
    free(rank);
    free(sorted);
    free(next);
    return good;
}
