// SPDX-License-Identifier: GPL-3.0-or-later
// The outline of an opening: its normal, and whether it is a flat, convex polygon.
#ifndef ENF_VISIBILITY_WINDING_H
#define ENF_VISIBILITY_WINDING_H

#include "enfilade/base.h"

enum { ENF_WINDING_CORNERS_MAX = 64 }; ///< the limit of the compilers that write .prt files

typedef enum enf_winding_fault {
    ENF_WINDING_FINE,
    ENF_WINDING_NO_AREA,
    ENF_WINDING_NOT_PLANAR,
    ENF_WINDING_NOT_CONVEX
} enf_winding_fault;

/// Drops corners that equal the one before them (the first comes after the last). Returns how many are left.
int32_t enf_winding_drop_doubles(double (*corners)[3], int32_t count);

/// How far a corner may lie from where it should, because it was written with six digits as old compilers do:
/// three units of the sixth digit of the largest coordinate, 0.03 at 4096. (A corner is off by up to
/// half a unit in each coordinate, 0.9 in space; so is the plane it is held against, and a little tilted.)
double enf_winding_tolerance(const double (*corners)[3], int32_t count);

/// The unit normal by the right-hand rule, from the areas of all corners. False if there is none: the area is
/// below 1e-12 of the square of the size, which is what rounding makes of corners on one line.
bool enf_winding_normal(const double (*corners)[3], int32_t count, double normal[3]);

/// Is it a convex polygon that goes round once, within the tolerance? `count` is at least 3. *corner receives
/// the index of the offending corner.
enf_winding_fault enf_winding_judge(const double (*corners)[3], int32_t count, int32_t *corner);

#endif
