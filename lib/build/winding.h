// SPDX-License-Identifier: GPL-3.0-or-later
// How many closed solids hold each region: winding numbers by vote over the polygons between regions.
#ifndef ENF_BUILD_WINDING_H
#define ENF_BUILD_WINDING_H

#include "build/complex.h"

/// Fills winding[r] and ambiguous[r] for `region_count` regions of cells. Regions that reach the outside of
/// the hull have winding 0. False without memory.
bool enf_complex_wind(const enf_complex *complex, const enf_mesh *mesh, const int32_t *cell_region,
                      int32_t region_count, int32_t *winding, bool *ambiguous);

#endif
