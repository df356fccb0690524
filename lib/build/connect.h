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

/// Frees the lists of the facets around each cell, and makes them anew: a stage that needs memory, not them,
/// can do without. False without memory.
void enf_complex_unlist_facets(enf_complex *complex);
bool enf_complex_list_facets(enf_complex *complex);

/// Lists the polygons that each cell sees, for the file. False without memory.
bool enf_complex_list_seen(enf_complex *complex);

#endif
