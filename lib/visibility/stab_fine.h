// SPDX-License-Identifier: GPL-3.0-or-later
// Lines in more digits than doubles have, for what only such lines pass.
#ifndef ENF_VISIBILITY_STAB_FINE_H
#define ENF_VISIBILITY_STAB_FINE_H

#include "visibility/stab_parts.h"

typedef mpf_t enf_fine_point[3];

/// The line from at[0] to at[1], as whole edges are: seen from the stabber's origin, in units.
typedef struct enf_fine {
    mp_bitcnt_t bits;
    int axis;        ///< the points lie in two planes across this axis,
    double plane[2]; ///< here, not seen from the origin; the line runs from the first to the second
    double reach;    ///< of the sequence: its longest side along an axis
    enf_fine_point at[2];
    mpf_t x[ENF_PLUECKER], term, sum;
} enf_fine;

/// Numbers of so many bits; clear them in any case.
void enf_fine_init(enf_fine *fine, mp_bitcnt_t bits);
void enf_fine_clear(enf_fine *fine);

// ---- stab_fine.c
/// out = the side on which the line passes the edge: above 0 as it should. x must be set.
void enf_fine_side(enf_fine *fine, mpz_t *edge, mpf_t out);
/// x of the points.
void enf_fine_set_x(enf_fine *fine);
/// Where enf_stabber_quadric found that the cone meets the quadric, in two planes next to the first and the
/// last portal.
void enf_fine_start(enf_fine *fine, enf_stabber *stabber);
/// value *= 2^shift
void enf_fine_shift(mpf_t value, int shift);
/// out = the coordinate in the world
void enf_fine_coordinate(const enf_fine *fine, const enf_stabber *stabber, int end, int axis, mpf_t out);

// ---- stab_centre.c
/// Does the line pass all edges, as far as its bits tell? If so, moves the points in their planes, away from
/// the edges. False without memory.
bool enf_fine_centre(enf_fine *fine, enf_stabber *stabber, bool *passes);

// ---- stab_round.c
/// A line between doubles next to it that passes all portals; false if none is found.
bool enf_fine_round(const enf_fine *line, const enf_stabber *stabber, enf_line *rounded);

// ---- stab_long.c
/// The line in decimals with so many digits: six of them, as a new string. Null without memory.
char *enf_fine_text(const enf_fine *fine, const enf_stabber *stabber, int digits);
/// Does the line of such a text pass all edges? Exact.
bool enf_stabber_passes_text(const enf_stabber *stabber, const char *text);

#endif
