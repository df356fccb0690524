// SPDX-License-Identifier: GPL-3.0-or-later
// Directed lines through two points, and whether they pass portals.
#ifndef ENF_VISIBILITY_LINE_H
#define ENF_VISIBILITY_LINE_H

#include "visibility/portal_graph.h"

/// The whole line, not only the part between its points; it points from `from` to `to`. Finite.
typedef struct enf_line {
    double from[3], to[3];
} enf_line;

/// Does the line pass all edges of the portal on the inner side, strictly, in the portal's direction? Exact
/// for any finite doubles. An edge between equal corners is no edge; a winding without edges lets nothing
/// through.
bool enf_line_passes(const enf_line *line, const enf_portal_graph *graph, int32_t portal);

/// What doubles can tell of the same: +1 surely passes, -1 surely does not, 0 unsure.
int enf_line_passes_quickly(const enf_line *line, const enf_portal_graph *graph, int32_t portal);

/// Sign of det(line, a - from, b - from): exact for any finite doubles. Positive if b is in front of the
/// plane through from, to and a, whose front sees them turn counter-clockwise.
int enf_line_side(const enf_line *line, const double a[3], const double b[3]);

#endif
