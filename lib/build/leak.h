// SPDX-License-Identifier: GPL-3.0-or-later
// Leaks: a way from a spawn point to the outside, for the person who has to close the hole.
#ifndef ENF_BUILD_LEAK_H
#define ENF_BUILD_LEAK_H

#include "build/region.h"

/// Fills the leak fields of coloured regions with spawns placed. The path is the one whose narrowest opening
/// is widest, and of those one through the fewest cells: it leads through the hole itself, not through a
/// hairline beside it. False without memory.
bool enf_regions_trace_leak(enf_regions *regions, const enf_complex *complex, const enf_mesh *mesh);

#endif
