// SPDX-License-Identifier: MIT
// Points on portals. A portal is a union of convex polygons; files may hold nonsense, then so is the point.
#ifndef ENF_RUN_PORTAL_SHAPE_H
#define ENF_RUN_PORTAL_SHAPE_H

#include "enfilade/format.h"

/// The centroid of a portal, moved onto the portal if that is not convex; world times `scale`, which must
/// make all coordinates small enough for their products.
void enf_portal_middle(const enf_file_view *view, int32_t portal, double scale, double middle[3]);

/// The point of a portal nearest to a point, world. False: there is none (the portal is nonsense).
bool enf_portal_nearest(const enf_file_view *view, int32_t portal, const double to[3], double nearest[3]);

/// The point u of a portal with the least |a - u| + |u - b|, world. False: there is none.
bool enf_portal_between(const enf_file_view *view, int32_t portal, const double a[3], const double b[3],
                        double best[3]);

/// The point u of an edge with the least |a - u| + |u - b|.
void enf_edge_between(const double from[3], const double to[3], const double a[3], const double b[3],
                      double best[3]);

#endif
