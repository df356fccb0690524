// SPDX-License-Identifier: GPL-3.0-or-later
// Check: does a line come to one portal before another? Exactly; for portals that lie in one plane, but for
// rounding, where a line can pass the edges of both and still come to the wrong one first.
#ifndef ENF_VISIBILITY_CHECK_WITNESS_ORDER_H
#define ENF_VISIBILITY_CHECK_WITNESS_ORDER_H

#include "visibility/portal_graph.h"

#include <gmp.h>

/// The line is directed from -> to, which differ. Windings that are not planar have several planes, through
/// their first corner and an edge; any two of them in order will do.
bool enf_witness_in_order(const enf_portal_graph *graph, mpq_t from[3], mpq_t to[3], int32_t first,
                          int32_t second);

#endif
