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

bool enf_pvs_row_decode(const uint8_t *coded, size_t size, uint8_t *row, int32_t cell_count) {
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
        if (row) memset(row + made, value, count);
        made += count;
    }
    bool is_clean = cell_count % 8 == 0 || value >> cell_count % 8 == 0;
    return made == bytes && is_clean;
}
