// SPDX-License-Identifier: GPL-3.0-or-later
// Still: facets that nothing will cut or clip go straight into the fine complex.
#ifndef ENF_BUILD_STILL_H
#define ENF_BUILD_STILL_H

#include "build/yield.h"

/// Appends all facets that are in no part, each with the polygons that cover it, to a yield that is empty,
/// and sets its still_count. False without memory.
bool enf_still_emit(enf_yield *yield, const enf_arrangement *arrangement, const enf_parts *parts,
                    int threads);

#endif
