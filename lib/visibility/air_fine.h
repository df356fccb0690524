// SPDX-License-Identifier: GPL-3.0-or-later
// The fine cells of a compiled world as the leafs of its air: where walls share no planes, as in caverns, no
// partition by their planes has fewer.
#ifndef ENF_VISIBILITY_AIR_FINE_H
#define ENF_VISIBILITY_AIR_FINE_H

#include "visibility/air_parts.h"
#include "visibility/portal_graph.h"

/// Each fine cell of a kept region is a body, in a leaf of its own; made on some threads. Needs the exact
/// part of the file. Both are overwritten; free them in any case.
enf_status enf_air_fine_make(enf_portal_graph *leafs, enf_air_parts *parts, const enf_file_view *view,
                             int threads, enf_error *error);

#endif
