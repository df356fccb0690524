// SPDX-License-Identifier: GPL-3.0-or-later
// The convex hull of two windows of one opening.
#ifndef ENF_VISIBILITY_HULL_H
#define ENF_VISIBILITY_HULL_H

#include "visibility/window.h"

/// Makes *window the hull of itself and the other, both of an opening with these axes (enf_shape), with no
/// more than ENF_WINDOW_MOST corners in all. Returns
/// false, with the window as it was, if the other reaches out of it by no more than the tolerance.
bool enf_hull_extend(enf_window *window, const enf_outline *other, const int32_t axes[2], double tolerance);

#endif
