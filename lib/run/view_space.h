// SPDX-License-Identifier: MIT
// Spaces: the world as it is seen behind portals that transform.
#ifndef ENF_RUN_VIEW_SPACE_H
#define ENF_RUN_VIEW_SPACE_H

#include "run/view_lens.h"

enum { ENF_VIEW_SPACES = 256 };

typedef struct enf_view_spaces {
    int32_t count;
    enf_view_space spaces[ENF_VIEW_SPACES];
    enf_view_lens lenses[ENF_VIEW_SPACES];
} enf_view_spaces;

/// Only the world itself.
void enf_spaces_clear(enf_view_spaces *spaces, const enf_view_lens *lens);

/// The space behind a portal seen in `parent`, made if there is none yet. -1: there is no room, or its
/// numbers are not finite.
int32_t enf_spaces_pass(enf_view_spaces *spaces, int32_t parent, const enf_file_view *file, int32_t portal,
                        const double matrix[12]);

#endif
