// SPDX-License-Identifier: GPL-3.0-or-later
// The convex hull of points in one plane.
#ifndef ENF_VISIBILITY_FLAT_HULL_H
#define ENF_VISIBILITY_FLAT_HULL_H

#include <stdint.h>

/// Writes the corners of the hull, counter-clockwise seen from where the normal points, and returns how many;
/// fewer than three if the points lie on one line. Sorts the points. The hull has room for 2 * count + 1.
int32_t enf_flat_hull(double (*points)[3], int32_t count, const double normal[3], double (*hull)[3]);

#endif
