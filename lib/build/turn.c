// SPDX-License-Identifier: GPL-3.0-or-later
// Three steps, each from the one before:
//   1 cluster  directions of normals, up to sign, beginning with the largest polygons
//   2 choose   the two clusters at right angles that, with the direction square to both, have most area
//   3 refine   iterated least squares: of the polygons that are nearly square to an axis, every corner's
//              distance from the polygon's middle, along that axis, should be 0. What counts as "nearly"
//              shrinks each round down to the tolerance, so slight slopes drop out.
// The third step uses corners, not normals: its error is that of the coordinates divided by the polygons'
// sizes and by the square root of their number, small against the tolerance over the whole world.
//
// Everything is computed in the canonical axes of the raw points (frame.c), over polygons in canonical order
// (pieces.c), with nothing but + - * / and square roots: the same bits for any order of the input, on any
// machine.
#include "build/turn.h"

#include "base/array.h"
#include "build/pieces.h"
#include "build/ring.h"
#include "build/weld.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CLUSTERS = 64, REFINE_ROUNDS = 20, REFINE_MOST = 16384 };

static const double same_direction = 1 / 64.0; ///< sine of the angle
static const double first_slope = 1 / 32.0;    ///< how far from square a polygon may be in the first round
static const double least_slope = 1e-12;       ///< then all rounds ask for squareness as good as it gets
static const double least_determinant =
    1e-9; ///< of the product of the diagonal: less, and a rotation is left open
static const double aligned_enough = 0.5;     ///< of the area: no search
static const double aligned_twice = 1 / 16.0; ///< of it along a second axis, too
static const double worth_turning = 0.25;     ///< of the area must become axis-parallel...
static const double better_by = 1.25;         ///< ... and so many times what is
static const double thickness = 32;           ///< a flat polygon is wider than this many reaches

typedef struct facing {
    double normal[3], area;
    int32_t piece, place; ///< place: in canonical order
} facing;

typedef struct seeker {
    double *at; ///< xyz in the canonical axes, sorted; unit: the canonical frame's step
    size_t count;
    double reach; ///< in the same unit
    enf_pieces pieces;
    facing *facings; ///< in canonical order; by falling area, once that is needed
    size_t facing_count;
    double total; ///< area
    double axes[3][3];
} seeker;

double enf_power_of_two_above(double x) {
    int exponent;
    double mantissa = frexp(x, &exponent);
    return ldexp(1, mantissa == 0.5 ? exponent - 1 : exponent);
}

bool enf_points_are_round(const double *points, size_t count, double step) {
    size_t whole = 0;
    for (size_t i = 0; i < 3 * count; i++) whole += nearbyint(points[i] / step) * step == points[i];
    return 2 * whole >= 3 * count;
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int i = 0; i < 3; i++) out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static bool normalise(double v[3]) {
    double length = sqrt(dot(v, v));
    if (!(length > 0)) return false;
    for (int i = 0; i < 3; i++) v[i] /= length;
    return true;
}

// ---- polygons

/// Turns the ring so that it does not matter where its list began, nor which way round it ran.
static void make_canonical(int32_t *ring, size_t count) {
    enf_ring_rotate(ring, count);
    if (ring[1] <= ring[count - 1]) return;
    for (size_t i = 1, k = count - 1; i < k; i++, k--) {
        int32_t swap = ring[i];
        ring[i] = ring[k];
        ring[k] = swap;
    }
}

static bool add_pieces(seeker *s, const enf_frame_rings *rings, const int32_t *rank) {
    int32_t *ring = NULL;
    size_t capacity = 0;
    bool good = true;
    for (size_t k = 0; k < rings->polygon_count && good; k++) {
        int32_t p = rings->polygons[k];
        int64_t first = rings->soup->polygon_corner[p];
        size_t count = (size_t)(rings->soup->polygon_corner[p + 1] - first);
        good = enf_array_reserve(ring, capacity, count);
        if (!good) break;
        for (size_t i = 0; i < count; i++)
            ring[i] = rank[rings->place_of[rings->soup->corner_point[first + (int64_t)i]]];
        count = enf_ring_remove_repeats(ring, count);
        if (count < 3) continue;
        make_canonical(ring, count);
        good = enf_pieces_add(&s->pieces, ring, count, p);
    }
    free(ring);
    return good;
}

static const double *corner_of(const seeker *s, int32_t piece, int64_t k) {
    return &s->at[3 * (size_t)s->pieces.corners[s->pieces.corner[piece] + k]];
}

/// Normal and area, by Newell's sum over differences from the first corner.
static facing face_of(const seeker *s, int32_t piece) {
    facing out = {.piece = piece};
    int64_t count = (int64_t)enf_pieces_size(&s->pieces, piece);
    const double *origin = corner_of(s, piece, 0);
    for (int64_t k = 1; k + 1 < count; k++) {
        double u[3], v[3], n[3];
        for (int a = 0; a < 3; a++) {
            u[a] = corner_of(s, piece, k)[a] - origin[a];
            v[a] = corner_of(s, piece, k + 1)[a] - origin[a];
        }
        cross(u, v, n);
        for (int a = 0; a < 3; a++) out.normal[a] += n[a];
    }
    out.area = sqrt(dot(out.normal, out.normal)) / 2;
    if (!normalise(out.normal)) out.area = 0;
    return out;
}

static int compare_facings(const void *left, const void *right) {
    const facing *a = left, *b = right;
    if (a->area != b->area) return a->area > b->area ? -1 : 1;
    return (a->place > b->place) - (a->place < b->place);
}

/// Largest first. Most soups turn out not to need it.
static void sort_facings(seeker *s) {
    qsort(s->facings, s->facing_count, sizeof *s->facings, compare_facings);
}

/// The polygons in canonical order.
static enf_status list_facings(seeker *s, enf_error *error) {
    int32_t *order = enf_array_new(s->pieces.count, sizeof *order);
    int32_t *copies = enf_array_new(s->pieces.count, sizeof *copies);
    s->facings = enf_array_new(s->pieces.count, sizeof *s->facings);
    enf_status status =
        order && copies && s->facings ? ENF_OK : enf_fail_memory(error, "the directions of the polygons");
    size_t kept = 0;
    if (status == ENF_OK && s->pieces.count)
        status = enf_pieces_sort(&s->pieces, order, copies, &kept, error);
    for (size_t i = 0; i < kept && status == ENF_OK; i++) {
        facing face = face_of(s, order[i]);
        if (!(face.area > 0)) continue;
        face.place = (int32_t)i;
        s->total += face.area;
        s->facings[s->facing_count++] = face;
    }
    free(order);
    free(copies);
    return status;
}

// ---- what is axis-parallel

/// The axis that all corners are square to, within `width`, or -1. `axes` null: the coordinate axes.
static int flat_axis(const double extent[3], double reach, double slope) {
    int axis = 0;
    for (int a = 1; a < 3; a++)
        if (extent[a] < extent[axis]) axis = a;
    double u = extent[(axis + 1) % 3], v = extent[(axis + 2) % 3];
    double width = 2 * reach + slope * fmax(u, v);
    return extent[axis] <= width && fmin(u, v) >= thickness * reach ? axis : -1;
}

static void measure_extent(const seeker *s, int32_t piece, double extent[3]) {
    int64_t count = (int64_t)enf_pieces_size(&s->pieces, piece);
    const double *origin = corner_of(s, piece, 0);
    double low[3] = {0, 0, 0}, high[3] = {0, 0, 0};
    for (int64_t k = 1; k < count; k++) {
        const double *p = corner_of(s, piece, k);
        double d[3] = {p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]};
        for (int a = 0; a < 3; a++) {
            double u = dot(s->axes[a], d);
            low[a] = u < low[a] ? u : low[a];
            high[a] = u > high[a] ? u : high[a];
        }
    }
    for (int a = 0; a < 3; a++) extent[a] = high[a] - low[a];
}

static int axis_of_facing(const seeker *s, size_t i) {
    double extent[3];
    measure_extent(s, s->facings[i].piece, extent);
    return flat_axis(extent, s->reach, 0);
}

/// The area square to each of the axes; returns their sum. (Sums depend on the order, which is canonical both
/// before facings are sorted and after.)
static double measure_aligned(const seeker *s, double area[3]) {
    area[0] = area[1] = area[2] = 0;
    for (size_t i = 0; i < s->facing_count; i++) {
        int axis = axis_of_facing(s, i);
        if (axis >= 0) area[axis] += s->facings[i].area;
    }
    return area[0] + area[1] + area[2];
}

static bool is_aligned_enough(const double area[3], double total) {
    double sum = area[0] + area[1] + area[2], largest = fmax(area[0], fmax(area[1], area[2]));
    double smallest = fmin(area[0], fmin(area[1], area[2]));
    return sum >= aligned_enough * total && sum - largest - smallest >= aligned_twice * total;
}

// ---- is it worth looking?

enum {
    BOX_SHARE = 8,
    BOXES = 2 * BOX_SHARE + 1
}; ///< boxes of directions, to the side: so many in 1, and in all

static int box_of(double x) {
    return (int)((x + 1) * BOX_SHARE);
}

/// A triangle that is square to some axis, if its normal is more than 1/16 off (sine of the angle), is
/// between two lines 32 reaches apart.
static bool is_wide(const seeker *s, const facing *face) {
    double longest = 0;
    for (int64_t k = 0; k < 3; k++) {
        const double *p = corner_of(s, face->piece, k), *q = corner_of(s, face->piece, (k + 1) % 3);
        double d[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, square = dot(d, d);
        longest = square > longest ? square : longest;
    }
    double least = 17 * s->reach;
    return enf_pieces_size(&s->pieces, face->piece) == 3 && face->area * face->area > least * least * longest;
}

/// The most area in three by three by three boxes. Sums along one axis after the other; the boxes are used
/// up.
static double fullest(double (*area)[BOXES][BOXES]) {
    enum { STARTS = BOXES - 2 };
    double most = 0;
    for (int i = 0; i < BOXES; i++) {
        for (int j = 0; j < BOXES; j++)
            for (int k = 0; k < STARTS; k++) area[i][j][k] += area[i][j][k + 1] + area[i][j][k + 2];
        for (int j = 0; j < STARTS; j++)
            for (int k = 0; k < STARTS; k++) area[i][j][k] += area[i][j + 1][k] + area[i][j + 2][k];
    }
    for (int i = 0; i < STARTS; i++) {
        for (int j = 0; j < STARTS; j++) {
            for (int k = 0; k < STARTS; k++) {
                double sum = area[i][j][k] + area[i + 1][j][k] + area[i + 2][j][k];
                most = sum > most ? sum : most;
            }
        }
    }
    return most;
}

/// Can any axes have enough area square to them? Whatever an axis, the normals within 1/16 of it are in the
/// boxes around its own.
static bool may_be_worth_turning(const seeker *s) {
    double area[BOXES][BOXES][BOXES] = {{{0}}}, other = 0;
    for (size_t i = 0; i < s->facing_count; i++) {
        const facing *face = &s->facings[i];
        const double *n = face->normal;
        if (is_wide(s, face)) {
            area[box_of(n[0])][box_of(n[1])][box_of(n[2])] += face->area;
            area[box_of(-n[0])][box_of(-n[1])][box_of(-n[2])] += face->area;
        } else {
            other += face->area;
        }
    }
    return 3 * fullest(area) + other > 0.99 * worth_turning * s->total;
}

// ---- 1 and 2: a first guess

typedef struct direction {
    double along[3], area;
} direction;

static bool is_parallel(const double a[3], const double b[3]) {
    double n[3];
    if (fabs(dot(a, b)) < 0.99) return false; // most pairs: far from it
    cross(a, b, n);
    return dot(n, n) <= same_direction * same_direction;
}

static int cluster_directions(const seeker *s, direction directions[CLUSTERS]) {
    int count = 0;
    for (size_t i = 0; i < s->facing_count; i++) {
        const facing *face = &s->facings[i];
        int found = 0;
        while (found < count && !is_parallel(directions[found].along, face->normal)) found++;
        if (found == CLUSTERS) continue;
        if (found == count) {
            memcpy(directions[count].along, face->normal, sizeof face->normal);
            directions[count++].area = 0;
        }
        directions[found].area += face->area;
    }
    return count;
}

/// Sets the axes to the best pair at right angles. False if there is none.
static bool guess_axes(seeker *s, const direction *directions, int count) {
    double best = 0;
    for (int i = 0; i < count; i++) {
        for (int k = i + 1; k < count; k++) {
            const double *a = directions[i].along, *b = directions[k].along;
            if (fabs(dot(a, b)) > same_direction) continue;
            double third[3], score = directions[i].area + directions[k].area;
            cross(a, b, third);
            for (int l = 0; l < count; l++)
                if (is_parallel(directions[l].along, third)) score += directions[l].area;
            if (score <= best) continue;
            best = score;
            memcpy(s->axes[0], a, sizeof s->axes[0]);
            memcpy(s->axes[1], b, sizeof s->axes[1]);
        }
    }
    return best > 0;
}

/// Makes the rows a rotation again, the first one leading.
static bool square_axes(double axes[3][3]) {
    if (!normalise(axes[0])) return false;
    double along = dot(axes[0], axes[1]);
    for (int a = 0; a < 3; a++) axes[1][a] -= along * axes[0][a];
    if (!normalise(axes[1])) return false;
    cross(axes[0], axes[1], axes[2]);
    return normalise(axes[2]);
}

// ---- 3: least squares

/// Adds the corners of one polygon that should be flat along `axis`: rows of the normal equations for the
/// small rotation w that minimises the squares of (u + w x u) along the axis, u from the polygon's middle.
static void add_equations(const seeker *s, int32_t piece, int axis, double matrix[3][3], double right[3]) {
    int64_t count = (int64_t)enf_pieces_size(&s->pieces, piece);
    const double *origin = corner_of(s, piece, 0);
    double middle[3] = {0, 0, 0};
    for (int pass = 0; pass < 2; pass++) {
        for (int64_t k = 0; k < count; k++) {
            const double *p = corner_of(s, piece, k);
            double d[3] = {p[0] - origin[0], p[1] - origin[1], p[2] - origin[2]}, u[3];
            for (int a = 0; a < 3; a++) u[a] = dot(s->axes[a], d);
            if (pass == 0) {
                for (int a = 0; a < 3; a++) middle[a] += u[a] / (double)count;
                continue;
            }
            double row[3] = {0, 0, 0}; // (w x u)[axis] = w[b] u[c] - w[c] u[b]
            int b = (axis + 1) % 3, c = (axis + 2) % 3;
            row[b] = u[c] - middle[c];
            row[c] = middle[b] - u[b];
            for (int i = 0; i < 3; i++) {
                for (int j = 0; j < 3; j++) matrix[i][j] += row[i] * row[j];
                right[i] -= row[i] * (u[axis] - middle[axis]);
            }
        }
    }
}

/// Cramer's rule. False if the directions leave the rotation open.
static bool solve(double m[3][3], const double right[3], double w[3]) {
    double column[3][3], n[3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) column[j][i] = m[i][j];
    cross(column[1], column[2], n);
    double determinant = dot(column[0], n);
    if (!(determinant > least_determinant * m[0][0] * m[1][1] * m[2][2])) return false;
    for (int j = 0; j < 3; j++) {
        cross(column[(j + 1) % 3], column[(j + 2) % 3], n);
        w[j] = dot(right, n) / determinant;
    }
    return true;
}

static bool refine_once(seeker *s, double slope) {
    double matrix[3][3] = {{0}}, right[3] = {0}, w[3], moved[3][3];
    for (size_t i = 0; i < s->facing_count && i < REFINE_MOST; i++) {
        double extent[3];
        measure_extent(s, s->facings[i].piece, extent);
        int axis = flat_axis(extent, s->reach, slope);
        if (axis >= 0) add_equations(s, s->facings[i].piece, axis, matrix, right);
    }
    if (!solve(matrix, right, w)) return false;
    for (int a = 0; a < 3; a++) { // u + w x u, row by row
        int b = (a + 1) % 3, c = (a + 2) % 3;
        for (int i = 0; i < 3; i++)
            moved[a][i] = s->axes[a][i] + (w[b] * s->axes[c][i] - w[c] * s->axes[b][i]);
    }
    memcpy(s->axes, moved, sizeof moved);
    return square_axes(s->axes);
}

static bool find_axes(seeker *s) {
    direction directions[CLUSTERS];
    int count = cluster_directions(s, directions);
    if (!guess_axes(s, directions, count) || !square_axes(s->axes)) return false;
    double slope = first_slope;
    for (int round = 0; round<REFINE_ROUNDS; round++, slope = slope> least_slope ? slope / 8 : 0)
        if (!refine_once(s, slope)) return false;
    return true;
}

// ---- the whole

/// Sorted points in the canonical axes of the raw ones; rank[i]: the place of points[i] among them.
static enf_status lay_out(seeker *s, const enf_frame *frame, const double *points, int32_t *rank,
                          enf_error *error) {
    enf_site *sites = enf_array_new(s->count, sizeof *sites);
    s->at = enf_array_new(s->count, 3 * sizeof *s->at);
    if (!sites || !s->at) {
        free(sites);
        return enf_fail_memory(error, "the points");
    }
    for (size_t i = 0; i < s->count; i++) {
        sites[i].id = (int32_t)i;
        enf_frame_to_grid(frame, &points[3 * i], sites[i].at);
        for (int a = 0; a < 3; a++) sites[i].at[a] += 0.0; // -0 becomes 0
    }
    enf_sites_sort(sites, s->count);
    for (size_t i = 0; i < s->count; i++) {
        memcpy(&s->at[3 * i], sites[i].at, sizeof sites[i].at);
        rank[sites[i].id] = (int32_t)i;
    }
    free(sites);
    return ENF_OK;
}

/// The axes that were found, as rows in world coordinates; a rotation, not a mirror.
static void give_rows(const seeker *s, const enf_frame *frame, double rows[3][3]) {
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) rows[a][frame->axis[b]] = frame->sign[b] * s->axes[a][b];
    for (int b = 0; b < 3 && frame->handedness < 0; b++) rows[2][b] = -rows[2][b];
}

/// Turns the points. Sums run over the canonical axes, so that they are rounded the same way for any order of
/// the user's.
static void turn_points(const seeker *s, const enf_frame *frame, const int32_t *rank, double *points) {
    for (size_t i = 0; i < s->count; i++) {
        const double *at = &s->at[3 * (size_t)rank[i]];
        for (int a = 0; a < 3; a++) points[3 * i + (size_t)a] = dot(s->axes[a], at) * frame->step;
        if (frame->handedness < 0) points[3 * i + 2] = -points[3 * i + 2];
    }
}

static void judge(seeker *s, const enf_frame *frame, enf_turn *turn) {
    double area[3];
    for (int a = 0; a < 3; a++)
        for (int b = 0; b < 3; b++) s->axes[a][b] = a == b;
    turn->aligned_before = turn->aligned = measure_aligned(s, area) / s->total;
    turn->outcome = ENF_TURN_ALIGNED;
    if (is_aligned_enough(area, s->total)) return;
    turn->outcome = ENF_TURN_NONE;
    if (!may_be_worth_turning(s)) return;
    sort_facings(s);
    if (!find_axes(s)) return;
    double aligned = measure_aligned(s, area) / s->total;
    if (aligned < worth_turning || aligned < better_by * turn->aligned_before) return;
    turn->outcome = ENF_TURN_FOUND;
    turn->aligned = aligned;
    give_rows(s, frame, turn->rows);
}

enf_status enf_turn_find(enf_turn *turn, double *points, size_t count, const enf_frame_rings *rings,
                         double reach, enf_error *error) {
    *turn = (enf_turn){.rows = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    if (!(reach > 0) || count < 3 || rings->polygon_count == 0) return ENF_OK;
    turn->outcome = ENF_TURN_ROUND;
    if (enf_points_are_round(points, count, enf_power_of_two_above(32 * reach))) return ENF_OK;
    turn->is_framed = true;
    enf_frame_choose(&turn->frame, points, count, rings);
    const enf_frame frame = turn->frame;
    seeker s = {.count = count, .reach = reach / frame.step};
    int32_t *rank = enf_array_new(count, sizeof *rank);
    enf_status status =
        rank ? lay_out(&s, &frame, points, rank, error) : enf_fail_memory(error, "the points");
    if (status == ENF_OK && !add_pieces(&s, rings, rank)) status = enf_fail_memory(error, "the polygons");
    if (status == ENF_OK) status = list_facings(&s, error);
    turn->outcome = ENF_TURN_NONE;
    if (status == ENF_OK && s.total > 0) judge(&s, &frame, turn);
    if (status == ENF_OK && turn->outcome == ENF_TURN_FOUND) turn_points(&s, &frame, rank, points);
    free(rank);
    free(s.at);
    free(s.facings);
    enf_pieces_free(&s.pieces);
    return status;
}
