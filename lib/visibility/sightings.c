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
        free(sightings->cells[i].sightings);
        free(sightings->cells[i].lines);
    }
    free(sightings->cells);
    enf_bits_free(&sightings->seen);
    memset(sightings, 0, sizeof *sightings);
}

bool enf_sightings_add(enf_sightings *sightings, int32_t cell, const enf_sighting *sighting,
                       const enf_line *line) {
    enf_cell_sightings *of = &sightings->cells[cell];
    size_t count = (size_t)of->count + 1;
    if (!enf_array_reserve(of->sightings, of->capacity, count)) return false;
    if (sightings->keep_lines && !enf_array_reserve(of->lines, of->line_capacity, count)) return false;
    if (sightings->keep_lines) of->lines[of->count] = line ? *line : (enf_line){{0}, {0}};
    of->sightings[of->count++] = *sighting;
    enf_bit_set(enf_bits_row(&sightings->seen, cell), sighting->cell);
    return true;
}

bool enf_sightings_symmetrise(enf_sightings *sightings) {
    for (int32_t i = 0; i < sightings->seen.row_count; i++) {
        for (int32_t k = 0; k < sightings->cells[i].count; k++) {
            enf_sighting there = sightings->cells[i].sightings[k];
            enf_sighting back = {.cell = i, .portals = there.portals};
            if (enf_bit_get(enf_bits_row(&sightings->seen, there.cell), i)) continue;
            enf_line line = {{0}, {0}};
            if (sightings->keep_lines) {
                memcpy(line.from, sightings->cells[i].lines[k].to, sizeof line.from);
                memcpy(line.to, sightings->cells[i].lines[k].from, sizeof line.to);
            }
            if (!enf_sightings_add(sightings, there.cell, &back, &line)) return false;
        }
    }
    return true;
}
