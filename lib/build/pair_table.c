// SPDX-License-Identifier: GPL-3.0-or-later
// A hash table from an unordered pair of numbers to a number.
#include "build/pair_table.h"

#include "base/array.h"

#include <stdlib.h>

enum { PAGE_BITS = 12, SLOTS_MIN = 16 }; ///< a page has as many numbers; at least so many slots

typedef struct enf_pair_slot pair_slot;

typedef struct pair {
    uint32_t low, high;
} pair;

static pair pair_of(int32_t a, int32_t b) {
    return a < b ? (pair){(uint32_t)a, (uint32_t)b} : (pair){(uint32_t)b, (uint32_t)a};
}

bool enf_pair_table_create(enf_pair_table *table, int32_t numbers) {
    table->page_count = (numbers >> PAGE_BITS) + 1;
    table->pages = enf_array_zeroed((size_t)table->page_count, sizeof *table->pages);
    return table->pages;
}

void enf_pair_table_free(enf_pair_table *table) {
    for (int32_t i = 0; table->pages && i < table->page_count; ++i) free(table->pages[i].slots);
    free(table->pages);
    *table = (enf_pair_table){0};
}

static enf_pair_page *page_of(const enf_pair_table *table, pair pair) {
    return &table->pages[pair.high >> PAGE_BITS];
}

static uint32_t home_of(const enf_pair_page *page, pair pair) {
    uint64_t key = ((uint64_t)pair.high << 32 | pair.low) ^ pair.high;
    key *= 0x9e3779b97f4a7c15u;
    key = (key ^ key >> 29) * 0xbf58476d1ce4e5b9u;
    return (uint32_t)((key >> 32) * page->slot_count >> 32);
}

static uint32_t after(const enf_pair_page *page, uint32_t slot) {
    return slot + 1 < page->slot_count ? slot + 1 : 0;
}

/// How far on from one slot another is.
static uint32_t distance(const enf_pair_page *page, uint32_t from, uint32_t to) {
    return to >= from ? to - from : to + page->slot_count - from;
}

/// The slot of the pair, or the empty one where it would be. The page has slots.
static pair_slot *find(const enf_pair_page *page, pair pair) {
    uint32_t at = home_of(page, pair);
    while (page->slots[at].value >= 0 &&
           (page->slots[at].low != pair.low || page->slots[at].high != pair.high))
        at = after(page, at);
    return &page->slots[at];
}

/// Makes slots for so many pairs, two thirds full, and puts those of before there. False without memory.
static bool resize(enf_pair_page *page, size_t count) {
    size_t slots = count + count / 2 < SLOTS_MIN ? SLOTS_MIN : count + count / 2;
    enf_pair_page grown = {.count = page->count};
    if (slots > UINT32_MAX || !(grown.slots = enf_array_new(slots, sizeof *grown.slots))) return false;
    grown.slot_count = (uint32_t)slots;
    for (size_t i = 0; i < slots; ++i) grown.slots[i].value = -1;
    for (uint32_t i = 0; i < page->slot_count; ++i) {
        const pair_slot *slot = &page->slots[i];
        if (slot->value >= 0) *find(&grown, (pair){slot->low, slot->high}) = *slot;
    }
    free(page->slots);
    *page = grown;
    return true;
}

void enf_pair_table_expect(enf_pair_table *table, int32_t a, int32_t b) {
    page_of(table, pair_of(a, b))->expected++;
}

int32_t enf_pair_table_find(const enf_pair_table *table, int32_t a, int32_t b) {
    pair pair = pair_of(a, b);
    const enf_pair_page *page = page_of(table, pair);
    return page->slots ? find(page, pair)->value : -1;
}

bool enf_pair_table_put(enf_pair_table *table, int32_t a, int32_t b, int32_t value) {
    pair pair = pair_of(a, b);
    enf_pair_page *page = page_of(table, pair);
    if (!page->slots && !resize(page, page->expected)) return false;
    pair_slot *slot = find(page, pair);
    if (slot->value < 0) {
        if ((uint64_t)(page->count + 1) * 4 > (uint64_t)page->slot_count * 3) {
            if (!resize(page, (size_t)page->count * 2)) return false;
            slot = find(page, pair);
        }
        page->count++;
    }
    *slot = (pair_slot){pair.low, pair.high, value};
    return true;
}

void enf_pair_table_remove(enf_pair_table *table, int32_t a, int32_t b) {
    pair pair = pair_of(a, b);
    enf_pair_page *page = page_of(table, pair);
    const pair_slot *found = page->slots ? find(page, pair) : NULL;
    if (!found || found->value < 0) return;
    uint32_t hole = (uint32_t)(found - page->slots), at = hole;
    for (;;) {
        at = after(page, at);
        const pair_slot *slot = &page->slots[at];
        if (slot->value < 0) break;
        uint32_t home = home_of(page, (struct pair){slot->low, slot->high});
        if (distance(page, home, at) < distance(page, hole, at)) continue;
        page->slots[hole] = *slot;
        hole = at;
    }
    page->slots[hole].value = -1;
    page->count--;
}
