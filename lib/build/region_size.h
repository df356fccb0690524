// SPDX-License-Identifier: GPL-3.0-or-later
// What regions are made of, told by their boundary alone.
#ifndef ENF_BUILD_REGION_SIZE_H
#define ENF_BUILD_REGION_SIZE_H

#include "build/region.h"

/// Fills volume, front_area, back_area, touches_outside, hairline, winding and ambiguous (allocated, all
/// zero) of regions whose cells are coloured. Cells in gaps (gap.h) add nothing to the surface that tells a
/// hairline: what layer went with which region says nothing of the region. False without memory.
bool enf_regions_measure(enf_regions *regions, const enf_complex *complex, const enf_mesh *mesh,
                         const bool *gap, double crack);

#endif
