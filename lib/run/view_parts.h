// SPDX-License-Identifier: MIT
// The insides of a view.
#ifndef ENF_RUN_VIEW_PARTS_H
#define ENF_RUN_VIEW_PARTS_H

#include "run/view_clip.h"
#include "run/view_queue.h"
#include "run/view_seen.h"
#include "run/view_space.h"

/// Nearer to a polygon than this share of the world's size, an eye looks through the whole of it. Corners are
/// rounded to 2^-53 of the size; at this distance that is 1e-9 on a screen of 90 degrees, a thousandth of the
/// slack.
#define ENF_VIEW_NEAR_SHARE 1e-7

enum { ENF_VIEW_PIECES = 16 }; ///< of a portal, that are joined if they make one region

struct enf_view {
    const enf_world *world;
    const enf_file_view *file;
    enf_view_options options; ///< defaults filled in
    double reach;             ///< the largest coordinate, world units
    enf_view_queue queue;
    enf_view_seen seen;
    enf_view_spaces spaces;
    int32_t hint; ///< tetrahedron of the eye
    int32_t entry_capacity;
    enf_view_entry *entries;
    int32_t *order; ///< entry -> visit
    enf_visible visible;

    // Of the run that goes on.
    const enf_instance *instance;
    const enf_camera *camera;
    bool use_seen;
    double pixels; ///< of a unit of area

    // Of the portal that is looked at.
    enf_view_piece pieces[ENF_VIEW_PIECES]; ///< what is seen of its polygons
    int32_t piece_count;
    bool is_whole; ///< some polygon lets the region pass as it is
    double corners[ENF_VIEW_CORNERS][2];
    enf_view_region region; ///< under construction
    double region_corners[ENF_VIEW_EDGES_MAX][2];
    enf_view_line region_lines[ENF_VIEW_LINES];
};

/// Looks from the eye's cell on, until nothing waits. False: capacity ran out.
bool enf_view_walk(enf_view *view, int32_t cell);

#endif
