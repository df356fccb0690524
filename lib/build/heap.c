// SPDX-License-Identifier: GPL-3.0-or-later
// An indexed binary heap (Cormen et al., Introduction to Algorithms, chapter 6).
#include "build/heap.h"

#include "base/array.h"

#include <assert.h>
#include <stdlib.h>

bool enf_heap_create(enf_heap *heap, int32_t capacity) {
    assert(capacity >= 0);
    *heap = (enf_heap){.capacity = capacity};
    heap->items = enf_array_new((size_t)capacity, sizeof *heap->items);
    heap->places = enf_array_new((size_t)capacity, sizeof *heap->places);
    heap->keys = enf_array_new((size_t)capacity, sizeof *heap->keys);
    if (!heap->items || !heap->places || !heap->keys) {
        enf_heap_free(heap);
        return false;
    }
    for (int32_t i = 0; i < capacity; ++i) heap->places[i] = -1;
    return true;
}

void enf_heap_free(enf_heap *heap) {
    free(heap->items);
    free(heap->places);
    free(heap->keys);
    *heap = (enf_heap){0};
}

bool enf_heap_has(const enf_heap *heap, int32_t item) {
    return heap->places[item] >= 0;
}

int32_t enf_heap_top(const enf_heap *heap) {
    return heap->count > 0 ? heap->items[0] : -1;
}

bool enf_heap_key_less(enf_heap_key a, enf_heap_key b) {
    if (a.weight != b.weight) return a.weight < b.weight;
    if (a.first != b.first) return a.first < b.first;
    return a.second < b.second;
}

static void put(enf_heap *heap, int32_t place, int32_t item) {
    heap->items[place] = item;
    heap->places[item] = place;
}

static void rise(enf_heap *heap, int32_t place, int32_t item) {
    while (place > 0) {
        int32_t parent = (place - 1) / 2;
        if (!enf_heap_key_less(heap->keys[item], heap->keys[heap->items[parent]])) break;
        put(heap, place, heap->items[parent]);
        place = parent;
    }
    put(heap, place, item);
}

static void sink(enf_heap *heap, int32_t place, int32_t item) {
    for (;;) {
        int64_t child = 2 * (int64_t)place + 1;
        if (child >= heap->count) break;
        if (child + 1 < heap->count &&
            enf_heap_key_less(heap->keys[heap->items[child + 1]], heap->keys[heap->items[child]]))
            ++child;
        if (!enf_heap_key_less(heap->keys[heap->items[child]], heap->keys[item])) break;
        put(heap, place, heap->items[child]);
        place = (int32_t)child;
    }
    put(heap, place, item);
}

void enf_heap_set(enf_heap *heap, int32_t item, enf_heap_key key) {
    assert(item >= 0 && item < heap->capacity);
    assert(key.weight == key.weight);
    int32_t place = heap->places[item];
    if (place < 0) {
        heap->keys[item] = key;
        rise(heap, heap->count++, item);
        return;
    }
    bool lighter = enf_heap_key_less(key, heap->keys[item]);
    heap->keys[item] = key;
    if (lighter)
        rise(heap, place, item);
    else
        sink(heap, place, item);
}

void enf_heap_remove(enf_heap *heap, int32_t item) {
    assert(item >= 0 && item < heap->capacity);
    int32_t place = heap->places[item];
    if (place < 0) return;
    int32_t last = heap->items[--heap->count];
    heap->places[item] = -1;
    if (last == item) return;
    if (enf_heap_key_less(heap->keys[last], heap->keys[item]))
        rise(heap, place, last);
    else
        sink(heap, place, last);
}
