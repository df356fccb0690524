// SPDX-License-Identifier: GPL-3.0-or-later
// Windows that beams have reached, one for each directed portal, while a cast goes on.
#ifndef ENF_VISIBILITY_KEPT_H
#define ENF_VISIBILITY_KEPT_H

#include "visibility/separator.h"

enum { ENF_KEPT_CORNERS = 24 }; ///< of a merged window; beyond that it becomes the whole outline

typedef enum enf_beam_state { ENF_BEAM_NONE, ENF_BEAM_REACHED, ENF_BEAM_WAITING } enf_beam_state;

/// What is known of one directed portal. There are many, looked at in no order: windows are elsewhere.
typedef struct enf_kept_beam {
    int32_t window;                  ///< its place; -1: none yet
    int16_t count;                   ///< corners of the window
    uint8_t state : 2, is_whole : 1; ///< the caster's; the window is the outline
    uint8_t growths;
} enf_kept_beam;

/// The corners of a window, as an outline's.
typedef struct enf_kept_window {
    double at[3][ENF_KEPT_CORNERS + ENF_OUTLINE_MORE];
} enf_kept_window;

typedef struct enf_kept {
    const enf_shapes *shapes; ///< not owned
    enf_kept_beam *beams;     ///< per directed portal; all zero at first
    enf_kept_window *windows; ///< those of this cast come first
    int32_t window_count;
    enf_window merged; ///< scratch
} enf_kept;

/// False without memory; free it in any case.
bool enf_kept_make(enf_kept *kept, const enf_shapes *shapes);
void enf_kept_free(enf_kept *kept);

/// What is reached of a portal.
enf_outline enf_kept_outline(const enf_kept *kept, int32_t portal);

/// The portal is reached for the first time: by the window, or as a whole.
void enf_kept_begin(enf_kept *kept, int32_t portal, const enf_window *window, enf_remains remains);

/// Merges another window into what was reached before. False, with that as it was, if it does not grow.
bool enf_kept_grow(enf_kept *kept, int32_t portal, const enf_window *window, enf_remains remains);

#endif
