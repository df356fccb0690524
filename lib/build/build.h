// SPDX-License-Identifier: GPL-3.0-or-later
// The recipe: soup to world, stage by stage, with everything the stages leave behind.
#ifndef ENF_BUILD_BUILD_H
#define ENF_BUILD_BUILD_H

#include "build/decimate.h"
#include "build/memory_estimate.h"
#include "build/portal.h"
#include "build/region.h"

/// Who triangulates: our own code (delaunay.h), CGAL, which makes the very same tetrahedra, or TetGen, which
/// may break ties of cospherical points another way.
typedef enum enf_tetrahedralizer {
    ENF_TETRAHEDRALIZER_OWN,
    ENF_TETRAHEDRALIZER_CGAL,
    ENF_TETRAHEDRALIZER_TETGEN
} enf_tetrahedralizer;

/// The stages of the recipe, in order.
typedef enum enf_stage {
    ENF_STAGE_CLEAN,
    ENF_STAGE_TETRAHEDRALIZE,
    ENF_STAGE_SPLIT,
    ENF_STAGE_CONNECT,
    ENF_STAGE_COLOUR,
    ENF_STAGE_DECIMATE,
    ENF_STAGE_PORTALS,
    ENF_STAGE_COUNT
} enf_stage;

/// Called now and then: stage name, 0..1 of that stage. Return false to cancel.
typedef bool enf_progress(void *user, const char *stage, double fraction);

typedef struct enf_build_options {
    enf_clean_options clean;
    enf_tetrahedralizer tetrahedralizer;
    enf_heuristic heuristic;
    enf_stop stop;
    enf_keep keep;
    bool plain_cells; ///< Delaunay tetrahedra, and fine cells as the cuts make them; otherwise flip.h first,
                      ///< and convex ones are joined
    bool measure_resident; ///< stages report resident_bytes, which costs a look into a system file each
    int threads;
    uint64_t memory;        ///< bytes that the process may have at most; 0: what the system allows
    int stages;             ///< run only this many, the first; 0: all
    enf_progress *progress; ///< may be null
    void *progress_user;
} enf_build_options;

#define ENF_STAGE_COUNT_MAX 16

typedef struct enf_stage_report {
    const char *name;
    double seconds, cpu_seconds; ///< by the clock; of the processor, all threads together
    uint64_t peak_bytes;         ///< the most memory that the process had until the end of the stage
    uint64_t resident_bytes;     ///< what it had then, if that was asked for
    bool ran;
    char why[160]; ///< why it was skipped, or what it skipped
} enf_stage_report;

/// A compiled world, still in the builder's own form. Written to a file by format/write.h.
typedef struct enf_build {
    enf_soup soup;
    enf_mesh mesh;
    enf_complex complex;
    enf_regions regions;
    enf_decimation decimation; ///< over kept fine cells only
    int32_t *cell_of;          ///< per fine cell of the complex: final cell, or -1 (discarded)
    int32_t cell_count;        ///< final cells
    enf_portals portals;

    int64_t portals_initial; ///< pairs of kept fine cells with open area between them
    enf_stage_report stages[ENF_STAGE_COUNT_MAX];
    int stage_count;
    double seconds;
    uint64_t peak_bytes;
    enf_memory_counts counts;      ///< what the estimates of memory were made from
    uint64_t peak_bytes_least;     ///< estimate after clean: of a world whose polygons cut nothing
    uint64_t peak_bytes_predicted; ///< estimate once there are tetrahedra
} enf_build;

void enf_build_free(enf_build *build);

/// Memory is estimated after clean, and again once there are tetrahedra; a world that will not fit is refused
/// then (ENF_NO_RESOURCES).
/// Runs clean to portals, or the first stages of them, over build->soup (already read). On failure the build
/// can only be freed.
enf_status enf_build_run(enf_build *build, const enf_build_options *options, enf_error *error);

#endif
