// SPDX-License-Identifier: MIT
// A row is decoded when the eye enters another cell; as it is kept, an eye that stays costs nothing.
#include "run/view_seen.h"

#include "format/pvs_row.h"
#include "run/view_clip.h"

#include <stdlib.h>

bool enf_seen_create(enf_view_seen *seen, const enf_file_view *file) {
    *seen = (enf_view_seen){.cell = -1};
    if (!file->pvs) return true;
    seen->row = malloc(enf_pvs_row_bytes(file->cell_count) + 1);
    seen->other = malloc(enf_pvs_row_bytes(file->cell_count) + 1);
    return seen->row && seen->other;
}

void enf_seen_free(enf_view_seen *seen) {
    free(seen->row);
    free(seen->other);
}

static bool decode(const enf_file_view *file, int32_t cell, uint8_t *row) {
    int64_t first = file->pvs_offset[cell], size = file->pvs_offset[cell + 1] - first;
    return enf_pvs_row_decode(file->pvs_rows + first, (size_t)size, row, file->cell_count);
}

bool enf_seen_look(enf_view_seen *seen, const enf_file_view *file, int32_t cell) {
    if (!seen->row) return false;
    if (seen->cell == cell) return true;
    bool decoded = decode(file, cell, seen->row);
    seen->cell = decoded ? cell : -1;
    return decoded;
}

bool enf_seen_join(enf_view_seen *seen, const enf_file_view *file, const int32_t *cells, int32_t count) {
    if (!enf_seen_look(seen, file, cells[0])) return false;
    size_t bytes = enf_pvs_row_bytes(file->cell_count);
    for (int32_t i = 1; i < count; i++) {
        seen->cell = -1;
        if (!decode(file, cells[i], seen->other)) return false;
        for (size_t k = 0; k < bytes; k++) seen->row[k] |= seen->other[k];
    }
    return true;
}

static bool touches(const enf_file_view *file, const enf_file_portal *portal, const double eye[3],
                    double near_distance) {
    const enf_file_portal_polygon *polygon = &file->portal_polygons[portal->polygon_first];
    for (int32_t i = 0; i < portal->polygon_count; i++)
        if (enf_view_is_near(eye, near_distance, polygon[i].plane,
                             file->portal_vertices + polygon[i].vertex_first, polygon[i].vertex_count))
            return true;
    return false;
}

int32_t enf_seen_touch(const enf_file_view *file, const double eye[3], double near_distance,
                       int32_t cells[ENF_SEEN_CELLS]) {
    int32_t count = 1;
    for (int32_t i = 0; i < count; i++) {
        const enf_file_cell *cell = &file->cells[cells[i]];
        for (int32_t k = 0; k < cell->portal_count; k++) {
            const enf_file_portal *portal = &file->portals[file->cell_portals[cell->portal_first + k]];
            int32_t known = 0;
            if (!touches(file, portal, eye, near_distance)) continue;
            while (known < count && cells[known] != portal->to) known++;
            if (known < count) continue;
            if (count == ENF_SEEN_CELLS) return 0;
            cells[count++] = portal->to;
        }
    }
    return count;
}
