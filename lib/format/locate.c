// SPDX-License-Identifier: MIT
// Point location: boxes around tetrahedra give the candidates, four sides decide each, and the tree of cuts
// inside a tetrahedron gives the fine cell. All sides are exact, so a point on a boundary is *known* to be on
// it, and the rule for boundaries (run.h) can be kept to the letter.
//
// A hint, the tetrahedron of an earlier answer, is tried first, or one from a grid of bricks (E. P. Muecke,
// I. Saias, B. Zhu, "Fast randomized point location without preprocessing", 1996, is where the idea of good
// starts comes from), then a walk from it towards the point across faces (O. Devillers, S. Pion, M. Teillaud,
// "Walking in a triangulation", 2002), for a bounded number of steps.
#include "format/locate.h"

#include "base/exact.h"
#include "format/frame.h"
#include "format/round.h"

#include <math.h>

#define WALK_STEPS_MAX 24
#define HINT_STEPS_MAX 8 // where bricks have another start
#define BRANCHES_MAX \
    64 // cut planes of one tetrahedron that go through the point; more are not followed twice

/// A determinant of four points of the finer grid is not off by more (base/exact.c).
#define SURE 0x1p115

typedef struct query {
    const enf_file_view *view;
    double at[3]; ///< whole numbers of the finer grid: grid coordinates times frame->locate_scale
    int32_t best; ///< fine cell, or -1
    int32_t best_tetrahedron;
} query;

// Corner k is opposite to the face with these corners, which turn counter-clockwise seen from inside.
static const int face_corner[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};

static void load_point(const query *query, int32_t point, double out[3]) {
    const double *from = query->view->points[point], scale = query->view->frame->locate_scale;
    for (int a = 0; a < 3; a++) out[a] = from[a] * scale;
}

/// As load_point, seen from the point that is asked for.
static void load_relative(const query *query, int32_t point, double out[3]) {
    const double *from = query->view->points[point], scale = query->view->frame->locate_scale;
    for (int a = 0; a < 3; a++) out[a] = from[a] * scale - query->at[a];
}

/// How the point lies to the plane through three others, by the volume that they span as seen from it if that
/// leaves no doubt.
static int side_of(const query *query, const int32_t through[3], double volume) {
    if (fabs(volume) > SURE) return volume < 0 ? 1 : -1;
    double a[3], b[3], c[3];
    load_point(query, through[0], a);
    load_point(query, through[1], b);
    load_point(query, through[2], c);
    return enf_points_orient(a, b, c, query->at);
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/// +1 strictly inside the tetrahedron, 0 on its boundary, -1 outside. *away: a face that has the point
/// outside. `behind`: a face that is known to have it inside; -1: none.
static int tetrahedron_side(const query *query, int32_t tetrahedron, int behind, int *away) {
    const int32_t *corners = query->view->tetrahedra[tetrahedron];
    double at[4][3], one[3], other[3];
    int least = 1;
    for (int k = 0; k < 4; k++) load_relative(query, corners[k], at[k]);
    cross(at[2], at[3], one);
    cross(at[0], at[1], other);
    const double volume[4] = {-dot(at[1], one), dot(at[0], one), -dot(at[3], other), dot(at[2], other)};
    for (int face = 0; face < 4; face++) {
        const int *pick = face_corner[face];
        if (face == behind) continue;
        const int32_t through[3] = {corners[pick[0]], corners[pick[1]], corners[pick[2]]};
        int side = side_of(query, through, volume[face]);
        if (side < 0) {
            *away = face;
            return -1;
        }
        if (side < least) least = side;
    }
    return least;
}

static int plane_side(const query *query, int32_t plane) {
    const int32_t *through = query->view->planes[plane];
    double a[3], b[3], c[3], across[3];
    if (through[2] >= 0) {
        load_relative(query, through[0], a);
        load_relative(query, through[1], b);
        load_relative(query, through[2], c);
        cross(b, c, across);
        return side_of(query, through, dot(a, across));
    }
    // One step of the finer grid along the axis, or against it at the very edge of the range.
    int axis = -1 - through[2];
    load_point(query, through[0], a);
    load_point(query, through[1], b);
    for (int i = 0; i < 3; i++) c[i] = a[i];
    double step = a[axis] < 0 ? 1 : -1;
    c[axis] += step;
    return enf_points_orient(a, b, c, query->at) * (int)step;
}

/// Cells before discarded space, then the lower number.
static void consider(query *query, int32_t tetrahedron, int32_t fine) {
    const int32_t *cell = query->view->fine_cell;
    int32_t best = query->best;
    if (best < 0 || (cell[fine] >= 0) > (cell[best] >= 0) ||
        ((cell[fine] >= 0) == (cell[best] >= 0) && fine < best)) {
        query->best = fine;
        query->best_tetrahedron = tetrahedron;
    }
}

/// Considers every fine cell of the tetrahedron that touches the point. True if there is one only.
static bool descend(query *query, int32_t tetrahedron) {
    const enf_file_view *view = query->view;
    int32_t waiting[BRANCHES_MAX];
    int count = 0;
    bool single = true;
    waiting[count++] = view->tetrahedron_root[tetrahedron];
    while (count > 0) {
        int32_t node = waiting[--count];
        while (node >= 0) {
            int side = plane_side(query, view->node_plane[node]);
            if (side == 0) {
                single = false;
                if (count < BRANCHES_MAX) waiting[count++] = view->node_child[node][0];
            }
            node = view->node_child[node][side >= 0];
        }
        consider(query, tetrahedron, -1 - node);
    }
    return single;
}

/// The face of a tetrahedron that another one lies behind; -1: none.
static int face_to(const enf_file_view *view, int32_t tetrahedron, int32_t other) {
    const int32_t *next = view->tetrahedron_next[tetrahedron];
    for (int face = 0; face < 4; face++)
        if (next[face] == other) return face;
    return -1;
}

typedef enum outcome { FOUND, ON_BORDER, LOST } outcome;

/// The walk from a hint. FOUND if it ended strictly inside a fine cell; otherwise nothing has been found.
static outcome walk(query *query, int32_t hint, int steps) {
    const enf_file_view *view = query->view;
    int32_t tetrahedron = hint;
    int behind = -1;
    for (int step = 0; step < steps && tetrahedron >= 0; step++) {
        int away = 0, side = tetrahedron_side(query, tetrahedron, behind, &away);
        if (side > 0) {
            if (descend(query, tetrahedron)) return FOUND;
            query->best = -1;
            return ON_BORDER;
        }
        if (side == 0) return ON_BORDER;
        int32_t next = view->tetrahedron_next[tetrahedron][away];
        behind = next >= 0 ? face_to(view, next, tetrahedron) : -1;
        tetrahedron = next;
    }
    return LOST;
}

/// A tetrahedron not far from the point; -1: unknown.
static int32_t find_start(const query *query) {
    const enf_file_view *view = query->view;
    const enf_file_start *start = view->start;
    if (!start) return -1;
    int64_t brick = 0;
    for (int a = 0; a < 3; a++) {
        double along = (query->at[a] / view->frame->locate_scale - start->origin[a]) * start->per_step[a];
        int32_t last = start->count[a] - 1;
        brick = brick * start->count[a] + (!(along > 0) ? 0 : along < last ? (int32_t)along : last);
    }
    return view->start_tetrahedra[brick];
}

static bool box_holds(const enf_file_box *box, const double at[3]) {
    return at[0] >= box->min[0] && at[0] <= box->max[0] && at[1] >= box->min[1] && at[1] <= box->max[1] &&
           at[2] >= box->min[2] && at[2] <= box->max[2];
}

static void search(query *query) {
    const enf_file_view *view = query->view;
    double grid[3];
    for (int a = 0; a < 3; a++) grid[a] = query->at[a] / view->frame->locate_scale;
    for (int32_t i = 0; i < view->box_count;) {
        const enf_file_box *box = &view->boxes[i];
        if (!box_holds(box, grid)) {
            i = box->next;
            continue;
        }
        i++;
        if (box->tetrahedron < 0) continue;
        int away, side = tetrahedron_side(query, box->tetrahedron, -1, &away);
        if (side >= 0) descend(query, box->tetrahedron);
        if (side > 0) return;
    }
}

static double distance_to_segment(const double point[3], const double from[3], const double to[3]) {
    double along[3], off[3], length = 0, share = 0, square = 0;
    for (int a = 0; a < 3; a++) {
        along[a] = to[a] - from[a];
        off[a] = point[a] - from[a];
        length += along[a] * along[a];
        share += along[a] * off[a];
    }
    share = length > 0 ? fmax(0, fmin(share / length, 1)) : 0;
    for (int a = 0; a < 3; a++) square += (off[a] - share * along[a]) * (off[a] - share * along[a]);
    return sqrt(square);
}

/// The point is at least so far from a tetrahedron, by its longest edge and how far the others reach from it.
/// For needles, whose rounded faces may face anywhere.
static double needle_distance(const query *query, int32_t tetrahedron) {
    double corner[4][3], longest = -1, width = 0;
    int from = 0, to = 0;
    for (int k = 0; k < 4; k++) load_point(query, query->view->tetrahedra[tetrahedron][k], corner[k]);
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < i; k++) {
            double length = distance_to_segment(corner[i], corner[k], corner[k]);
            if (length <= longest) continue;
            longest = length;
            from = i;
            to = k;
        }
    }
    for (int k = 0; k < 4; k++) width = fmax(width, distance_to_segment(corner[k], corner[from], corner[to]));
    return distance_to_segment(query->at, corner[from], corner[to]) - width;
}

/// How far (grid steps, rounded) the point lies outside the tetrahedron, by the face that is violated most.
static double outside_distance(const query *query, int32_t tetrahedron) {
    double most = fmax(0, needle_distance(query, tetrahedron));
    for (int face = 0; face < 4; face++) {
        double corner[3][3], normal[3];
        for (int k = 0; k < 3; k++)
            load_point(query, query->view->tetrahedra[tetrahedron][face_corner[face][k]], corner[k]);
        for (int a = 0; a < 3; a++) {
            int b = (a + 1) % 3, c = (a + 2) % 3;
            normal[a] = (corner[1][b] - corner[0][b]) * (corner[2][c] - corner[0][c]) -
                        (corner[1][c] - corner[0][c]) * (corner[2][b] - corner[0][b]);
        }
        double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]), sum = 0;
        for (int a = 0; a < 3; a++) sum -= normal[a] * (query->at[a] - corner[0][a]);
        if (length > 0 && sum / length > most) most = sum / length;
    }
    return most / query->view->frame->locate_scale;
}

/// No tetrahedron holds the point, but it may lie outside the hull by rounding only: take the nearest.
static void search_nearest(query *query) {
    const enf_file_view *view = query->view;
    double grid[3], nearest = view->frame->locate_rounding;
    int32_t found = -1;
    for (int a = 0; a < 3; a++) grid[a] = query->at[a] / view->frame->locate_scale;
    for (int32_t i = 0; i < view->box_count;) {
        const enf_file_box *box = &view->boxes[i];
        bool inside = box_holds(box, grid);
        i = inside ? i + 1 : box->next;
        if (!inside || box->tetrahedron < 0) continue;
        double distance = outside_distance(query, box->tetrahedron);
        if (distance > nearest || (distance == nearest && found >= 0 && box->tetrahedron > found)) continue;
        nearest = distance;
        found = box->tetrahedron;
    }
    if (found >= 0) descend(query, found);
}

enf_place enf_view_locate(const enf_file_view *view, const double point[3], int32_t hint) {
    double grid[3];
    enf_view_to_grid(view, point, grid);
    return enf_view_locate_grid(view, grid, hint);
}

enf_place enf_view_locate_grid(const enf_file_view *view, const double grid[3], int32_t hint) {
    const enf_place nowhere = {-1, -1, -1, -1, ENF_WORLD_OUTSIDE};
    query query = {.view = view, .best = -1, .best_tetrahedron = -1};
    for (int a = 0; a < 3; a++) {
        double scaled = grid[a] * view->frame->locate_scale;
        if (!(fabs(scaled) <= ENF_FILE_GRID_MAX)) return nowhere;
        query.at[a] = enf_round(scaled);
    }
    outcome outcome = LOST;
    if (hint >= 0 && hint < view->tetrahedron_count)
        outcome = walk(&query, hint, view->start ? HINT_STEPS_MAX : WALK_STEPS_MAX);
    int32_t start = outcome == LOST ? find_start(&query) : -1;
    if (start >= 0) outcome = walk(&query, start, WALK_STEPS_MAX);
    if (outcome != FOUND) search(&query);
    if (query.best < 0) search_nearest(&query);
    if (query.best < 0) return nowhere;
    int32_t region = view->fine_region[query.best];
    enf_place place = {view->fine_cell[query.best], query.best, region, query.best_tetrahedron,
                       ENF_WORLD_AIR};
    place.kind = (enf_world_kind)view->regions[region].kind;
    return place;
}
