// SPDX-License-Identifier: GPL-3.0-or-later
// Random worlds of many cells that need no builder: the cubes of the air of world_fixture are joined at
// random to (concave) cells, with random convex portals in some of the faces between them, and walls
// elsewhere; a cell sees what is at most two portals away.
#ifndef ENF_TESTS_RUN_WORLDS_H
#define ENF_TESTS_RUN_WORLDS_H

#include "enfilade/run.h"

typedef struct run_world {
    unsigned char *bytes; ///< the file
    size_t size;
    enf_world *world;
    double box_min[3], box_max[3]; ///< of the cells
} run_world;

/// `side`: cubes along an edge, even; half of them are air. `turned`: no face is parallel to an axis.
run_world run_world_grid(int side, bool turned, uint64_t seed);

/// The world of world_fixture: two cells, with lines of sight and the exact complex, without a visible set.
run_world run_world_whole(int side);

#ifdef ENFILADE_CLI
/// Compiles an OBJ file, gzipped or not.
run_world run_world_compile(const char *path);
#endif

/// Puts numbers that are finite and make no sense into the portals and the points of triangles, and opens it
/// again.
void run_world_scramble(run_world *world, uint64_t *seed);

/// Lets some cells list a portal twice, and another one not, and opens the world again.
void run_world_scramble_lists(run_world *world, uint64_t *seed);

/// Such a number.
double run_nasty(uint64_t *seed);

void run_world_free(run_world *grid);

/// The next of a sequence (splitmix64).
uint64_t run_random(uint64_t *seed);

/// From 0 to 1, without 1.
double run_random_share(uint64_t *seed);

#endif
