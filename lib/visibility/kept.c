// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/kept.h"

#include "base/array.h"
#include "visibility/hull.h"

#include <stdlib.h>

enum { GROWTHS_MOST = 8 }; ///< how often a window may grow before it becomes the whole outline

bool enf_kept_make(enf_kept *kept, const enf_shapes *shapes) {
    const size_t portals = 2 * (size_t)shapes->graph->opening_count;
    kept->shapes = shapes;
    kept->window_count = 0;
    kept->beams = enf_array_zeroed(portals, sizeof *kept->beams);
    kept->windows = enf_array_new(portals, sizeof *kept->windows);
    return kept->beams && kept->windows;
}

void enf_kept_free(enf_kept *kept) {
    free(kept->beams);
    free(kept->windows);
}

enf_outline enf_kept_outline(const enf_kept *kept, int32_t portal) {
    const enf_kept_beam *beam = &kept->beams[portal];
    if (beam->is_whole) return enf_shape_outline(kept->shapes, portal >> 1);
    const enf_kept_window *window = &kept->windows[beam->window];
    return (enf_outline){beam->count, {window->at[0], window->at[1], window->at[2]}};
}

static void keep(enf_kept *kept, int32_t portal, const enf_window *window, enf_remains remains) {
    enf_kept_beam *beam = &kept->beams[portal];
    beam->is_whole =
        remains == ENF_REMAINS_WHOLE || window->count > ENF_KEPT_CORNERS || beam->growths >= GROWTHS_MOST;
    if (beam->is_whole) return;
    if (beam->window < 0) beam->window = kept->window_count++;
    beam->count = (int16_t)window->count;
    for (int axis = 0; axis < 3; axis++)
        enf_outline_copy(kept->windows[beam->window].at[axis], window->at[axis], window->count);
}

void enf_kept_begin(enf_kept *kept, int32_t portal, const enf_window *window, enf_remains remains) {
    enf_kept_beam *beam = &kept->beams[portal];
    beam->window = -1;
    beam->growths = 0;
    keep(kept, portal, window, remains);
}

bool enf_kept_grow(enf_kept *kept, int32_t portal, const enf_window *window, enf_remains remains) {
    enf_kept_beam *beam = &kept->beams[portal];
    const enf_shape *shape = &kept->shapes->shapes[portal >> 1];
    if (beam->count + window->count > ENF_WINDOW_MOST) remains = ENF_REMAINS_WHOLE;
    if (remains != ENF_REMAINS_WHOLE) {
        const enf_outline outline = enf_kept_outline(kept, portal), other = enf_window_outline(window);
        enf_window_take(&kept->merged, &outline);
        if (!enf_hull_extend(&kept->merged, &other, shape->axes, kept->shapes->tolerance)) return false;
        beam->growths++;
    }
    keep(kept, portal, &kept->merged, remains);
    return true;
}
