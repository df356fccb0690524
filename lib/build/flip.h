// SPDX-License-Identifier: GPL-3.0-or-later
// Flip: lets the tetrahedra have the polygons' own edges where that takes no more than a flip.
#ifndef ENF_BUILD_FLIP_H
#define ENF_BUILD_FLIP_H

#include "build/clean.h"
#include "build/tetrahedra.h"

/// Flips tetrahedra so that more of the polygons' edges are theirs. *flips: how many times. The same for any
/// numbering of the input, as mesh and tetrahedra are.
enf_status enf_tet_mesh_flip(enf_tet_mesh *tets, const enf_mesh *mesh, int32_t *flips, enf_error *error);

#endif
