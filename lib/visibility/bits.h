// SPDX-License-Identifier: GPL-3.0-or-later
// A matrix of bits, row by row: for each portal, or cell, a set of others.
#ifndef ENF_VISIBILITY_BITS_H
#define ENF_VISIBILITY_BITS_H

#include "enfilade/base.h"

typedef struct enf_bits {
    int32_t row_count;
    size_t row_words; ///< 64-bit words of a row, an even number
    uint64_t *words;
} enf_bits;

/// All zero. False without memory; free it in any case.
bool enf_bits_new(enf_bits *bits, int32_t row_count, int32_t columns);
void enf_bits_free(enf_bits *bits);

static inline uint64_t *enf_bits_row(const enf_bits *bits, int32_t row) {
    return bits->words + (size_t)row * bits->row_words;
}

static inline bool enf_bit_get(const uint64_t *row, int32_t index) {
    return row[index >> 6] >> (index & 63) & 1;
}

static inline void enf_bit_set(uint64_t *row, int32_t index) {
    row[index >> 6] |= UINT64_C(1) << (index & 63);
}

static inline void enf_bit_clear(uint64_t *row, int32_t index) {
    row[index >> 6] &= ~(UINT64_C(1) << (index & 63));
}

/// The first bit of the row that is set, from `index` on; -1 if there is none.
static inline int32_t enf_bit_next(const uint64_t *row, size_t words, int32_t index) {
    size_t word = (size_t)index >> 6;
    if (word >= words) return -1;
    uint64_t rest = row[word] >> (index & 63) << (index & 63);
    while (!rest) {
        if (++word == words) return -1;
        rest = row[word];
    }
    return (int32_t)(word << 6) + __builtin_ctzll(rest);
}

/// How many are set.
int64_t enf_bits_count(const uint64_t *row, size_t words);

#endif
