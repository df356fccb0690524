// SPDX-License-Identifier: GPL-3.0-or-later
// A hash table from an unordered pair of numbers to a number.
#include "build/pair_table.h"

#include "base/array.h"

#include <stdlib.h>

bool enf_pair_table_create(enf_pair_table *table, size_t capacity) {
    *table = (enf_pair_table){0};
    size_t slots = 16;
    while (slots / 4 * 3 < capacity + 1 && slots < SIZE_MAX / 4) slots *= 2;
    table->mask = slots - 1;
    table->keys = enf_array_new(slots, sizeof *table->keys);
    table->values = enf_array_new(slots, sizeof *table->values);
    if (!table->keys || !table->values) {
        enf_pair_table_free(table);
        return false;
    }
    for (size_t i = 0; i < slots; ++i) table->values[i] = -1;
    return true;
}

void enf_pair_table_free(enf_pair_table *table) {
    free(table->keys);
    free(table->values);
    *table = (enf_pair_table){0};
}

static uint64_t key_of(int32_t a, int32_t b) {
    uint32_t low = (uint32_t)(a < b ? a : b), high = (uint32_t)(a < b ? b : a);
    return (uint64_t)high << 32 | low;
}

static size_t home_of(const enf_pair_table *table, uint64_t key) {
    key = (key ^ key >> 32) * 0x9e3779b97f4a7c15u;
    key = (key ^ key >> 29) * 0xbf58476d1ce4e5b9u;
    return (size_t)(key ^ key >> 32) & table->mask;
}

int32_t *enf_pair_table_at(enf_pair_table *table, int32_t a, int32_t b) {
    uint64_t key = key_of(a, b);
    size_t slot = home_of(table, key);
    while (table->values[slot] >= 0 && table->keys[slot] != key) slot = (slot + 1) & table->mask;
    table->keys[slot] = key;
    return &table->values[slot];
}

bool enf_pair_table_reserve(enf_pair_table *table, size_t capacity) {
    if ((table->mask + 1) / 4 * 3 >= capacity + 1) return true;
    enf_pair_table grown;
    if (!enf_pair_table_create(&grown, 2 * capacity)) return false;
    for (size_t i = 0; i <= table->mask; ++i) {
        if (table->values[i] < 0) continue;
        size_t slot = home_of(&grown, table->keys[i]);
        while (grown.values[slot] >= 0) slot = (slot + 1) & grown.mask;
        grown.keys[slot] = table->keys[i];
        grown.values[slot] = table->values[i];
    }
    enf_pair_table_free(table);
    *table = grown;
    return true;
}

void enf_pair_table_remove(enf_pair_table *table, int32_t a, int32_t b) {
    int32_t *value = enf_pair_table_at(table, a, b);
    if (*value < 0) return;
    size_t hole = (size_t)(value - table->values), slot = hole;
    for (;;) {
        slot = (slot + 1) & table->mask;
        if (table->values[slot] < 0) break;
        size_t home = home_of(table, table->keys[slot]);
        if (((slot - home) & table->mask) < ((slot - hole) & table->mask)) continue;
        table->keys[hole] = table->keys[slot];
        table->values[hole] = table->values[slot];
        hole = slot;
    }
    table->values[hole] = -1;
}
