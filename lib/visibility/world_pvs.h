// SPDX-License-Identifier: GPL-3.0-or-later
// The visible set of a compiled world, in the form of its file.
#ifndef ENF_VISIBILITY_WORLD_PVS_H
#define ENF_VISIBILITY_WORLD_PVS_H

#include "build/write.h"
#include "visibility/visibility.h"

/// Up to so many openings between cells, visible sets take about as long as the rest of a compile, if there
/// is a partition of the air (world_air.h).
enum { ENF_WORLD_PVS_OPENINGS = 20000 };

/// Finds what the image's cells see and adds it to the image. *visibility is overwritten; free it in any
/// case. What a cell sees is never too little. `left_out`: null, or a world in which they would
/// take longer than that is left as it is, and it is told so.
enf_status enf_world_pvs_add(enf_build_image *image, const enf_visibility_options *options, bool *left_out,
                             enf_visibility *visibility, enf_error *error);

#endif
