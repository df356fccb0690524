// SPDX-License-Identifier: GPL-3.0-or-later
// Who was seen to see whom: cells, with the lines that prove it.
#ifndef ENF_VISIBILITY_SIGHTINGS_H
#define ENF_VISIBILITY_SIGHTINGS_H

#include "visibility/bits.h"
#include "visibility/line.h"

typedef struct enf_sighting {
    int32_t cell;    ///< that is seen
    int32_t portals; ///< on the way to it
} enf_sighting;

/// What one cell was seen to see. Only one thread at a time adds to a cell.
typedef struct enf_cell_sightings {
    int32_t count;
    size_t capacity, line_capacity, long_capacity;
    enf_sighting *sightings;
    enf_line *lines;   ///< one each, if lines are kept; from == to: there is none between doubles
    char **long_lines; ///< one each, if lines are kept; as in stab.h, or null. Owned
} enf_cell_sightings;

typedef struct enf_sightings {
    enf_bits seen;             ///< bit j of row i: cell i was seen to see cell j
    enf_cell_sightings *cells; ///< seen.row_count
    bool keep_lines;
} enf_sightings;

/// Nobody sees anybody. False without memory; free it in any case.
bool enf_sightings_new(enf_sightings *sightings, int32_t cell_count, bool keep_lines);
void enf_sightings_free(enf_sightings *sightings);

/// Adds a sighting that is not there yet; `line` may be null. False without memory.
bool enf_sightings_add(enf_sightings *sightings, int32_t cell, const enf_sighting *sighting,
                       const enf_line *line);

/// The same with a line in more digits, which is copied; it may be null, too.
bool enf_sightings_add_long(enf_sightings *sightings, int32_t cell, const enf_sighting *sighting,
                            const enf_line *line, const char *long_line);

/// Who was seen sees, too: adds what is there one way only the other way round. False without memory.
bool enf_sightings_symmetrise(enf_sightings *sightings);

#endif
