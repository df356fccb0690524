// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/pvs.h"

#include "base/array.h"
#include "base/memory.h"
#include "format/output.h"

#include <inttypes.h>
#include <stdlib.h>

enum { WORD_BITS = 64 };

enf_status enf_pvs_new(enf_pvs *pvs, int32_t cell_count, enf_error *error) {
    size_t words = ((size_t)cell_count + WORD_BITS - 1) / WORD_BITS;
    *pvs = (enf_pvs){.row_words = words};
    // A system that lends more than it has would kill us when the rows are filled.
    const char *limiter;
    double bytes = (double)words * 8 * cell_count;
    if (bytes < (double)enf_memory_limit(&limiter))
        pvs->rows = enf_array_zeroed(words * (size_t)cell_count, sizeof *pvs->rows);
    if (!pvs->rows)
        return enf_fail(error, ENF_NO_RESOURCES,
                        "the visible sets of %" PRId32
                        " cells take %.3g MB, more than there is; split the world",
                        cell_count, bytes / 1e6);
    pvs->cell_count = cell_count;
    for (int32_t i = 0; i < cell_count; i++) enf_pvs_set(pvs, i, i);
    return ENF_OK;
}

void enf_pvs_free(enf_pvs *pvs) {
    free(pvs->rows);
    *pvs = (enf_pvs){0};
}

static int32_t count_bits(uint64_t word) {
#ifdef __GNUC__
    return __builtin_popcountll(word);
#else
    int32_t count = 0;
    for (; word; word &= word - 1) count++;
    return count;
#endif
}

int32_t enf_pvs_seen(const enf_pvs *pvs, int32_t cell) {
    const uint64_t *row = enf_pvs_row(pvs, cell);
    int32_t seen = 0;
    for (size_t w = 0; w < pvs->row_words; w++) seen += count_bits(row[w]);
    return seen;
}

int64_t enf_pvs_pairs(const enf_pvs *pvs) {
    int64_t pairs = 0;
    for (int32_t i = 0; i < pvs->cell_count; i++) pairs += enf_pvs_seen(pvs, i);
    return pairs;
}

double enf_pvs_mean_seen(const enf_pvs *pvs) {
    return pvs->cell_count ? (double)enf_pvs_pairs(pvs) / pvs->cell_count : 0;
}

static void print_row(const enf_pvs *pvs, int32_t cell, FILE *out) {
    const char *blank = "";
    for (int32_t j = 0; j < pvs->cell_count; j++) {
        if (!enf_pvs_get(pvs, cell, j)) continue;
        fprintf(out, "%s%" PRId32, blank, j);
        blank = " ";
    }
    fputc('\n', out);
}

void enf_pvs_print(const enf_pvs *pvs, FILE *out) {
    for (int32_t i = 0; i < pvs->cell_count && !ferror(out); i++) print_row(pvs, i, out);
}

enf_status enf_pvs_write(const enf_pvs *pvs, const char *path, enf_error *error) {
    enf_output output;
    enf_status status = enf_output_open(&output, path, error);
    if (status) return status;
    enf_pvs_print(pvs, output.file);
    return enf_output_commit(&output, error);
}
