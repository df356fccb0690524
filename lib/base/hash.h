// SPDX-License-Identifier: MIT
// A 64-bit hash of bytes, for provenance and hash tables. Not for adversaries: it is fast, not cryptographic.
#ifndef ENF_BASE_HASH_H
#define ENF_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

/// Hash of `size` bytes. The same on every platform; chain calls by passing the previous result as `seed`.
uint64_t enf_hash64(const void *data, size_t size, uint64_t seed);

/// Mixes one word so that every input bit changes about half of the output bits (a bijection).
static inline uint64_t enf_hash_mix(uint64_t word) {
    word = (word ^ word >> 32) * UINT64_C(0xd6e8feb86659fd93);
    word = (word ^ word >> 32) * UINT64_C(0xd6e8feb86659fd93);
    return word ^ word >> 32;
}

#endif
