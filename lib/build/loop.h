// SPDX-License-Identifier: GPL-3.0-or-later
// Convex polygons on planes (loops), and cutting them with planes, exactly. A pool holds the loops of one
// small job (a facet, a wall of portals).
#ifndef ENF_BUILD_LOOP_H
#define ENF_BUILD_LOOP_H

#include "build/complex.h"
#include "build/geometry.h"
#include "build/subdivision.h"

typedef struct enf_loop {
    int32_t plane;
    int32_t first, count; ///< corners in the pool
} enf_loop;

typedef struct enf_pool {
    enf_geometry geometry;
    enf_corner *corners;
    size_t corner_count, corner_capacity;
    int8_t *signs; ///< of the last loop that was classified
    size_t sign_capacity;
    bool failed; ///< out of memory, sometime since the pool was made
} enf_pool;

void enf_pool_free(enf_pool *pool);

/// A loop of `count` corners, copied into the pool.
enf_loop enf_pool_loop(enf_pool *pool, int32_t plane, const enf_corner *corners, int32_t count);

/// A facet's outline, without corners on straight lines.
enf_loop enf_facet_loop(const enf_subdivision *subdivision, int32_t facet, enf_pool *pool);

/// The same corners the other way round (for a plane that faces the other way).
enf_loop enf_pool_reversed(enf_pool *pool, enf_loop loop);

typedef enum enf_position {
    ENF_POSITION_ON,     ///< every corner is on the plane
    ENF_POSITION_BEHIND, ///< none in front, some behind
    ENF_POSITION_FRONT,  ///< none behind, some in front
    ENF_POSITION_ACROSS, ///< some behind, some in front
} enf_position;

/// Fills pool->signs for the loop's corners.
enf_position enf_pool_classify(enf_pool *pool, enf_loop loop, int32_t plane);

/// Cuts a loop that lies ACROSS and has just been classified. Either result may be null.
void enf_pool_cut(enf_pool *pool, enf_loop loop, int32_t plane, enf_loop *behind, enf_loop *front);

/// Keeps the part of *loop on one side (-1 behind, +1 in front) of the plane. False if no area is left.
bool enf_pool_keep(enf_pool *pool, enf_loop *loop, int32_t plane, int side);

/// The side (-1 or +1) of the edge plane of its corner `i` on which a loop lies.
int enf_pool_edge_side(enf_pool *pool, enf_loop loop, int32_t i);

/// Area vector (by the right-hand rule along the corners) from rounded positions.
void enf_loop_area(const enf_corner *corners, int64_t count, const double (*positions)[3], double area[3]);

/// Appends a loop to an array of loops (grows it). False without memory.
bool enf_loops_append(enf_loops *loops, const enf_corner *corners, int32_t count);
void enf_loops_free(enf_loops *loops);

#endif
