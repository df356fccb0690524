// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/bits.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

bool enf_bits_new(enf_bits *bits, int32_t row_count, int32_t columns) {
    bits->row_count = row_count;
    bits->row_words = ((size_t)columns + 127) / 128 * 2;
    size_t words = (size_t)row_count * bits->row_words;
    bits->words = enf_array_zeroed(words, sizeof *bits->words);
    return bits->words != NULL;
}

void enf_bits_free(enf_bits *bits) {
    free(bits->words);
    memset(bits, 0, sizeof *bits);
}

int64_t enf_bits_count(const uint64_t *row, size_t words) {
    int64_t count = 0;
    for (size_t i = 0; i < words; i++) count += __builtin_popcountll(row[i]);
    return count;
}
