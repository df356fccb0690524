// SPDX-License-Identifier: GPL-3.0-or-later
// Sight lines as text: proof of what is visible, for others to check.
#ifndef ENF_VISIBILITY_WITNESS_H
#define ENF_VISIBILITY_WITNESS_H

#include "visibility/visibility.h"

/// Writes a line `i j x y z x y z` for each witness: two cells, i < j, a point in i and one in j that see
/// each other, with 17 digits, sorted by i and j. Where only lines that are not between doubles pass, all six
/// numbers have more digits than 17 and are meant as they stand. Write errors stay in the stream.
enf_status enf_witnesses_print(const enf_visibility *visibility, FILE *out, enf_error *error);

#endif
