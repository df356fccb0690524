// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/block_heap.h"

#include "base/array.h"

#include <stdlib.h>

static enf_heap *block_of(const enf_block_heap *heap, int32_t item) {
    return &heap->blocks[item >> heap->block_bits];
}

/// An item's number in its block.
static int32_t inner(const enf_block_heap *heap, int32_t item) {
    return item & (int32_t)((UINT32_C(1) << heap->block_bits) - 1);
}

bool enf_block_heap_create(enf_block_heap *heap, int32_t count, int block_bits) {
    uint32_t most = UINT32_C(1) << block_bits, blocks = ((uint32_t)count + most - 1) >> block_bits;
    if (blocks == 0) blocks = 1;
    *heap = (enf_block_heap){.count = count, .block_bits = block_bits, .block_count = (int32_t)blocks};
    heap->blocks = enf_array_zeroed(blocks, sizeof *heap->blocks);
    bool good = heap->blocks;
    for (int32_t block = 0; good && block < heap->block_count; ++block) {
        uint32_t rest = (uint32_t)count - ((uint32_t)block << block_bits);
        good = enf_heap_create(&heap->blocks[block], (int32_t)(rest < most ? rest : most));
    }
    if (!good) enf_block_heap_free(heap);
    return good;
}

void enf_block_heap_free(enf_block_heap *heap) {
    for (int32_t block = 0; heap->blocks && block < heap->block_count; ++block)
        enf_heap_free(&heap->blocks[block]);
    free(heap->blocks);
    *heap = (enf_block_heap){0};
}

bool enf_block_heap_divide(enf_block_heap *heap, int block_bits) {
    enf_block_heap divided;
    if (!enf_block_heap_create(&divided, heap->count, block_bits)) return false;
    for (int32_t block = 0; block < heap->block_count; ++block) {
        const enf_heap *from = &heap->blocks[block];
        for (int32_t place = 0; place < from->count; ++place)
            enf_block_heap_set(&divided, (block << heap->block_bits) + from->entries[place].item,
                               from->entries[place].key);
        enf_heap_free(&heap->blocks[block]);
    }
    enf_block_heap_free(heap);
    *heap = divided;
    return true;
}

int32_t enf_block_heap_top(const enf_block_heap *heap, int32_t block) {
    int32_t item = enf_heap_top(&heap->blocks[block]);
    return item < 0 ? -1 : (block << heap->block_bits) + item;
}

enf_heap_key enf_block_heap_key_of(const enf_block_heap *heap, int32_t item) {
    return enf_heap_key_of(block_of(heap, item), inner(heap, item));
}

void enf_block_heap_set(enf_block_heap *heap, int32_t item, enf_heap_key key) {
    enf_heap_set(block_of(heap, item), inner(heap, item), key);
}

void enf_block_heap_remove(enf_block_heap *heap, int32_t item) {
    enf_heap_remove(block_of(heap, item), inner(heap, item));
}
