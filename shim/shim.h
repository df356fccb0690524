// SPDX-License-Identifier: GPL-3.0-or-later
// The C face of the C++ libraries. C in, C out; nothing throws across; memory comes from malloc.
#ifndef ENF_SHIM_H
#define ENF_SHIM_H

#include "enfilade/base.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Tetrahedra of a Delaunay triangulation, in no particular order: four point indices each, positively
/// oriented (the determinant of (b-a, c-a, d-a) is > 0). Free `corners` with free().
typedef struct enf_tetrahedra {
    int32_t (*corners)[4];
    size_t count;
} enf_tetrahedra;

/// Delaunay triangulation of `point_count` different points (xyz) by CGAL, exact predicates, spatially sorted
/// insertion. Cospherical points are broken by CGAL's symbolic perturbation, so the result depends on the set
/// of points only. ENF_BAD_INPUT if all points lie in a plane; ENF_NO_RESOURCES without memory.
enf_status enf_shim_delaunay_cgal(const double *points, size_t point_count, enf_tetrahedra *out,
                                  enf_error *error);

/// The same by TetGen. ENF_BAD_USAGE in a build without it.
enf_status enf_shim_delaunay_tetgen(const double *points, size_t point_count, enf_tetrahedra *out,
                                    enf_error *error);

/// What the triangulation alone costs, as a yardstick: processor seconds that CGAL takes to insert the
/// points, spatially sorted, into nothing more than a Delaunay triangulation, and its finite tetrahedra.
enf_status enf_shim_delaunay_time(const double *points, size_t point_count, double *seconds,
                                  size_t *tetrahedra, enf_error *error);

/// True when this build has TetGen.
bool enf_shim_has_tetgen(void);

#ifdef __cplusplus
}
#endif
#endif
