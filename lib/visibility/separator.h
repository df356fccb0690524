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

/// For lines that have passed one directed portal only: they go on beyond its plane.
void enf_separators_begin(enf_separators *separators, const enf_shapes *shapes, int32_t from_portal);

/// The same, and the planes through an edge of one window and a corner of the other that have `from` behind
/// and `to` in front: lines that pass `from` and then `to` stay in front from there on. `from` is a window of
/// the directed portal `from_portal`, `to` of `to_portal`. A plane that rounding could tilt too much is left
/// out, or given the slack it needs.
void enf_separators_find(enf_separators *separators, const enf_shapes *shapes, const enf_window *from,
                         int32_t from_portal, const enf_window *to, int32_t to_portal);

/// What they leave of another portal's opening.
enf_remains enf_separators_pass(const enf_separators *separators, const enf_shapes *shapes, int32_t portal,
                                enf_window *window);

/// May they leave something of the hull of these points?
bool enf_separators_meet(const enf_separators *separators, const double (*points)[3], int32_t count);

#endif
