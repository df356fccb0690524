// SPDX-License-Identifier: MIT
// The row of the visible set of the cell that the eye is in, as bits.
#ifndef ENF_RUN_VIEW_SEEN_H
#define ENF_RUN_VIEW_SEEN_H

#include "enfilade/format.h"

typedef struct enf_view_seen {
    uint8_t *row; ///< null: the world has no visible set
    int32_t cell; ///< whose row it is; -1: none yet
} enf_view_seen;

bool enf_seen_create(enf_view_seen *seen, const enf_file_view *file);
void enf_seen_free(enf_view_seen *seen);

/// Decodes the row of a cell, unless it is there from the run before. False if there is no visible set.
bool enf_seen_look(enf_view_seen *seen, const enf_file_view *file, int32_t cell);

static inline bool enf_seen_has(const enf_view_seen *seen, int32_t cell) {
    return seen->row[cell >> 3] >> (cell & 7) & 1;
}

#endif
