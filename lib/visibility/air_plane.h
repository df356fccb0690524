// SPDX-License-Identifier: GPL-3.0-or-later
// Which plane to divide a part of the world by: the plane of one of its walls.
#ifndef ENF_VISIBILITY_AIR_PLANE_H
#define ENF_VISIBILITY_AIR_PLANE_H

#include "visibility/air_walls.h"

typedef struct enf_air_plane {
    double normal[3], offset; ///< normal . x = offset; the normal has length 1
} enf_air_plane;

typedef enum enf_air_side {
    ENF_AIR_ON = 0,
    ENF_AIR_FRONT = 1,
    ENF_AIR_BACK = 2,
    ENF_AIR_BOTH = 3
} enf_air_side;

/// Some walls, by their numbers, and what is to be known of them.
typedef struct enf_air_part {
    const enf_walls *walls;
    const int32_t *items;
    int32_t count;
    int depth;        ///< of the tree, where the part is
    double tolerance; ///< world units: what is nearer to a plane counts as on it
} enf_air_part;

/// Of a height above a plane.
static inline enf_air_side enf_air_side_of(double height, double tolerance) {
    return height > tolerance ? ENF_AIR_FRONT : height < -tolerance ? ENF_AIR_BACK : ENF_AIR_ON;
}

/// On which side of the plane a wall lies.
enf_air_side enf_air_plane_side(const enf_air_plane *plane, const enf_walls *walls, int32_t wall,
                                double tolerance);

/// Chooses a plane for a part of one wall or more, with up to so many threads; it is the same for any number.
/// False without memory.
bool enf_air_plane_choose(const enf_air_part *part, int threads, enf_air_plane *plane);

#endif
