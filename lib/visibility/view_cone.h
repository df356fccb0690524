// SPDX-License-Identifier: GPL-3.0-or-later
// What can be seen from a point through a window.
#ifndef ENF_VISIBILITY_VIEW_CONE_H
#define ENF_VISIBILITY_VIEW_CONE_H

#include "visibility/separator.h"

/// The planes through the eye and the edges of a window of a directed portal. Those that go by the eye are
/// left out.
void enf_view_cone_find(enf_separators *cone, const double eye[3], const enf_window *window, int32_t portal);

bool enf_view_cone_has(const enf_separators *cone, const double point[3]);

#endif
