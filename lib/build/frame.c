// SPDX-License-Identifier: GPL-3.0-or-later
// Axes are ordered by extent, then by whole-number moments of the centred coordinate; they point to where the
// odd moments are positive. What the moments leave open (worlds with symmetric marginals) is decided by the
// smallest order-independent hash of the grid points over the frames still possible, and where these are
// equal, too (the set of points is symmetric), of the polygons. If even the polygons are symmetric any of the
// frames gives the same.
#include "build/frame.h"

#include "base/hash.h"
#include "build/wide.h"

#include <float.h>
#include <math.h>
#include <string.h>

/// What is known of one axis of the input.
typedef struct axis_key {
    double extent;
    enf_wide even[3]; ///< sums of |u|, u^2, |u|^3: do not change when the axis is mirrored
    int sign;         ///< of the first odd moment that is not 0; 0 if all are
} axis_key;

static int compare_wide(enf_wide a, enf_wide b) {
    return (a > b) - (a < b);
}

/// Order of two axes: the one with the larger key first. 0 if they cannot be told apart.
static int compare_axes(const axis_key *a, const axis_key *b) {
    if (a->extent != b->extent) return a->extent > b->extent ? -1 : 1;
    for (int k = 0; k < 3; k++) {
        int order = compare_wide(b->even[k], a->even[k]);
        if (order) return order;
    }
    return 0;
}

/// Twice the distance from the middle of [low, high]: rounding is the same when the axis is mirrored.
static double centred(double x, double low, double high) {
    return 2 * x - (low + high);
}

static void find_bounds(const double *points, size_t count, double low[3], double high[3]) {
    for (int a = 0; a < 3; a++) {
        low[a] = count ? points[a] : 0;
        high[a] = low[a];
    }
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) {
            double x = points[3 * i + a];
            low[a] = x < low[a] ? x : low[a];
            high[a] = x > high[a] ? x : high[a];
        }
}

/// x * 2^exponent.
static inline double scaled(double x, int exponent) {
    if (exponent < -1000 || exponent > 1000) return ldexp(x, exponent);
    uint64_t bits = (uint64_t)(exponent + 1023) << 52;
    double factor;
    memcpy(&factor, &bits, sizeof factor);
    return x * factor;
}

static void find_keys(const double *points, size_t count, const double low[3], const double high[3],
                      axis_key keys[3]) {
    double largest = 0;
    for (int a = 0; a < 3; a++)
        largest = fmax(largest,
                       fmax(fabs(centred(low[a], low[a], high[a])), fabs(centred(high[a], low[a], high[a]))));
    int exponent = 0;
    frexp(largest, &exponent);
    for (int a = 0; a < 3; a++) {
        enf_wide odd[3] = {0}, even[3] = {0};
        for (size_t i = 0; i < count; i++) {
            // Truncated to 30 bits of the largest one: cubes of 2^31 points fit 128 bits.
            int64_t u = (int64_t)scaled(centred(points[3 * i + a], low[a], high[a]), 30 - exponent);
            int64_t size = u < 0 ? -u : u, square = u * u;
            enf_wide cube = (enf_wide)square * size;
            odd[0] += u, odd[1] += u < 0 ? -cube : cube, odd[2] += u < 0 ? -square : square;
            even[0] += size, even[1] += square, even[2] += cube;
        }
        keys[a] = (axis_key){.extent = high[a] - low[a]};
        memcpy(keys[a].even, even, sizeof even);
        for (int k = 0; k < 3 && keys[a].sign == 0; k++) keys[a].sign = compare_wide(odd[k], 0);
    }
}

/// The power of two for which the largest coordinate has 53 bits before the point (coarser only where a finer
/// step would not be a double any more).
static double choose_step(const double low[3], const double high[3]) {
    double largest = 0;
    for (int a = 0; a < 3; a++) largest = fmax(largest, fmax(fabs(low[a]), fabs(high[a])));
    if (largest == 0) return 1;
    int exponent;
    frexp(largest, &exponent);
    return ldexp(1, exponent - 53 < DBL_MIN_EXP - DBL_MANT_DIG ? DBL_MIN_EXP - DBL_MANT_DIG : exponent - 53);
}

static uint64_t hash_point(const enf_frame *frame, const double *point) {
    uint64_t hash = 0;
    for (int a = 0; a < 3; a++) {
        double grid = frame->sign[a] * point[frame->axis[a]] / frame->step + 0.0; // -0 becomes 0
        uint64_t bits;
        memcpy(&bits, &grid, sizeof bits);
        hash = enf_hash_mix(hash * 3 + bits);
    }
    return hash;
}

static uint64_t hash_points(const enf_frame *frame, const double *points, size_t count) {
    uint64_t sum = 0;
    for (size_t i = 0; i < count; i++) sum += enf_hash_mix(hash_point(frame, &points[3 * i]));
    return sum;
}

/// Depends on each polygon's corners and on the way round, not on where its list begins.
static uint64_t hash_rings(const enf_frame *frame, const double *points, const enf_frame_rings *rings) {
    const enf_soup *soup = rings->soup;
    uint64_t sum = 0;
    for (size_t i = 0; i < rings->polygon_count; i++) {
        int64_t first = soup->polygon_corner[rings->polygons[i]],
                end = soup->polygon_corner[rings->polygons[i] + 1];
        uint64_t ring = 0, before = 0;
        for (int64_t k = first == end ? end : first - 1; k < end; k++) { // from the last corner once round
            int32_t corner = soup->corner_point[k < first ? end - 1 : k];
            uint64_t here = hash_point(frame, &points[3 * (size_t)rings->place_of[corner]]);
            if (k >= first)
                ring +=
                    frame->handedness > 0 ? enf_hash_mix(before + 3 * here) : enf_hash_mix(here + 3 * before);
            before = here;
        }
        sum += enf_hash_mix(ring);
    }
    return sum;
}

/// +1 if the axes are an even permutation with an even number of mirrored ones, or neither.
static int find_handedness(const enf_frame *frame) {
    bool even = (frame->axis[1] - frame->axis[0] + 3) % 3 == 1;
    return (even ? 1 : -1) * frame->sign[0] * frame->sign[1] * frame->sign[2];
}

/// Lists every order and direction of the axes that the keys allow; the input's own comes first.
static int list_candidates(double step, const axis_key keys[3], enf_frame candidates[48]) {
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    int count = 0;
    for (int o = 0; o < 6; o++) {
        const int *order = orders[o];
        if (compare_axes(&keys[order[0]], &keys[order[1]]) > 0 ||
            compare_axes(&keys[order[1]], &keys[order[2]]) > 0)
            continue;
        for (int mirror = 0; mirror < 8; mirror++) {
            enf_frame candidate = {.step = step};
            bool allowed = true;
            for (int a = 0; a < 3; a++) {
                candidate.axis[a] = order[a];
                candidate.sign[a] = mirror >> a & 1 ? -1 : 1;
                allowed = allowed && candidate.sign[a] * keys[order[a]].sign >= 0;
            }
            candidate.handedness = find_handedness(&candidate);
            if (allowed) candidates[count++] = candidate;
        }
    }
    return count;
}

/// The candidate with the smallest hash of points, then of polygons, then the first.
static void choose_candidate(enf_frame *frame, const enf_frame *candidates, int count, const double *points,
                             size_t point_count, const enf_frame_rings *rings) {
    uint64_t point_hash[48], least = UINT64_MAX;
    int ties = 0;
    for (int c = 0; c < count && count > 1; c++) {
        point_hash[c] = hash_points(&candidates[c], points, point_count);
        if (point_hash[c] < least) least = point_hash[c], ties = 0;
        ties += point_hash[c] == least;
    }
    int best = -1;
    uint64_t least_ring = 0;
    for (int c = 0; c < count && count > 1; c++) {
        if (point_hash[c] != least) continue;
        uint64_t ring_hash = ties > 1 ? hash_rings(&candidates[c], points, rings) : 0;
        if (best < 0 || ring_hash < least_ring) best = c, least_ring = ring_hash;
    }
    const enf_frame *chosen = &candidates[best < 0 ? 0 : best];
    frame->step = chosen->step;
    frame->handedness = chosen->handedness;
    memcpy(frame->axis, chosen->axis, sizeof frame->axis);
    memcpy(frame->sign, chosen->sign, sizeof frame->sign);
}

void enf_frame_choose(enf_frame *frame, const double *points, size_t count, const enf_frame_rings *rings) {
    double low[3], high[3];
    axis_key keys[3];
    enf_frame candidates[48];
    find_bounds(points, count, low, high);
    find_keys(points, count, low, high, keys);
    int candidate_count = list_candidates(choose_step(low, high), keys, candidates);
    choose_candidate(frame, candidates, candidate_count, points, count, rings);
}

void enf_frame_direction_to_world(const enf_frame *frame, const double grid[3], double world[3]) {
    double at[3] = {grid[0], grid[1], grid[2]}, turned[3];
    for (int a = 0; a < 3; a++) turned[frame->axis[a]] = frame->sign[a] * at[a];
    for (int a = 0; a < 3; a++)
        world[a] = (frame->is_turned ? frame->turn[0][a] * turned[0] + frame->turn[1][a] * turned[1] +
                                           frame->turn[2][a] * turned[2]
                                     : turned[a]) +
                   0.0; // -0 becomes 0: the smaller of the two is the compiler's choice
}

void enf_frame_to_world(const enf_frame *frame, const double grid[3], double world[3]) {
    enf_frame_direction_to_world(frame, grid, world);
    for (int a = 0; a < 3; a++) world[a] *= frame->step;
}

void enf_frame_to_grid(const enf_frame *frame, const double world[3], double grid[3]) {
    double at[3] = {world[0], world[1], world[2]}, turned[3];
    for (int a = 0; a < 3; a++) {
        const double *row = frame->turn[a];
        turned[a] = frame->is_turned ? row[0] * at[0] + row[1] * at[1] + row[2] * at[2] : at[a];
    }
    for (int a = 0; a < 3; a++) grid[a] = frame->sign[a] * turned[frame->axis[a]] / frame->step;
}
