// SPDX-License-Identifier: GPL-3.0-or-later
// Incremental insertion after A. Bowyer and D. F. Watson (both 1981): the tetrahedra whose spheres hold the
// new point are taken out, and the hole is filled with tetrahedra from its rim to the point. Points come in
// rounds, each along a curve (N. Amenta, S. Choi, G. Rote, "Incremental constructions con BRIO", 2003), so
// the walk to the next point is short. Outside each triangle of the hull is a tetrahedron with a corner at
// infinity. Cospherical points are told apart by the perturbation of O. Devillers and M. Teillaud,
// "Perturbations for Delaunay and weighted Delaunay 3D triangulations" (2011), as in CGAL: the result depends
// on the set of points only, and nothing is flat.
#include "build/delaunay.h"

#include "base/array.h"
#include "base/exact.h"
#include "base/hash.h"
#include "base/sphere.h"
#include "build/tet_order.h"
#include "build/tetrahedra.h"

#include <stdlib.h>
#include <string.h>

enum { AT_INFINITY = -1, SPARE = -2 }; ///< in place of corners; the latter in that of the first

/// A rim is a sphere, so it has half as many corners as faces, and two.
enum { RIM_POINTS_MAX = 64, SMALL_RIM = 2 * RIM_POINTS_MAX - 4 };

/// Faces have numbers, too: 4 * tetrahedron + the corner that is opposite.
typedef struct tetrahedron {
    int32_t corner[4]; ///< positively oriented, also when a point beyond the hull is put for infinity
    int32_t next[4];   ///< for each face, the same face of the neighbour
} tetrahedron;

typedef struct triangulation {
    const double *points;
    tetrahedron *tets;
    uint32_t *seen; ///< in_hole, or one more: not in the hole; what is less is of earlier points
    size_t count, capacity, seen_capacity;

    uint32_t in_hole;
    int32_t *hole; ///< tetrahedra
    size_t hole_count, hole_capacity;
    int32_t *rim; ///< faces of tetrahedra in the hole with none of them beyond
    size_t rim_count, rim_capacity;
    int32_t rim_points, rim_point[RIM_POINTS_MAX]; ///< the corners of a small rim
    uint8_t *place;                  ///< of points, from infinity on: which corner of the rim they were last
    uint8_t rim_place[SMALL_RIM][3]; ///< those of its faces
    int32_t at_edge[RIM_POINTS_MAX][RIM_POINTS_MAX]; ///< the new face from one corner of it to another
    int32_t *spare;                                  ///< tetrahedra that are none
    size_t spare_count, spare_capacity;
    int32_t last; ///< a tetrahedron at the last point
} triangulation;

/// The corners of each face, counter-clockwise as seen from inside.
static const int face_corners[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}};

/// Where in its list a corner of a face is.
static const int8_t corner_places[4][4] = {{-1, 0, 2, 1}, {0, -1, 1, 2}, {0, 2, -1, 1}, {0, 1, 2, -1}};

static void free_triangulation(triangulation *d) {
    free(d->tets);
    free(d->place);
    free(d->seen);
    free(d->hole);
    free(d->rim);
    free(d->spare);
}

// ---------------------------------------------------------------------------------------------- predicates

static const double *point_at(const triangulation *d, int32_t i) {
    return d->points + 3 * (size_t)i;
}

static int orient(const triangulation *d, int32_t a, int32_t b, int32_t c, int32_t point) {
    return enf_points_orient(point_at(d, a), point_at(d, b), point_at(d, c), point_at(d, point));
}

/// > 0 if the point is on the inner side of the face of a finite tetrahedron or, if the face is one of the
/// hull and the corner is at infinity, beyond the hull.
static int side_of_face(const triangulation *d, const int32_t corner[4], int face, int32_t point) {
    const int *at = face_corners[face];
    // The analyzer does not follow corners through memcpy into a grown array.
    // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.ArraySubscript)
    return orient(d, corner[at[0]], corner[at[1]], corner[at[2]], point);
}

/// Apart, because it is rare. Does the sphere hold a point that lies on it? The last two of the five points
/// decide (see the paper).
__attribute__((noinline)) static bool perturbed_sphere_holds(const triangulation *d, const int32_t corner[4],
                                                             int32_t point) {
    int32_t before = INT32_MAX;
    for (int round = 0; round < 2; round++) {
        int last = -1;
        for (int k = 0; k < 4; k++) {
            if (corner[k] < before && (last < 0 || corner[k] > corner[last])) last = k;
        }
        if (point < before && point > corner[last]) return false;
        int32_t turned[4];
        memcpy(turned, corner, sizeof turned);
        turned[last] = point;
        const int side = orient(d, turned[0], turned[1], turned[2], turned[3]);
        if (side != 0) return side > 0;
        before = corner[last];
    }
    return false;
}

/// Of a number that is not 0. Either is as likely, so it is asked in a way that compilers make no branch of.
static inline bool is_negative(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    return bits >> 63;
}

static inline bool sphere_holds(const triangulation *d, const int32_t corner[4], int32_t point) {
    const double *const at[4] = {point_at(d, corner[0]), point_at(d, corner[1]), point_at(d, corner[2]),
                                 point_at(d, corner[3])};
    double largest, determinant = enf_sphere_determinant(at, point_at(d, point), &largest);
    if (enf_sphere_is_sure(determinant, largest)) return !is_negative(determinant);
    const int side = enf_corners_side_of_sphere_exactly(at, point_at(d, point));
    return side > 0 || (side == 0 && perturbed_sphere_holds(d, corner, point));
}

static bool is_finite(const int32_t corner[4]) {
    return (corner[0] | corner[1] | corner[2] | corner[3]) >= 0;
}

/// Must the tetrahedron go when the point comes? At infinity the sphere is the half-space beyond the hull
/// and, in the hull's plane, the circle in which that meets the sphere of the tetrahedron inside.
static inline bool is_in_conflict(const triangulation *d, int32_t t, int32_t point) {
    if (is_finite(d->tets[t].corner)) return sphere_holds(d, d->tets[t].corner, point);
    const int infinity = enf_tetrahedron_place(d->tets[t].corner, AT_INFINITY);
    const int side = side_of_face(d, d->tets[t].corner, infinity, point);
    return side > 0 || (side == 0 && sphere_holds(d, d->tets[d->tets[t].next[infinity] >> 2].corner, point));
}

// ---------------------------------------------------------------------------------------------- insertion

/// A tetrahedron in conflict with the point: walks through faces behind which the point is. Delaunay
/// tetrahedra cannot lead round in circles (H. Edelsbrunner, 1990).
static int32_t find_conflict(const triangulation *d, int32_t point) {
    int32_t t = d->last;
    if (!is_finite(d->tets[t].corner))
        t = d->tets[t].next[enf_tetrahedron_place(d->tets[t].corner, AT_INFINITY)] >> 2;
    for (int32_t came = -1;;) {
        int k = 0;
        for (; k < 4; k++) {
            if (d->tets[t].next[k] == came) continue;
            if (side_of_face(d, d->tets[t].corner, k, point) < 0) break;
        }
        if (k == 4) return t;
        came = 4 * t + k;
        t = d->tets[t].next[k] >> 2;
        if (!is_finite(d->tets[t].corner)) return t;
    }
}

/// The tetrahedra in conflict, which are connected, and the faces around them. What is found is put at the
/// end of its list either way, and counted where it belongs there: processors can't guess where. False
/// without memory.
static bool dig_hole(triangulation *d, int32_t first, int32_t point) {
    const uint32_t in_hole = d->in_hole;
    size_t hole_count = 1, rim_count = 0;
    d->hole[0] = first;
    d->seen[first] = in_hole;
    for (size_t i = 0; i < hole_count; i++) {
        if (!enf_array_reserve(d->hole, d->hole_capacity, hole_count + 5)) return false;
        if (!enf_array_reserve(d->rim, d->rim_capacity, rim_count + 5)) return false;
        const int32_t t = d->hole[i];
        for (int k = 0; k < 4; k++) {
            const int32_t u = d->tets[t].next[k] >> 2;
            uint32_t seen = d->seen[u];
            if (seen < in_hole) {
                const bool conflict = is_in_conflict(d, u, point);
                d->seen[u] = seen = in_hole + !conflict;
                d->hole[hole_count] = u;
                hole_count += conflict;
            }
            d->rim[rim_count] = 4 * t + k;
            rim_count += seen - in_hole;
        }
    }
    d->hole_count = hole_count;
    d->rim_count = rim_count;
    return true;
}

/// Room for as many new tetrahedra as the rim has faces. False without memory.
static bool prepare_filling(triangulation *d) {
    const size_t wanted = d->count + d->rim_count;
    return enf_array_reserve(d->spare, d->spare_capacity, d->spare_count + d->hole_count) &&
           enf_array_reserve(d->tets, d->capacity, wanted) &&
           enf_array_reserve(d->seen, d->seen_capacity, wanted);
}

static void join_faces(triangulation *d, int32_t a, int32_t b) {
    d->tets[a >> 2].next[a & 3] = b;
    d->tets[b >> 2].next[b & 3] = a;
}

static int32_t take_slot(triangulation *d) {
    const size_t spare = d->spare_count > 0; // no branch, as above
    const int32_t last = d->spare[d->spare_count - spare], slot = spare ? last : (int32_t)d->count;
    d->seen[d->count] = 0;
    d->spare_count -= spare;
    d->count += !spare;
    return slot;
}

/// The tetrahedron between a face of the rim and the point. Returns its number.
static int32_t add_tetrahedron(triangulation *d, int32_t face, int32_t point) {
    const int32_t t = take_slot(d);
    const tetrahedron *old = &d->tets[face >> 2];
    const int *at = face_corners[face & 3];
    tetrahedron *new = &d->tets[t];
    *new =
        (tetrahedron){{old->corner[at[0]], old->corner[at[1]], old->corner[at[2]], point}, {-1, -1, -1, -1}};
    join_faces(d, 4 * t + 3, old->next[face & 3]);
    d->last = t;
    return t;
}

/// A number below RIM_POINTS_MAX for a corner of the rim.
static int32_t place_of(triangulation *d, int32_t corner) {
    const int32_t last = d->place[corner + 1]; // infinity is -1
    const int32_t new = (last >= d->rim_points) | (d->rim_point[last] != corner);
    const int32_t place = last + new *(d->rim_points - last);
    d->place[corner + 1] = (uint8_t)place;
    d->rim_point[place] = corner;
    d->rim_points += new;
    return place;
}

/// Each new face is noted at its edge of the rim, (from, to), and finds the other from `to` to `from`.
static void fill_small_hole(triangulation *d, int32_t point) {
    d->rim_points = 0;
    for (size_t i = 0; i < d->rim_count; i++) {
        const int32_t t = add_tetrahedron(d, d->rim[i], point), *corner = d->tets[t].corner;
        uint8_t *place = d->rim_place[i];
        for (int k = 0; k < 3; k++) place[k] = (uint8_t)place_of(d, corner[k]);
        for (int k = 0; k < 3; k++) d->at_edge[place[(k + 1) % 3]][place[(k + 2) % 3]] = 4 * t + k;
        d->rim[i] = t;
    }
    for (size_t i = 0; i < d->rim_count; i++) {
        const uint8_t *place = d->rim_place[i];
        int32_t *next = d->tets[d->rim[i]].next;
        for (int k = 0; k < 3; k++) next[k] = d->at_edge[place[(k + 2) % 3]][place[(k + 1) % 3]];
    }
}

/// Joins the new tetrahedron at a face of the rim to the other one at each edge of that: turns around the
/// edge through the hole until the rim comes again. There, -1 - the new tetrahedron has been left.
static void join_tetrahedron(triangulation *d, int32_t face) {
    const int *at = face_corners[face & 3];
    const int32_t t = -1 - d->tets[face >> 2].next[face & 3], *corner = d->tets[t].corner;
    for (int k = 0; k < 3; k++) {
        if (d->tets[t].next[k] >= 0) continue;
        const int32_t from = corner[(k + 1) % 3], to = corner[(k + 2) % 3];
        int32_t u = face >> 2, came = face & 3, leave = at[k];
        for (int32_t next; (next = d->tets[u].next[leave]) >= 0;) {
            u = next >> 2;
            came = next & 3;
            leave = 6 - came - enf_tetrahedron_place(d->tets[u].corner, from) -
                    enf_tetrahedron_place(d->tets[u].corner, to);
        }
        const int32_t other = -1 - d->tets[u].next[leave];
        join_faces(d, 4 * t + k, 4 * other + corner_places[leave][came]);
    }
}

/// In proportion to the size of the hole, however large.
static void fill_large_hole(triangulation *d, int32_t point) {
    for (size_t i = 0; i < d->rim_count; i++) {
        const int32_t face = d->rim[i], t = add_tetrahedron(d, face, point);
        d->tets[face >> 2].next[face & 3] = -1 - t;
    }
    for (size_t i = 0; i < d->rim_count; i++) join_tetrahedron(d, d->rim[i]);
}

static void fill_hole(triangulation *d, int32_t point) {
    if (d->rim_count <= SMALL_RIM)
        fill_small_hole(d, point);
    else
        fill_large_hole(d, point);
    for (size_t i = 0; i < d->hole_count; i++) {
        d->tets[d->hole[i]].corner[0] = SPARE;
        d->spare[d->spare_count++] = d->hole[i];
    }
}

static enf_status fail_memory(enf_error *error) {
    return enf_fail_memory(error, "the Delaunay tetrahedra");
}

static enf_status insert_point(triangulation *d, int32_t point, enf_error *error) {
    const int32_t first = find_conflict(d, point);
    d->in_hole += 2;
    if (!dig_hole(d, first, point) || !prepare_filling(d)) return fail_memory(error);
    fill_hole(d, point);
    return ENF_OK;
}

// ---------------------------------------------------------------------------------------------- all of them

enum { ROUND_BITS = 3, ROUNDS_MAX = 21 }; ///< each round has eight times the points of the one before

/// In which round from the last a point comes, at random but always the same.
static int round_of(int32_t point) {
    const uint64_t bits = enf_hash_mix((uint64_t)point + 1);
    return __builtin_ctzll(bits | UINT64_C(1) << 63) / ROUND_BITS;
}

/// Where the points come that are along the curve so far: the last round last. False without memory.
static bool order_points(const double *points, size_t count, int32_t *order) {
    int32_t *along = enf_array_new(count, sizeof *along);
    if (!along || !enf_curve_order(points, count, along)) {
        free(along);
        return false;
    }
    size_t next[ROUNDS_MAX + 2] = {0};
    for (size_t i = 0; i < count; i++) next[ROUNDS_MAX - round_of((int32_t)i) + 1]++;
    for (int r = 0; r < ROUNDS_MAX; r++) next[r + 1] += next[r];
    for (size_t i = 0; i < count; i++) order[next[ROUNDS_MAX - round_of(along[i])]++] = along[i];
    free(along);
    return true;
}

/// Can the point be one more corner of the first tetrahedron?
static bool spans(const triangulation *d, const int32_t *corner, int count, int32_t point) {
    if (count == 3) return orient(d, corner[0], corner[1], corner[2], point) != 0;
    if (count == 1) return true;
    return !enf_points_collinear(point_at(d, corner[0]), point_at(d, corner[1]), point_at(d, point));
}

/// Brings four points to the front that are not in one plane.
static enf_status choose_first(const triangulation *d, int32_t *order, size_t count, enf_error *error) {
    for (int have = 1; have < 4; have++) {
        size_t i = (size_t)have;
        while (i < count && !spans(d, order, have, order[i])) i++;
        if (i >= count)
            return enf_fail(error, ENF_BAD_INPUT, "all points lie in one plane; a world needs some volume");
        const int32_t chosen = order[i];
        order[i] = order[have];
        order[have] = chosen;
    }
    if (orient(d, order[0], order[1], order[2], order[3]) < 0) {
        const int32_t swap = order[0];
        order[0] = order[1];
        order[1] = swap;
    }
    return ENF_OK;
}

/// One tetrahedron, and four around it with a corner at infinity. False without memory.
static bool begin(triangulation *d, const int32_t first[4], size_t point_count) {
    d->count = 5;
    const size_t likely = 8 * point_count; // with those at infinity and to spare; more when they come
    d->place = enf_array_zeroed(point_count + 1, sizeof *d->place);
    if (!d->place || !enf_array_reserve(d->tets, d->capacity, likely) ||
        !enf_array_reserve(d->seen, d->seen_capacity, likely) ||
        !enf_array_reserve(d->hole, d->hole_capacity, 64))
        return false;
    memset(d->seen, 0, d->count * sizeof *d->seen);
    memcpy(d->tets[0].corner, first, sizeof d->tets->corner);
    for (int32_t k = 0; k < 4; k++) { // infinity in the place of corner k, and two others exchanged
        int32_t *corner = d->tets[k + 1].corner;
        const int a = (k + 1) % 4, b = (k + 2) % 4;
        memcpy(corner, first, sizeof d->tets->corner);
        corner[k] = AT_INFINITY;
        corner[a] = first[b];
        corner[b] = first[a];
        join_faces(d, k, 4 * (k + 1) + k);
        for (int32_t i = 0; i < k; i++) {
            const int here = i == a ? b : i == b ? a : i; // where corner i is
            const int ia = (i + 1) % 4, ib = (i + 2) % 4, there = k == ia ? ib : k == ib ? ia : k;
            join_faces(d, 4 * (k + 1) + here, 4 * (i + 1) + there);
        }
    }
    d->last = 0;
    return true;
}

/// The finite tetrahedra; their corners take the place of everything.
static void take_tetrahedra(triangulation *d, enf_tetrahedra *out) {
    int32_t(*corners)[4] = (int32_t(*)[4])d->tets;
    size_t count = 0;
    for (size_t t = 0; t < d->count; t++) {
        if (is_finite(d->tets[t].corner)) memmove(corners[count++], d->tets[t].corner, sizeof *corners);
    }
    enf_array_trim(corners, count);
    *out = (enf_tetrahedra){.corners = corners, .count = count};
    d->tets = NULL;
}

/// The points must be in lexicographic order, all different.
static enf_status check_points(const double *points, size_t point_count, enf_error *error) {
    if (point_count > INT32_MAX)
        return enf_fail(error, ENF_NO_RESOURCES, "%zu points are more than this build can number",
                        point_count);
    for (size_t i = 1; i < point_count; i++) {
        const double *p = points + 3 * (i - 1), *q = p + 3;
        if (p[0] < q[0] || (p[0] == q[0] && (p[1] < q[1] || (p[1] == q[1] && p[2] < q[2])))) continue;
        return enf_fail(error, ENF_BAD_INPUT, "points %zu and %zu are equal or not sorted; weld them first",
                        i - 1, i);
    }
    return ENF_OK;
}

enf_status enf_delaunay(const double *points, size_t point_count, enf_tetrahedra *out, enf_error *error) {
    *out = (enf_tetrahedra){0};
    enf_status status = check_points(points, point_count, error);
    if (status != ENF_OK) return status;
    triangulation d = {.points = points};
    int32_t *order = enf_array_new(point_count, sizeof *order);
    if (!order || !order_points(points, point_count, order)) status = fail_memory(error);
    if (!status) status = choose_first(&d, order, point_count, error);
    if (!status && !begin(&d, order, point_count)) status = fail_memory(error);
    for (size_t i = 4; i < point_count && !status; i++) status = insert_point(&d, order[i], error);
    if (!status) take_tetrahedra(&d, out);
    free(order);
    free_triangulation(&d);
    return status;
}
