// SPDX-License-Identifier: GPL-3.0-or-later
// The potentially visible set: which cell sees which.
//
// As text: line i + 1 holds the numbers of the cells that cell i sees, ascending, itself included, with one
// blank between them. There is no header; the number of lines is the number of cells.
#ifndef ENF_VISIBILITY_PVS_H
#define ENF_VISIBILITY_PVS_H

#include "enfilade/base.h"

#include <stdio.h>

typedef struct enf_pvs {
    int32_t cell_count;
    size_t row_words; ///< 64-bit words in a row; the bits after the last cell are 0
    uint64_t *rows;   ///< bit j of row i: cell i sees cell j
} enf_pvs;

/// Every cell sees itself and nothing else. ENF_NO_RESOURCES without the memory. Free it in any case.
enf_status enf_pvs_new(enf_pvs *pvs, int32_t cell_count, enf_error *error);
void enf_pvs_free(enf_pvs *pvs);

static inline uint64_t *enf_pvs_row(const enf_pvs *pvs, int32_t cell) {
    return pvs->rows + (size_t)cell * pvs->row_words;
}

static inline bool enf_pvs_get(const enf_pvs *pvs, int32_t from, int32_t to) {
    return enf_pvs_row(pvs, from)[to >> 6] >> (to & 63) & 1;
}

/// Only from one to the other: set both for what sees each other.
static inline void enf_pvs_set(enf_pvs *pvs, int32_t from, int32_t to) {
    enf_pvs_row(pvs, from)[to >> 6] |= UINT64_C(1) << (to & 63);
}

/// How many cells a cell sees, itself included.
int32_t enf_pvs_seen(const enf_pvs *pvs, int32_t cell);

/// Directed pairs: what all cells see, themselves included.
int64_t enf_pvs_pairs(const enf_pvs *pvs);

/// What a cell sees on average; 0 without cells.
double enf_pvs_mean_seen(const enf_pvs *pvs);

/// Writes the text. Errors stay in the stream (ferror), for enf_output_commit to find.
void enf_pvs_print(const enf_pvs *pvs, FILE *out);

/// Writes the text to a file ("-": standard output) that appears whole or not at all.
enf_status enf_pvs_write(const enf_pvs *pvs, const char *path, enf_error *error);

/// Reads such a text (gzipped or not; "-": standard input) about `cell_count` cells into *pvs, which is
/// overwritten. ENF_BAD_INPUT with file and line if it has more or fewer lines, or a line does not ascend,
/// names cells that do not exist, or lacks its own. Free it in any case.
enf_status enf_pvs_read(enf_pvs *pvs, const char *path, int32_t cell_count, enf_error *error);

#endif
