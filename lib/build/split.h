// SPDX-License-Identifier: GPL-3.0-or-later
// Split: cut the cells that polygons cross, only those, into convex fine cells.
#ifndef ENF_BUILD_SPLIT_H
#define ENF_BUILD_SPLIT_H

#include "build/arrangement.h"
#include "build/complex.h"

/// Fills the complex with facets, covers and pieces in which cells have numbers of arrangement->subdivision;
/// enf_complex_connect completes it.
enf_status enf_complex_split(enf_complex *complex, enf_arrangement *arrangement, const enf_crew *crew,
                             enf_error *error);

#endif
