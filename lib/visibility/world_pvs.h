// SPDX-License-Identifier: GPL-3.0-or-later
// The visible set of a compiled world, in the form of its file.
#ifndef ENF_VISIBILITY_WORLD_PVS_H
#define ENF_VISIBILITY_WORLD_PVS_H

#include "build/write.h"
#include "visibility/visibility.h"

/// Finds what the image's cells see and adds it to the image. *visibility is overwritten; free it in any
/// case. What a cell sees is never too little; for cells that are not convex it is what their portals allow.
enf_status enf_world_pvs_add(enf_image *image, const enf_visibility_options *options,
                             enf_visibility *visibility, enf_error *error);

#endif
