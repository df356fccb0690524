// SPDX-License-Identifier: GPL-3.0-or-later
// Sorting rings and finding twins. The first three corners travel with the sort, they nearly always decide.
#define _GNU_SOURCE // qsort_r
#include "build/pieces.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

void enf_pieces_free(enf_pieces *pieces) {
    free(pieces->corner);
    free(pieces->corners);
    free(pieces->source);
    *pieces = (enf_pieces){0};
}

bool enf_pieces_add(enf_pieces *pieces, const int32_t *ring, size_t count, int32_t source) {
    if (pieces->count >= INT32_MAX - 1 ||
        !enf_array_reserve(pieces->corner, pieces->corner_capacity, pieces->count + 2) ||
        !enf_array_reserve(pieces->source, pieces->source_capacity, pieces->count + 1) ||
        !enf_array_reserve(pieces->corners, pieces->corners_capacity, pieces->corner_count + count))
        return false;
    if (pieces->count == 0) pieces->corner[0] = 0;
    memcpy(pieces->corners + pieces->corner_count, ring, count * sizeof *ring);
    pieces->corner_count += count;
    pieces->source[pieces->count++] = source;
    pieces->corner[pieces->count] = (int64_t)pieces->corner_count;
    return true;
}

size_t enf_pieces_size(const enf_pieces *pieces, int32_t piece) {
    return (size_t)(pieces->corner[piece + 1] - pieces->corner[piece]);
}

static int compare_rings(const int32_t *a, size_t a_count, const int32_t *b, size_t b_count) {
    for (size_t i = 0; i < a_count && i < b_count; i++)
        if (a[i] != b[i]) return a[i] < b[i] ? -1 : 1;
    return (a_count > b_count) - (a_count < b_count);
}

static int compare_pieces(const enf_pieces *pieces, int32_t a, int32_t b) {
    return compare_rings(&pieces->corners[pieces->corner[a]], enf_pieces_size(pieces, a),
                         &pieces->corners[pieces->corner[b]], enf_pieces_size(pieces, b));
}

typedef struct sort_key {
    int32_t first[3], piece;
} sort_key;

static int compare_keys(const void *left, const void *right, void *pieces) {
    const sort_key *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->first[k] != b->first[k]) return a->first[k] < b->first[k] ? -1 : 1;
    int order = compare_pieces(pieces, a->piece, b->piece);
    return order ? order : (a->piece > b->piece) - (a->piece < b->piece);
}

enum { INSERT_MAX = 24 }; ///< keys that are sorted by insertion

static void sort_keys(const enf_pieces *pieces, sort_key *keys, size_t count) {
    if (count > INSERT_MAX) {
        qsort_r(keys, count, sizeof *keys, compare_keys, (void *)pieces);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        sort_key moved = keys[i];
        size_t k = i;
        for (; k > 0 && compare_keys(&moved, &keys[k - 1], (void *)pieces) < 0; k--) keys[k] = keys[k - 1];
        keys[k] = moved;
    }
}

/// The keys dealt out by their first corner: what is left to sort is a few at a time. False without memory.
static bool deal_keys(const enf_pieces *pieces, sort_key *keys) {
    int32_t most = 0;
    for (size_t i = 0; i < pieces->count; i++) {
        int32_t first = pieces->corners[pieces->corner[i]];
        most = first > most ? first : most;
    }
    size_t *next = enf_array_zeroed((size_t)most + 2, sizeof *next);
    if (!next) return false;
    for (size_t i = 0; i < pieces->count; i++) next[pieces->corners[pieces->corner[i]] + 1]++;
    for (int32_t p = 0; p < most; p++) next[p + 1] += next[p];
    for (size_t i = 0; i < pieces->count; i++) {
        const int32_t *ring = &pieces->corners[pieces->corner[i]];
        sort_key *key = &keys[next[ring[0]]++];
        memcpy(key->first, ring, sizeof key->first);
        key->piece = (int32_t)i;
    }
    free(next);
    return true;
}

enf_status enf_pieces_sort(const enf_pieces *pieces, int32_t *order, int32_t *copies, size_t *kept,
                           enf_error *error) {
    sort_key *keys = enf_array_new(pieces->count, sizeof *keys);
    if (!keys || !deal_keys(pieces, keys)) {
        free(keys);
        return enf_fail_memory(error, "sorting the polygons");
    }
    for (size_t begin = 0, end; begin < pieces->count; begin = end) {
        for (end = begin + 1; end < pieces->count && keys[end].first[0] == keys[begin].first[0];) end++;
        sort_keys(pieces, keys + begin, end - begin);
    }
    *kept = 0;
    for (size_t i = 0; i < pieces->count; i++) {
        if (*kept == 0 || compare_pieces(pieces, order[*kept - 1], keys[i].piece) != 0) {
            order[*kept] = keys[i].piece;
            copies[(*kept)++] = 0;
        }
        copies[*kept - 1]++;
    }
    free(keys);
    return ENF_OK;
}

/// Is the ring among order[low .. high - 1], which are sorted?
static bool is_among(const enf_pieces *pieces, const int32_t *order, size_t low, size_t high,
                     const int32_t *ring, size_t count) {
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        int side = compare_rings(&pieces->corners[pieces->corner[order[middle]]],
                                 enf_pieces_size(pieces, order[middle]), ring, count);
        if (side == 0) return true;
        if (side < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return false;
}

static int32_t first_corner(const enf_pieces *pieces, int32_t piece) {
    return pieces->corners[pieces->corner[piece]];
}

/// A ring and its twin begin at the same corner.
enf_status enf_pieces_count_two_sided(const enf_pieces *pieces, const int32_t *order, size_t kept,
                                      size_t *two_sided, enf_error *error) {
    int32_t *reversed = NULL;
    size_t capacity = 0;
    *two_sided = 0;
    for (size_t begin = 0, end; begin < kept; begin = end) {
        int32_t first = first_corner(pieces, order[begin]);
        for (end = begin + 1; end < kept && first_corner(pieces, order[end]) == first;) end++;
        for (size_t i = begin; i < end && end - begin > 1; i++) {
            const int32_t *ring = &pieces->corners[pieces->corner[order[i]]];
            size_t count = enf_pieces_size(pieces, order[i]);
            if (!enf_array_reserve(reversed, capacity, count)) {
                free(reversed);
                return enf_fail_memory(error, "the polygons");
            }
            reversed[0] = ring[0];
            for (size_t k = 1; k < count; k++) reversed[k] = ring[count - k];
            *two_sided += is_among(pieces, order, begin, end, reversed, count);
        }
    }
    free(reversed);
    return ENF_OK;
}
