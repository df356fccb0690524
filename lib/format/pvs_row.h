// SPDX-License-Identifier: MIT
// Rows of visible cells, coded as level formats have done since Quake (1996): bytes of a bit row as they are,
// but a zero is followed by how many zeros there are in a row, 1 to 255.
#ifndef ENF_FORMAT_PVS_ROW_H
#define ENF_FORMAT_PVS_ROW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// How many bytes a row of bits has: bit j of byte i is cell 8 i + j.
static inline size_t enf_pvs_row_bytes(int32_t cell_count) {
    return ((size_t)cell_count + 7) / 8;
}

/// Codes a row into `coded`, which has room for 2 * bytes. Returns how many bytes it took.
size_t enf_pvs_row_encode(const uint8_t *row, size_t bytes, uint8_t *coded);

/// Decodes a row of enf_pvs_row_bytes, or only looks at it if `row` is null. False if it is not exactly that
/// long, or has bits beyond the last cell.
bool enf_pvs_row_decode(const uint8_t *coded, size_t size, uint8_t *row, int32_t cell_count);

#endif
