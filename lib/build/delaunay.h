// SPDX-License-Identifier: GPL-3.0-or-later
// Delaunay tetrahedra of the clean points, by arithmetic and a data structure of our own.
#ifndef ENF_BUILD_DELAUNAY_H
#define ENF_BUILD_DELAUNAY_H

#include "shim/shim.h"

/// Delaunay triangulation of `point_count` different points (xyz, whole numbers of at most 2^53) in
/// lexicographic order. The very same tetrahedra as enf_shim_delaunay_cgal makes, in no particular order.
/// ENF_BAD_INPUT if all points lie in a plane, or are not sorted or not different; ENF_NO_RESOURCES without
/// memory.
enf_status enf_delaunay(const double *points, size_t point_count, enf_tetrahedra *out, enf_error *error);

#endif
