// SPDX-License-Identifier: GPL-3.0-or-later
// By blocks of 64 by 64, as bit by bit most are far from each other in memory.
#include "visibility/symmetry.h"

enum { BLOCK = 64 };

/// Turns 64 by 64 bits over: bit j of word i and bit i of word j change places (H. S. Warren, "Hacker's
/// Delight", 2002).
static void transpose(uint64_t block[BLOCK]) {
    uint64_t mask = UINT32_MAX;
    for (int step = BLOCK / 2; step; step /= 2, mask ^= mask << step)
        for (int i = 0; i < BLOCK; i = (i + step + 1) & ~step) {
            const uint64_t changed = (block[i] >> step ^ block[i + step]) & mask;
            block[i] ^= changed << step;
            block[i + step] ^= changed;
        }
}

/// Bits 2k and 2k + 1 change places.
static uint64_t swap_twins(uint64_t word) {
    const uint64_t even = UINT64_C(0x5555555555555555);
    return (word & even) << 1 | (word >> 1 & even);
}

/// A block the other way round, of twins if `twin` is 1, for the block whose rows are the columns of this
/// one. False if there is nothing in it.
static bool take_turned(const enf_bits *bits, int twin, int32_t row_block, int32_t column_block,
                        uint64_t block[BLOCK]) {
    uint64_t any = 0;
    for (int32_t i = 0; i < BLOCK; i++) {
        const int32_t row = row_block * BLOCK + (i ^ twin);
        const uint64_t word = row < bits->row_count ? enf_bits_row(bits, row)[column_block] : 0;
        block[i] = twin ? swap_twins(word) : word;
        any |= word;
    }
    if (any) transpose(block);
    return any;
}

static void keep_block(const enf_bits *bits, int32_t row_block, int32_t column_block,
                       const uint64_t block[BLOCK]) {
    for (int32_t i = 0; i < BLOCK && row_block * BLOCK + i < bits->row_count; i++)
        enf_bits_row(bits, row_block * BLOCK + i)[column_block] &= block[i];
}

static void keep_pairs(enf_bits *bits, int twin) {
    const int32_t blocks = (bits->row_count + BLOCK - 1) / BLOCK;
    uint64_t one[BLOCK], other[BLOCK];
    for (int32_t r = 0; r < blocks; r++)
        for (int32_t c = r; c < blocks; c++) {
            const bool some = take_turned(bits, twin, r, c, one);
            if (!take_turned(bits, twin, c, r, other) && !some) continue;
            keep_block(bits, c, r, one);
            if (c > r) keep_block(bits, r, c, other);
        }
}

void enf_symmetry_keep(enf_bits *bits) {
    keep_pairs(bits, 0);
}

void enf_symmetry_keep_twins(enf_bits *bits) {
    keep_pairs(bits, 1);
}
