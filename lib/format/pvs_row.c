// SPDX-License-Identifier: MIT
#include "format/pvs_row.h"

#include <string.h>

size_t enf_pvs_row_encode(const uint8_t *row, size_t bytes, uint8_t *coded) {
    size_t size = 0;
    for (size_t i = 0; i < bytes;) {
        coded[size++] = row[i];
        if (row[i++]) continue;
        uint8_t run = 1;
        while (i < bytes && !row[i] && run < UINT8_MAX) i++, run++;
        coded[size++] = run;
    }
    return size;
}

/// Without branches on the bytes, which are hard to foresee: each says what the next one is.
static bool is_row(const uint8_t *coded, size_t size, int32_t cell_count) {
    uint64_t made = 0;
    unsigned is_run = 0, was_run = 0, bad = 0; // a run: how many zeros there are. Bad: a run of none
    for (size_t i = 0; i < size; i++) {
        unsigned value = coded[i], is_zero = value == 0;
        made += is_run ? value : !is_zero;
        bad |= is_run & is_zero;
        was_run = is_run;
        is_run = ~is_run & is_zero;
    }
    unsigned last = was_run || size == 0 ? 0 : coded[size - 1];
    bool is_clean = cell_count % 8 == 0 || last >> cell_count % 8 == 0;
    return !is_run && !bad && made == enf_pvs_row_bytes(cell_count) && is_clean;
}

bool enf_pvs_row_decode(const uint8_t *coded, size_t size, uint8_t *row, int32_t cell_count) {
    if (!row) return is_row(coded, size, cell_count);
    size_t made = 0, bytes = enf_pvs_row_bytes(cell_count);
    uint8_t value = 0;
    for (size_t i = 0; i < size; i++) {
        size_t count = 1;
        value = coded[i];
        if (!value) {
            if (++i == size || !coded[i]) return false;
            count = coded[i];
        }
        if (count > bytes - made) return false;
        memset(row + made, value, count);
        made += count;
    }
    bool is_clean = cell_count % 8 == 0 || value >> cell_count % 8 == 0;
    return made == bytes && is_clean;
}
