// SPDX-License-Identifier: MIT
// The row of the visible set of the cell that the eye is in, as bits.
#ifndef ENF_RUN_VIEW_SEEN_H
#define ENF_RUN_VIEW_SEEN_H

#include "enfilade/format.h"

typedef struct enf_view_seen {
    uint8_t *row;   ///< null: the world has no visible set
    uint8_t *other; ///< room for another
    int32_t cell;   ///< whose row it is; -1: none yet
} enf_view_seen;

bool enf_seen_create(enf_view_seen *seen, const enf_file_view *file);
void enf_seen_free(enf_view_seen *seen);

enum { ENF_SEEN_CELLS = 16 };

/// An eye on a portal is in several cells at once: the cells that it touches, from `cells[0]` on, through
/// polygons nearer than `near_distance`. Returns their number; 0: more than ENF_SEEN_CELLS.
int32_t enf_seen_touch(const enf_file_view *file, const double eye[3], double near_distance,
                       int32_t cells[ENF_SEEN_CELLS]);

/// Makes the row that of several cells together. False if there is no visible set.
bool enf_seen_join(enf_view_seen *seen, const enf_file_view *file, const int32_t *cells, int32_t count);

/// Decodes the row of a cell, unless it is there from the run before. False if there is no visible set.
bool enf_seen_look(enf_view_seen *seen, const enf_file_view *file, int32_t cell);

static inline bool enf_seen_has(const enf_view_seen *seen, int32_t cell) {
    return seen->row[cell >> 3] >> (cell & 7) & 1;
}

#endif
