// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/fine_vertices.h"

#include "base/array.h"

bool enf_fine_vertices_take(enf_fine_vertices *list, const enf_file_view *view, int32_t fine) {
    int32_t count = 0;
    for (int32_t k = view->fine_facet[fine]; k < view->fine_facet[fine + 1]; k++) {
        const int32_t *offset = &view->facet_offset[view->fine_facets[k]];
        if (!enf_array_reserve(list->vertices, list->capacity, count + offset[1] - offset[0])) return false;
        for (int64_t i = offset[0]; i < offset[1]; i++) {
            const int32_t vertex = view->facet_corners[i].vertex;
            int32_t seen = 0;
            while (seen < count && list->vertices[seen] != vertex) seen++;
            if (seen == count) list->vertices[count++] = vertex;
        }
    }
    list->count = count;
    return true;
}
