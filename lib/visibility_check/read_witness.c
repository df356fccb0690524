// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility_check/read_witness.h"

#include "base/array.h"
#include "build/read.h"
#include "visibility/decimal.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static enf_status read_cells(enf_source *source, int32_t cell[2], int32_t cell_count, enf_error *error) {
    for (int e = 0; e < 2; e++) {
        int64_t number;
        if (!enf_source_more(source) || !enf_source_whole(source, &number) || !enf_source_word_ends(source))
            return enf_source_fail(source, error,
                                   "the number of a cell should stand here; make the file again");
        if (number < 0 || number >= cell_count)
            return enf_fail(error, ENF_BAD_INPUT,
                            "%s:%" PRId64 ": there is no cell %" PRId64 "; they are numbered 0 to %" PRId32,
                            source->name, source->line, number, cell_count - 1);
        cell[e] = (int32_t)number;
    }
    if (cell[0] >= cell[1])
        return enf_source_fail(source, error, "the first cell should be less than the second");
    return ENF_OK;
}

static enf_status read_point(enf_source *source, double point[3], enf_error *error) {
    for (int i = 0; i < 3; i++)
        if (!enf_source_number(source, &point[i]) || !enf_source_word_ends(source) || !isfinite(point[i]))
            return enf_source_fail(
                source, error,
                "two points, six finite numbers, should follow the cells; make the file again");
    return ENF_OK;
}

/// Has one of the words from here to the cursor more digits than it takes to tell doubles apart?
static bool has_long_number(const enf_source *source, const char *at) {
    int digits = 0;
    bool counts = true;
    for (; at < source->at; at++) {
        if (*at == ' ' || *at == '\t')
            digits = 0, counts = true;
        else if (*at == 'e' || *at == 'E')
            counts = false;
        else if (counts && *at >= '0' && *at <= '9')
            digits += digits > 0 || *at != '0';
        if (digits > DBL_DECIMAL_DIG) return true;
    }
    return false;
}

/// Keeps the decimals from `at` to the cursor; they must be plain ones.
static enf_status keep_decimals(enf_source *source, const char *at, enf_witness *witness, enf_error *error) {
    mpq_t number;
    int digits;
    witness->decimals = strndup(at, (size_t)(source->at - at));
    if (!witness->decimals) return enf_fail_memory(error, "the sight lines");
    const char *rest = witness->decimals;
    mpq_init(number);
    while (*rest && enf_decimal_read(number, &rest, &digits)) continue;
    mpq_clear(number);
    if (*rest == '\0') return ENF_OK;
    return enf_source_fail(source, error,
                           "numbers of more than 17 digits, and those beside them, should be "
                           "decimals; make the file again");
}

static bool ascends(const enf_witness *before, const enf_witness *witness) {
    if (before->cell[0] != witness->cell[0]) return before->cell[0] < witness->cell[0];
    return before->cell[1] < witness->cell[1];
}

static enf_status read_line(enf_witness_list *list, enf_source *source, int32_t cell_count,
                            enf_error *error) {
    if (!enf_array_reserve(list->items, list->capacity, list->count + 1))
        return enf_fail_memory(error, "the sight lines");
    enf_witness *witness = &list->items[list->count];
    *witness = (enf_witness){.decimals = NULL};
    list->count++;
    enf_status status = read_cells(source, witness->cell, cell_count, error);
    const char *numbers = source->at;
    if (!status) status = read_point(source, witness->from, error);
    if (!status) status = read_point(source, witness->to, error);
    if (!status && has_long_number(source, numbers)) status = keep_decimals(source, numbers, witness, error);
    if (status) return status;
    if (enf_source_more(source))
        return enf_source_fail(source, error,
                               "there is something behind the two points; make the file again");
    if (list->count > 1 && !ascends(witness - 1, witness))
        return enf_source_fail(source, error,
                               "the pairs of cells do not ascend; sort the file by both numbers");
    return ENF_OK;
}

enf_status enf_witnesses_read(enf_witness_list *list, const char *path, int32_t cell_count,
                              enf_error *error) {
    enf_source source;
    memset(list, 0, sizeof *list);
    enf_status status = enf_source_open(&source, path, error);
    bool more = !status && source.size > 0;
    while (!status && more) {
        status = read_line(list, &source, cell_count, error);
        more = !status && enf_source_next_line(&source);
    }
    enf_source_close(&source);
    return status;
}

void enf_witnesses_free(enf_witness_list *list) {
    for (size_t k = 0; k < list->count; k++) free(list->items[k].decimals);
    free(list->items);
    memset(list, 0, sizeof *list);
}
