// SPDX-License-Identifier: GPL-3.0-or-later
// A table with open addressing.
#include "visibility/distinct.h"

#include "base/array.h"
#include "base/hash.h"
#include "base/parallel.h"

#include <stdlib.h>
#include <string.h>

/// Scratch memory, for any number of runs. All zero at first.
typedef struct table {
    int32_t *slots;
    uint32_t slot_count; ///< a power of two, or 0
} table;

/// Makes room for twice as many as there are points, at least, and empties it. False without memory.
static bool start(table *table, int32_t count, uint32_t *used) {
    uint32_t wanted = 8;
    while (wanted < 2 * (uint32_t)count) wanted *= 2;
    if (wanted > table->slot_count) {
        free(table->slots);
        table->slots = enf_array_new(wanted, sizeof *table->slots);
        table->slot_count = table->slots ? wanted : 0;
        if (!table->slots) return false;
    }
    memset(table->slots, -1, wanted * sizeof *table->slots);
    *used = wanted;
    return true;
}

static uint32_t hash_of(const double point[3]) {
    uint64_t words[3], hash = 0;
    memcpy(words, point, sizeof words);
    for (int i = 0; i < 3; i++) hash = enf_hash_mix(hash ^ words[i]);
    return (uint32_t)hash;
}

/// Keeps the first of equal points. Returns how many are left, or -1 without memory.
static int32_t keep(table *table, double (*points)[3], int32_t count) {
    int32_t kept = 0;
    uint32_t used;
    if (count > INT32_MAX / 2 || !start(table, count, &used)) return -1;
    for (int32_t i = 0; i < count; i++) {
        uint32_t slot = hash_of(points[i]) & (used - 1);
        for (; table->slots[slot] >= 0; slot = (slot + 1) & (used - 1))
            if (memcmp(points[table->slots[slot]], points[i], sizeof *points) == 0) break;
        if (table->slots[slot] >= 0) continue;
        table->slots[slot] = kept;
        if (kept < i) memcpy(points[kept], points[i], sizeof *points);
        kept++;
    }
    return kept;
}

// ---------------------------------------------------------------------------------------------- runs

enum { SHARES = 64 }; ///< of the runs, however many threads there are

typedef struct keeping {
    const enf_distinct_runs *runs;
    int32_t *kept; ///< per run
    bool good[SHARES];
} keeping;

static void keep_share(void *user, int32_t share, int thread) {
    keeping *keeping = user;
    const enf_distinct_runs *runs = keeping->runs;
    table table = {0};
    bool good = true;
    (void)thread;
    const int32_t begin = (int32_t)((int64_t)runs->count * share / SHARES),
                  end = (int32_t)((int64_t)runs->count * (share + 1) / SHARES);
    for (int32_t run = begin; good && run < end; run++) {
        double(*points)[3] = runs->points + runs->first[run];
        if (runs->fill) runs->fill(runs->user, run, points);
        keeping->kept[run] = keep(&table, points, runs->first[run + 1] - runs->first[run]);
        good = keeping->kept[run] >= 0;
    }
    keeping->good[share] = good;
    free(table.slots);
}

static void move_together(const enf_distinct_runs *runs, const int32_t *kept) {
    int32_t made = 0;
    for (int32_t run = 0; run < runs->count; run++) {
        if (kept[run] > 0 && made < runs->first[run])
            memmove(runs->points + made, runs->points + runs->first[run],
                    (size_t)kept[run] * sizeof *runs->points);
        runs->first[run] = made;
        made += kept[run];
    }
    runs->first[runs->count] = made;
}

bool enf_distinct_keep_runs(const enf_distinct_runs *runs, int threads) {
    keeping keeping = {.runs = runs, .kept = enf_array_new((size_t)runs->count, sizeof *keeping.kept)};
    bool good = keeping.kept;
    if (good) enf_parallel_for(&(enf_crew){.threads = threads}, SHARES, keep_share, &keeping);
    for (int i = 0; good && i < SHARES; i++) good = keeping.good[i];
    if (good) move_together(runs, keeping.kept);
    free(keeping.kept);
    return good;
}
