// SPDX-License-Identifier: GPL-3.0-or-later
// Cutting a polygon that is not planar, not convex or not even simple into triangles.
#ifndef ENF_BUILD_TRIANGULATE_H
#define ENF_BUILD_TRIANGULATE_H

#include "enfilade/base.h"

/// Ear clipping takes quadratic time at worst; rings with more corners than this are refused.
#define ENF_TRIANGULATE_MOST 8192

/// Cuts a ring of grid points (3 <= count <= ENF_TRIANGULATE_MOST, no collinear neighbours, in canonical
/// rotation) into at most count - 2 triangles, each with area, in the ring's orientation. Simple rings (also
/// with holes tied in by a bridge) are covered exactly as seen in their main projection; of others the
/// triangles cover what the ring goes around, each facing the way its part of the ring turns. `triangles` has
/// room for count - 2. Sets *made. ENF_NO_RESOURCES without memory.
enf_status enf_triangulate(const int32_t *ring, size_t count, const double *points, int32_t (*triangles)[3],
                           size_t *made, enf_error *error);

#endif
