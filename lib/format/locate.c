// SPDX-License-Identifier: MIT
// Point location: a walk ends at the tetrahedron that holds the point, and the tree of cuts inside it gives
// the fine cell. All sides are exact, so a point on a boundary is *known* to be on it, and the rule for
// boundaries (run.h) can be kept to the letter.
//
// The walk begins at a hint, the tetrahedron of an earlier answer, or one from a grid of bricks (E. P.
// Muecke, I. Saias, B. Zhu, "Fast randomized point location without preprocessing", 1996, is where the idea
// of good starts comes from) and goes towards the point across faces (O. Devillers, S. Pion, M. Teillaud,
// "Walking in a triangulation", 2002). Where it leaves the hull, which is convex, the point is outside. It
// takes a bounded number of steps; should they not be enough, all tetrahedra are searched.
#include "format/locate.h"

#include "format/frame.h"
#include "format/locate_point.h"
#include "format/round.h"

#include <math.h>
#include <string.h>

#define WALK_STEPS_MAX 256
#define HINT_STEPS_MAX 8   // where bricks have another start
#define STEPS_PER_ORDER 16 // then faces are tried in another order: a walk may turn in circles

/// The face of a tetrahedron that another one lies behind; -1: none.
static int face_to(const enf_file_view *view, int32_t tetrahedron, int32_t other) {
    const int32_t *next = view->tetrahedron_next[tetrahedron];
    for (int face = 0; face < 4; face++)
        if (next[face] == other) return face;
    return -1;
}

typedef enum outcome {
    INSIDE,
    ON_BORDER,
    NEAR_HULL, ///< outside the hull, perhaps by rounding only
    OUTSIDE,
    LOST
} outcome;

/// Where a walk has ended.
typedef struct stop {
    outcome outcome;
    int32_t tetrahedron;
} stop;

/// A face of the hull that the point is hardly outside of counts as having it inside: the walk goes on, and
/// ends below the point.
static stop walk(const enf_locating *point, int32_t from, int steps) {
    const enf_file_view *view = point->view;
    stop at = {LOST, from};
    int known = 0;
    bool is_outside = false;
    for (int step = 0; step < steps; step++) {
        int away, side = enf_locating_side(point, at.tetrahedron, known, step / STEPS_PER_ORDER, &away);
        if (side >= 0) {
            at.outcome = is_outside ? NEAR_HULL : side > 0 ? INSIDE : ON_BORDER;
            return at;
        }
        int32_t next = view->tetrahedron_next[at.tetrahedron][away];
        if (next >= 0) {
            int behind = face_to(view, next, at.tetrahedron);
            known = behind >= 0 ? 1 << behind : 0;
            at.tetrahedron = next;
        } else if (enf_locating_is_far(point, at.tetrahedron, away)) {
            at.outcome = OUTSIDE;
            return at;
        } else {
            is_outside = true;
            known |= 1 << away;
        }
    }
    return at;
}

/// A tetrahedron not far from the point; -1: unknown. Earlier compilers left bricks outside of the hull
/// empty: then one on the way to the middle.
static int32_t find_start(const enf_locating *point) {
    const enf_file_view *view = point->view;
    const enf_file_start *start = view->start;
    if (!start) return -1;
    int32_t brick[3], middle[3];
    for (int a = 0; a < 3; a++) {
        double along = (point->at[a] / view->frame->locate_scale - start->origin[a]) * start->per_step[a];
        int32_t last = start->count[a] - 1;
        brick[a] = !(along > 0) ? 0 : along < last ? (int32_t)along : last;
        middle[a] = last / 2;
    }
    for (;;) {
        int64_t row = (int64_t)brick[0] * start->count[1] + brick[1];
        int32_t found = view->start_tetrahedra[row * start->count[2] + brick[2]];
        if (found >= 0 || memcmp(brick, middle, sizeof brick) == 0) return found;
        for (int a = 0; a < 3; a++) brick[a] = middle[a] + (brick[a] - middle[a]) / 2;
    }
}

/// A walk from the hint; if that is not enough, from a brick.
static stop walk_there(const enf_locating *point, int32_t hint) {
    const enf_file_view *view = point->view;
    stop at = {LOST, -1};
    if (hint >= 0 && hint < view->tetrahedron_count)
        at = walk(point, hint, view->start ? HINT_STEPS_MAX : WALK_STEPS_MAX);
    int32_t start = at.outcome == LOST ? find_start(point) : -1;
    return start >= 0 ? walk(point, start, WALK_STEPS_MAX) : at;
}

/// Considers the fine cells that touch the point, or none if it is outside.
static void find_fine(enf_locating *point, int32_t hint) {
    stop at = walk_there(point, hint);
    if (at.outcome == INSIDE) {
        enf_locating_descend(point, at.tetrahedron);
        return;
    }
    if (at.outcome == OUTSIDE || (at.outcome == ON_BORDER && enf_locating_star(point, at.tetrahedron)) ||
        (at.outcome == NEAR_HULL && enf_locating_nearest(point, at.tetrahedron)))
        return;
    if (at.outcome != NEAR_HULL) enf_locating_search(point);
    if (point->best < 0) enf_locating_search_nearest(point);
}

/// False if it is nowhere near.
static inline bool set_point(enf_locating *point, const enf_file_view *view, const double grid[3]) {
    const double scale = view->frame->locate_scale, x = grid[0] * scale, y = grid[1] * scale,
                 z = grid[2] * scale;
    *point = (enf_locating){view, {enf_round(x), enf_round(y), enf_round(z)}, -1, -1};
    return fabs(x) <= ENF_FILE_GRID_MAX && fabs(y) <= ENF_FILE_GRID_MAX && fabs(z) <= ENF_FILE_GRID_MAX;
}

enf_place enf_view_locate(const enf_file_view *view, const double point[3], int32_t hint) {
    double grid[3];
    enf_view_to_grid(view, point, grid);
    return enf_view_locate_grid(view, grid, hint);
}

enf_place enf_view_locate_grid(const enf_file_view *view, const double grid[3], int32_t hint) {
    enf_locating point;
    if (set_point(&point, view, grid)) find_fine(&point, hint);
    if (point.best < 0) return (enf_place){-1, -1, -1, -1, ENF_WORLD_OUTSIDE};
    int32_t region = view->fine_region[point.best];
    enf_place place = {view->fine_cell[point.best], point.best, region, point.best_tetrahedron,
                       ENF_WORLD_AIR};
    place.kind = (enf_world_kind)view->regions[region].kind;
    return place;
}

int32_t enf_view_locate_near(const enf_file_view *view, const double grid[3], int32_t from) {
    enf_locating point;
    if (from < 0 || from >= view->tetrahedron_count || !set_point(&point, view, grid)) return from;
    return walk(&point, from, WALK_STEPS_MAX).tetrahedron;
}
