// SPDX-License-Identifier: MIT
// A multiply-rotate hash over little-endian 64-bit words in two lanes, closed by a bijective mixer.
#include "base/hash.h"

#include <string.h>

static uint64_t load_word(const unsigned char *bytes) {
    uint64_t word;
    memcpy(&word, bytes, sizeof word);
#if __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    word = __builtin_bswap64(word);
#endif
    return word;
}

static uint64_t rotate(uint64_t word, int by) {
    return word << by | word >> (64 - by);
}

static uint64_t step(uint64_t lane, uint64_t word) {
    return rotate(lane ^ word * UINT64_C(0x9e3779b97f4a7c15), 29) * UINT64_C(0xd1b54a32d192ed03) + 1;
}

uint64_t enf_hash64(const void *data, size_t size, uint64_t seed) {
    const unsigned char *bytes = data;
    size_t left = size;
    uint64_t even = enf_hash_mix(seed + UINT64_C(0x8cb92ba72f3d8dd7));
    uint64_t odd = enf_hash_mix(seed ^ UINT64_C(0xabc98388fb8fac03));
    for (; left >= 16; left -= 16, bytes += 16) {
        even = step(even, load_word(bytes));
        odd = step(odd, load_word(bytes + 8));
    }
    unsigned char tail[16] = {0};
    if (left) memcpy(tail, bytes, left);
    even = step(even, load_word(tail));
    odd = step(odd, load_word(tail + 8));
    return enf_hash_mix(even ^ enf_hash_mix(odd + (uint64_t)size));
}
