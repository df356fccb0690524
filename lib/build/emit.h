// SPDX-License-Identifier: GPL-3.0-or-later
// Emit: settled facets become facets of the fine complex.
#ifndef ENF_BUILD_EMIT_H
#define ENF_BUILD_EMIT_H

#include "build/settle.h"

/// Appends a facet, with its covers and pieces, to the complex, and frees it. False without memory.
bool enf_emit_facet(enf_settler *settler, int32_t facet);

#endif
