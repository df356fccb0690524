// SPDX-License-Identifier: GPL-3.0-or-later
// How much memory a world will need, before it is needed.
#ifndef ENF_BUILD_MEMORY_ESTIMATE_H
#define ENF_BUILD_MEMORY_ESTIMATE_H

#include "build/clean.h"
#include "build/tetrahedra.h"

/// What is known of a world when an estimate is made.
typedef struct enf_memory_counts {
    uint64_t soup_points, soup_corners, soup_polygons;
    uint64_t points, polygons, corners; ///< clean
    uint64_t tetrahedra;                ///< 0: not known yet
    uint64_t missing;                   ///< triangles of polygons that no tetrahedron has as a face
} enf_memory_counts;

/// All that is known after clean.
enf_memory_counts enf_memory_count(const enf_soup *soup, const enf_mesh *mesh);

/// Adds what is known once there are tetrahedra.
void enf_memory_count_tetrahedra(enf_memory_counts *counts, const enf_mesh *mesh, const enf_tet_mesh *tets);

/// The missing triangles, less those that are missing without harm.
double enf_memory_cuts(const enf_memory_counts *counts);

/// The most memory that the process will have had when the world is written, bytes. Without tetrahedra it is
/// what a world needs whose polygons cut nothing: the least that is to be expected.
uint64_t enf_memory_estimate(const enf_memory_counts *counts);

typedef struct enf_memory_allowance {
    uint64_t bytes;
    const char *limiter; ///< what allows no more
} enf_memory_allowance;

/// So many bytes by --memory; 0: what the system allows now (asks it: a dozen files).
enf_memory_allowance enf_memory_allow(uint64_t bytes);

/// ENF_NO_RESOURCES, with words, if the estimate exceeds what is allowed, or the counts are beyond what this
/// build can number.
enf_status enf_memory_admit(const enf_memory_counts *counts, enf_memory_allowance allowed, enf_error *error);

/// "512M", "16G": a whole number above 0, with K, M, G or T for powers of 1024, or bytes. False for anything
/// else.
bool enf_memory_parse(const char *text, uint64_t *bytes);

#endif
