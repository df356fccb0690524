// SPDX-License-Identifier: GPL-3.0-or-later
// The polygons that clean makes, before they are in order.
#ifndef ENF_BUILD_PIECES_H
#define ENF_BUILD_PIECES_H

#include "enfilade/base.h"

/// Rings of point numbers, each in its canonical rotation (smallest number first).
typedef struct enf_pieces {
    size_t count;
    int64_t *corner; ///< count + 1 offsets into corners
    int32_t *corners;
    int32_t *source; ///< soup polygon; rises with the piece's number
    size_t corner_count;
    size_t corner_capacity, corners_capacity, source_capacity;
} enf_pieces;

void enf_pieces_free(enf_pieces *pieces);

/// Appends a ring. False without memory, or when there are too many to number.
bool enf_pieces_add(enf_pieces *pieces, const int32_t *ring, size_t count, int32_t source);

size_t enf_pieces_size(const enf_pieces *pieces, int32_t piece);

/// Sorts by corners, lexicographically: order[0 .. *kept) are the different pieces; of equal ones the first
/// is kept; copies[i] counts how often order[i] is there. `order` and `copies` have room for all.
enf_status enf_pieces_sort(const enf_pieces *pieces, int32_t *order, int32_t *copies, size_t *kept,
                           enf_error *error);

/// How many of the sorted pieces have a twin among them that runs the other way.
enf_status enf_pieces_count_two_sided(const enf_pieces *pieces, const int32_t *order, size_t kept,
                                      size_t *two_sided, enf_error *error);

#endif
