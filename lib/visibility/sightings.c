// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/sightings.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

bool enf_sightings_new(enf_sightings *sightings, int32_t cell_count, bool keep_lines) {
    *sightings = (enf_sightings){.keep_lines = keep_lines};
    sightings->cells = enf_array_zeroed((size_t)cell_count, sizeof *sightings->cells);
    return enf_bits_new(&sightings->seen, cell_count, cell_count) && sightings->cells;
}

void enf_sightings_free(enf_sightings *sightings) {
    for (int32_t i = 0; sightings->cells && i < sightings->seen.row_count; i++) {
        for (int32_t k = 0; sightings->keep_lines && k < sightings->cells[i].count; k++)
            free(sightings->cells[i].long_lines[k]);
        free(sightings->cells[i].long_lines);
        free(sightings->cells[i].sightings);
        free(sightings->cells[i].lines);
    }
    free(sightings->cells);
    enf_bits_free(&sightings->seen);
    memset(sightings, 0, sizeof *sightings);
}

/// Appends lines to those of the cell, if they are kept.
static bool keep_lines(enf_cell_sightings *of, const enf_line *line, const char *long_line) {
    size_t count = (size_t)of->count + 1;
    if (!enf_array_reserve(of->lines, of->line_capacity, count) ||
        !enf_array_reserve(of->long_lines, of->long_capacity, count))
        return false;
    of->lines[of->count] = line ? *line : (enf_line){{0}, {0}};
    of->long_lines[of->count] = long_line ? strdup(long_line) : NULL;
    return !long_line || of->long_lines[of->count];
}

bool enf_sightings_add_long(enf_sightings *sightings, int32_t cell, const enf_sighting *sighting,
                            const enf_line *line, const char *long_line) {
    enf_cell_sightings *of = &sightings->cells[cell];
    size_t count = (size_t)of->count + 1;
    if (!enf_array_reserve(of->sightings, of->capacity, count)) return false;
    if (sightings->keep_lines && !keep_lines(of, line, long_line)) return false;
    of->sightings[of->count++] = *sighting;
    enf_bit_set(enf_bits_row(&sightings->seen, cell), sighting->cell);
    return true;
}

bool enf_sightings_add(enf_sightings *sightings, int32_t cell, const enf_sighting *sighting,
                       const enf_line *line) {
    return enf_sightings_add_long(sightings, cell, sighting, line, NULL);
}

/// Three numbers of six to the end, as a new string; null without memory.
static char *turn_long(const char *line) {
    const char *to = line;
    for (int blanks = 0; blanks < 3; to++) blanks += *to == ' ';
    const size_t size = strlen(line) + 1, rest = strlen(to);
    char *turned = enf_array_new(size, 1);
    if (!turned) return NULL;
    memcpy(turned, to, rest);
    turned[rest] = ' ';
    memcpy(turned + rest + 1, line, size - rest - 2);
    turned[size - 1] = '\0';
    return turned;
}

/// The sighting the other way round, of the same line.
static bool add_back(enf_sightings *sightings, int32_t cell, int32_t index) {
    const enf_cell_sightings *of = &sightings->cells[cell];
    const enf_sighting back = {.cell = cell, .portals = of->sightings[index].portals};
    const int32_t to = of->sightings[index].cell;
    if (!sightings->keep_lines) return enf_sightings_add(sightings, to, &back, NULL);
    const char *long_line = of->long_lines[index];
    char *turned = long_line ? turn_long(long_line) : NULL;
    enf_line line;
    memcpy(line.from, of->lines[index].to, sizeof line.from);
    memcpy(line.to, of->lines[index].from, sizeof line.to);
    const bool done = (turned || !long_line) && enf_sightings_add_long(sightings, to, &back, &line, turned);
    free(turned);
    return done;
}

bool enf_sightings_symmetrise(enf_sightings *sightings) {
    for (int32_t i = 0; i < sightings->seen.row_count; i++) {
        for (int32_t k = 0; k < sightings->cells[i].count; k++) {
            const int32_t cell = sightings->cells[i].sightings[k].cell;
            if (enf_bit_get(enf_bits_row(&sightings->seen, cell), i)) continue;
            if (!add_back(sightings, i, k)) return false;
        }
    }
    return true;
}
