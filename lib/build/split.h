// SPDX-License-Identifier: GPL-3.0-or-later
// Split: cut the cells that polygons cross, only those, into convex fine cells.
#ifndef ENF_BUILD_SPLIT_H
#define ENF_BUILD_SPLIT_H

#include "build/arrangement.h"
#include "build/complex.h"

/// Fills arrangement->subdivision and hits. enf_complex_connect makes the fine complex of them.
enf_status enf_complex_split(enf_complex *complex, enf_arrangement *arrangement, const enf_crew *crew,
                             enf_error *error);

#endif
