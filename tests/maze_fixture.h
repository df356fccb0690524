// SPDX-License-Identifier: GPL-3.0-or-later
// A floor of square rooms with openings of many sizes between neighbours, as a portal file.
#ifndef ENF_TESTS_MAZE_FIXTURE_H
#define ENF_TESTS_MAZE_FIXTURE_H

#include "visibility/portal_graph.h"

/// The text of a PRT1 file of side * side cells; free it.
char *maze_print(int side, uint64_t seed);

/// The same as a finished graph; free it with enf_portal_graph_free.
void maze_read(enf_portal_graph *graph, int side, uint64_t seed);

#endif
