// SPDX-License-Identifier: GPL-3.0-or-later
// Planes, crossings and the one predicate that everything exact stands on: on which side of a plane is a
// vertex?
//
// Coordinates are whole numbers, |x| <= 2^53. With differences of 54 bits, a plane's normal has 109 bits and
// its offset 164; the determinant of four planes stays below 2^497, so 512 bits decide every case
// (exact_plane.h). Few get so far: a filter in doubles, then one in pairs of doubles (doubled_plane.h) decide
// nearly all.
#ifndef ENF_BUILD_GEOMETRY_H
#define ENF_BUILD_GEOMETRY_H

#include "build/doubled_plane.h"
#include "enfilade/base.h"

/// A plane as the floating-point filter sees it: normal . x + offset, with bounds on the coefficients'
/// errors.
typedef struct enf_plane_filter {
    double normal[3], offset;
    double normal_size;              ///< largest |component|
    double normal_error;             ///< bound on each component's error; 0: exact
    double offset_error;             ///< the same for the offset
    double normal_unit, offset_unit; ///< powers of two that divide the true coefficients
    int32_t axis;                    ///< the axis that the plane is square to (its normal is +-1 then), or -1
} enf_plane_filter;

/// A crossing of three planes in homogeneous coordinates, with error bounds. There are very many.
typedef struct enf_crossing {
    int32_t plane[3];
    int16_t at_unit, weight_unit;  ///< the true values are divisible by two to the power of these
    int8_t weight_sign;            ///< exact sign of the weight
    bool located;                  ///< found by better arithmetic; the weight is 1 or -1
    double at[3], weight;          ///< the point is at / weight
    double at_error, weight_error; ///< 0: exact
} enf_crossing;

/// What decides a predicate: doubles, pairs of doubles, whole numbers of any size.
enum { ENF_TIER_FILTER, ENF_TIER_PAIRS, ENF_TIER_EXACT, ENF_TIERS };

enum { ENF_FILTERS_KEPT = 64, ENF_MEETINGS_KEPT = 256, ENF_SIDES_KEPT = 1024 };

/// On which side of a plane a point lies, where that took exact arithmetic.
typedef struct enf_kept_side {
    int32_t plane; ///< + 1; 0: none
    int32_t point, side;
} enf_kept_side;

/// What was made a while ago: cells are cut by the same planes again and again, and their corners held
/// against one after the other.
typedef struct enf_kept_filters {
    int32_t plane[ENF_FILTERS_KEPT]; ///< + 1; 0: none
    enf_plane_filter filter[ENF_FILTERS_KEPT];
    int32_t meeting_of[ENF_MEETINGS_KEPT][3]; ///< the planes; all the same: none
    enf_doubled_meeting meeting[ENF_MEETINGS_KEPT];
    enf_kept_side side[ENF_SIDES_KEPT];
} enf_kept_filters;

/// Vertices are numbered: points, then crossings.
typedef struct enf_geometry {
    int32_t point_count;
    const double *points; ///< xyz
    int32_t (*planes)[3]; ///< as in enf_complex
    int32_t plane_count;
    /// Of planes filter_first .. filter_end - 1; filter_end = 0: of all. Others are made when they are
    /// needed.
    enf_plane_filter *filters;
    int32_t filter_first, filter_end;
    enf_kept_filters *kept; ///< of these; null: none are kept. One thread's own

    enf_crossing *crossings; ///< vertex point_count + i
    int32_t crossing_count;
    size_t crossing_capacity;

    uint64_t decided[ENF_TIERS]; ///< predicates, by what decided them; those that were kept count once
} enf_geometry;

/// The plane's filter, from planes[plane].
void enf_geometry_make_filter(const enf_geometry *geometry, int32_t plane, enf_plane_filter *filter);

/// The plane's filter: the stored one, or one made in `room`.
const enf_plane_filter *enf_geometry_filter(const enf_geometry *geometry, int32_t plane,
                                            enf_plane_filter *room);

/// Fills the stored filter of a plane.
void enf_geometry_set_plane(enf_geometry *geometry, int32_t plane);

/// The vertex where three planes cross in one point (they must). -1 without memory.
int32_t enf_geometry_cross(enf_geometry *geometry, int32_t a, int32_t b, int32_t c);

/// A vertex that is not a point. The pointer holds until the next crossing is made.
const enf_crossing *enf_geometry_crossing(const enf_geometry *geometry, int32_t vertex);

/// +1: the vertex is in front of the plane, -1: behind, 0: on it. Exact.
int enf_geometry_side(enf_geometry *geometry, int32_t vertex, int32_t plane);

/// The same with the plane's filter at hand.
int enf_geometry_side_by(enf_geometry *geometry, int32_t vertex, int32_t plane,
                         const enf_plane_filter *filter);

/// The same for the wanted ones of a row of up to 32 planes, a bit each: those that have the vertex behind
/// them, and those that have it in front.
void enf_geometry_sides_by(enf_geometry *geometry, int32_t vertex, int32_t first_plane, uint32_t wanted,
                           const enf_plane_filter *filters, uint32_t sides[2]);

/// A hash that is the same for planes that are (up to rounding, with rare exceptions) the same, whichever way
/// they face: a first sieve before the exact test.
uint64_t enf_geometry_plane_bucket(const enf_geometry *geometry, int32_t plane);

/// The axis along which a normal is longest; *sign is the normal's there (+1 or -1). Exact. For planes of
/// three points.
int enf_geometry_dominant_axis(const enf_geometry *geometry, const int32_t points[3], int *sign);

/// Do two planes of three points that are parallel face the same way? Exact.
bool enf_geometry_same_way(const enf_geometry *geometry, int32_t a, int32_t b);

/// The vertex's coordinates as far as they are known: quick, for measuring, where a crossing of nearly
/// parallel planes may be far off.
static inline void enf_geometry_near(const enf_geometry *geometry, int32_t vertex, double position[3]) {
    if (vertex < geometry->point_count) {
        for (int i = 0; i < 3; i++) position[i] = geometry->points[3 * (size_t)vertex + (size_t)i];
        return;
    }
    const enf_crossing *crossing = &geometry->crossings[vertex - geometry->point_count];
    for (int i = 0; i < 3; i++) position[i] = crossing->at[i] / crossing->weight;
}

/// The vertex's coordinates: exact for points, rounded (a few units in the last place of the world's size)
/// for crossings.
void enf_geometry_position(enf_geometry *geometry, int32_t vertex, double position[3]);

#endif
