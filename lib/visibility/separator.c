// SPDX-License-Identifier: GPL-3.0-or-later
// Planes are found for four edges at a time.
#include "visibility/separator.h"

#include "base/four.h"
#include "visibility/contact.h"

#include <math.h>

/// Corners this near to a plane may touch it. Points of a window next to the plane, but for its tolerance,
/// are not further from those corners than 2^-14 of the window's size, or so.
static const double band_tolerances = 0x1p14;

/// Of the size of the world: what is nearer to each other than `near` are looked at closely; contacts may be
/// nearer than they look by `contact_error`, as corners within the band count for all that is near them.
static const double near = 0x1p-12, contact_error = 0x1p-30;

/// Two windows and the way between them.
typedef struct passage {
    const enf_shapes *shapes;
    const enf_outline *one, *other; ///< planes go through the edges of one
    bool turns;                     ///< one turns counter-clockwise against the sight
    bool forward;                   ///< sight goes from one to other
    bool is_second;                 ///< planes through the edges of other have been found already
    double gap;                     ///< the windows are at least this far apart; negative: no telling
    double span;                    ///< no way from corner to corner is longer, all axes summed up
} passage;

/// The planes through four edges that touch the other window, which is on their front side.
typedef struct tangents {
    enf_four normal[3];     ///< length 1
    enf_four tilt;          ///< how far the plane may move, anywhere in the world, if its corners move by 1
    enf_four behind, front; ///< the highest corner of one, the lowest of the other
    enf_four_mask good;     ///< there is such a plane, and it has one behind it
} tangents;

ENF_PART_OF_WIDE enf_four dot_four(const enf_four a[3], const enf_four b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

ENF_PART_OF_WIDE void cross_four(const enf_four a[3], const enf_four b[3], enf_four cross[3]) {
    cross[0] = a[1] * b[2] - a[2] * b[1];
    cross[1] = a[2] * b[0] - a[0] * b[2];
    cross[2] = a[0] * b[1] - a[1] * b[0];
}

/// Of the planes through an edge and a corner, the one that has no other corner behind it: from each corner
/// that is, the plane turns on to it.
ENF_PART_OF_WIDE void turn_to(const enf_outline *other, const enf_four from[3], const enf_four edge[3],
                              enf_four normal[3]) {
    enf_four way[3], next[3];
    for (int axis = 0; axis < 3; axis++) way[axis] = other->at[axis][0] - from[axis];
    cross_four(edge, way, normal);
    for (int32_t i = 1; i < other->count; i++) {
        for (int axis = 0; axis < 3; axis++) way[axis] = other->at[axis][i] - from[axis];
        cross_four(edge, way, next);
        const enf_four_mask behind = dot_four(normal, way) < 0;
        for (int axis = 0; axis < 3; axis++) normal[axis] = enf_four_choose(behind, next[axis], normal[axis]);
    }
}

ENF_PART_OF_WIDE enf_four inverse_root(enf_four square) {
    enf_four roots;
    for (int lane = 0; lane < ENF_FOUR; lane++) roots[lane] = sqrt(square[lane]);
    return 1 / roots;
}

/// The highest corner above planes through the origin.
ENF_PART_OF_WIDE enf_four highest(const enf_outline *outline, const enf_four normal[3]) {
    enf_four highest = enf_four_all(-HUGE_VAL);
    for (int32_t i = 0; i < outline->count; i++)
        highest = enf_four_max(highest, outline->at[0][i] * normal[0] + outline->at[1][i] * normal[1] +
                                            outline->at[2][i] * normal[2]);
    return highest;
}

/// The lowest corner, and the one that is next to it.
ENF_PART_OF_WIDE enf_four lowest(const enf_outline *outline, const enf_four normal[3], enf_four *second) {
    enf_four lowest = enf_four_all(HUGE_VAL);
    *second = lowest;
    for (int32_t i = 0; i < outline->count; i++) {
        const enf_four height =
            outline->at[0][i] * normal[0] + outline->at[1][i] * normal[1] + outline->at[2][i] * normal[2];
        *second = enf_four_min(*second, enf_four_max(lowest, height));
        lowest = enf_four_min(lowest, height);
    }
    return lowest;
}

ENF_PART_OF_WIDE tangents find_tangents(const passage *passage, int32_t first) {
    const int32_t from = passage->turns ? first : first + 1, to = passage->turns ? first + 1 : first;
    enf_four a[3], edge[3], normal[3];
    tangents tangents;
    for (int axis = 0; axis < 3; axis++) {
        a[axis] = enf_four_load(passage->one->at[axis] + from);
        edge[axis] = enf_four_load(passage->one->at[axis] + to) - a[axis];
    }
    turn_to(passage->other, a, edge, normal);
    const enf_four square = dot_four(normal, normal), inverse = inverse_root(square);
    for (int axis = 0; axis < 3; axis++) tangents.normal[axis] = normal[axis] * inverse;
    tangents.tilt = 2 + 4 * passage->span * passage->shapes->extent * inverse;
    tangents.behind = highest(passage->one, tangents.normal);
    enf_four second;
    tangents.front = lowest(passage->other, tangents.normal, &second);
    tangents.good = (square > 0) & (inverse < HUGE_VAL) &
                    (tangents.behind <= tangents.front + passage->shapes->tolerance);
    // Planes through edges of both, as parallel edges have them, are found from the first already.
    if (passage->is_second) tangents.good &= second > tangents.front + passage->shapes->tolerance;
    return tangents;
}

/// Which of four edges from this one on there are.
ENF_PART_OF_WIDE enf_four_mask are_edges(const enf_outline *outline, int32_t first) {
    return (enf_four_mask){0, 1, 2, 3} < (int64_t)(outline->count - first);
}

// What a plane must leave over. A point of a window may be off by the tolerance, so a line may come through
// the plane the wrong way, by that much on the way between the windows where both touch the plane, and go on
// so to the end of the world: where windows touch each other at the plane, the plane says nothing.

static double find_swing(const passage *passage, double distance) {
    return 4 * passage->shapes->extent / distance;
}

/// For windows that are near each other: how near, where they touch the plane?
static double find_slack(const passage *passage, const double normal[3], double tilt) {
    const enf_shapes *shapes = passage->shapes;
    const double distance =
        enf_contact_distance(passage->one, passage->other, normal, band_tolerances * shapes->tolerance) -
        shapes->extent * contact_error;
    return distance > 0 ? shapes->tolerance * (tilt + find_swing(passage, distance)) : HUGE_VAL;
}

static void add_cut(enf_separators *separators, const double normal[3], double least) {
    const int32_t index = separators->count++;
    for (int axis = 0; axis < 3; axis++) separators->normal[axis][index] = normal[axis];
    separators->least[index] = least;
}

/// For windows that are not far from each other.
ENF_PART_OF_WIDE void add_near_planes(enf_separators *separators, const passage *passage) {
    const enf_outline *one = passage->one;
    for (int32_t first = 0; first < one->count; first += ENF_FOUR) {
        const tangents tangents = find_tangents(passage, first);
        unsigned good = enf_four_bits(tangents.good & are_edges(one, first));
        for (; good && separators->count < ENF_SEPARATORS_MOST; good &= good - 1) {
            const int lane = __builtin_ctz(good);
            const double sign = passage->forward ? 1 : -1;
            double normal[3];
            for (int axis = 0; axis < 3; axis++) normal[axis] = tangents.normal[axis][lane];
            const double slack = find_slack(passage, normal, tangents.tilt[lane]);
            if (slack > passage->shapes->extent) continue;
            for (int axis = 0; axis < 3; axis++) normal[axis] *= sign;
            add_cut(separators, normal,
                    (passage->forward ? tangents.front[lane] : -tangents.behind[lane]) - slack);
        }
    }
}

/// Four cuts, of which those that are good are added: mostly some first ones, or all. (Not to branch between
/// others is worth it: there is no telling which they are.)
ENF_PART_OF_WIDE void add_good(enf_separators *separators, const enf_four normal[3], enf_four least,
                               enf_four_mask good) {
    int32_t index = separators->count;
    const unsigned bits = enf_four_bits(good);
    if ((bits & (bits + 1)) == 0) {
        for (int axis = 0; axis < 3; axis++) enf_four_store(separators->normal[axis] + index, normal[axis]);
        enf_four_store(separators->least + index, least);
        separators->count += __builtin_popcount(bits);
        return;
    }
    for (int lane = 0; lane < ENF_FOUR; lane++) {
        for (int axis = 0; axis < 3; axis++) separators->normal[axis][index] = normal[axis][lane];
        separators->least[index] = least[lane];
        index -= (int32_t)good[lane];
    }
    separators->count = index;
}

/// For windows that are: their distance is that of their openings.
ENF_PART_OF_WIDE void add_far_planes(enf_separators *separators, const passage *passage) {
    const enf_outline *one = passage->one;
    const double swing = find_swing(passage, passage->gap), tolerance = passage->shapes->tolerance;
    for (int32_t first = 0; first < one->count; first += ENF_FOUR) {
        if (separators->count > ENF_SEPARATORS_MOST - ENF_FOUR) return;
        tangents tangents = find_tangents(passage, first);
        const enf_four slack = tolerance * (tangents.tilt + swing);
        const enf_four_mask good = tangents.good & are_edges(one, first) & (slack <= passage->shapes->extent);
        if (!passage->forward)
            for (int axis = 0; axis < 3; axis++) tangents.normal[axis] = -tangents.normal[axis];
        add_good(separators, tangents.normal, (passage->forward ? tangents.front : -tangents.behind) - slack,
                 good);
    }
}

ENF_PART_OF_WIDE void add_planes(enf_separators *separators, const passage *passage) {
    if (passage->gap < passage->shapes->extent * near)
        add_near_planes(separators, passage);
    else
        add_far_planes(separators, passage);
}

/// The size of the box around two openings, all axes summed up.
static double find_span(const enf_shapes *shapes, int32_t portal, int32_t other) {
    const enf_shape *one = &shapes->shapes[portal >> 1], *two = &shapes->shapes[other >> 1];
    double span = 0;
    for (int axis = 0; axis < 3; axis++)
        span += fabs(one->middle[axis] - two->middle[axis]) + one->half[axis] + two->half[axis];
    return span;
}

/// How far apart the boxes around two openings are.
static double find_box_gap(const enf_shape *one, const enf_shape *two) {
    double apart[3];
    for (int axis = 0; axis < 3; axis++) {
        const double between =
            fabs(one->middle[axis] - two->middle[axis]) - one->half[axis] - two->half[axis];
        apart[axis] = between > 0 ? between : 0;
    }
    return sqrt(enf_dot(apart, apart));
}

/// How far apart two openings are at least: their spheres; where these meet, their boxes.
static double find_gap(const enf_shapes *shapes, int32_t portal, int32_t other) {
    const enf_shape *one = &shapes->shapes[portal >> 1], *two = &shapes->shapes[other >> 1];
    double way[3];
    for (int axis = 0; axis < 3; axis++) way[axis] = one->centre[axis] - two->centre[axis];
    const double gap = sqrt(enf_dot(way, way)) - one->radius - two->radius;
    return gap < shapes->extent * near ? find_box_gap(one, two) : gap;
}

void enf_separators_close(enf_separators *separators) {
    const double nowhere[3] = {0};
    const int32_t count = separators->count;
    while (separators->count % ENF_FOUR) add_cut(separators, nowhere, -HUGE_VAL);
    separators->count = count;
}

void enf_separators_begin(enf_separators *separators, const enf_shapes *shapes, int32_t from_portal) {
    const enf_cut cut = enf_shape_cut(shapes, from_portal);
    separators->count = 0;
    separators->spare = 0;
    add_cut(separators, cut.normal, cut.least);
    enf_separators_close(separators);
}

ENF_WIDE_TOO void enf_separators_between(enf_separators *separators, const enf_shapes *shapes,
                                         const enf_outline *from, int32_t from_portal, const enf_outline *to,
                                         int32_t to_portal) {
    enf_separators_begin(separators, shapes, from_portal);
    passage passage = {.shapes = shapes,
                       .one = from,
                       .other = to,
                       .turns = !(from_portal & 1),
                       .forward = true,
                       .gap = find_gap(shapes, from_portal, to_portal),
                       .span = find_span(shapes, from_portal, to_portal)};
    add_planes(separators, &passage);
    passage.one = to;
    passage.other = from;
    passage.turns = to_portal & 1;
    passage.forward = false;
    passage.is_second = true;
    add_planes(separators, &passage);
    enf_separators_close(separators);
}

void enf_separators_find(enf_separators *separators, const enf_shapes *shapes, const enf_window *from,
                         int32_t from_portal, const enf_window *to, int32_t to_portal) {
    const enf_outline one = enf_window_outline(from), two = enf_window_outline(to);
    enf_separators_between(separators, shapes, &one, from_portal, &two, to_portal);
}

// Between a body and a window it is different: what planes must leave over there is a line of each bundle,
// not each line. Take a sight line with all lines near it, as far as some radius, and move it down towards
// the plane by a tolerance: that line passes the window, too, so that the sight line passes it at least a
// tolerance above the plane. It was below or at the plane before, and so it rises, and stays that high for
// good. No error of a corner is made larger by it, however near to the body the window is. All lines around
// the sight line within a radius that is a little smaller (by three tolerances) do the same. So what planes
// have to leave begins a tolerance above them. After n windows those sights are there still that had 3n
// tolerances of room around them; those that only touch a plane, as along a wall or the edge of a step, are
// gone. (A tolerance is body_share of that of windows here.) Both sides of a plane are measured, corner by
// corner: how it was found does not matter. What such a plane would take off only where it touches, it
// leaves.

/// Of the tolerance of windows: what such planes leave begins so far above them. It is some times what
/// rounding does to corners.
static const double body_share = 0x1p-6;

/// Edges of a body, and the way to turn round each: twice its number, and 1 for backwards.
typedef struct turns {
    int32_t count;
    uint16_t items[2 * ENF_BODY_EDGES + ENF_FOUR];
} turns;

/// Edges of a body, bit by bit.
typedef struct edge_set {
    uint64_t left, right,
        both; ///< some corner of the window is behind the face on this side; one is behind both
} edge_set;

ENF_PART_OF_WIDE edge_set find_behind(const passage *passage, const enf_body *body) {
    const enf_outline *window = passage->one;
    edge_set found = {0};
    for (int32_t i = 0; i < window->count; i++) {
        const double x = window->at[0][i], y = window->at[1][i], z = window->at[2][i];
        uint64_t left = 0, right = 0;
        for (int32_t first = 0; first < body->face_count; first += ENF_FOUR) {
            const unsigned behind = enf_four_bits(
                x * enf_four_load(body->normal[0] + first) + y * enf_four_load(body->normal[1] + first) +
                    z * enf_four_load(body->normal[2] + first) <
                enf_four_load(body->offset + first) - passage->shapes->tolerance);
            left |= body->edges[0][first / ENF_FOUR][behind];
            right |= body->edges[1][first / ENF_FOUR][behind];
        }
        found.left |= left;
        found.right |= right;
        found.both |= left & right;
    }
    return found;
}

/// Backwards as far as edges of `one` go, forwards as far as those of `other` do.
ENF_PART_OF_WIDE void list_turns(uint64_t one, uint64_t other, turns *turns) {
    int32_t count = 0;
    for (; one; one &= one - 1) turns->items[count++] = (uint16_t)(2 * __builtin_ctzll(one) + 1);
    for (; other; other &= other - 1) turns->items[count++] = (uint16_t)(2 * __builtin_ctzll(other));
    turns->count = count;
}

/// The edges that a plane may touch which has the window in front and the body behind. Among planes through
/// an edge those with the body behind lie between its faces. If a corner of the window is behind both faces,
/// it is behind all of them. If none is behind one face, planes that turn away from this face go on to have
/// the window in front until they touch it: there is no need to look the other way round, and none to look
/// at all where none is behind the other face, either.
ENF_PART_OF_WIDE void choose_turns(const passage *passage, const enf_body *body, turns *turns) {
    if (body->face_count > 0) {
        const edge_set found = find_behind(passage, body);
        list_turns(found.left & ~found.both, found.right & ~found.both, turns);
    } else {
        turns->count = 2 * body->edge_count;
        for (int32_t i = 0; i < turns->count; i++) turns->items[i] = (uint16_t)i;
    }
    for (int lane = 0; lane < ENF_FOUR; lane++) turns->items[turns->count + lane] = 0;
}

/// Four of these edges, and the plane through each that touches the window, by its normal of any length.
typedef struct body_edges {
    enf_four a[3], along[3], left[3], right[3], normal[3];
} body_edges;

ENF_PART_OF_WIDE enf_four gather(const double *from, const int32_t *places) {
    return (enf_four){from[places[0]], from[places[1]], from[places[2]], from[places[3]]};
}

/// As turn_to.
ENF_PART_OF_WIDE void turn_body_edges(const passage *passage, const enf_body *body, const uint16_t *turns,
                                      body_edges *edges) {
    const enf_outline *window = passage->one;
    const int32_t places[ENF_FOUR] = {turns[0] >> 1, turns[1] >> 1, turns[2] >> 1, turns[3] >> 1};
    const enf_four_mask back = -(enf_four_mask){turns[0] & 1, turns[1] & 1, turns[2] & 1, turns[3] & 1};
    enf_four way[3], next[3];
    for (int axis = 0; axis < 3; axis++) {
        edges->a[axis] = gather(body->from[axis], places);
        edges->left[axis] = gather(body->left[axis], places);
        edges->right[axis] = gather(body->right[axis], places);
        edges->along[axis] = gather(body->along[axis], places);
        edges->along[axis] = (enf_four)((enf_four_mask)edges->along[axis] ^ (back & INT64_MIN));
        way[axis] = window->at[axis][0] - edges->a[axis];
    }
    cross_four(edges->along, way, edges->normal);
    for (int32_t i = 1; i < window->count; i++) {
        for (int axis = 0; axis < 3; axis++) way[axis] = window->at[axis][i] - edges->a[axis];
        cross_four(edges->along, way, next);
        const enf_four_mask behind = dot_four(edges->normal, way) < 0;
        for (int axis = 0; axis < 3; axis++)
            edges->normal[axis] = enf_four_choose(behind, next[axis], edges->normal[axis]);
    }
}

/// Adds those of four planes that part the body and the window. They have the body behind them if they do not
/// come into the wedge of the two faces.
ENF_PART_OF_WIDE void add_body_tangents(enf_separators *separators, const passage *passage,
                                        const body_edges *edges, enf_four_mask good) {
    good &= (dot_four(edges->normal, edges->left) <= 0) & (dot_four(edges->normal, edges->right) <= 0);
    if (!enf_four_bits(good)) return;
    const double tolerance = passage->shapes->tolerance * body_share;
    const enf_four square = dot_four(edges->normal, edges->normal), inverse = inverse_root(square);
    enf_four unit[3], second;
    for (int axis = 0; axis < 3; axis++) unit[axis] = edges->normal[axis] * inverse;
    const enf_four behind = dot_four(unit, edges->a), front = lowest(passage->one, unit, &second);
    good &= (square > 0) & (inverse < HUGE_VAL) & (behind <= front + tolerance) &
            (enf_four_abs(dot_four(unit, edges->along)) <= tolerance);
    add_good(separators, unit, front + tolerance, good);
}

/// The planes through edges of the window, which are turned so as to have the body behind them. `one` of the
/// passage is the window, `other` the body.
ENF_PART_OF_WIDE void add_window_planes(enf_separators *separators, const passage *passage) {
    const enf_outline *window = passage->one;
    for (int32_t first = 0; first < window->count; first += ENF_FOUR) {
        if (separators->count > ENF_SEPARATORS_MOST - ENF_FOUR) return;
        tangents tangents = find_tangents(passage, first);
        for (int axis = 0; axis < 3; axis++) tangents.normal[axis] = -tangents.normal[axis];
        const double tolerance = passage->shapes->tolerance * body_share;
        const enf_four_mask good = tangents.good & (tangents.front + tolerance >= tangents.behind);
        add_good(separators, tangents.normal, tolerance - tangents.behind, good & are_edges(window, first));
    }
}

/// The planes through edges of the body. `one` of the passage is the window, `other` the body.
ENF_PART_OF_WIDE void add_body_planes(enf_separators *separators, const passage *passage,
                                      const enf_body *body) {
    turns turns;
    choose_turns(passage, body, &turns);
    for (int32_t first = 0; first < turns.count; first += ENF_FOUR) {
        if (separators->count > ENF_SEPARATORS_MOST - ENF_FOUR) return;
        const enf_four_mask there = (enf_four_mask){0, 1, 2, 3} < (int64_t)(turns.count - first);
        body_edges edges;
        turn_body_edges(passage, body, turns.items + first, &edges);
        add_body_tangents(separators, passage, &edges, there);
    }
}

ENF_WIDE_TOO void enf_separators_from_body(enf_separators *separators, const enf_shapes *shapes,
                                           const enf_body *body, const enf_outline *to, int32_t to_portal) {
    const passage passage = {.shapes = shapes, .one = to, .other = &body->corners, .turns = to_portal & 1};
    separators->count = 0;
    separators->spare = 2 * shapes->tolerance * body_share;
    add_window_planes(separators, &passage);
    add_body_planes(separators, &passage, body);
    enf_separators_close(separators);
}

/// The cuts that may leave nothing of a box, as far as its middle tells; false in *some if one of them surely
/// does.
ENF_PART_OF_WIDE uint64_t find_doubtful(const enf_separators *separators, const double middle[3],
                                        const double half[3], bool *some) {
    uint64_t doubtful = 0;
    *some = true;
    for (int32_t first = 0; first < separators->count; first += ENF_FOUR) {
        enf_four height = -enf_four_load(separators->least + first), reach = enf_four_all(0);
        for (int axis = 0; axis < 3; axis++) {
            const enf_four normal = enf_four_load(separators->normal[axis] + first);
            height += middle[axis] * normal;
            reach += half[axis] * enf_four_abs(normal);
        }
        if (enf_four_bits(height + reach < 0)) {
            *some = false;
            return 0;
        }
        doubtful |= (uint64_t)enf_four_bits(height < 0) << first;
    }
    return doubtful;
}

ENF_WIDE_TOO bool enf_separators_meet(const enf_separators *separators, const double middle[3],
                                      const double half[3], const double (*points)[3], int32_t count) {
    bool some;
    uint64_t doubtful = find_doubtful(separators, middle, half, &some);
    for (; some && doubtful; doubtful &= doubtful - 1) {
        const int32_t i = __builtin_ctzll(doubtful);
        const double normal[3] = {separators->normal[0][i], separators->normal[1][i],
                                  separators->normal[2][i]};
        int32_t k = 0;
        while (k < count && enf_dot(normal, points[k]) < separators->least[i]) k++;
        some = k < count;
    }
    return some;
}
