// SPDX-License-Identifier: GPL-3.0-or-later
// A hash table from an unordered pair of numbers to a number.
#include "build/pair_table.h"

#include "base/array.h"

#include <stdlib.h>

typedef struct enf_pair_slot pair_slot;

bool enf_pair_table_create(enf_pair_table *table, size_t capacity) {
    *table = (enf_pair_table){0};
    size_t slots = 16;
    while (slots / 4 * 3 < capacity + 1 && slots < SIZE_MAX / 4) slots *= 2;
    table->mask = slots - 1;
    table->slots = enf_array_new(slots, sizeof *table->slots);
    if (!table->slots) return false;
    for (size_t i = 0; i < slots; ++i) table->slots[i].value = -1;
    return true;
}

void enf_pair_table_free(enf_pair_table *table) {
    free(table->slots);
    *table = (enf_pair_table){0};
}

static size_t home_of(const enf_pair_table *table, uint32_t low, uint32_t high) {
    uint64_t key = ((uint64_t)high << 32 | low) ^ high;
    key *= 0x9e3779b97f4a7c15u;
    key = (key ^ key >> 29) * 0xbf58476d1ce4e5b9u;
    return (size_t)(key ^ key >> 32) & table->mask;
}

/// The slot of the pair, or the empty one where it would be.
static pair_slot *find(const enf_pair_table *table, uint32_t low, uint32_t high) {
    size_t at = home_of(table, low, high);
    while (table->slots[at].value >= 0 && (table->slots[at].low != low || table->slots[at].high != high))
        at = (at + 1) & table->mask;
    return &table->slots[at];
}

int32_t *enf_pair_table_at(enf_pair_table *table, int32_t a, int32_t b) {
    uint32_t low = (uint32_t)(a < b ? a : b), high = (uint32_t)(a < b ? b : a);
    pair_slot *slot = find(table, low, high);
    slot->low = low;
    slot->high = high;
    return &slot->value;
}

bool enf_pair_table_reserve(enf_pair_table *table, size_t capacity) {
    if ((table->mask + 1) / 4 * 3 >= capacity + 1) return true;
    enf_pair_table grown;
    if (!enf_pair_table_create(&grown, 2 * capacity)) return false;
    for (size_t i = 0; i <= table->mask; ++i) {
        const pair_slot *slot = &table->slots[i];
        if (slot->value >= 0) *find(&grown, slot->low, slot->high) = *slot;
    }
    enf_pair_table_free(table);
    *table = grown;
    return true;
}

void enf_pair_table_remove(enf_pair_table *table, int32_t a, int32_t b) {
    uint32_t low = (uint32_t)(a < b ? a : b), high = (uint32_t)(a < b ? b : a);
    const pair_slot *found = find(table, low, high);
    if (found->value < 0) return;
    size_t hole = (size_t)(found - table->slots), at = hole;
    for (;;) {
        at = (at + 1) & table->mask;
        if (table->slots[at].value < 0) break;
        size_t home = home_of(table, table->slots[at].low, table->slots[at].high);
        if (((at - home) & table->mask) < ((at - hole) & table->mask)) continue;
        table->slots[hole] = table->slots[at];
        hole = at;
    }
    table->slots[hole].value = -1;
}
