// SPDX-License-Identifier: GPL-3.0-or-later
// Ways to break a world file, at least one for each invariant that the checker knows.
#ifndef ENF_TESTS_CHECK_BREAKERS_H
#define ENF_TESTS_CHECK_BREAKERS_H

#include "enfilade/format.h"

typedef struct world {
    uint8_t *bytes;
    size_t size;
    enf_file_view view;
} world;

/// Breaks the world in the `index`-th way of its kind, in its bytes. False if there are no more ways. Where a
/// kind needs luck (a change that breaks this invariant and none before it), it has many ways, and one of
/// them must do.
typedef bool breaker(world *w, int index);

typedef struct check_kind {
    const char *row; ///< the invariant that it breaks
    breaker *breaks;
} check_kind;

extern const check_kind check_kinds[];
extern const int check_kind_count;

#endif
