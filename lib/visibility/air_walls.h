// SPDX-License-Identifier: GPL-3.0-or-later
// The walls around the air of a compiled world: for each occluder the part of it that air touches.
#ifndef ENF_VISIBILITY_AIR_WALLS_H
#define ENF_VISIBILITY_AIR_WALLS_H

#include "enfilade/format.h"

/// A convex polygon. The plane: normal . x = offset.
typedef struct enf_wall {
    double normal[3], offset; ///< world units; the normal has length 1
    int32_t first, count;     ///< of its corners
    double middle[3], radius; ///< a sphere that holds them
    bool has_air_behind;      ///< on both sides: it is all that parts the air there
} enf_wall;

typedef struct enf_walls {
    int32_t count, corner_count;
    enf_wall *walls;
    double (*corners)[3]; ///< world; counter-clockwise seen from where the normal points
    size_t wall_capacity, corner_capacity;
} enf_walls;

/// Of each occluder the convex hull of what touches kept cells (clean leaves convex occluders only), and
/// sealed cracks one by one, on some threads: what comes out is the same for any number. Needs the exact part
/// of the file (view->has_exact). *walls is overwritten; free it in any case.
enf_status enf_air_walls_make(enf_walls *walls, const enf_file_view *view, int threads, enf_error *error);

/// Adds a wall; the corners are copied, and held by a sphere. False without memory.
bool enf_walls_add(enf_walls *walls, const enf_wall *like, const double (*corners)[3], int32_t count);

/// How many planes the walls lie in, about: what is next to the same counts as such. `size` is the largest
/// coordinate in magnitude. -1 without memory.
int32_t enf_walls_count_planes(const enf_walls *walls, double size);

void enf_walls_free(enf_walls *walls);

#endif
