// SPDX-License-Identifier: GPL-3.0-or-later
// Welding by a hash grid over the representatives.
#include "build/weld.h"

#include "base/array.h"
#include "base/hash.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static int compare_sites(const void *left, const void *right) {
    const enf_site *a = left, *b = right;
    for (int k = 0; k < 3; k++)
        if (a->at[k] != b->at[k]) return a->at[k] < b->at[k] ? -1 : 1;
    return (a->id > b->id) - (a->id < b->id);
}

/// A number that is larger for larger doubles; 0 and -0 are the same.
static uint64_t rising(double x) {
    uint64_t bits;
    double one = x + 0.0;
    memcpy(&bits, &one, sizeof bits);
    return bits >> 63 ? ~bits : bits | UINT64_C(1) << 63;
}

enum { DIGIT_BITS = 11, DIGITS = 6, FEW = 256 }; ///< of a rising number; sites that are sorted by comparing
enum { FIRST_DIGIT = 3 }; ///< those above it tell nearly all coordinates apart that differ

typedef struct ranked {
    uint64_t key;
    size_t place;
} ranked;

/// One pass of a radix sort by one digit; false if all have the same one.
static bool deal_by_digit(const ranked *from, ranked *to, size_t count, int digit) {
    size_t next[1 << DIGIT_BITS] = {0}, sum = 0;
    const int shift = DIGIT_BITS * digit;
    const uint64_t mask = (1 << DIGIT_BITS) - 1;
    for (size_t i = 0; i < count; i++) next[from[i].key >> shift & mask]++;
    if (next[from[0].key >> shift & mask] == count) return false;
    for (size_t i = 0; i <= mask; i++) {
        size_t here = next[i];
        next[i] = sum;
        sum += here;
    }
    for (size_t i = 0; i < count; i++) to[next[from[i].key >> shift & mask]++] = from[i];
    return true;
}

static uint64_t leading_digits(const enf_site *site) {
    return rising(site->at[0]) >> DIGIT_BITS * FIRST_DIGIT;
}

/// Sorts by the leading digits of the first coordinate. False, with the sites as they were, without memory.
static bool sort_by_first(enf_site *sites, size_t count) {
    ranked *now = enf_array_new(count, sizeof *now), *then = enf_array_new(count, sizeof *then);
    enf_site *given = enf_array_new(count, sizeof *given);
    bool good = now && then && given;
    if (good) {
        memcpy(given, sites, count * sizeof *given);
        for (size_t i = 0; i < count; i++) now[i] = (ranked){rising(given[i].at[0]), i};
        for (int digit = FIRST_DIGIT; digit < DIGITS; digit++) {
            if (!deal_by_digit(now, then, count, digit)) continue;
            ranked *swap = now;
            now = then;
            then = swap;
        }
        for (size_t i = 0; i < count; i++) sites[i] = given[now[i].place];
    }
    free(now);
    free(then);
    free(given);
    return good;
}

enum { INSERT_MAX = 16 }; ///< sites that are sorted by insertion: at most places there are a few

static void sort_few(enf_site *sites, size_t count) {
    if (count > INSERT_MAX) {
        qsort(sites, count, sizeof *sites, compare_sites);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        enf_site one = sites[i];
        size_t k = i;
        for (; k > 0 && compare_sites(&sites[k - 1], &one) > 0; k--) sites[k] = sites[k - 1];
        sites[k] = one;
    }
}

void enf_sites_sort(enf_site *sites, size_t count) {
    size_t ordered = 1; // welding and flattening leave most orders as they were
    while (ordered < count && compare_sites(&sites[ordered - 1], &sites[ordered]) <= 0) ordered++;
    if (ordered >= count) return;
    if (count <= FEW || !sort_by_first(sites, count)) {
        qsort(sites, count, sizeof *sites, compare_sites);
        return;
    }
    for (size_t begin = 0, end; begin < count; begin = end) { // equal ones by the rest
        uint64_t leading = leading_digits(&sites[begin]);
        for (end = begin + 1; end < count && leading_digits(&sites[end]) == leading;) end++;
        sort_few(sites + begin, end - begin);
    }
}

static bool same_place(const enf_site *a, const enf_site *b) {
    return a->at[0] == b->at[0] && a->at[1] == b->at[1] && a->at[2] == b->at[2];
}

size_t enf_sites_unite(enf_site *sites, size_t count, int32_t *group_of) {
    size_t groups = 0;
    for (size_t i = 0; i < count; i++) {
        int32_t id = sites[i].id;
        if (groups == 0 || !same_place(&sites[groups - 1], &sites[i])) sites[groups++] = sites[i];
        group_of[id] = (int32_t)(groups - 1);
    }
    return groups;
}

/// Representatives in a hash table of chains; every chain is in rising order of position.
typedef struct hash_grid {
    const enf_site *sites;
    double distance, reach, width; ///< reach: the distance, with room for rounding; width of a grid cell
    size_t mask;
    int32_t *head, *tail; ///< per slot, -1 = empty
    int32_t *next;        ///< per site, -1 = end
} hash_grid;

static size_t grid_slot(const hash_grid *grid, double x, double y, double z) {
    uint64_t hash = enf_hash_mix((uint64_t)(int64_t)x);
    hash = enf_hash_mix(hash + (uint64_t)(int64_t)y);
    return enf_hash_mix(hash + (uint64_t)(int64_t)z) & grid->mask;
}

static bool is_near(const hash_grid *grid, int32_t a, int32_t b) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double difference = grid->sites[a].at[k] - grid->sites[b].at[k];
        sum += difference * difference;
    }
    return sum <= grid->distance * grid->distance;
}

/// The first representative near `site`, or -1.
static int32_t find_near(const hash_grid *grid, int32_t site) {
    double low[3], high[3];
    for (int k = 0; k < 3; k++) {
        low[k] = floor((grid->sites[site].at[k] - grid->reach) / grid->width);
        high[k] = floor((grid->sites[site].at[k] + grid->reach) / grid->width);
    }
    int32_t first = -1;
    for (double x = low[0]; x <= high[0]; x++)
        for (double y = low[1]; y <= high[1]; y++)
            for (double z = low[2]; z <= high[2]; z++)
                for (int32_t i = grid->head[grid_slot(grid, x, y, z)]; i >= 0 && (first < 0 || i < first);
                     i = grid->next[i])
                    if (is_near(grid, i, site)) first = i;
    return first;
}

static void add_representative(hash_grid *grid, int32_t site) {
    const double *at = grid->sites[site].at;
    size_t slot =
        grid_slot(grid, floor(at[0] / grid->width), floor(at[1] / grid->width), floor(at[2] / grid->width));
    grid->next[site] = -1;
    if (grid->head[slot] < 0)
        grid->head[slot] = site;
    else
        grid->next[grid->tail[slot]] = site;
    grid->tail[slot] = site;
}

enf_status enf_sites_weld(const enf_site *sites, size_t count, double distance, int32_t *joined_to,
                          enf_error *error) {
    if (distance < 1) { // different grid points are at least 1 apart
        for (size_t i = 0; i < count; i++) joined_to[i] = (int32_t)i;
        return ENF_OK;
    }
    hash_grid grid = {.sites = sites, .distance = fmin(distance, 0x1p56)};
    grid.reach = grid.distance * (1 + 0x1p-40) + 1;
    grid.width = 4 * grid.reach;
    size_t slots = 16;
    while (slots < count + count / 2) slots *= 2;
    grid.mask = slots - 1;
    grid.head = enf_array_new(slots, sizeof *grid.head);
    grid.tail = enf_array_new(slots, sizeof *grid.tail);
    grid.next = enf_array_new(count, sizeof *grid.next);
    enf_status status = ENF_OK;
    if (!grid.head || !grid.tail || !grid.next) {
        status = enf_fail_memory(error, "welding");
    } else {
        memset(grid.head, -1, slots * sizeof *grid.head);
        for (size_t i = 0; i < count; i++) {
            joined_to[i] = find_near(&grid, (int32_t)i);
            if (joined_to[i] >= 0) continue;
            joined_to[i] = (int32_t)i;
            add_representative(&grid, (int32_t)i);
        }
    }
    free(grid.head);
    free(grid.tail);
    free(grid.next);
    return status;
}
