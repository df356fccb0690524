// SPDX-License-Identifier: GPL-3.0-or-later
// Axes are ordered by extent, then by whole-number moments of the centred coordinate; they point to where the
// odd moments are positive. What the moments leave open (worlds with symmetric marginals) is decided by the
// smallest order-independent hash of the grid points over the frames still possible; equal hashes mean that
// the set of points itself is symmetric, and then the input's axes are taken as they are.
#include "build/frame.h"

#include "base/hash.h"
#include "base/wide.h"

#include <float.h>
#include <math.h>
#include <string.h>

/// What is known of one axis of the input.
typedef struct axis_key {
    double extent;
    enf_int128 even[3]; ///< sums of |u|, u^2, |u|^3: do not change when the axis is mirrored
    int sign;           ///< of the first odd moment that is not 0; 0 if all are
} axis_key;

static int compare_int128(enf_int128 a, enf_int128 b) {
    return (a > b) - (a < b);
}

/// Order of two axes: the one with the larger key first. 0 if they cannot be told apart.
static int compare_axes(const axis_key *a, const axis_key *b) {
    if (a->extent != b->extent) return a->extent > b->extent ? -1 : 1;
    for (int k = 0; k < 3; k++) {
        int order = compare_int128(b->even[k], a->even[k]);
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
            low[a] = fmin(low[a], points[3 * i + a]);
            high[a] = fmax(high[a], points[3 * i + a]);
        }
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
        enf_int128 odd[3] = {0}, even[3] = {0};
        for (size_t i = 0; i < count; i++) {
            // Truncated to 30 bits of the largest one: cubes of 2^31 points fit 128 bits.
            enf_int128 u = (int64_t)ldexp(centred(points[3 * i + a], low[a], high[a]), 30 - exponent);
            enf_int128 size = u < 0 ? -u : u;
            odd[0] += u, odd[1] += u * u * u, odd[2] += u * size;
            even[0] += size, even[1] += u * u, even[2] += u * u * size;
        }
        keys[a] = (axis_key){.extent = high[a] - low[a]};
        memcpy(keys[a].even, even, sizeof even);
        for (int k = 0; k < 3 && keys[a].sign == 0; k++) keys[a].sign = compare_int128(odd[k], 0);
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

static uint64_t hash_in_frame(const enf_frame *frame, const double *points, size_t count) {
    uint64_t sum = 0;
    for (size_t i = 0; i < count; i++) {
        uint64_t hash = 0;
        for (int a = 0; a < 3; a++) {
            double grid = frame->sign[a] * points[3 * i + frame->axis[a]] / frame->step + 0.0;
            uint64_t bits;
            memcpy(&bits, &grid, sizeof bits);
            hash = enf_hash_mix(hash * 3 + bits);
        }
        sum += enf_hash_mix(hash);
    }
    return sum;
}

/// Tries every order and direction that the keys allow; the first of equals is the input's own.
static void break_ties(enf_frame *frame, const axis_key keys[3], const double *points, size_t count) {
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    enf_frame candidates[48];
    int candidate_count = 0;
    for (int o = 0; o < 6; o++) {
        const int *order = orders[o];
        if (compare_axes(&keys[order[0]], &keys[order[1]]) > 0 ||
            compare_axes(&keys[order[1]], &keys[order[2]]) > 0)
            continue;
        for (int mirror = 0; mirror < 8; mirror++) {
            enf_frame candidate = {.step = frame->step};
            bool allowed = true;
            for (int a = 0; a < 3; a++) {
                candidate.axis[a] = order[a];
                candidate.sign[a] = mirror >> a & 1 ? -1 : 1;
                allowed = allowed && candidate.sign[a] * keys[order[a]].sign >= 0;
            }
            if (allowed) candidates[candidate_count++] = candidate;
        }
    }
    int best = 0;
    uint64_t best_hash = candidate_count > 1 ? hash_in_frame(&candidates[0], points, count) : 0;
    for (int c = 1; c < candidate_count; c++) {
        uint64_t hash = hash_in_frame(&candidates[c], points, count);
        if (hash < best_hash) best = c, best_hash = hash;
    }
    *frame = candidates[best];
}

/// +1 if the axes are an even permutation with an even number of mirrored ones, or neither.
static int find_handedness(const enf_frame *frame) {
    bool even = (frame->axis[1] - frame->axis[0] + 3) % 3 == 1;
    return (even ? 1 : -1) * frame->sign[0] * frame->sign[1] * frame->sign[2];
}

void enf_frame_choose(enf_frame *frame, const double *points, size_t count) {
    double low[3], high[3];
    axis_key keys[3];
    find_bounds(points, count, low, high);
    *frame = (enf_frame){.step = choose_step(low, high)};
    find_keys(points, count, low, high, keys);
    break_ties(frame, keys, points, count);
    frame->handedness = find_handedness(frame);
}

void enf_frame_to_world(const enf_frame *frame, const double grid[3], double world[3]) {
    double at[3] = {grid[0], grid[1], grid[2]};
    for (int a = 0; a < 3; a++) world[frame->axis[a]] = frame->sign[a] * at[a] * frame->step;
}

void enf_frame_to_grid(const enf_frame *frame, const double world[3], double grid[3]) {
    double at[3] = {world[0], world[1], world[2]};
    for (int a = 0; a < 3; a++) grid[a] = frame->sign[a] * at[frame->axis[a]] / frame->step;
}
