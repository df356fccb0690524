// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/world_pvs.h"

#include "base/array.h"
#include "build/write_parts.h"
#include "format/pvs_row.h"
#include "visibility/world_visibility.h"

#include <stdlib.h>

_Static_assert((int)ENF_METHOD_REACH == (int)ENF_FILE_PVS_REACH &&
                   (int)ENF_METHOD_EXACT == (int)ENF_FILE_PVS_EXACT,
               "methods are written as they are");

/// The cell's row as bytes.
static void take_bytes(const enf_pvs *pvs, int32_t cell, uint8_t *bytes) {
    const uint64_t *row = enf_pvs_row(pvs, cell);
    size_t count = enf_pvs_row_bytes(pvs->cell_count);
    for (size_t i = 0; i < count; i++) bytes[i] = (uint8_t)(row[i / 8] >> i % 8 * 8);
}

/// Codes all rows into an array that is given away; null without memory.
static uint8_t *code_rows(const enf_pvs *pvs, int64_t *offsets) {
    size_t bytes = enf_pvs_row_bytes(pvs->cell_count), capacity = 0, size = 0;
    uint8_t *row = enf_array_new(bytes, 1), *coded = NULL;
    bool good = row != NULL;
    for (int32_t i = 0; good && i < pvs->cell_count; i++) {
        if (!(good = enf_array_reserve(coded, capacity, size + 2 * bytes))) break;
        take_bytes(pvs, i, row);
        size += enf_pvs_row_encode(row, bytes, coded + size);
        offsets[i + 1] = (int64_t)size;
    }
    free(row);
    if (good && !coded) coded = enf_array_new(0, 1); // no cells
    if (good) return coded;
    free(coded);
    return NULL;
}

static enf_status add_rows(enf_build_image *image, const enf_visibility *visibility, enf_error *error) {
    const enf_pvs *pvs = &visibility->pvs;
    enf_file_pvs *head = enf_build_image_new(image, 1, sizeof *head);
    int64_t *offsets = enf_build_image_new(image, (size_t)pvs->cell_count + 1, sizeof *offsets);
    uint8_t *rows = head && offsets ? code_rows(pvs, offsets) : NULL;
    if (!rows) return enf_fail_memory(error, "the visible set");
    enf_build_image_own(image, rows);
    *head = (enf_file_pvs){.method = (uint32_t)visibility->method, .pairs = enf_pvs_pairs(pvs)};
    image->view.pvs = head;
    image->view.pvs_offset = offsets;
    image->view.pvs_rows = rows;
    image->view.pvs_byte_count = offsets[pvs->cell_count];
    return ENF_OK;
}

enf_status enf_world_pvs_add(enf_build_image *image, const enf_visibility_options *options, bool *left_out,
                             enf_visibility *visibility, enf_error *error) {
    enf_world_air air = {0};
    *visibility = (enf_visibility){0};
    bool is_large = left_out && image->view.portal_count / 2 > ENF_WORLD_PVS_OPENINGS;
    enf_status status =
        is_large ? ENF_OK : enf_world_air_make(&air, &image->view, left_out != NULL, options->threads, error);
    is_large = is_large || (left_out && !air.has_partition);
    if (left_out) *left_out = is_large;
    if (!status && !is_large) {
        status = enf_world_visibility_run(visibility, &air, &image->view, options, error);
        if (!status) status = add_rows(image, visibility, error);
    }
    enf_world_air_free(&air);
    return status;
}
