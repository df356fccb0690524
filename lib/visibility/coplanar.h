// SPDX-License-Identifier: GPL-3.0-or-later
// Portals that lead into the same cell through the same plane: what beams reach of them can be put together.
#ifndef ENF_VISIBILITY_COPLANAR_H
#define ENF_VISIBILITY_COPLANAR_H

#include "visibility/follows.h"
#include "visibility/shapes.h"

/// Rings of portals that share a plane, the way through it, the cell behind, and what follows there. Returns
/// per portal the next one of its ring, itself if it is alone; null without memory. The caller frees it.
int32_t *enf_coplanar_make(const enf_shapes *shapes, const enf_follows *follows);

#endif
