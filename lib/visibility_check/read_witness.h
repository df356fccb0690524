// SPDX-License-Identifier: GPL-3.0-or-later
// Sight lines from their text: a line `i j x y z x y z` for each, two cells, i < j, and two points; sorted by
// i and j, no pair twice. Coordinates are rounded to doubles, unless one of a line's six has more digits than
// 17: then all six are meant as they stand.
#ifndef ENF_VISIBILITY_CHECK_READ_WITNESS_H
#define ENF_VISIBILITY_CHECK_READ_WITNESS_H

#include "visibility_check/check_witness.h"

typedef struct enf_witness_list {
    enf_witness *items;
    size_t count, capacity;
} enf_witness_list;

/// Reads such a text (gzipped or not; "-": standard input) about `cell_count` cells into *list, which is
/// overwritten. ENF_BAD_INPUT with file and line for whatever is not as it should be. Free it in any case.
enf_status enf_witnesses_read(enf_witness_list *list, const char *path, int32_t cell_count, enf_error *error);

void enf_witnesses_free(enf_witness_list *list);

#endif
