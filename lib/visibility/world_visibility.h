// SPDX-License-Identifier: GPL-3.0-or-later
// Which cell of a compiled world can see which.
#ifndef ENF_VISIBILITY_WORLD_VISIBILITY_H
#define ENF_VISIBILITY_WORLD_VISIBILITY_H

#include "visibility/visibility.h"
#include "visibility/world_air.h"

/// As enf_visibility_run, but visibility->pvs is about the world's cells; what else is counted is about the
/// leafs, if there are any. A cell sees itself, its neighbours, and what both the portals (with all that is
/// between them taken for air) and the leafs allow that part of it sees part of: never too little, but for
/// sight through slits thinner than the partition's tolerance, or with less room around it than a few
/// tolerances of windows for each leaf on its way (separator.h). options->want_witnesses is not looked at:
/// lines through concave cells prove nothing.
enf_status enf_world_visibility_run(enf_visibility *visibility, const enf_world_air *air,
                                    const enf_file_view *view, const enf_visibility_options *options,
                                    enf_error *error);

#endif
