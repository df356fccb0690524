// SPDX-License-Identifier: GPL-3.0-or-later
// The rung `hourglass`: beams from a portal through all portal sequences at once.
//
// The hourglass of a single sequence is bounded by separating planes (S. J. Teller, "Visibility Computations
// in Densely Occluded Polyhedral Environments", 1992). Where sequences are many, because cells are many and
// most openings between them open, that means to come to the same portal again and again. Here the windows
// that all sequences leave of a portal are merged into one, their convex hull, and each portal is looked at
// anew only while its window grows. What is merged lets through a little more than each sequence alone; what
// it gains is that the work grows with the pairs of portals and not with the sequences.
#ifndef ENF_VISIBILITY_BEAMS_H
#define ENF_VISIBILITY_BEAMS_H

#include "visibility/bits.h"
#include "visibility/bodies.h"
#include "visibility/follows.h"
#include "visibility/shapes.h"

/// Scratch memory of one thread.
typedef struct enf_beams enf_beams;

/// Null without memory. What they are made from is shared and must stay. Beams from portals try no other
/// pairs than those in `facing`, which may be null if there are to be none; `follows` are those portals that
/// can come right after each other.
enf_beams *enf_beams_new(const enf_shapes *shapes, const enf_bits *facing, const enf_follows *follows);
void enf_beams_free(enf_beams *beams);

/// Casts the beams of a directed portal. *portals receives the portals that they reach, in the order in which
/// they were reached first; returns how many. Valid until the next call.
int32_t enf_beams_cast(enf_beams *beams, int32_t source, const int32_t **portals);

/// Casts the beams of all bodies of an owner at once, as of their hull, through all portals of their cells.
/// In *met, a row of bits that was zero, those owners are set whose bodies the beams meet, and those with
/// bodies in the same cells.
void enf_beams_cast_owner(enf_beams *beams, const enf_bodies *bodies, int32_t owner, uint64_t *met);

/// The same without beams: through all portals that have some of the owner's bodies behind them.
void enf_beams_face_owner(enf_beams *beams, const enf_bodies *bodies, int32_t owner, uint64_t *met);

/// What they reach of one of these portals.
void enf_beams_window(const enf_beams *beams, int32_t portal, enf_window *window);

/// How often a portal was looked at so far, by all casts.
int64_t enf_beams_visits(const enf_beams *beams);

#endif
