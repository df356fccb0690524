// SPDX-License-Identifier: GPL-3.0-or-later
// Lines go both ways: what sees something is seen by it.
#ifndef ENF_VISIBILITY_SYMMETRY_H
#define ENF_VISIBILITY_SYMMETRY_H

#include "visibility/bits.h"

/// Clears every bit j of row i without bit i of row j. As many columns as rows.
void enf_symmetry_keep(enf_bits *bits);

/// The same for directed portals: every bit q of row p without bit p ^ 1 of row q ^ 1.
void enf_symmetry_keep_twins(enf_bits *bits);

#endif
