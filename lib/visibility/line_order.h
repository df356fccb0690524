// SPDX-License-Identifier: GPL-3.0-or-later
// Does a line pass the portals of a sequence in their order? In convex cells that comes by itself; where
// portals of a cell lie in one plane but for rounding, a line may pass the edges of both and yet come to the
// second first.
#ifndef ENF_VISIBILITY_LINE_ORDER_H
#define ENF_VISIBILITY_LINE_ORDER_H

#include "visibility/line.h"
#include "visibility/shapes.h"

/// The line passes all portals of the sequence. `decimals`, if not null, are the six coordinates of its
/// points instead (stab.h, long_line). Exact; where a winding is not planar, any of the planes through its
/// first corner and an edge will do.
bool enf_line_is_in_order(const enf_shapes *shapes, const enf_line *line, const char *decimals,
                          const int32_t *sequence, int32_t count);

#endif
