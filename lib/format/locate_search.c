// SPDX-License-Identifier: MIT
// Boxes around tetrahedra give the candidates. For points that no walk has found.
#include "format/locate_point.h"
#include "format/locate_star.h"

#include <math.h>

static bool box_holds(const enf_file_box *box, const double at[3]) {
    return at[0] >= box->min[0] && at[0] <= box->max[0] && at[1] >= box->min[1] && at[1] <= box->max[1] &&
           at[2] >= box->min[2] && at[2] <= box->max[2];
}

/// A walk along the boxes that hold a point.
typedef struct search {
    const enf_file_view *view;
    double grid[3];
    int32_t next;             ///< box
    int32_t tetrahedron, end; ///< left of a leaf
} search;

static search search_for(const enf_locating *point) {
    search search = {.view = point->view};
    for (int a = 0; a < 3; a++) search.grid[a] = point->at[a] / point->view->frame->locate_scale;
    return search;
}

/// The next tetrahedron of a leaf whose box holds the point; -1: none.
static int32_t next_candidate(search *search) {
    while (search->tetrahedron == search->end && search->next < search->view->box_count) {
        const enf_file_box *box = &search->view->boxes[search->next];
        bool inside = box_holds(box, search->grid);
        search->next = inside ? search->next + 1 : box->next;
        if (!inside || box->tetrahedron < 0) continue;
        search->tetrahedron = box->tetrahedron;
        search->end = enf_file_box_end(box, search->view->tetrahedron_count);
    }
    return search->tetrahedron < search->end ? search->tetrahedron++ : -1;
}

void enf_locating_search(enf_locating *point) {
    search search = search_for(point);
    int32_t tetrahedron;
    while ((tetrahedron = next_candidate(&search)) >= 0) {
        int away, side = enf_locating_side(point, tetrahedron, 0, 0, &away);
        if (side >= 0) enf_locating_descend(point, tetrahedron);
        if (side > 0) return;
    }
}

// --- Outside by rounding
// -----------------------------------------------------------------------------------------------------
// A triangle lies along its longest edge here, so that even the distance to a needle is off by little more
// than coordinates are.

typedef struct spread {
    double along[3], across[3]; ///< directions of length 1: of the longest edge; from it to the third corner
    double length, shift, height; ///< of the edge; where along it the third corner is, and how far from it
} spread;

/// Of three corners, seen from the point, the first two of which are to be the ends of the longest edge.
/// False if all three lie on a line.
static bool spread_out(const double corner[3][3], spread *out) {
    double edge[3], arm[3];
    for (int a = 0; a < 3; a++) {
        edge[a] = corner[1][a] - corner[0][a];
        arm[a] = corner[2][a] - corner[0][a];
    }
    out->length = sqrt(enf_locating_dot(edge, edge));
    if (!(out->length > 0)) return false;
    for (int a = 0; a < 3; a++) out->along[a] = edge[a] / out->length;
    out->shift = enf_locating_dot(arm, out->along);
    for (int a = 0; a < 3; a++) arm[a] -= out->shift * out->along[a];
    out->height = sqrt(enf_locating_dot(arm, arm));
    if (!(out->height > 0)) return false;
    for (int a = 0; a < 3; a++) out->across[a] = arm[a] / out->height;
    return true;
}

static double distance_to_edge(const double from[3], const double to[3]) {
    double along[3], share = 0, square = 0;
    for (int a = 0; a < 3; a++) along[a] = to[a] - from[a];
    double length = enf_locating_dot(along, along);
    if (length > 0) share = fmax(0, fmin(-enf_locating_dot(along, from) / length, 1));
    for (int a = 0; a < 3; a++) {
        double off = from[a] + share * along[a];
        square += off * off;
    }
    return sqrt(square);
}

/// From the point to the triangle of three corners, the first two of which are the ends of the longest edge.
static double distance_to_triangle(const double corner[3][3]) {
    double least = INFINITY;
    for (int k = 0; k < 3; k++) least = fmin(least, distance_to_edge(corner[k], corner[(k + 1) % 3]));
    spread s;
    if (!spread_out(corner, &s)) return least;
    double off[3], t = -enf_locating_dot(corner[0], s.along);
    for (int a = 0; a < 3; a++) off[a] = -corner[0][a] - t * s.along[a];
    double h = enf_locating_dot(off, s.across);
    bool inside =
        h >= 0 && h * s.shift <= t * s.height && h * (s.length - s.shift) <= (s.length - t) * s.height;
    if (!inside) return least;
    for (int a = 0; a < 3; a++) off[a] -= h * s.across[a];
    return fmin(least, sqrt(enf_locating_dot(off, off)));
}

/// The corners of a face as seen from the point, the longest edge first.
static void load_face(const enf_locating *point, int32_t tetrahedron, int face, double corner[3][3]) {
    const int32_t *corners = point->view->tetrahedra[tetrahedron];
    double at[3][3], longest = -1;
    int first = 0;
    for (int k = 0; k < 3; k++) enf_locating_relative(point, corners[enf_face_corner[face][k]], at[k]);
    for (int k = 0; k < 3; k++) {
        double edge[3];
        for (int a = 0; a < 3; a++) edge[a] = at[(k + 1) % 3][a] - at[k][a];
        double length = enf_locating_dot(edge, edge);
        if (length <= longest) continue;
        longest = length;
        first = k;
    }
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) corner[k][a] = at[(first + k) % 3][a];
}

/// From a point outside to the tetrahedron, grid steps.
static double outside_distance(const enf_locating *point, int32_t tetrahedron) {
    double least = INFINITY, corner[3][3];
    for (int face = 0; face < 4; face++) {
        load_face(point, tetrahedron, face, corner);
        least = fmin(least, distance_to_triangle((const double(*)[3])corner));
    }
    return least / point->view->frame->locate_scale;
}

bool enf_locating_is_far(const enf_locating *point, int32_t tetrahedron, int face) {
    double corner[3][3], off[3], most = 0;
    spread s;
    load_face(point, tetrahedron, face, corner);
    if (!spread_out((const double(*)[3])corner, &s)) return false;
    double t = -enf_locating_dot(corner[0], s.along);
    for (int a = 0; a < 3; a++) off[a] = -corner[0][a] - t * s.along[a];
    double h = enf_locating_dot(off, s.across);
    for (int a = 0; a < 3; a++) {
        off[a] -= h * s.across[a];
        most = fmax(most, fabs(corner[0][a]));
    }
    double rounded = 0x1p-48 * (most + s.length) * (1 + (s.length + fabs(h)) / s.height);
    return sqrt(enf_locating_dot(off, off)) - rounded >
           2 * point->view->frame->locate_rounding * point->view->frame->locate_scale;
}

typedef struct nearest {
    double distance;
    int32_t tetrahedron; ///< -1: none
} nearest;

/// The nearer one, then the lower number.
static void challenge(nearest *best, double distance, int32_t tetrahedron) {
    if (distance > best->distance ||
        (distance == best->distance && best->tetrahedron >= 0 && tetrahedron > best->tetrahedron))
        return;
    *best = (nearest){distance, tetrahedron};
}

void enf_locating_search_nearest(enf_locating *point) {
    nearest best = {point->view->frame->locate_rounding, -1};
    search search = search_for(point);
    int32_t tetrahedron;
    while ((tetrahedron = next_candidate(&search)) >= 0)
        challenge(&best, outside_distance(point, tetrahedron), tetrahedron);
    if (best.tetrahedron >= 0) enf_locating_descend(point, best.tetrahedron);
}

/// The hull and a ball around the point are convex, so the tetrahedra that they share hang together by faces.
bool enf_locating_nearest(enf_locating *point, int32_t tetrahedron) {
    nearest best = {point->view->frame->locate_rounding, -1};
    enf_star star;
    enf_star_begin(&star);
    enf_star_add(&star, tetrahedron);
    const double ball = outside_distance(point, tetrahedron) + point->view->frame->locate_rounding;
    for (int i = 0; i < star.count; i++) {
        double distance = outside_distance(point, star.list[i]);
        if (distance > ball) continue;
        challenge(&best, distance, star.list[i]);
        for (int face = 0; face < 4; face++) {
            int32_t next = point->view->tetrahedron_next[star.list[i]][face];
            if (next >= 0 && !enf_star_add(&star, next)) return false;
        }
    }
    if (best.tetrahedron >= 0) enf_locating_descend(point, best.tetrahedron);
    return true;
}
