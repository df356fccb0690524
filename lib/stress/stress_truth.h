// SPDX-License-Identifier: GPL-3.0-or-later
// The oracles of the stress harness: what a compiled world says against what is known of its soup. They share
// no code with the stages that made the world, nor with check.
#ifndef ENF_BUILD_STRESS_TRUTH_H
#define ENF_BUILD_STRESS_TRUTH_H

#include "enfilade/format.h"
#include "stress/stress_case.h"

/// What the oracles asked and found.
typedef struct enf_stress_verdict {
    int32_t points;   ///< asked for rock or air
    int32_t segments; ///< asked for polygons between their ends
    int32_t surfaces; ///< points of input polygons that were looked for
    int32_t disagreements;
    char first[200]; ///< the first disagreement
} enf_stress_verdict;

/// Counts a disagreement; the words of the first stay.
void enf_stress_disagree(enf_stress_verdict *verdict, const char *format, ...) ENF_PRINTF(2, 3);

/// Asks for `count` points whether the kind that locate answers is that of the solids, or shells, that the
/// soup was made of. Points nearer to a face than clean may have moved it are not asked for. Draws random
/// numbers from the case.
void enf_stress_ask_points(enf_stress_case *made, const enf_file_view *view, int count,
                           enf_stress_verdict *verdict);

/// Takes `count` short segments, many of them through polygons, and decides exactly (GMP) which clean
/// polygons cross each: ends with a polygon between them are not in one fine cell, ends with nothing between
/// them are in one region.
void enf_stress_ask_segments(enf_stress_case *made, const enf_file_view *view, int count,
                             enf_stress_verdict *verdict);

/// Looks for `count` points of input polygons that were not rejected: a clean polygon must be near.
void enf_stress_ask_surfaces(enf_stress_case *made, const enf_file_view *view, int count,
                             enf_stress_verdict *verdict);

/// A random point of a convex polygon whose corners are points[ring[i]].
void enf_stress_pick_point(enf_stress_case *made, const double *points, const int32_t *ring, int32_t count,
                           double at[3]);

/// Is an edge of a polygon so near? (Polygons without area are no faces of solids, yet clean may leave
/// slivers of them.)
bool enf_stress_near_edge(const enf_soup *soup, const double at[3], double reach);

/// How far clean may have moved a face, and how far outside the hull a point may still be located in it,
/// world units, with room for rounding.
double enf_stress_margin(const enf_file_view *view);

#endif
