// SPDX-License-Identifier: GPL-3.0-or-later
// Separating planes: what lines through two windows can reach beyond the second (S. J. Teller, "Computing the
// antipenumbra of an area light source", 1992).
#ifndef ENF_VISIBILITY_SEPARATOR_H
#define ENF_VISIBILITY_SEPARATOR_H

#include "visibility/body.h"
#include "visibility/shapes.h"
#include "visibility/window.h"

enum { ENF_SEPARATORS_MOST = 64 };

/// Cuts. What is above the count, up to the next four, leaves everything over.
typedef struct enf_separators {
    int32_t count;
    double normal[3][ENF_SEPARATORS_MOST],
        least[ENF_SEPARATORS_MOST]; ///< keep what is in front: normal . x >= least
    double spare;                   ///< cuts that take off no more than this are not made
} enf_separators;

/// Fills up to the next four, once all are there.
void enf_separators_close(enf_separators *separators);

/// For lines that have passed one directed portal only: they go on beyond its plane.
void enf_separators_begin(enf_separators *separators, const enf_shapes *shapes, int32_t from_portal);

/// The same, and the planes through an edge of one window and a corner of the other that have `from` behind
/// and `to` in front: lines that pass `from` and then `to` stay in front from there on. `from` is a window of
/// the directed portal `from_portal`, `to` of `to_portal`. A plane that rounding could tilt too much is left
/// out, or given the slack it needs.
void enf_separators_between(enf_separators *separators, const enf_shapes *shapes, const enf_outline *from,
                            int32_t from_portal, const enf_outline *to, int32_t to_portal);

/// The same, for windows.
void enf_separators_find(enf_separators *separators, const enf_shapes *shapes, const enf_window *from,
                         int32_t from_portal, const enf_window *to, int32_t to_portal);

/// The planes that part a body from `to`, a window of the directed portal `to_portal`, or of some in its
/// plane, through an edge of one and a corner of the other: lines from the body that pass `to` stay in front
/// from there on, for good by the tolerance of windows, if they have three tolerances of room around them.
/// (All that have not may be lost; so may be, where windows are merged, what has less room than a tolerance.)
void enf_separators_from_body(enf_separators *separators, const enf_shapes *shapes, const enf_body *body,
                              const enf_outline *to, int32_t to_portal);

/// May they leave something of the hull of these points? The box around them, middle and half, is asked
/// first.
bool enf_separators_meet(const enf_separators *separators, const double middle[3], const double half[3],
                         const double (*points)[3], int32_t count);

typedef enum enf_remains { ENF_REMAINS_NOTHING, ENF_REMAINS_PART, ENF_REMAINS_WHOLE } enf_remains;

/// What they leave of another portal's opening. The window receives only a part.
enf_remains enf_separators_cut(const enf_separators *separators, const enf_shapes *shapes, int32_t portal,
                               enf_window *window);

/// The same; the window receives the whole outline, too.
enf_remains enf_separators_pass(const enf_separators *separators, const enf_shapes *shapes, int32_t portal,
                                enf_window *window);

#endif
