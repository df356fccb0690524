// SPDX-License-Identifier: GPL-3.0-or-later
// A table with open addressing.
#include "visibility/distinct.h"

#include "base/array.h"
#include "base/hash.h"

#include <stdlib.h>
#include <string.h>

/// Makes room for twice as many as there are points, at least, and empties it. False without memory.
static bool start(enf_distinct *distinct, int32_t count, uint32_t *used) {
    uint32_t wanted = 8;
    while (wanted < 2 * (uint32_t)count) wanted *= 2;
    if (wanted > distinct->slot_count) {
        free(distinct->slots);
        distinct->slots = enf_array_new(wanted, sizeof *distinct->slots);
        distinct->slot_count = distinct->slots ? wanted : 0;
        if (!distinct->slots) return false;
    }
    memset(distinct->slots, -1, wanted * sizeof *distinct->slots);
    *used = wanted;
    return true;
}

static uint32_t hash_of(const double point[3]) {
    uint64_t words[3], hash = 0;
    memcpy(words, point, sizeof words);
    for (int i = 0; i < 3; i++) hash = enf_hash_mix(hash ^ words[i]);
    return (uint32_t)hash;
}

int32_t enf_distinct_keep(enf_distinct *distinct, double (*points)[3], int32_t count) {
    int32_t kept = 0;
    uint32_t used;
    if (count > INT32_MAX / 2 || !start(distinct, count, &used)) return -1;
    for (int32_t i = 0; i < count; i++) {
        uint32_t slot = hash_of(points[i]) & (used - 1);
        for (; distinct->slots[slot] >= 0; slot = (slot + 1) & (used - 1))
            if (memcmp(points[distinct->slots[slot]], points[i], sizeof *points) == 0) break;
        if (distinct->slots[slot] >= 0) continue;
        distinct->slots[slot] = kept;
        if (kept < i) memcpy(points[kept], points[i], sizeof *points);
        kept++;
    }
    return kept;
}
