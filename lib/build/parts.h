// SPDX-License-Identifier: GPL-3.0-or-later
// Parts: what can be cut by itself, and what need not be looked at.
//
// Tetrahedra that no polygon enters stay as they are. The others fall into groups that are connected through
// facets; groups are put together to parts of a fair size, in the order of the tetrahedra. The parts are the
// world's alone: they do not depend on the number of threads.
#ifndef ENF_BUILD_PARTS_H
#define ENF_BUILD_PARTS_H

#include "build/arrangement.h"
#include "build/flood.h"
#include "build/subdivision.h"

typedef struct enf_parts {
    int32_t count;              ///< 1 or more; the first has the most to do
    int32_t *cell_of;           ///< per tetrahedron: its number in its part, or -1: it stays as it is
    int32_t *tetrahedron_first; ///< count + 1 offsets
    int32_t *tetrahedra;
    int32_t *facet_first; ///< count + 1 offsets
    int32_t *facets;
    size_t *cuts; ///< per part, polygons that may cut, each as often as there are tetrahedra that it enters
    uint8_t *marked; ///< per facet of the tetrahedra: it is in a part. The others lie between tetrahedra that
                     ///< stay as they are, and are covered wholly or not at all
} enf_parts;

/// False without memory; free it in any case.
bool enf_parts_make(enf_parts *parts, const enf_arrangement *arrangement, const enf_candidates *candidates,
                    int threads);
void enf_parts_free(enf_parts *parts);

enf_tet_part enf_parts_at(const enf_parts *parts, int32_t part);

#endif
