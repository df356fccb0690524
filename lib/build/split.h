// SPDX-License-Identifier: GPL-3.0-or-later
// Split: cut the tetrahedra that polygons cross, only those, into convex fine cells. The results of all
// tetrahedra, put together in order: connect.h makes the fine complex of them.
#ifndef ENF_BUILD_SPLIT_H
#define ENF_BUILD_SPLIT_H

#include "base/parallel.h"
#include "build/arrangement.h"
#include "build/complex.h"

/// Fills the complex up to faces and covers; pieces and seen polygons are left to enf_complex_connect.
/// `crossings` receives every crossing that was made (vertex point_count + i; free() it).
enf_status enf_complex_split(enf_complex *complex, enf_arrangement *arrangement, const enf_crew *crew,
                             enf_crossing **crossings, enf_error *error);

#endif
