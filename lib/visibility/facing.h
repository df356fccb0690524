// SPDX-License-Identifier: GPL-3.0-or-later
// The rung `facing`: which portals a sight line through a portal could pass later, going by planes alone.
#ifndef ENF_VISIBILITY_FACING_H
#define ENF_VISIBILITY_FACING_H

#include "base/parallel.h"
#include "visibility/bits.h"
#include "visibility/shapes.h"

/// Bit q of row p: portal q can be reached from portal p through portals that are all in front of p and have
/// p behind them, each in front of the one before it. Symmetric: q is in p's row exactly if the twin of p is
/// in the row of the twin of q. `exactly`: no pair that a line passes, by however little, is left out;
/// else what reaches beyond a plane by no more than the tolerance of the shapes may count as in it. *facing
/// is made; free it in any case.
enf_status enf_facing_find(enf_bits *facing, const enf_shapes *shapes, bool exactly, const enf_crew *crew,
                           enf_error *error);

/// Could a line pass the one portal and then the other, as far as planes tell, by more than the tolerance of
/// the shapes?
bool enf_portals_face(const enf_shapes *shapes, int32_t portal, int32_t other);

#endif
