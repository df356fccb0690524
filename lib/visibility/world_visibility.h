// SPDX-License-Identifier: GPL-3.0-or-later
// Which cell of a compiled world can see which.
#ifndef ENF_VISIBILITY_WORLD_VISIBILITY_H
#define ENF_VISIBILITY_WORLD_VISIBILITY_H

#include "visibility/visibility.h"
#include "visibility/world_air.h"

/// As enf_visibility_run, over the partition of the air: what is counted is about its leafs, but
/// visibility->pvs is about the world's cells. A cell sees another if part of it may see part of the other
/// through the leafs, itself, and its neighbours; never too little. Without a partition, if the portals
/// allow it. options->want_witnesses and options->bodies are not looked at.
enf_status enf_world_visibility_run(enf_visibility *visibility, const enf_world_air *air,
                                    const enf_file_view *view, const enf_visibility_options *options,
                                    enf_error *error);

#endif
