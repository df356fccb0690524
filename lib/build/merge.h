// SPDX-License-Identifier: GPL-3.0-or-later
// Joining convex polygons of one plane, edge to edge, into fewer convex polygons.
#ifndef ENF_BUILD_MERGE_H
#define ENF_BUILD_MERGE_H

#include "build/loop.h"

/// Joins loops[0..count) of the pool, all on one plane and counter-clockwise seen from its front, as long as
/// two of them share a whole edge and together are convex. Vertices must be canonical: equal numbers where
/// they are the same point. Returns how many are left (at the front of the array, in order of their first
/// part); sets pool->failed without memory.
int32_t enf_pool_merge(enf_pool *pool, enf_loop *loops, int32_t count);

#endif
