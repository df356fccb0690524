// SPDX-License-Identifier: MIT
// Option structs that grow: each begins with a `size_t size`, which the caller sets to the struct's size as
// he knows it. Members are only ever added at the end, beyond what sizeof was before (not into padding), and
// a member that is all zeros means the default.
#ifndef ENF_BASE_OPTIONS_H
#define ENF_BASE_OPTIONS_H

#include "enfilade/base.h"

/// Fills the `size` bytes of `to` from a caller's struct: what an older caller does not know stays zero, and
/// so does everything if `from` is null; to->size becomes `size`. ENF_BAD_USAGE if from->size is no size, or
/// if a newer caller has set what this library does not know. `what` is the struct's name, for the words.
enf_status enf_options_take(void *to, size_t size, const void *from, const char *what, enf_error *error);

#endif
