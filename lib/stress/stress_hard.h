// SPDX-License-Identifier: GPL-3.0-or-later
// Named soups that others choke on, always the same ones, and how many cells they need at least.
#ifndef ENF_BUILD_STRESS_HARD_H
#define ENF_BUILD_STRESS_HARD_H

#include "stress/stress_case.h"

typedef struct enf_stress_hard {
    const char *name, *description;
    const char *peer;    ///< what became of VolumeMesher with such a soup; "-": not tried
    double peer_seconds; ///< 0: it gave no result
    bool is_generic;     ///< in general position: enf_stress_count_crossings says something
    double stretch;      ///< of z before crossings are counted; an affine map leaves their number alone
    void (*make)(enf_stress_case *made, const struct enf_stress_hard *soup);
    int count;     ///< of pieces
    double amount; ///< jitter, offset, scale or strange number
} enf_stress_hard;

/// Soup number `index`, or null after the last.
const enf_stress_hard *enf_stress_hard_find(int index);

/// Free the case in any event.
enf_status enf_stress_hard_make(enf_stress_case *made, const enf_stress_hard *soup, enf_error *error);

/// Counts the points where three of the first `most` polygons cross inside all three of them. For soups in
/// general position that is a lower bound of the fine cells of any convex subdivision that carries the
/// polygons, as they are given (tolerances may merge some): in a direction that is parallel to none of the
/// planes, exactly one of the eight corners around such a point has it as its lowest point; a convex cell
/// that reaches the point in that corner lies in it, and has no other lowest point. Points that rounding puts
/// in doubt, and crossings at small angles, are not counted. *used: how many polygons were looked at.
int64_t enf_stress_count_crossings(const enf_stress_case *made, size_t most, double stretch, size_t *used);

#endif
