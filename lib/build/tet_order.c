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

/// The lowest 21 bits, two zeros between any two of them.
static uint64_t spread(uint64_t x) {
    x &= 0x1fffff;
    x = (x | x << 32) & UINT64_C(0x1f00000000ffff);
    x = (x | x << 16) & UINT64_C(0x1f0000ff0000ff);
    x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
    return (x | x << 2) & UINT64_C(0x1249249249249249);
}

/// Where the point is along the curve. |x| <= 2^53: 55 bits, of which the first 21 count.
static uint64_t place_of(const double point[3]) {
    uint64_t key = 0;
    for (int k = 0; k < 3; k++) key |= spread((uint64_t)((int64_t)point[k] + (INT64_C(1) << 54)) >> 34) << k;
    return key;
}

enum { DIGIT_BITS = 9, DIGITS = 7 }; ///< of the 63 bits of a place

/// One pass of a radix sort: by one digit, what is equal there stays in its order.
static void deal_by_digit(const placed *from, placed *to, size_t count, int digit) {
    size_t next[1 << DIGIT_BITS] = {0}, sum = 0;
    const int shift = DIGIT_BITS * digit;
    const uint64_t mask = (1 << DIGIT_BITS) - 1;
    for (size_t i = 0; i < count; i++) next[from[i].key >> shift & mask]++;
    for (size_t i = 0; i <= mask; i++) {
        size_t here = next[i];
        next[i] = sum;
        sum += here;
    }
    for (size_t i = 0; i < count; i++) to[next[from[i].key >> shift & mask]++] = from[i];
}

bool enf_curve_order(const double *points, size_t count, int32_t *order) {
    placed *now = enf_array_new(count, sizeof *now), *then = enf_array_new(count, sizeof *then);
    const bool good = now && then;
    if (good) {
        for (size_t i = 0; i < count; i++) now[i] = (placed){place_of(points + 3 * i), (int32_t)i};
        for (int digit = 0; digit < DIGITS; digit++) {
            deal_by_digit(now, then, count, digit);
            placed *swap = now;
            now = then;
            then = swap;
        }
        for (size_t i = 0; i < count; i++) order[i] = now[i].point;
    }
    free(now);
    free(then);
    return good;
}

/// Each point's rank along the curve (free() it), or null without memory.
static int32_t *rank_points(const double *points, size_t count) {
    int32_t *order = enf_array_new(count, sizeof *order), *rank = enf_array_new(count, sizeof *rank);
    if (order && rank && enf_curve_order(points, count, order)) {
        for (size_t i = 0; i < count; i++) rank[order[i]] = (int32_t)i;
    } else {
        free(rank);
        rank = NULL;
    }
    free(order);
    return rank;
}

static int32_t first_rank(const int32_t *rank, const int32_t corner[4]) {
    int32_t first = rank[corner[0]];
    for (int k = 1; k < 4; k++) first = rank[corner[k]] < first ? rank[corner[k]] : first;
    return first;
}

/// The lowest corner first, the second lowest next, by even permutations. (These include the rotations of
/// three corners, so there is one such form.)
static void turn_corners(const int32_t from[4], int32_t to[4]) {
    static const int even[4][4] = {{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}};
    int lowest = 0, second = 1;
    for (int k = 1; k < 4; k++) lowest = from[k] < from[lowest] ? k : lowest;
    const int *turned = even[lowest];
    for (int k = 2; k < 4; k++) second = from[turned[k]] < from[turned[second]] ? k : second;
    to[0] = from[lowest];
    for (int k = 1; k < 4; k++) to[k] = from[turned[1 + (second + k - 2) % 3]];
}

static int compare_corners(const void *a, const void *b) {
    const int32_t *p = a, *q = b;
    for (int k = 0; k < 4; k++)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

enum { FEW = 24 }; ///< tetrahedra at a place; there are six on average, but may be thousands

/// By their corners, those at one place.
static void sort_place(int32_t (*corners)[4], size_t count) {
    if (count > FEW) {
        qsort(corners, count, sizeof *corners, compare_corners);
        return;
    }
    for (size_t i = 1; i < count; i++) { // insertion
        int32_t moved[4];
        memcpy(moved, corners[i], sizeof moved);
        size_t k = i;
        for (; k > 0 && compare_corners(moved, corners[k - 1]) < 0; k--)
            memcpy(corners[k], corners[k - 1], sizeof moved);
        memcpy(corners[k], moved, sizeof moved);
    }
}

bool enf_tetrahedra_sort(int32_t (**corners)[4], size_t count, const double *points, size_t point_count) {
    int32_t *rank = rank_points(points, point_count);
    int32_t(*sorted)[4] = enf_array_new(count, sizeof *sorted), (*given)[4] = *corners;
    size_t *end = enf_array_zeroed(point_count + 1, sizeof *end); // of each place, once they are dealt
    bool good = rank && sorted && end;
    if (good) {
        for (size_t t = 0; t < count; t++) end[first_rank(rank, given[t]) + 1]++;
        for (size_t i = 0; i < point_count; i++) end[i + 1] += end[i];
        for (size_t t = 0; t < count; t++) turn_corners(given[t], sorted[end[first_rank(rank, given[t])]++]);
        for (size_t i = 0; i < point_count; i++) {
            size_t begin = i > 0 ? end[i - 1] : 0;
            sort_place(sorted + begin, end[i] - begin);
        }
        free(given);
        *corners = sorted;
    } else {
        free(sorted);
    }
    free(rank);
    free(end);
    return good;
}
