// SPDX-License-Identifier: GPL-3.0-or-later
// The portal graphs of a compiled world.
#ifndef ENF_VISIBILITY_WORLD_GRAPH_H
#define ENF_VISIBILITY_WORLD_GRAPH_H

#include "enfilade/format.h"
#include "visibility/portal_graph.h"

/// The cells of a world and the portals between them, world units: one opening for all polygons of a portal
/// that lie in one plane, their convex hull. *graph is overwritten; free it in any case.
enf_status enf_world_graph_make(enf_portal_graph *graph, const enf_file_view *view, enf_error *error);

/// The fine cells of a world, all convex, and the open pieces of the facets between them, but for those about
/// as thin as rounding; fine cells in discarded regions have no openings. Needs the exact part of the file
/// (view->has_exact).
enf_status enf_world_graph_make_fine(enf_portal_graph *graph, const enf_file_view *view, enf_error *error);

#endif
