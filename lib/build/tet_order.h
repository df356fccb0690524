// SPDX-License-Identifier: GPL-3.0-or-later
// The order of tetrahedra: near in space, near in memory.
#ifndef ENF_BUILD_TET_ORDER_H
#define ENF_BUILD_TET_ORDER_H

#include "enfilade/base.h"

/// The numbers of the points (xyz, grid steps) in order along a space-filling curve. False without memory.
bool enf_curve_order(const double *points, size_t count, int32_t *order);

/// Sorts tetrahedra along a space-filling curve through their points (xyz, grid steps), those at the same
/// place by their corners: what the later stages touch together lies together. Corners are turned so that the
/// lowest comes first and the second lowest next; orientations stay. The same set of tetrahedra becomes the
/// same array. Replaces the array (from malloc) by another. False without memory.
bool enf_tetrahedra_sort(int32_t (**corners)[4], size_t count, const double *points, size_t point_count);

#endif
