// SPDX-License-Identifier: GPL-3.0-or-later
// Where, in a cone, the Pluecker quadric's form falls below 0.
#ifndef ENF_VISIBILITY_STAB_QUADRIC_H
#define ENF_VISIBILITY_STAB_QUADRIC_H

#include "visibility/cone.h"

/// Scratch: all numbers are initialised once.
typedef struct enf_quadric {
    enf_cone cone;
    int sign;                 ///< +1 or -1: what Q is multiplied by
    enf_whole_vector witness; ///< of enf_quadric_falls
    int steps;                ///< what decided: 1 rays, 2 edges, 3 larger faces
    enf_whole_vector slice;   ///< the sum of the sides
    mpz_t a, b, c, d, determinant, g[3], mu[3], gram[3][3];
    enf_whole_vector completing[ENF_PLUECKER]; ///< sides that make a cone pointed
    enf_whole_vector echelon[ENF_PLUECKER];
} enf_quadric;

void enf_quadric_init(enf_quadric *quadric);
void enf_quadric_free(enf_quadric *quadric);

/// Is sign * Q below 0 anywhere in the cone, which must be pointed? Then the witness is such a point of the
/// cone.
bool enf_quadric_falls(enf_quadric *quadric);

#endif
