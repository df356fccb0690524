// SPDX-License-Identifier: GPL-3.0-or-later
// The corners of a compiled world's fine cells.
#ifndef ENF_VISIBILITY_FINE_VERTICES_H
#define ENF_VISIBILITY_FINE_VERTICES_H

#include "enfilade/format.h"

/// All zero at first; free `vertices`.
typedef struct enf_fine_vertices {
    int32_t *vertices; ///< of the file's
    int32_t count;
    size_t capacity;
} enf_fine_vertices;

/// Lists the vertices of a fine cell's facets, each once. Needs the exact part of the file. False without
/// memory.
bool enf_fine_vertices_take(enf_fine_vertices *list, const enf_file_view *view, int32_t fine);

#endif
