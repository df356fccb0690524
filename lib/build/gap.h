// SPDX-License-Identifier: GPL-3.0-or-later
// Gaps: where two polygons overlap that were coplanar before their coordinates were rounded, a layer of cells
// lies between them that is thinner than the tolerance. It may have wide faces to both sides and still be no
// way through.
#ifndef ENF_BUILD_GAP_H
#define ENF_BUILD_GAP_H

#include "build/complex.h"

/// Sets gap[cell] (all false before) for the cells that are thinner than `crack` (grid steps) and touch a
/// wall. False without memory.
bool enf_gaps_find(const enf_complex *complex, double crack, bool *gap);

/// Unites in `parent` the cells (and, after them, the outside of the hull) that openings at least `crack`
/// wide join through such cells: straight along the thin direction, through what all pieces on the way leave
/// open. `pieces`: all open pieces at such cells. False without memory.
bool enf_gaps_join(const enf_complex *complex, double crack, const bool *gap, const int32_t *pieces,
                   size_t piece_count, int32_t *parent);

#endif
