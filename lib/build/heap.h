// SPDX-License-Identifier: GPL-3.0-or-later
// An indexed heap: numbered items, the one with the smallest key on top, and the key of any item can be
// raised or lowered where it stands (Cormen et al., Introduction to Algorithms, chapter 6; Johnson, 1975).
#ifndef ENF_BUILD_HEAP_H
#define ENF_BUILD_HEAP_H

#include "enfilade/base.h"

/// Keys are ordered by weight (never NaN), then by first, then by second.
typedef struct enf_heap_key {
    double weight;
    int32_t first, second;
} enf_heap_key;

typedef struct enf_heap {
    int32_t count;    ///< items in the heap
    int32_t capacity; ///< items are numbered 0..capacity-1
    struct enf_heap_entry {
        enf_heap_key key; ///< beside the item, so that comparing them touches nothing else
        int32_t item;
    } * entries;     ///< the heap: the children of place i are at 4i+1 to 4i+4
    int32_t *places; ///< for each item its place, or -1 when it is not in the heap
} enf_heap;

/// An empty heap for items 0..capacity-1. Returns false when there is no memory.
bool enf_heap_create(enf_heap *heap, int32_t capacity);
void enf_heap_free(enf_heap *heap);

/// The key of an item that is in the heap.
enf_heap_key enf_heap_key_of(const enf_heap *heap, int32_t item);

bool enf_heap_has(const enf_heap *heap, int32_t item);

/// The item with the smallest key, or -1 when the heap is empty.
int32_t enf_heap_top(const enf_heap *heap);

/// Puts an item in with this key, or changes its key when it is in already.
void enf_heap_set(enf_heap *heap, int32_t item, enf_heap_key key);

/// Takes an item out; nothing happens when it is not in.
void enf_heap_remove(enf_heap *heap, int32_t item);

static inline bool enf_heap_key_less(enf_heap_key a, enf_heap_key b) {
    if (a.weight != b.weight) return a.weight < b.weight;
    if (a.first != b.first) return a.first < b.first;
    return a.second < b.second;
}

#endif
