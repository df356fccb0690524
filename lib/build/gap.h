// SPDX-License-Identifier: GPL-3.0-or-later
// Gaps: where two polygons overlap that were coplanar before their coordinates were rounded, a layer of cells
// lies between them that is thinner than the tolerance. It may have wide faces to both sides and still be no
// way through.
#ifndef ENF_BUILD_GAP_H
#define ENF_BUILD_GAP_H

#include "build/complex.h"

/// Unites in `parent` what openings at least `crack` (grid steps, > 0) wide join. The sets' items are the
/// cells, then the outside of the hull, then the pieces. Sets gap[cell] for the cells (all false before) that
/// are thinner than `crack` and touch a wall; these are in no set but their own. An opening leads through
/// such a cell if it is also wide where the piece that leads in and the one that leads out lie above each
/// other. `face_cell`: per face its cell. False without memory.
bool enf_gaps_join(const enf_complex *complex, const int32_t *face_cell, double crack, bool *gap,
                   int32_t *parent);

#endif
