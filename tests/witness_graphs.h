// SPDX-License-Identifier: GPL-3.0-or-later
// Small portal graphs for the tests of sight lines and hidden pairs. Free them with enf_portal_graph_free.
#ifndef ENF_TESTS_WITNESS_GRAPHS_H
#define ENF_TESTS_WITNESS_GRAPHS_H

#include "visibility/portal_graph.h"

/// A door square to `axis` there, from low to high along the two other axes; it leads that way along the
/// axis.
void add_door(enf_portal_graph *graph, int32_t from, int32_t to, int axis, double at, const double low[2],
              const double high[2]);

/// A door from (at, 0, 0) to (at, 2, 2), along x.
void add_square(enf_portal_graph *graph, int32_t from, int32_t to, double at);

void finish(enf_portal_graph *graph);
void scale_graph(enf_portal_graph *graph, double factor);

/// Rooms 0 .. count - 1 along x, with squares at 1, 2, ...
enf_portal_graph row_of_rooms(int32_t count);

/// Rooms 0 .. 3: along x, along y, and back.
enf_portal_graph bend(void);

/// Rooms 0 .. 4 along x. The first and the last door end at y = width, the second, halfway, begins at 0; the
/// third is thin in z.
enf_portal_graph slit(double width);

/// Rooms 0 .. 3 behind doors square to y, z and x, out of the level dm1.
enf_portal_graph three_doors(void);

/// Rooms 0 .. 6 behind six doors of the level e3m3: lines miss by a thousandth of a unit.
enf_portal_graph six_doors(void);

/// At least 0, less than 1.
double random_unit(uint64_t *seed);

/// Tilted doors along x, in whole numbers.
enf_portal_graph random_chain(uint64_t *seed);

#endif
