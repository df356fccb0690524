// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/world_views.h"

#include "base/array.h"
#include "visibility/view_cone.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    DEPTH_MOST = 200, ///< leafs in a row
    AIMS = 3          ///< lines at a body, from one point through one window
};

typedef struct viewer {
    enf_world_lines *lines;
    const enf_portal_graph *leafs;
    const enf_bodies *bodies;
    const enf_pvs *claimed;
    enf_shapes shapes; ///< of the leafs' openings
    int32_t cell;      ///< that is looked from
    double eye[3];
    int64_t most;
} viewer;

/// A random point of a body: a mean of its corners, often near one of them.
static void mix_corners(viewer *viewer, int32_t body, double point[3]) {
    const enf_bodies *bodies = viewer->bodies;
    const int32_t first = bodies->corner_first[body], count = bodies->corner_first[body + 1] - first;
    const double power = 1 + 15 * enf_world_lines_share(viewer->lines);
    double sum = 0;
    memset(point, 0, 3 * sizeof *point);
    for (int32_t i = first; i < first + count; i++) {
        const double weight = pow(enf_world_lines_share(viewer->lines), power) + 1e-9;
        sum += weight;
        for (int axis = 0; axis < 3; axis++) point[axis] += weight * bodies->corners[i][axis];
    }
    for (int axis = 0; axis < 3; axis++) point[axis] /= sum;
}

/// A random point of the window.
static void mix_window(viewer *viewer, const enf_window *window, double point[3]) {
    double sum = 0;
    memset(point, 0, 3 * sizeof *point);
    for (int32_t i = 0; i < window->count; i++) {
        const double weight = enf_world_lines_share(viewer->lines);
        sum += weight;
        for (int axis = 0; axis < 3; axis++) point[axis] += weight * window->at[axis][i];
    }
    for (int axis = 0; axis < 3; axis++) point[axis] /= sum;
}

/// Aims at a body behind the window until a line shows its cell.
static void aim(viewer *viewer, const enf_separators *cone, const enf_window *window, int32_t body) {
    const int32_t cell = viewer->bodies->owner[body];
    enf_line line;
    memcpy(line.from, viewer->eye, sizeof line.from);
    for (int k = 0; k < AIMS && !enf_pvs_get(&viewer->lines->seen, viewer->cell, cell); k++) {
        mix_corners(viewer, body, line.to);
        if (!enf_view_cone_has(cone, line.to)) mix_window(viewer, window, line.to);
        enf_world_lines_follow(viewer->lines, &line, viewer->cell);
    }
}

// NOLINTNEXTLINE(misc-no-recursion): from leaf to leaf, DEPTH_MOST at most
static void look(viewer *viewer, int32_t via, const enf_window *window, int depth) {
    const enf_portal_graph *leafs = viewer->leafs;
    const enf_bodies *bodies = viewer->bodies;
    const int32_t leaf = enf_portal_to(leafs, via);
    enf_separators cone;
    enf_window next;
    if (depth == DEPTH_MOST || viewer->lines->count >= viewer->most) return;
    enf_view_cone_find(&cone, viewer->eye, window, via);
    for (int32_t body = bodies->cell_first[leaf]; body < bodies->cell_first[leaf + 1]; body++) {
        const int32_t cell = bodies->owner[body], first = bodies->corner_first[body];
        if (!enf_pvs_get(viewer->claimed, viewer->cell, cell)) continue;
        if (enf_pvs_get(&viewer->lines->seen, viewer->cell, cell)) continue;
        if (enf_separators_meet(&cone, bodies->middle[body], bodies->half[body],
                                (const double(*)[3])(bodies->corners + first),
                                bodies->corner_first[body + 1] - first))
            aim(viewer, &cone, window, body);
    }
    for (int32_t k = leafs->cell_portal[leaf]; k < leafs->cell_portal[leaf + 1]; k++) {
        const int32_t portal = leafs->cell_portals[k];
        if (portal == (via ^ 1) || enf_shape_height(&viewer->shapes, portal, viewer->eye) >= 0) continue;
        if (enf_separators_pass(&cone, &viewer->shapes, portal, &next) != ENF_REMAINS_NOTHING)
            look(viewer, portal, &next, depth + 1);
    }
}

/// From a random point of one of the cell's bodies.
static void look_around(viewer *viewer) {
    const enf_portal_graph *leafs = viewer->leafs;
    const enf_bodies *bodies = viewer->bodies;
    const int32_t first = bodies->owner_first[viewer->cell],
                  count = bodies->owner_first[viewer->cell + 1] - first;
    const int32_t leaf = bodies->cells[first + (int32_t)(count * enf_world_lines_share(viewer->lines))];
    int32_t body = bodies->cell_first[leaf];
    while (bodies->owner[body] != viewer->cell) body++;
    mix_corners(viewer, body, viewer->eye);
    for (int32_t k = leafs->cell_portal[leaf]; k < leafs->cell_portal[leaf + 1]; k++) {
        const int32_t portal = leafs->cell_portals[k];
        enf_window window;
        if (enf_shape_height(&viewer->shapes, portal, viewer->eye) >= 0) continue;
        enf_shape_window(&viewer->shapes, portal, &window);
        look(viewer, portal, &window, 0);
    }
}

/// How many of the cell's claims have not been seen; `after` it only.
static int64_t count_unseen(const viewer *viewer, int32_t after) {
    int64_t count = 0;
    for (int32_t other = after; other < viewer->claimed->cell_count; other++)
        count += enf_pvs_get(viewer->claimed, viewer->cell, other) &&
                 !enf_pvs_get(&viewer->lines->seen, viewer->cell, other);
    return count;
}

int64_t enf_world_views_aim(enf_world_lines *lines, const enf_world_air *air, const enf_pvs *claimed,
                            int points, int64_t most, bool *good) {
    viewer viewer = {
        .lines = lines, .leafs = &air->leafs, .bodies = &air->parts.bodies, .claimed = claimed, .most = most};
    int64_t pairs = 0;
    *good = !air->uses_leafs || enf_shapes_make(&viewer.shapes, &air->leafs);
    for (int32_t cell = 0; *good && air->uses_leafs && cell < claimed->cell_count; cell++) {
        viewer.cell = cell;
        pairs += count_unseen(&viewer, cell + 1);
        if (viewer.bodies->owner_first[cell] == viewer.bodies->owner_first[cell + 1]) continue;
        for (int k = 0; k < points && lines->count < most && count_unseen(&viewer, 0) > 0; k++)
            look_around(&viewer);
    }
    if (air->uses_leafs) enf_shapes_free(&viewer.shapes);
    return pairs;
}
