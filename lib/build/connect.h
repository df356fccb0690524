// SPDX-License-Identifier: GPL-3.0-or-later
// Connect: overlay the faces on the two sides of every facet, and take away what polygons cover.
#ifndef ENF_BUILD_CONNECT_H
#define ENF_BUILD_CONNECT_H

#include "base/parallel.h"
#include "build/arrangement.h"
#include "build/complex.h"

/// Finishes a complex that enf_complex_split began: pieces, seen polygons, vertices, planes (moved out of the
/// arrangement). `crossings`: what enf_complex_split left; still the caller's.
enf_status enf_complex_connect(enf_complex *complex, enf_arrangement *arrangement,
                               const enf_crossing *crossings, const enf_crew *crew, enf_error *error);

#endif
