// SPDX-License-Identifier: GPL-3.0-or-later
// One run of the stress harness: soup, pipeline, file, check, oracles.
#ifndef ENF_BUILD_STRESS_RUN_H
#define ENF_BUILD_STRESS_RUN_H

#include "build/build.h"
#include "stress/stress_truth.h"

/// How a run ended.
typedef enum enf_stress_outcome {
    ENF_STRESS_UNFINISHED,
    ENF_STRESS_FINE,
    ENF_STRESS_REFUSED, ///< the pipeline gave an error for a soup that it should have compiled
    ENF_STRESS_BROKEN,  ///< check names an invariant that does not hold, or the file can't be read back
    ENF_STRESS_WRONG,   ///< an oracle disagrees
    ENF_STRESS_HARNESS, ///< the harness itself failed (memory, a folder for temporary files)
} enf_stress_outcome;

typedef struct enf_stress_result {
    enf_stress_outcome outcome;
    char reason[320];                         ///< if not fine
    const char *volatile stage;               ///< of the pipeline: the last one that was begun
    double seconds;                           ///< CPU time of the pipeline; 0 until it has ended
    uint64_t peak_bytes;                      ///< most memory that the process had until then
    int64_t rejected;                         ///< polygons and lines that were left out
    double cell_seconds;                      ///< of that until decimate begins: clean to colour
    double delaunay_seconds;                  ///< of CGAL's triangulation of the same vertices alone
    int32_t polygons, tetrahedra, fine_cells; ///< also of a run that did not finish, as far as it came
    enf_stress_verdict verdict;
} enf_stress_result;

typedef struct enf_stress_options {
    const char
        *folder; ///< for the file, which is removed again; null: no file, the image in memory is checked
    int cells;   ///< > 0: odd seeds are decimated down to so many cells; otherwise --stop auto
    void (*compiled)(void); ///< called between the pipeline and the rest; may be null
    bool yardstick;         ///< also time CGAL's Delaunay triangulation alone
    int points;     ///< how many the oracles ask for in a run (and as many segments, a quarter of surfaces)
    bool time_only; ///< nothing is written or judged
} enf_stress_options;

/// Compiles a soup with one thread, writes it, checks it, asks the oracles. The soup is taken from the case.
void enf_stress_compile(enf_stress_case *made, const enf_build_options *options,
                        const enf_stress_options *harness, enf_stress_result *result);

/// The same for a family and seed.
void enf_stress_run(int family, uint64_t seed, const enf_stress_options *harness, enf_stress_result *result);

/// What a family and seed are compiled with: mostly --keep all; kinds of regions do not depend on it.
enf_build_options enf_stress_build_options(const enf_stress_case *made, uint64_t seed, int cells);

#endif
