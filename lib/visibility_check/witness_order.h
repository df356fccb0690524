// SPDX-License-Identifier: GPL-3.0-or-later
// Check: does a line come to one portal before another? Exactly; for portals that lie in one plane, but for
// rounding, where a line can pass the edges of both and still come to the wrong one first.
#ifndef ENF_VISIBILITY_CHECK_WITNESS_ORDER_H
#define ENF_VISIBILITY_CHECK_WITNESS_ORDER_H

#include "visibility/portal_graph.h"

#include <gmp.h>

/// The line is directed from -> to, which differ, and passes all edges of both portals. It comes to a portal
/// in that triangle of the fan from the winding's first corner that it goes through. The second place has to
/// lie ahead of the first, strictly.
bool enf_witness_in_order(const enf_portal_graph *graph, mpq_t from[3], mpq_t to[3], int32_t first,
                          int32_t second);

/// The same as enf_witness_in_order by doubles: true if it is certain.
bool enf_witness_surely_in_order(const enf_portal_graph *graph, const double from[3], const double to[3],
                                 int32_t first, int32_t second);

#endif
