// SPDX-License-Identifier: MIT
// A binary heap of numbered nodes by a key that may sink; of equal keys the lowest number comes first.
#ifndef ENF_RUN_PATH_HEAP_H
#define ENF_RUN_PATH_HEAP_H

#include <stdbool.h>
#include <stdint.h>

typedef struct enf_path_heap_entry {
    int64_t key;
    int32_t node;
} enf_path_heap_entry;

typedef struct enf_path_heap {
    enf_path_heap_entry *entries; ///< room for every node
    int32_t *slot; ///< per node: where it lies; -1 after it was taken out; not set before it was added
    int32_t count;
} enf_path_heap;

/// Takes memory for nodes 0 to count - 1. False without.
bool enf_path_heap_make(enf_path_heap *heap, int32_t count);
void enf_path_heap_free(enf_path_heap *heap);

/// A node that is not in the heap.
void enf_path_heap_add(enf_path_heap *heap, int32_t node, int64_t key);

/// A node that is in the heap; the key may not rise.
void enf_path_heap_sink(enf_path_heap *heap, int32_t node, int64_t key);

/// Takes the first node out; the heap must not be empty.
enf_path_heap_entry enf_path_heap_pop(enf_path_heap *heap);

#endif
