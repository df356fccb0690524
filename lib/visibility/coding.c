// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/coding.h"

#include <string.h>

/// The first bit from `index` on that is as `value` says, or `columns`.
static int32_t find_bit(const uint64_t *row, int32_t columns, int32_t index, bool value) {
    while (index < columns) {
        uint64_t word = value ? row[index >> 6] : ~row[index >> 6];
        word = word >> (index & 63) << (index & 63);
        if (word) return (index & ~63) + __builtin_ctzll(word);
        index = (index | 63) + 1;
    }
    return columns;
}

void enf_put_row(enf_bytes *bytes, const uint64_t *row, size_t words) {
    int32_t columns = (int32_t)(words * 64), runs = 0;
    for (int32_t from = 0; (from = find_bit(row, columns, from, true)) < columns; runs++)
        from = find_bit(row, columns, from, false);
    enf_put_number(bytes, (uint64_t)runs);
    for (int32_t at = 0; runs > 0; runs--) {
        int32_t from = find_bit(row, columns, at, true), to = find_bit(row, columns, from, false);
        enf_put_number(bytes, (uint64_t)(from - at));
        enf_put_number(bytes, (uint64_t)(to - from));
        at = to;
    }
}

void enf_take_row(enf_reader *reader, uint64_t *row, int32_t columns) {
    int32_t at = 0;
    for (uint64_t runs = enf_take_number(reader, (uint64_t)columns); runs > 0 && !reader->failed; runs--) {
        at += (int32_t)enf_take_number(reader, (uint64_t)(columns - at));
        int32_t to = at + (int32_t)enf_take_number(reader, (uint64_t)(columns - at));
        for (; at < to; at++) enf_bit_set(row, at);
    }
}

static bool has_line(const enf_line *line) {
    return memcmp(line->from, line->to, sizeof line->from) != 0;
}

static void put_line(enf_bytes *bytes, const enf_line *line) {
    enf_put_number(bytes, has_line(line));
    for (int i = 0; has_line(line) && i < 6; i++)
        enf_put_real(bytes, i < 3 ? line->from[i] : line->to[i - 3]);
}

static void take_line(enf_reader *reader, enf_line *line) {
    *line = (enf_line){{0}, {0}};
    if (enf_take_number(reader, 1) == 0) return;
    for (int i = 0; i < 6; i++) *(i < 3 ? &line->from[i] : &line->to[i - 3]) = enf_take_real(reader);
}

void enf_put_sightings(enf_bytes *bytes, const enf_sightings *sightings, int32_t cell, int32_t first) {
    const enf_cell_sightings *of = &sightings->cells[cell];
    enf_put_number(bytes, (uint64_t)(of->count - first));
    for (int32_t k = first; k < of->count; k++) {
        enf_put_number(bytes, (uint64_t)of->sightings[k].cell);
        enf_put_number(bytes, (uint64_t)of->sightings[k].portals);
        if (sightings->keep_lines) put_line(bytes, &of->lines[k]);
    }
}

bool enf_take_sightings(enf_reader *reader, enf_sightings *sightings, int32_t cell) {
    int32_t cells = sightings->seen.row_count;
    const uint64_t *seen = enf_bits_row(&sightings->seen, cell);
    for (uint64_t count = enf_take_number(reader, (uint64_t)cells); count > 0; count--) {
        enf_line line;
        enf_sighting sighting = {.cell = (int32_t)enf_take_number(reader, (uint64_t)cells - 1)};
        sighting.portals = (int32_t)enf_take_number(reader, INT32_MAX);
        if (sightings->keep_lines) take_line(reader, &line);
        if (sighting.cell == cell || enf_bit_get(seen, sighting.cell)) reader->failed = true;
        if (reader->failed) return true;
        if (!enf_sightings_add(sightings, cell, &sighting, sightings->keep_lines ? &line : NULL))
            return false;
    }
    return true;
}

void enf_put_counts(enf_bytes *bytes, const int64_t *counts, int count) {
    for (int i = 0; i < count; i++) enf_put_number(bytes, (uint64_t)counts[i]);
}

void enf_take_counts(enf_reader *reader, int64_t *counts, int count) {
    for (int i = 0; i < count; i++) counts[i] = (int64_t)enf_take_number(reader, ENF_COUNT_MOST);
}
