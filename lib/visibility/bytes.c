// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/bytes.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void enf_bytes_free(enf_bytes *bytes) {
    free(bytes->data);
    *bytes = (enf_bytes){0};
}

void enf_put_bytes(enf_bytes *bytes, const void *data, size_t size) {
    if (bytes->failed || size == 0) return;
    if (!enf_array_reserve(bytes->data, bytes->capacity, bytes->count + size)) {
        bytes->failed = true;
        return;
    }
    memcpy(bytes->data + bytes->count, data, size);
    bytes->count += size;
}

void enf_put_number(enf_bytes *bytes, uint64_t number) {
    uint8_t digits[10];
    size_t count = 0;
    for (; number >= 128; number >>= 7) digits[count++] = (uint8_t)(number | 128);
    digits[count++] = (uint8_t)number;
    enf_put_bytes(bytes, digits, count);
}

void enf_put_word(enf_bytes *bytes, uint64_t word, int size) {
    uint8_t digits[8];
    for (int i = 0; i < size; i++) digits[i] = (uint8_t)(word >> 8 * i);
    enf_put_bytes(bytes, digits, (size_t)size);
}

void enf_put_real(enf_bytes *bytes, double real) {
    uint64_t word;
    memcpy(&word, &real, sizeof word);
    enf_put_word(bytes, word, 8);
}

const uint8_t *enf_take_bytes(enf_reader *reader, size_t size) {
    const uint8_t *data = reader->at;
    if (reader->failed || size > enf_reader_left(reader)) {
        reader->failed = true;
        return NULL;
    }
    reader->at += size;
    return data;
}

uint64_t enf_take_number(enf_reader *reader, uint64_t most) {
    uint64_t number = 0;
    for (int shift = 0; shift < 64; shift += 7) {
        const uint8_t *digit = enf_take_bytes(reader, 1);
        if (!digit) return 0;
        number |= (uint64_t)(*digit & 127) << shift;
        if (*digit < 128) {
            reader->failed = number > most || (shift == 63 && *digit > 1);
            return reader->failed ? 0 : number;
        }
    }
    reader->failed = true;
    return 0;
}

uint64_t enf_take_word(enf_reader *reader, int size) {
    const uint8_t *digits = enf_take_bytes(reader, (size_t)size);
    uint64_t word = 0;
    for (int i = 0; digits && i < size; i++) word |= (uint64_t)digits[i] << 8 * i;
    return word;
}

double enf_take_real(enf_reader *reader) {
    uint64_t word = enf_take_word(reader, 8);
    double real;
    memcpy(&real, &word, sizeof real);
    if (isfinite(real)) return real;
    reader->failed = true;
    return 0;
}
