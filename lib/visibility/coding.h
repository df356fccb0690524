// SPDX-License-Identifier: GPL-3.0-or-later
// What jobs find, as bytes and back: rows of bits, sightings, counts. What is taken from bytes is checked.
#ifndef ENF_VISIBILITY_CODING_H
#define ENF_VISIBILITY_CODING_H

#include "visibility/bytes.h"
#include "visibility/sightings.h"

/// Sums of many counts still fit.
#define ENF_COUNT_MOST ((uint64_t)INT64_MAX >> 20)

/// A row of bits: how many runs of ones there are; for each, the zeroes before it and its length.
void enf_put_row(enf_bytes *bytes, const uint64_t *row, size_t words);

/// Into a row that is all zero, of `columns` bits.
void enf_take_row(enf_reader *reader, uint64_t *row, int32_t columns);

/// What the cell was seen to see, from its sighting `first` on, with lines if they are kept.
void enf_put_sightings(enf_bytes *bytes, const enf_sightings *sightings, int32_t cell, int32_t first);

/// Adds them. Cells that do not exist, the cell itself and cells that it sees already are failures. False
/// without memory.
bool enf_take_sightings(enf_reader *reader, enf_sightings *sightings, int32_t cell);

/// Counts, 0 to ENF_COUNT_MOST.
void enf_put_counts(enf_bytes *bytes, const int64_t *counts, int count);
void enf_take_counts(enf_reader *reader, int64_t *counts, int count);

#endif
