// SPDX-License-Identifier: GPL-3.0-or-later
// Heaps of neighbours: items 0..count-1 in blocks of 2^block_bits, each with a heap of its own. Where numbers
// run along a curve through space, a block is a part of space, and work on it stays near in memory.
#ifndef ENF_BUILD_BLOCK_HEAP_H
#define ENF_BUILD_BLOCK_HEAP_H

#include "build/heap.h"

/// All items in one block.
#define ENF_ONE_BLOCK_BITS 31

typedef struct enf_block_heap {
    int32_t count; ///< items are numbered 0..count-1
    int block_bits;
    int32_t block_count; ///< 1 or more
    enf_heap *blocks;
} enf_block_heap;

/// Empty, in blocks of 2^block_bits items, 0 to ENF_ONE_BLOCK_BITS. Returns false when there is no memory.
bool enf_block_heap_create(enf_block_heap *heap, int32_t count, int block_bits);
void enf_block_heap_free(enf_block_heap *heap);

/// Puts what is in into other blocks. False, with the blocks as they were, when there is no memory.
bool enf_block_heap_divide(enf_block_heap *heap, int block_bits);

/// The item of a block with the smallest key, or -1 when the block is empty.
int32_t enf_block_heap_top(const enf_block_heap *heap, int32_t block);

/// These do what those of enf_heap do.
enf_heap_key enf_block_heap_key_of(const enf_block_heap *heap, int32_t item);
void enf_block_heap_set(enf_block_heap *heap, int32_t item, enf_heap_key key);
void enf_block_heap_remove(enf_block_heap *heap, int32_t item);

#endif
