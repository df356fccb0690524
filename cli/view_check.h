// SPDX-License-Identifier: GPL-3.0-or-later
// Does a view list what rays from the eye hit?
#ifndef ENF_CLI_VIEW_CHECK_H
#define ENF_CLI_VIEW_CHECK_H

#include "cli/first_hit.h"
#include "enfilade/view.h"

/// A camera with its axes: a ray through (x, y) of the screen goes along forward + x right + y up.
typedef struct check_camera {
    enf_camera camera;
    double forward[3], right[3], up[3];
    enf_place place;
} check_camera;

typedef struct view_check {
    const enf_world *world;
    const enf_file_view *view;
    first_hit_scene scene;
    int32_t *triangle_first; ///< triangle_count + 1 offsets into triangle_cells
    int32_t *triangle_cells; ///< the cells that have each triangle
    uint64_t seed;
    int64_t rays, hits, backs, lost,
        elsewhere;    ///< elsewhere: from an eye on a wall into a
                      ///< cell that no portal at the eye links with its own
    int64_t unlisted; ///< the ray's last cell is in view, but has not the triangle in its list
    int64_t seams;    ///< it only hits because triangles are taken a hair larger
    int64_t missed_cells, missed_regions;
    bool talks; ///< about misses
} view_check;

enf_status view_check_create(view_check *check, const enf_world *world, uint64_t seed, enf_error *error);
void view_check_free(view_check *check);

/// Looks from `eye` in a random direction, tilted; false if it is in no cell.
bool view_check_look(view_check *check, const double eye[3], check_camera *camera);

/// A random eye in a cell.
bool view_check_random(view_check *check, check_camera *camera);

/// An eye on a portal: kind 0 corner, 1 edge, 2 polygon, 3 near a corner, 4 near a polygon.
bool view_check_on_portal(view_check *check, int kind, check_camera *camera);

void view_check_direction(const check_camera *camera, double x, double y, double direction[3]);

/// Casts rays through random pixels. Returns the number of misses.
int64_t view_check_rays(view_check *check, const check_camera *camera, const enf_visible *visible, int rays);

/// Is a point of the screen in an entry's region?
bool view_check_covers(const enf_view_entry *entry, double x, double y);

#endif
