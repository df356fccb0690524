// SPDX-License-Identifier: GPL-3.0-or-later
// Connect: what polygons cover of the facets, cells joined where nothing divides them, and the fine complex
// of what is left.
#ifndef ENF_BUILD_CONNECT_H
#define ENF_BUILD_CONNECT_H

#include "build/arrangement.h"
#include "build/complex.h"

/// Completes the complex that enf_complex_split began; takes over the arrangement's planes.
enf_status enf_complex_connect(enf_complex *complex, enf_arrangement *arrangement, const enf_crew *crew,
                               enf_error *error);

#endif
