// SPDX-License-Identifier: MIT
#include "run/path_heap.h"

#include "base/array.h"

#include <stdlib.h>

bool enf_path_heap_make(enf_path_heap *heap, int32_t count) {
    *heap = (enf_path_heap){0};
    heap->entries = enf_array_new((size_t)count, sizeof *heap->entries);
    heap->slot = enf_array_new((size_t)count, sizeof *heap->slot);
    return heap->entries && heap->slot;
}

void enf_path_heap_free(enf_path_heap *heap) {
    free(heap->entries);
    free(heap->slot);
}

static bool is_before(enf_path_heap_entry a, enf_path_heap_entry b) {
    return a.key < b.key || (a.key == b.key && a.node < b.node);
}

static void put(enf_path_heap *heap, int32_t at, enf_path_heap_entry entry) {
    heap->entries[at] = entry;
    heap->slot[entry.node] = at;
}

static void move_up(enf_path_heap *heap, int32_t at, enf_path_heap_entry entry) {
    while (at > 0 && is_before(entry, heap->entries[(at - 1) / 2])) {
        put(heap, at, heap->entries[(at - 1) / 2]);
        at = (at - 1) / 2;
    }
    put(heap, at, entry);
}

void enf_path_heap_add(enf_path_heap *heap, int32_t node, int64_t key) {
    move_up(heap, heap->count++, (enf_path_heap_entry){key, node});
}

void enf_path_heap_sink(enf_path_heap *heap, int32_t node, int64_t key) {
    move_up(heap, heap->slot[node], (enf_path_heap_entry){key, node});
}

enf_path_heap_entry enf_path_heap_pop(enf_path_heap *heap) {
    enf_path_heap_entry first = heap->entries[0], last = heap->entries[--heap->count];
    heap->slot[first.node] = -1;
    int32_t at = 0, half = heap->count / 2;
    while (at < half) {
        int32_t child = 2 * at + 1;
        if (child + 1 < heap->count && is_before(heap->entries[child + 1], heap->entries[child])) child++;
        if (!is_before(heap->entries[child], last)) break;
        put(heap, at, heap->entries[child]);
        at = child;
    }
    if (heap->count > 0) put(heap, at, last);
    return first;
}
