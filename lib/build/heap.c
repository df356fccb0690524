// SPDX-License-Identifier: GPL-3.0-or-later
// An indexed heap with four children each (Johnson, Priority queues with update and finding minimum spanning
// trees, 1975): half as many levels as with two, so half as many places to tell where an item went.
#include "build/heap.h"

#include "base/array.h"

#include <assert.h>
#include <stdlib.h>

enum { CHILDREN = 4 };

bool enf_heap_create(enf_heap *heap, int32_t capacity) {
    assert(capacity >= 0);
    *heap = (enf_heap){.capacity = capacity};
    heap->entries = enf_array_new((size_t)capacity, sizeof *heap->entries);
    heap->places = enf_array_new((size_t)capacity, sizeof *heap->places);
    if (!heap->entries || !heap->places) {
        enf_heap_free(heap);
        return false;
    }
    for (int32_t i = 0; i < capacity; ++i) heap->places[i] = -1;
    return true;
}

void enf_heap_free(enf_heap *heap) {
    free(heap->entries);
    free(heap->places);
    *heap = (enf_heap){0};
}

bool enf_heap_has(const enf_heap *heap, int32_t item) {
    return heap->places[item] >= 0;
}

enf_heap_key enf_heap_key_of(const enf_heap *heap, int32_t item) {
    assert(heap->places[item] >= 0);
    return heap->entries[heap->places[item]].key;
}

int32_t enf_heap_top(const enf_heap *heap) {
    return heap->count > 0 ? heap->entries[0].item : -1;
}

static void put(enf_heap *heap, int32_t place, struct enf_heap_entry entry) {
    heap->entries[place] = entry;
    heap->places[entry.item] = place;
}

static void rise(enf_heap *heap, int32_t place, struct enf_heap_entry entry) {
    while (place > 0) {
        int32_t parent = (place - 1) / CHILDREN;
        if (!enf_heap_key_less(entry.key, heap->entries[parent].key)) break;
        put(heap, place, heap->entries[parent]);
        place = parent;
    }
    put(heap, place, entry);
}

static void sink(enf_heap *heap, int32_t place, struct enf_heap_entry entry) {
    for (;;) {
        int64_t child = CHILDREN * (int64_t)place + 1, end = child + CHILDREN;
        if (child >= heap->count) break;
        if (end > heap->count) end = heap->count;
        for (int64_t other = child + 1; other < end; ++other)
            if (enf_heap_key_less(heap->entries[other].key, heap->entries[child].key)) child = other;
        if (!enf_heap_key_less(heap->entries[child].key, entry.key)) break;
        put(heap, place, heap->entries[child]);
        place = (int32_t)child;
    }
    put(heap, place, entry);
}

void enf_heap_set(enf_heap *heap, int32_t item, enf_heap_key key) {
    assert(item >= 0 && item < heap->capacity);
    assert(key.weight == key.weight);
    const struct enf_heap_entry entry = {key, item};
    int32_t place = heap->places[item];
    if (place < 0)
        rise(heap, heap->count++, entry);
    else if (enf_heap_key_less(key, heap->entries[place].key))
        rise(heap, place, entry);
    else
        sink(heap, place, entry);
}

void enf_heap_remove(enf_heap *heap, int32_t item) {
    assert(item >= 0 && item < heap->capacity);
    int32_t place = heap->places[item];
    if (place < 0) return;
    enf_heap_key gone = heap->entries[place].key;
    struct enf_heap_entry last = heap->entries[--heap->count];
    heap->places[item] = -1;
    if (last.item == item) return;
    if (enf_heap_key_less(last.key, gone))
        rise(heap, place, last);
    else
        sink(heap, place, last);
}
