// SPDX-License-Identifier: GPL-3.0-or-later
// A small world made by hand, without the pipeline: n x n x n cubes of six tetrahedra each. A wall at half of
// x divides air (two cells, with one portal at half of y) from rock; one tetrahedron in the air is cut in
// two.
#ifndef ENF_TESTS_WORLD_FIXTURE_H
#define ENF_TESTS_WORLD_FIXTURE_H

#include "build/write.h"

#define FIXTURE_SPACING 4 ///< grid steps between points
#define FIXTURE_ALLOCATIONS 128

typedef struct fixture {
    enf_build build;
    int side; ///< n, even
    bool has_screen;
    int32_t cut; ///< the tetrahedron that is cut; its second fine cell is the last one
    void *memory[FIXTURE_ALLOCATIONS];
    int memory_count;
} fixture;

/// The frame's step, axes and signs may be any; null: step 1/4, nothing turned.
void fixture_make(fixture *fixture, int side, const enf_frame *frame);

/// The same with a screen in the air: a thin wall at half of z, in the cell of small y, all across it.
void fixture_make_with_screen(fixture *fixture, int side, const enf_frame *frame);
void fixture_free(fixture *fixture);

/// The tetrahedron that a fine cell is, or is a part of.
int32_t fixture_tetrahedron_of(const fixture *fixture, int32_t fine);

/// The saved file in memory from malloc.
unsigned char *fixture_save(const fixture *fixture, size_t *size);

/// A small world and its file, as cmocka's group set-up and tear-down.
typedef struct fixture_saved {
    fixture fixture;
    unsigned char *bytes;
    size_t size;
} fixture_saved;

int fixture_set_up(void **state);
int fixture_tear_down(void **state);

/// Reads a whole file (malloc).
unsigned char *fixture_read_file(const char *path, size_t *size);

/// After a change to a section's bytes: corrects all checksums, so that the checks behind them are reached.
void fixture_fix_checksums(unsigned char *file);

#endif
