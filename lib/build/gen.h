// SPDX-License-Identifier: GPL-3.0-or-later
// The built-in test worlds (`enfilade gen`): OBJ text, the same bytes for the same settings on every machine.
#ifndef ENF_BUILD_GEN_H
#define ENF_BUILD_GEN_H

#include <stdio.h>

#include "enfilade/base.h"

/// Writes the world `name` as OBJ text to `out`. Every room has a comment "# spawn x y z room-N" with a point
/// in its air; polygons are triangles whose front (counter-clockwise) faces the air; shells have no thickness
/// and no T-junctions, so that noise and rotation open no cracks.
///
/// `settings` are "key=value" texts, each key at most once:
///   scale=S | scale=SX,SY,SZ   default 1; not 0; a mirroring scale turns the triangles over
///   noise=A                    default 0; moves every distinct vertex by a pseudo-random vector that is at
///                              most A long
///   seed=N                     default 1; picks the noise, and the shape of `caverns`
///   rotate=AX,AY,AZ            degrees about x, then y, then z
///   translate=X,Y,Z
/// applied in this order (so A is in world units); spawns are transformed, without the noise. Worlds `office`
/// and `caverns` also take
///   floors=F (default 2), rooms=R (per floor, default 6), detail=N (each rectangle becomes N x N; the rock
///   of caverns is as much finer; default 1).
///
/// ENF_BAD_USAGE for an unknown name or key or a bad value, with words naming what is allowed;
/// ENF_NO_RESOURCES when memory runs out or `out` can't be written.
enf_status enf_gen_write(const char *name, const char *const *settings, size_t setting_count, FILE *out,
                         enf_error *error);

/// The name of world number `index`, or null after the last. *description (if not null) gets one line on it.
const char *enf_gen_list(size_t index, const char **description);

#endif
