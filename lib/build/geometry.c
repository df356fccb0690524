// SPDX-License-Identifier: GPL-3.0-or-later
// Plane-based exact geometry: K. Sugihara and M. Iri, "A solid modelling system free from topological
// inconsistency" (1989); G. Bernstein and D. Fussell, "Fast, exact, linear booleans" (2009). The filters
// carry first-order error bounds; U is half a unit in the last place of 1, and the factors leave room for the
// rounding of the bounds themselves.
#include "build/geometry.h"

#include "base/array.h"
#include "base/exact.h"
#include "base/limbs.h"
#include "build/doubled_plane.h"
#include "build/exact_plane.h"

#include <math.h>
#include <string.h>

#define U 0x1p-53

static double largest(const double v[3]) {
    double x = fabs(v[0]), y = fabs(v[1]), z = fabs(v[2]);
    return x > y ? (x > z ? x : z) : (y > z ? y : z);
}

/// Of a power of two.
static int16_t exponent_of(double power) {
    uint64_t bits;
    memcpy(&bits, &power, sizeof bits);
    return (int16_t)((int)(bits >> 52) - 1023);
}

static double power_of_two(int exponent) {
    uint64_t bits = (uint64_t)(exponent + 1023) << 52;
    double power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

static int axis_of(int32_t code) {
    return -1 - code;
}

/// The vectors from the first to the other two of a plane's three points; or along the axis of the edge's.
static inline void plane_spans(const enf_geometry *geometry, int32_t plane, double u[3], double v[3]) {
    const int32_t *defined = geometry->planes[plane];
    const double *p = geometry->points + 3 * (size_t)defined[0],
                 *q = geometry->points + 3 * (size_t)defined[1];
    for (int i = 0; i < 3; i++) {
        u[i] = q[i] - p[i];
        v[i] = defined[2] < 0 ? i == axis_of(defined[2])
                              : geometry->points[3 * (size_t)defined[2] + (size_t)i] - p[i];
    }
}

/// The axis that the plane is square to, or -1.
static int square_axis(const double u[3], const double v[3]) {
    for (int i = 0; i < 3; i++) {
        if (u[i] == 0 && v[i] == 0) return i;
    }
    return -1;
}

/// The same without rounding (differences may need 54 bits).
static void whole_spans(const enf_geometry *geometry, int32_t plane, int64_t u[3], int64_t v[3]) {
    const int32_t *defined = geometry->planes[plane];
    const double *p = geometry->points + 3 * (size_t)defined[0],
                 *q = geometry->points + 3 * (size_t)defined[1];
    for (int i = 0; i < 3; i++) {
        u[i] = (int64_t)q[i] - (int64_t)p[i];
        v[i] = defined[2] < 0 ? i == axis_of(defined[2])
                              : (int64_t)geometry->points[3 * (size_t)defined[2] + (size_t)i] - (int64_t)p[i];
    }
}

/// Planes square to an axis get the normal +1 or -1: exact, and small enough to keep crossings exact as well.
static void set_square_filter(const double *p, int axis, double sign, enf_plane_filter *filter) {
    for (int i = 0; i < 3; i++) filter->normal[i] = i == axis ? sign : 0;
    filter->axis = axis;
    filter->offset = -sign * p[axis];
    filter->normal_size = filter->normal_unit = 1;
    filter->offset_unit = enf_points_unit(&p, 1);
    filter->normal_error = filter->offset_error = 0;
}

static void make_square_filter(const enf_geometry *geometry, int32_t plane, int axis,
                               enf_plane_filter *filter) {
    int j = (axis + 1) % 3, k = (axis + 2) % 3;
    int64_t u[3], v[3];
    whole_spans(geometry, plane, u, v);
    enf_int128 area = (enf_int128)u[j] * v[k] - (enf_int128)u[k] * v[j];
    set_square_filter(geometry->points + 3 * (size_t)geometry->planes[plane][0], axis, area > 0 ? 1 : -1,
                      filter);
}

/// The plane through two points along an axis: the normal is their difference, turned.
static void make_edge_filter(const enf_geometry *geometry, const int32_t *defined, enf_plane_filter *filter) {
    const double *p = geometry->points + 3 * (size_t)defined[0],
                 *q = geometry->points + 3 * (size_t)defined[1];
    int axis = axis_of(defined[2]), j = axis < 2 ? axis + 1 : 0, k = axis > 0 ? axis - 1 : 2;
    double u = q[j] - p[j], v = q[k] - p[k];
    if (u == 0 || v == 0) {
        set_square_filter(p, u == 0 ? j : k, (u == 0 ? v : -u) > 0 ? 1 : -1, filter);
        return;
    }
    filter->axis = -1;
    filter->normal[axis] = 0;
    filter->normal[j] = v;
    filter->normal[k] = -u;
    double one = v * p[j], two = u * p[k], magnitude = fabs(one) + fabs(two);
    filter->normal_size = fabs(u) > fabs(v) ? fabs(u) : fabs(v);
    filter->normal_error = filter->normal_size < 0x1p53 ? 0 : 2 * U * filter->normal_size;
    filter->offset = two - one;
    filter->offset_error = 5 * U * magnitude + 1.001 * filter->normal_error * (fabs(p[j]) + fabs(p[k]));
    filter->normal_unit = enf_points_unit((const double *const[]){p, q}, 2);
    filter->offset_unit = filter->normal_unit * filter->normal_unit;
    if (filter->normal_error == 0 && magnitude < 0x1p53 * filter->offset_unit) filter->offset_error = 0;
}

void enf_geometry_make_filter(const enf_geometry *geometry, int32_t plane, enf_plane_filter *filter) {
    const int32_t *defined = geometry->planes[plane];
    if (defined[2] < 0) {
        make_edge_filter(geometry, defined, filter);
        return;
    }
    const double *p = geometry->points + 3 * (size_t)defined[0];
    double u[3], v[3], bound = 0;
    plane_spans(geometry, plane, u, v);
    filter->axis = square_axis(u, v);
    if (filter->axis >= 0) {
        make_square_filter(geometry, plane, filter->axis, filter);
        return;
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        double one = u[j] * v[k], two = u[k] * v[j];
        filter->normal[i] = one - two;
        double both = fabs(one) + fabs(two);
        bound = both > bound ? both : bound;
    }
    filter->normal_size = largest(filter->normal);
    filter->normal_error = 5 * U * bound;
    double sum = 0, magnitude = 0, reach = 0;
    for (int i = 0; i < 3; i++) {
        sum += filter->normal[i] * p[i];
        magnitude += fabs(filter->normal[i] * p[i]);
        reach += fabs(p[i]);
    }
    filter->offset = -sum;
    filter->offset_error = 5 * U * magnitude + 1.001 * filter->normal_error * reach;

    const double *corners[3] = {p, geometry->points + 3 * (size_t)defined[1],
                                geometry->points + 3 * (size_t)defined[2]};
    double unit = enf_points_unit(corners, 3);
    filter->normal_unit = unit * unit;
    filter->offset_unit = filter->normal_unit * unit;
    if (bound < 0x1p53 * filter->normal_unit) filter->normal_error = 0;
    if (filter->normal_error == 0 && magnitude < 0x1p53 * filter->offset_unit) filter->offset_error = 0;
}

void enf_geometry_set_plane(enf_geometry *geometry, int32_t plane) {
    enf_geometry_make_filter(geometry, plane, &geometry->filters[plane - geometry->filter_first]);
}

const enf_plane_filter *enf_geometry_filter(const enf_geometry *geometry, int32_t plane,
                                            enf_plane_filter *room) {
    if (plane >= geometry->filter_first && (plane < geometry->filter_end || geometry->filter_end == 0))
        return &geometry->filters[plane - geometry->filter_first];
    if (!geometry->kept) {
        enf_geometry_make_filter(geometry, plane, room);
        return room;
    }
    int slot = plane % ENF_FILTERS_KEPT;
    if (geometry->kept->plane[slot] != plane + 1) {
        geometry->kept->plane[slot] = plane + 1;
        enf_geometry_make_filter(geometry, plane, &geometry->kept->filter[slot]);
    }
    *room = geometry->kept->filter[slot]; // another may take its place
    return room;
}

// ---------------------------------------------------------------------------------------------- exact tier

static void exact_plane_of(const enf_geometry *geometry, int32_t plane, enf_exact_plane *out) {
    int64_t u[3], v[3];
    whole_spans(geometry, plane, u, v);
    enf_exact_plane_set(out, geometry->points + 3 * (size_t)geometry->planes[plane][0], u, v);
}

// ---------------------------------------------------------------------------------------------- crossings

static void cross(double out[3], const double a[3], const double b[3]) {
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        out[i] = a[j] * b[k] - a[k] * b[j];
    }
}

/// Homogeneous coordinates with error bounds: every coordinate is a sum of six products of three
/// coefficients.
static void approximate(const enf_geometry *geometry, enf_crossing *crossing) {
    const enf_plane_filter *f[3];
    enf_plane_filter room[3];
    double size[3], error[3], reach[3], off[3];
    for (int k = 0; k < 3; k++) {
        f[k] = enf_geometry_filter(geometry, crossing->plane[k], &room[k]);
        size[k] = f[k]->normal_size + f[k]->normal_error;
        error[k] = f[k]->normal_error;
        reach[k] = fabs(f[k]->offset) + f[k]->offset_error;
        off[k] = f[k]->offset_error;
    }
    double at[3] = {0, 0, 0}, at_error = 0, at_magnitude = 0, at_unit = HUGE_VAL, product[3];
    for (int k = 0; k < 3; k++) {
        int l = (k + 1) % 3, m = (k + 2) % 3;
        cross(product, f[l]->normal, f[m]->normal);
        for (int i = 0; i < 3; i++) at[i] -= f[k]->offset * product[i];
        if (k == 0) {
            crossing->weight =
                f[0]->normal[0] * product[0] + f[0]->normal[1] * product[1] + f[0]->normal[2] * product[2];
        }
        at_error += 2 * (off[k] * size[l] * size[m] + reach[k] * (error[l] * size[m] + size[l] * error[m])) +
                    2 * 8 * U * reach[k] * size[l] * size[m];
        at_magnitude += 2 * reach[k] * size[l] * size[m];
        double unit = f[k]->offset_unit * f[l]->normal_unit * f[m]->normal_unit;
        at_unit = unit < at_unit ? unit : at_unit;
    }
    for (int i = 0; i < 3; i++) crossing->at[i] = at[i];
    crossing->at_error = 1.01 * at_error;
    crossing->weight_error = 6.06 * (error[0] * size[1] * size[2] + size[0] * error[1] * size[2] +
                                     size[0] * size[1] * error[2] + 8 * U * size[0] * size[1] * size[2]);
    double weight_unit = f[0]->normal_unit * f[1]->normal_unit * f[2]->normal_unit;
    crossing->at_unit = exponent_of(at_unit);
    crossing->weight_unit = exponent_of(weight_unit);
    bool exact_normals = error[0] == 0 && error[1] == 0 && error[2] == 0;
    if (exact_normals && 6 * size[0] * size[1] * size[2] < 0x1p53 * weight_unit) {
        crossing->weight_error = 0;
    }
    if (exact_normals && off[0] == 0 && off[1] == 0 && off[2] == 0 && at_magnitude < 0x1p53 * at_unit) {
        crossing->at_error = 0;
    }
}

/// A plane with coefficients in pairs, as seen from a point of another. False if they do not fit.
static bool doubled_plane_of(const enf_geometry *geometry, int32_t plane, const double *origin,
                             enf_doubled_plane *out) {
    double u[3], v[3];
    plane_spans(geometry, plane, u, v);
    return enf_doubled_plane_set(out, geometry->points + 3 * (size_t)geometry->planes[plane][0], u, v,
                                 origin);
}

/// Where the planes of a crossing meet, as seen from a point of the first, which is the origin. False if they
/// do not fit.
static bool make_meeting(const enf_geometry *geometry, const enf_crossing *crossing, const double *origin,
                         enf_doubled_meeting *meeting) {
    enf_doubled_plane plane[3];
    for (int k = 0; k < 3; k++) {
        if (!doubled_plane_of(geometry, crossing->plane[k], origin, &plane[k])) return false;
    }
    enf_doubled_planes_meet(plane, meeting);
    return true;
}

static const double *origin_of(const enf_geometry *geometry, const enf_crossing *crossing) {
    return geometry->points + 3 * (size_t)geometry->planes[crossing->plane[0]][0];
}

/// The same, kept or made in `room`; null if they do not fit.
static const enf_doubled_meeting *meeting_of(const enf_geometry *geometry, const enf_crossing *crossing,
                                             enf_doubled_meeting *room) {
    const double *origin = origin_of(geometry, crossing);
    enf_kept_filters *kept = geometry->kept;
    if (!kept) return make_meeting(geometry, crossing, origin, room) ? room : NULL;
    size_t slot = (size_t)(crossing - geometry->crossings) % ENF_MEETINGS_KEPT;
    if (memcmp(kept->meeting_of[slot], crossing->plane, sizeof crossing->plane) != 0) {
        memset(kept->meeting_of[slot], 0, sizeof kept->meeting_of[slot]);
        if (!make_meeting(geometry, crossing, origin, &kept->meeting[slot])) return NULL;
        memcpy(kept->meeting_of[slot], crossing->plane, sizeof crossing->plane);
    }
    return &kept->meeting[slot];
}

/// The weight's sign, where rounding may hide it.
static int decide_weight(const enf_geometry *geometry, const enf_crossing *crossing) {
    enf_doubled_meeting room;
    const enf_doubled_meeting *meeting = meeting_of(geometry, crossing, &room);
    int sign = meeting ? enf_doubled_meeting_weight_sign(meeting) : 0;
    if (sign != 0) return sign;
    enf_exact_plane plane[3];
    for (int k = 0; k < 3; k++) exact_plane_of(geometry, crossing->plane[k], &plane[k]);
    return enf_exact_planes_weight_sign(plane);
}

int32_t enf_geometry_cross(enf_geometry *geometry, int32_t a, int32_t b, int32_t c) {
    if (!enf_array_reserve(geometry->crossings, geometry->crossing_capacity,
                           (size_t)geometry->crossing_count + 1)) {
        return -1;
    }
    enf_crossing *crossing = &geometry->crossings[geometry->crossing_count];
    crossing->plane[0] = a;
    crossing->plane[1] = b;
    crossing->plane[2] = c;
    crossing->located = false;
    approximate(geometry, crossing);
    if (fabs(crossing->weight) > crossing->weight_error) {
        crossing->weight_sign = crossing->weight > 0 ? 1 : -1;
    } else {
        crossing->weight_sign = (int8_t)decide_weight(geometry, crossing);
    }
    return geometry->point_count + geometry->crossing_count++;
}

// ---------------------------------------------------------------------------------------------- the
// predicate

/// A point against a plane in exact arithmetic, or as that found a while ago.
static int decide_exactly(enf_geometry *geometry, int32_t point, int32_t plane, const double *third) {
    const int32_t *defined = geometry->planes[plane];
    const double *at = geometry->points;
    uint32_t slot = ((uint32_t)point * UINT32_C(0x9E3779B1) ^ (uint32_t)plane) % ENF_SIDES_KEPT;
    enf_kept_side *known = geometry->kept ? &geometry->kept->side[slot] : NULL;
    if (known && known->plane == plane + 1 && known->point == point) return known->side;
    geometry->decided[ENF_TIER_EXACT]++;
    int side = enf_points_orient_exactly(at + 3 * (size_t)defined[0], at + 3 * (size_t)defined[1], third,
                                         at + 3 * (size_t)point);
    if (known) *known = (enf_kept_side){plane + 1, point, side};
    return side;
}

/// A point against a plane that `third` is in besides the two points that all planes have.
static int orient(enf_geometry *geometry, int32_t point, int32_t plane, const double *third) {
    const int32_t *defined = geometry->planes[plane];
    const double *at = geometry->points;
    int side = enf_points_orient_quickly(at + 3 * (size_t)defined[0], at + 3 * (size_t)defined[1], third,
                                         at + 3 * (size_t)point);
    if (side == ENF_UNSURE) return decide_exactly(geometry, point, plane, third);
    geometry->decided[ENF_TIER_FILTER]++;
    return side;
}

/// Where rounding may hide the side.
static int decide_point(enf_geometry *geometry, int32_t point, int32_t plane, const enf_plane_filter *filter,
                        double value, double magnitude) {
    const int32_t *defined = geometry->planes[plane];
    const double *x = geometry->points + 3 * (size_t)point, *p = geometry->points + 3 * (size_t)defined[0];
    double unit = filter->normal_unit * enf_points_unit((const double *const[]){x, p}, 2);
    if (filter->normal_error == 0 && magnitude < 0x1p53 * unit) { // nothing was rounded: 0 is 0
        geometry->decided[ENF_TIER_FILTER]++;
        return value > 0 ? 1 : value < 0 ? -1 : 0;
    }
    if (defined[2] >= 0) return orient(geometry, point, plane, geometry->points + 3 * (size_t)defined[2]);
    double third[3];
    int axis = axis_of(defined[2]), step = p[axis] > 0 ? -1 : 1; // one step beyond 2^53 is no double
    for (int i = 0; i < 3; i++) third[i] = i == axis ? p[i] + step : p[i];
    return step * orient(geometry, point, plane, third);
}

static inline int side_of_point(enf_geometry *geometry, int32_t point, int32_t plane,
                                const enf_plane_filter *filter) {
    const int32_t *defined = geometry->planes[plane];
    if ((point == defined[0]) | (point == defined[1]) | (point == defined[2])) return 0;
    const double *x = geometry->points + 3 * (size_t)point, *p = geometry->points + 3 * (size_t)defined[0];
    if (filter->axis >= 0) { // a comparison
        geometry->decided[ENF_TIER_FILTER]++;
        double here = x[filter->axis], there = p[filter->axis];
        int order = (here > there) - (here < there);
        return filter->normal[filter->axis] > 0 ? order : -order;
    }
    double value = 0, magnitude = 0, reach = 0;
    for (int i = 0; i < 3; i++) {
        double difference = x[i] - p[i];
        value += filter->normal[i] * difference;
        magnitude += fabs(filter->normal[i] * difference);
        reach += fabs(difference);
    }
    if (fabs(value) > 6 * U * magnitude + 1.001 * filter->normal_error * reach) {
        geometry->decided[ENF_TIER_FILTER]++;
        return 2 * (value > 0) - 1;
    }
    return decide_point(geometry, point, plane, filter, value, magnitude);
}

const enf_crossing *enf_geometry_crossing(const enf_geometry *geometry, int32_t vertex) {
    return &geometry->crossings[vertex - geometry->point_count];
}

/// The planes of a crossing that a point defines; a bit each.
static inline unsigned defined_by(const enf_geometry *geometry, const enf_crossing *crossing, int32_t point) {
    unsigned bits = 0;
    for (int k = 0; k < 3; k++) {
        const int32_t *plane = geometry->planes[crossing->plane[k]];
        bits |= (unsigned)((plane[0] == point) | (plane[1] == point) | (plane[2] == point)) << k;
    }
    return bits;
}

/// Does the plane go through the line in which two planes of the crossing meet, because two points say so?
/// The usual way for a crossing to lie on a fourth plane, known without arithmetic.
static bool shares_line(const enf_geometry *geometry, const enf_crossing *crossing, int32_t plane) {
    const int32_t *defined = geometry->planes[plane];
    unsigned a = defined_by(geometry, crossing, defined[0]), b = defined_by(geometry, crossing, defined[1]),
             c = defined[2] < 0 ? 0 : defined_by(geometry, crossing, defined[2]);
    unsigned ab = a & b, bc = b & c, ca = c & a;
    return (ab & (ab - 1)) || (bc & (bc - 1)) || (ca & (ca - 1)); // two bits in one of them
}

/// The same for the plane through a polygon's edge, where two of the crossing's planes hold the edge's ends
/// without being defined by them: cheaper to ask than to work out the crossing.
static bool holds_edge(enf_geometry *geometry, const enf_crossing *crossing, int32_t plane) {
    const int32_t *defined = geometry->planes[plane];
    int holding = 0;
    if (defined[2] >= 0) return false;
    for (int k = 0; k < 3 && holding + 3 - k >= 2; k++) {
        enf_plane_filter room;
        const enf_plane_filter *filter = enf_geometry_filter(geometry, crossing->plane[k], &room);
        holding += side_of_point(geometry, defined[0], crossing->plane[k], filter) == 0 &&
                   side_of_point(geometry, defined[1], crossing->plane[k], filter) == 0;
    }
    return holding >= 2;
}

/// Is the quotient as good as any position? A quarter of a grid step is as good as the points themselves.
static bool is_located(const enf_crossing *crossing) {
    return crossing->located ||
           crossing->at_error + 0x1p53 * crossing->weight_error < 0.25 * fabs(crossing->weight);
}

/// The crossing in rounded coordinates, by what doubles alone do not tell.
static void find_position(const enf_geometry *geometry, const enf_crossing *crossing, double position[3]) {
    enf_doubled_meeting room;
    const enf_doubled_meeting *meeting = meeting_of(geometry, crossing, &room);
    if (meeting && enf_doubled_meeting_point(meeting, origin_of(geometry, crossing), position)) return;
    enf_exact_plane plane[3];
    for (int k = 0; k < 3; k++) exact_plane_of(geometry, crossing->plane[k], &plane[k]);
    enf_exact_planes_meet(plane, position);
}

/// How far a position is off along an axis: a step, or a unit in the last place.
static double position_error(const double position[3]) {
    return 1 + 0x1p-50 * largest(position);
}

/// Notes where the crossing is, if its quotient does not tell.
static void locate(const enf_geometry *geometry, enf_crossing *crossing) {
    if (is_located(crossing)) return;
    double position[3];
    find_position(geometry, crossing, position);
    crossing->weight = crossing->weight_sign;
    for (int i = 0; i < 3; i++) crossing->at[i] = crossing->weight * position[i];
    crossing->at_error = position_error(position);
    crossing->weight_error = 0;
    crossing->located = true;
}

/// The side by the position of a crossing that is located, 0 if that may be off by more than its distance
/// from the plane.
static int side_of_position(const enf_geometry *geometry, const enf_crossing *crossing, int32_t plane,
                            const enf_plane_filter *filter) {
    const double *p = geometry->points + 3 * (size_t)geometry->planes[plane][0];
    double value = 0, magnitude = 0, reach = 0, position[3];
    for (int i = 0; i < 3; i++) {
        position[i] = crossing->at[i] / crossing->weight;
        double difference = position[i] - p[i];
        value += filter->normal[i] * difference;
        magnitude += fabs(filter->normal[i] * difference);
        reach += fabs(difference);
    }
    double error = 6 * U * magnitude + 1.001 * filter->normal_error * reach +
                   3.01 * (filter->normal_size + filter->normal_error) * position_error(position);
    if (fabs(value) > error) return value > 0 ? 1 : -1;
    return 0;
}

/// The second tier: sign of the determinant of a crossing's planes and another, 0 if not certain.
static int sign_in_pairs(const enf_geometry *geometry, const enf_crossing *crossing, int32_t plane) {
    enf_doubled_plane fourth;
    enf_doubled_meeting room;
    const enf_doubled_meeting *meeting = meeting_of(geometry, crossing, &room);
    if (!meeting || !doubled_plane_of(geometry, plane, origin_of(geometry, crossing), &fourth)) return 0;
    return enf_doubled_meeting_sign(meeting, &fourth);
}

/// Where rounding may hide the side.
static int decide_crossing(enf_geometry *geometry, enf_crossing *crossing, int32_t plane,
                           const enf_plane_filter *filter, double value, double magnitude, double error) {
    if (error == 6 * U * magnitude &&
        magnitude < 0x1p53 * filter->normal_unit * power_of_two(crossing->at_unit) &&
        magnitude < 0x1p53 * filter->offset_unit * power_of_two(crossing->weight_unit)) {
        geometry->decided[ENF_TIER_FILTER]++; // nothing was rounded: 0 is 0
        return value > 0 ? crossing->weight_sign : value < 0 ? -crossing->weight_sign : 0;
    }
    if (shares_line(geometry, crossing, plane)) {
        geometry->decided[ENF_TIER_FILTER]++;
        return 0;
    }
    bool located = is_located(crossing);
    int sign = located ? side_of_position(geometry, crossing, plane, filter) : 0;
    bool on_edge = sign == 0 && holds_edge(geometry, crossing, plane);
    if (!located && !on_edge) {
        locate(geometry, crossing);
        sign = side_of_position(geometry, crossing, plane, filter);
    }
    if (sign != 0 || on_edge) {
        geometry->decided[ENF_TIER_FILTER]++;
        return sign;
    }
    sign = sign_in_pairs(geometry, crossing, plane);
    if (sign != 0) {
        geometry->decided[ENF_TIER_PAIRS]++;
        return sign * crossing->weight_sign;
    }
    geometry->decided[ENF_TIER_EXACT]++;
    enf_exact_plane exact[4];
    for (int k = 0; k < 3; k++) exact_plane_of(geometry, crossing->plane[k], &exact[k]);
    exact_plane_of(geometry, plane, &exact[3]);
    // The determinant is the weight times the fourth plane's value at the crossing.
    return enf_exact_planes_sign(exact) * crossing->weight_sign;
}

static inline int side_of_crossing(enf_geometry *geometry, enf_crossing *crossing, int32_t plane,
                                   const enf_plane_filter *filter) {
    if ((plane == crossing->plane[0]) | (plane == crossing->plane[1]) | (plane == crossing->plane[2]))
        return 0;
    double value = filter->offset * crossing->weight, magnitude = fabs(value), reach = 0;
    for (int i = 0; i < 3; i++) {
        double term = filter->normal[i] * crossing->at[i];
        value += term;
        magnitude += fabs(term);
        reach += fabs(crossing->at[i]);
    }
    double error = 6 * U * magnitude + filter->normal_error * (reach + 3 * crossing->at_error) +
                   3 * filter->normal_size * crossing->at_error +
                   filter->offset_error * (fabs(crossing->weight) + crossing->weight_error) +
                   fabs(filter->offset) * crossing->weight_error;
    if (fabs(value) > 1.01 * error) {
        geometry->decided[ENF_TIER_FILTER]++;
        return (2 * (value > 0) - 1) * crossing->weight_sign;
    }
    return decide_crossing(geometry, crossing, plane, filter, value, magnitude, error);
}

int enf_geometry_side_by(enf_geometry *geometry, int32_t vertex, int32_t plane,
                         const enf_plane_filter *filter) {
    if (vertex < geometry->point_count) return side_of_point(geometry, vertex, plane, filter);
    return side_of_crossing(geometry, &geometry->crossings[vertex - geometry->point_count], plane, filter);
}

void enf_geometry_sides_by(enf_geometry *geometry, int32_t vertex, int32_t first_plane, uint32_t wanted,
                           const enf_plane_filter *filters, uint32_t sides[2]) {
    sides[0] = sides[1] = 0;
    for (uint32_t left = wanted; left; left &= left - 1) {
        int i = __builtin_ctz(left);
        int side = enf_geometry_side_by(geometry, vertex, first_plane + i, &filters[i]);
        sides[0] |= (uint32_t)(side < 0) << i;
        sides[1] |= (uint32_t)(side > 0) << i;
    }
}

int enf_geometry_side(enf_geometry *geometry, int32_t vertex, int32_t plane) {
    const int32_t *defined = geometry->planes[plane];
    bool stored =
        plane >= geometry->filter_first && (plane < geometry->filter_end || geometry->filter_end == 0);
    if (!stored && vertex < geometry->point_count && defined[2] >= 0) { // cheaper than making a filter
        if (vertex == defined[0] || vertex == defined[1] || vertex == defined[2]) return 0;
        return orient(geometry, vertex, plane, geometry->points + 3 * (size_t)defined[2]);
    }
    enf_plane_filter room;
    return enf_geometry_side_by(geometry, vertex, plane, enf_geometry_filter(geometry, plane, &room));
}

uint64_t enf_geometry_plane_bucket(const enf_geometry *geometry, int32_t plane) {
    enf_plane_filter room;
    const enf_plane_filter *filter = enf_geometry_filter(geometry, plane, &room);
    double length = sqrt(filter->normal[0] * filter->normal[0] + filter->normal[1] * filter->normal[1] +
                         filter->normal[2] * filter->normal[2]);
    double part[4] = {filter->normal[0] / length, filter->normal[1] / length, filter->normal[2] / length,
                      filter->offset / length * 0x1p-53};
    double sign = 1;
    for (int i = 0; i < 3; i++) {
        if (fabs(part[i]) < 0x1p-20) continue;
        sign = part[i] < 0 ? -1 : 1;
        break;
    }
    uint64_t hash = 0;
    for (int i = 0; i < 4; i++) {
        hash = (hash ^ (uint64_t)llround(sign * part[i] * 0x1p20)) * UINT64_C(0x9E3779B97F4A7C15);
        hash ^= hash >> 32;
    }
    return hash;
}

int enf_geometry_dominant_axis(const enf_geometry *geometry, const int32_t points[3], int *sign) {
    const double *at = geometry->points;
    int64_t u[3], v[3];
    for (int i = 0; i < 3; i++) {
        int64_t origin = (int64_t)at[3 * (size_t)points[0] + (size_t)i];
        u[i] = (int64_t)at[3 * (size_t)points[1] + (size_t)i] - origin;
        v[i] = (int64_t)at[3 * (size_t)points[2] + (size_t)i] - origin;
    }
    int axis = 0;
    enf_int128 best = -1;
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3, k = (i + 2) % 3;
        enf_int128 component = (enf_int128)u[j] * v[k] - (enf_int128)u[k] * v[j];
        enf_int128 size = component < 0 ? -component : component;
        if (size <= best) continue;
        best = size;
        axis = i;
        *sign = component < 0 ? -1 : 1;
    }
    return axis;
}

bool enf_geometry_same_way(const enf_geometry *geometry, int32_t a, int32_t b) {
    // Parallel normals are longest along the same axis (of equals, the first is taken in both).
    int sign_a, sign_b;
    enf_geometry_dominant_axis(geometry, geometry->planes[a], &sign_a);
    enf_geometry_dominant_axis(geometry, geometry->planes[b], &sign_b);
    return sign_a == sign_b;
}

void enf_geometry_position(enf_geometry *geometry, int32_t vertex, double position[3]) {
    const double *at = geometry->points + 3 * (size_t)vertex;
    double weight = 1;
    if (vertex >= geometry->point_count) {
        enf_crossing *crossing = &geometry->crossings[vertex - geometry->point_count];
        locate(geometry, crossing);
        at = crossing->at;
        weight = crossing->weight;
    }
    for (int i = 0; i < 3; i++) position[i] = at[i] / weight;
}
