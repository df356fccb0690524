// SPDX-License-Identifier: GPL-3.0-or-later
// Sight lines as text: proof of what is visible, for others to check.
#ifndef ENF_VISIBILITY_WITNESS_H
#define ENF_VISIBILITY_WITNESS_H

#include "visibility/visibility.h"

/// Writes a line `i j x y z x y z` for each witness: two cells, i < j, a point in i and one in j that see
/// each other, with 17 digits, sorted by i and j. Write errors stay in the stream.
enf_status enf_witnesses_print(const enf_visibility *visibility, FILE *out, enf_error *error);

#endif
