// SPDX-License-Identifier: GPL-3.0-or-later
// Stands in for tetgen.cpp in a build without TetGen (ENFILADE_TETGEN=OFF).
#include "shim/shim.h"

bool enf_shim_has_tetgen(void) {
    return false;
}

enf_status enf_shim_delaunay_tetgen(const double *points, size_t point_count, enf_tetrahedra *out,
                                    enf_error *error) {
    (void)points;
    (void)point_count;
    *out = (enf_tetrahedra){0};
    return enf_fail(
        error, ENF_BAD_USAGE,
        "this build has no TetGen; use --tetrahedralizer cgal, or configure with ENFILADE_TETGEN=ON");
}
