// SPDX-License-Identifier: GPL-3.0-or-later
// One polygon as a ring of point indices: taking out what has no area, and telling what is left.
#ifndef ENF_BUILD_RING_H
#define ENF_BUILD_RING_H

#include "enfilade/base.h"

/// Takes out repeated neighbours and spikes (a, b, a). Returns the new number of corners (0 if nothing is
/// left); if it is 3 or more, at least three corners are different.
size_t enf_ring_remove_repeats(int32_t *ring, size_t count);

/// Takes out corners on the line through their neighbours, and what then repeats, until none is left.
/// `points`: grid points, xyz. Returns the new number of corners; below 3 the ring had no area at all.
size_t enf_ring_remove_collinear(int32_t *ring, size_t count, const double *points);

/// Rotates the ring to its lexicographically smallest form, so that the corner it was listed from does not
/// matter.
void enf_ring_rotate(int32_t *ring, size_t count);

/// True if all corners lie in one plane exactly and the ring is strictly convex, going round once. The ring
/// has no collinear corners.
bool enf_ring_is_convex(const int32_t *ring, size_t count, const double *points);

/// The two axes of the coordinate plane in which the ring shows its largest area (right-handed: the ring's
/// normal points up where it turns left there, unless *sign is -1).
void enf_ring_projection(const int32_t *ring, size_t count, const double *points, int *u, int *v, int *sign);

/// Three corners in the ring's order that span its plane best. The ring is convex.
void enf_ring_plane(const int32_t *ring, size_t count, const double *points, int32_t plane[3]);

#endif
