// SPDX-License-Identifier: GPL-3.0-or-later
// Pointed cones {x : <x, s> >= 0 for all sides s} in R^6 with their rays, in whole numbers: T. S. Motzkin et
// al., "The double description method" (1953).
#ifndef ENF_VISIBILITY_CONE_H
#define ENF_VISIBILITY_CONE_H

#include "visibility/min_norm.h"

#include <gmp.h>
#include <stdbool.h>

typedef mpz_t enf_whole_vector[ENF_PLUECKER];

enum { ENF_CONE_WORDS = 8, ENF_CONE_SIDES = 64 * ENF_CONE_WORDS };

typedef struct enf_cone_ray {
    enf_whole_vector at;            ///< without common divisor
    double about[ENF_PLUECKER];     ///< `at`, rounded; not finite if too large
    uint64_t tight[ENF_CONE_WORDS]; ///< the sides s with <at, s> = 0
} enf_cone_ray;

typedef struct enf_cone {
    enf_cone_ray *rays; ///< ray_count in use; `made` exist
    int32_t ray_count, made, capacity;
    enf_whole_vector sides[ENF_CONE_SIDES];
    int32_t side_count, sides_made;
    mpz_t *values; ///< capacity: <ray, side> of the side at hand
    mpz_t term;
} enf_cone;

void enf_cone_init(enf_cone *cone);
void enf_cone_free(enf_cone *cone);

/// The cone of six sides, which must be independent; what it was before is gone. False without memory.
bool enf_cone_start(enf_cone *cone, mpz_t *const sides[ENF_PLUECKER]);

/// Cuts the cone by one more side, the ENF_CONE_SIDES-th at most. False without memory.
bool enf_cone_cut(enf_cone *cone, mpz_t *side);

/// out = <a, b>
void enf_whole_dot(mpz_t out, mpz_t *a, mpz_t *b);

/// Divides by the greatest common divisor.
void enf_whole_shorten(mpz_t *vector);

#endif
