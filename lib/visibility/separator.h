// SPDX-License-Identifier: GPL-3.0-or-later
// Separating planes: what lines through two windows can reach beyond the second (S. J. Teller, "Computing the
// antipenumbra of an area light source", 1992).
#ifndef ENF_VISIBILITY_SEPARATOR_H
#define ENF_VISIBILITY_SEPARATOR_H

#include "visibility/shapes.h"
#include "visibility/window.h"

enum { ENF_SEPARATORS_MOST = 64 };

typedef struct enf_separators {
    int32_t count;
    enf_cut cuts[ENF_SEPARATORS_MOST];
} enf_separators;

/// Finds the planes through an edge of one window and a corner of the other that have `from` behind and `to`
/// in front: lines that pass `from` and then `to` stay in front from there on. `from` is the window of a
/// directed portal with `from_portal`'s sense, `to` of `to_portal`'s. A plane that rounding could tilt too
/// much is left out, or given the slack it needs.
void enf_separators_find(enf_separators *separators, const enf_shapes *shapes, const enf_window *from,
                         int32_t from_portal, const enf_window *to, int32_t to_portal);

#endif
