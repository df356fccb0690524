// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers as bytes, for checkpoints and messages between processes; the same bytes on every machine.
#ifndef ENF_VISIBILITY_BYTES_H
#define ENF_VISIBILITY_BYTES_H

#include "enfilade/base.h"

/// Bytes that grow. Start with zeroes; free them in any case.
typedef struct enf_bytes {
    uint8_t *data;
    size_t count, capacity;
    bool failed; ///< there was no memory: what was put since then is missing
} enf_bytes;

void enf_bytes_free(enf_bytes *bytes);
void enf_put_bytes(enf_bytes *bytes, const void *data, size_t size);

/// A number, in as few bytes as it takes: seven bits each, the lowest first.
void enf_put_number(enf_bytes *bytes, uint64_t number);

/// Little-endian, in 4 or 8 bytes.
void enf_put_word(enf_bytes *bytes, uint64_t word, int size);

/// A double, bit for bit.
void enf_put_real(enf_bytes *bytes, double real);

/// Reads bytes that nobody vouches for. What does not fit sets `failed` and reads as 0 from then on.
typedef struct enf_reader {
    const uint8_t *at, *end;
    bool failed;
} enf_reader;

static inline size_t enf_reader_left(const enf_reader *reader) {
    return (size_t)(reader->end - reader->at);
}

/// Null if there are not as many.
const uint8_t *enf_take_bytes(enf_reader *reader, size_t size);

/// More than `most` is a failure.
uint64_t enf_take_number(enf_reader *reader, uint64_t most);
uint64_t enf_take_word(enf_reader *reader, int size);

/// What is not finite is a failure.
double enf_take_real(enf_reader *reader);

#endif
