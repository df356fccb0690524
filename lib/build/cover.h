// SPDX-License-Identifier: GPL-3.0-or-later
// Covers: the share of a polygon on a facet.
#ifndef ENF_BUILD_COVER_H
#define ENF_BUILD_COVER_H

#include "build/settle.h"

/// Lays the polygon of settler->lines on a facet in its plane. False without memory.
bool enf_cover_facet(enf_settler *settler, int32_t facet);

#endif
