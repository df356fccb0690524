// SPDX-License-Identifier: GPL-3.0-or-later
// Does a line come to the portals of a sequence in their order? In convex cells that comes by itself; where
// portals of a cell lie in one plane but for rounding, a line may pass the edges of both and yet come to the
// second first.
//
// A winding is planar only up to rounding. What spans it is the fan of triangles from its first corner: a
// line that passes all edges goes through one of these, or through two where they meet, and comes to the
// portal there. It comes to one portal before another if the place is earlier along the line, or if the
// triangles lie in one plane.
#ifndef ENF_VISIBILITY_LINE_ORDER_H
#define ENF_VISIBILITY_LINE_ORDER_H

#include "visibility/line.h"
#include "visibility/shapes.h"

/// Which portal of the sequence does the line, which passes all of them, not come to after the one before it?
/// The first such place in the sequence, or 0 if there is none: the line is in order. `decimals`, if not
/// null, are the six coordinates of its points instead (stab.h, long_line). Exact.
int32_t enf_line_disorder(const enf_shapes *shapes, const enf_line *line, const char *decimals,
                          const int32_t *sequence, int32_t count);

/// Does the line, which passes both portals, come to one before the other? True if doubles are sure of it.
bool enf_line_surely_in_order(const enf_shapes *shapes, const enf_line *line, int32_t before, int32_t after);

#endif
