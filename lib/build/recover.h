// SPDX-License-Identifier: GPL-3.0-or-later
// Plane recovery, a part of clean: what was coplanar before a tool rotated or rounded the world is coplanar
// again.
#ifndef ENF_BUILD_RECOVER_H
#define ENF_BUILD_RECOVER_H

#include "build/frame.h"

/// Sets mesh->weld and mesh->plane_tolerance: what the options say, or a part of the diagonal of the box of
/// `points` (xyz).
void enf_tolerances_choose(enf_mesh *mesh, const enf_clean_options *options, const double *points,
                           size_t count);

/// Turns the points and moves them to planes, in place, none by more than mesh->plane_tolerance (beside the
/// turn). Sets what the mesh reports on recovery, and mesh->frame. *changed: the points are not what they
/// were, and of the frame only the turn is still right.
enf_status enf_planes_recover(enf_mesh *mesh, double *points, size_t count, const enf_frame_rings *rings,
                              bool *changed, enf_error *error);

#endif
