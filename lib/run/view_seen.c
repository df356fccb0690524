// SPDX-License-Identifier: MIT
// A row is decoded when the eye enters another cell; as it is kept, an eye that stays costs nothing.
#include "run/view_seen.h"

#include "format/pvs_row.h"

#include <stdlib.h>

bool enf_seen_create(enf_view_seen *seen, const enf_file_view *file) {
    *seen = (enf_view_seen){.cell = -1};
    if (!file->pvs) return true;
    seen->row = malloc(enf_pvs_row_bytes(file->cell_count) + 1);
    return seen->row != NULL;
}

void enf_seen_free(enf_view_seen *seen) {
    free(seen->row);
}

bool enf_seen_look(enf_view_seen *seen, const enf_file_view *file, int32_t cell) {
    if (!seen->row) return false;
    if (seen->cell == cell) return true;
    int64_t first = file->pvs_offset[cell], size = file->pvs_offset[cell + 1] - first;
    seen->cell = cell;
    if (enf_pvs_row_decode(file->pvs_rows + first, (size_t)size, seen->row, file->cell_count)) return true;
    seen->cell = -1;
    return false;
}
