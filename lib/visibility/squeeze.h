// SPDX-License-Identifier: GPL-3.0-or-later
// Is there a sight line from one convex solid to another through a row of windows? The two are squeezed, and
// the windows with them: separating planes from either side take off what no such line meets, until nothing
// is left, or a line from the middle of what is left gets through. What is neither is halved.
//
// Other than for beams, the solids become small, and separating planes say all of what is hidden from a
// point.
#ifndef ENF_VISIBILITY_SQUEEZE_H
#define ENF_VISIBILITY_SQUEEZE_H

#include "visibility/line.h"
#include "visibility/solid.h"

typedef enum enf_squeeze_answer {
    ENF_SQUEEZE_HIDDEN, ///< no line, but within the tolerances of separators
    ENF_SQUEEZE_SEEN,
    ENF_SQUEEZE_OPEN ///< out of steps, or what is left is too small to tell, or that line of rough solids
} enf_squeeze_answer;

typedef struct enf_squeeze {
    const enf_shapes *shapes;
    /// Told of a line through all the windows, as far as doubles tell; true if it is what was looked for.
    bool (*try_line)(void *user, const enf_line *line);
    void *user;
    uint64_t seed; ///< of random points; goes on from call to call
    int64_t steps; ///< separators that may still be made; counts down
    bool
        is_rough; ///< the solids are larger than what is looked for: the first line that is not it is the end
    bool is_tiny; ///< set with an answer OPEN: what is left is too small
} enf_squeeze;

/// The windows are of directed portals, `count` of them, which may be none. ENF_NO_RESOURCES without memory.
enf_status enf_squeeze_run(enf_squeeze *squeeze, const enf_solid *from, const int32_t *portals,
                           const enf_window *windows, int32_t count, const enf_solid *to,
                           enf_squeeze_answer *answer, enf_error *error);

/// What the cuts leave of a window; false: nothing.
bool enf_squeeze_window(enf_window *window, const enf_separators *cuts);

#endif
