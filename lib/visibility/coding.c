// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/coding.h"

#include "base/array.h"

#include <stdlib.h>
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

/// What is put before a line. A long one is put as its length and its characters.
enum { NO_LINE, LINE_OF_DOUBLES, LONG_LINE };
enum { LONG_LINE_MOST = 1 << 20 };

static bool has_line(const enf_line *line) {
    return memcmp(line->from, line->to, sizeof line->from) != 0;
}

static void put_line(enf_bytes *bytes, const enf_line *line, const char *long_line) {
    enf_put_number(bytes, long_line ? LONG_LINE : has_line(line) ? LINE_OF_DOUBLES : NO_LINE);
    if (long_line) {
        enf_put_number(bytes, strlen(long_line));
        enf_put_bytes(bytes, long_line, strlen(long_line));
        return;
    }
    for (int i = 0; has_line(line) && i < 6; i++)
        enf_put_real(bytes, i < 3 ? line->from[i] : line->to[i - 3]);
}

/// Six words of what decimals are made of, one blank between two.
static bool is_long_line(const char *text, size_t length) {
    int words = 0;
    if (strspn(text, "+-.0123456789e ") != length) return false;
    for (size_t i = 0; i < length; i++) {
        const bool begins = text[i] != ' ' && (i == 0 || text[i - 1] == ' ');
        if (text[i] == ' ' && (i == 0 || text[i - 1] == ' ' || i + 1 == length)) return false;
        words += begins;
    }
    return words == 6;
}

/// *long_line: new, or null. False without memory.
static bool take_long_line(enf_reader *reader, char **long_line) {
    const size_t length = enf_take_number(reader, LONG_LINE_MOST);
    const uint8_t *bytes = enf_take_bytes(reader, length);
    if (!bytes) return true;
    *long_line = enf_array_zeroed(length + 1, 1);
    if (!*long_line) return false;
    memcpy(*long_line, bytes, length);
    if (!is_long_line(*long_line, length)) reader->failed = true;
    return true;
}

/// The same; *line if there is no long one.
static bool take_line(enf_reader *reader, enf_line *line, char **long_line) {
    *line = (enf_line){{0}, {0}};
    const uint64_t kind = enf_take_number(reader, LONG_LINE);
    if (kind == LONG_LINE) return take_long_line(reader, long_line);
    for (int i = 0; kind == LINE_OF_DOUBLES && i < 6; i++)
        *(i < 3 ? &line->from[i] : &line->to[i - 3]) = enf_take_real(reader);
    return true;
}

void enf_put_sightings(enf_bytes *bytes, const enf_sightings *sightings, int32_t cell, int32_t first) {
    const enf_cell_sightings *of = &sightings->cells[cell];
    enf_put_number(bytes, (uint64_t)(of->count - first));
    for (int32_t k = first; k < of->count; k++) {
        enf_put_number(bytes, (uint64_t)of->sightings[k].cell);
        enf_put_number(bytes, (uint64_t)of->sightings[k].portals);
        if (sightings->keep_lines) put_line(bytes, &of->lines[k], of->long_lines[k]);
    }
}

bool enf_take_sightings(enf_reader *reader, enf_sightings *sightings, int32_t cell) {
    int32_t cells = sightings->seen.row_count;
    const uint64_t *seen = enf_bits_row(&sightings->seen, cell);
    for (uint64_t count = enf_take_number(reader, (uint64_t)cells); count > 0; count--) {
        enf_line line = {{0}, {0}};
        char *long_line = NULL;
        enf_sighting sighting = {.cell = (int32_t)enf_take_number(reader, (uint64_t)cells - 1)};
        sighting.portals = (int32_t)enf_take_number(reader, INT32_MAX);
        bool done = !sightings->keep_lines || take_line(reader, &line, &long_line);
        if (sighting.cell == cell || enf_bit_get(seen, sighting.cell)) reader->failed = true;
        if (!reader->failed)
            done = done && enf_sightings_add_long(sightings, cell, &sighting, &line, long_line);
        free(long_line);
        if (reader->failed || !done) return done;
    }
    return true;
}

void enf_put_counts(enf_bytes *bytes, const int64_t *counts, int count) {
    for (int i = 0; i < count; i++) enf_put_number(bytes, (uint64_t)counts[i]);
}

void enf_take_counts(enf_reader *reader, int64_t *counts, int count) {
    for (int i = 0; i < count; i++) counts[i] = (int64_t)enf_take_number(reader, ENF_COUNT_MOST);
}
