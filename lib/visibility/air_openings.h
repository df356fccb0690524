// SPDX-License-Identifier: GPL-3.0-or-later
// The openings between the leafs of a world's air.
#ifndef ENF_VISIBILITY_AIR_OPENINGS_H
#define ENF_VISIBILITY_AIR_OPENINGS_H

#include "visibility/air_parts.h"
#include "visibility/portal_graph.h"

/// Makes the portal graph of the leafs that are air, finished, on some threads: it is the same for any
/// number. Thin walls are cut out of the openings. `size` is the largest coordinate in magnitude. *graph is
/// overwritten; free it in any case.
enf_status enf_air_openings_make(enf_portal_graph *graph, const enf_air_tree *tree,
                                 const enf_air_parts *parts, double size, int threads, enf_error *error);

#endif
