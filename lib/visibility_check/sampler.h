// SPDX-License-Identifier: GPL-3.0-or-later
// Which cells see each other, found by throwing lines: never all pairs, but each with a line to show for it.
// A test tool: it shares nothing with the solver.
#ifndef ENF_VISIBILITY_CHECK_SAMPLER_H
#define ENF_VISIBILITY_CHECK_SAMPLER_H

#include "visibility_check/check_witness.h"
#include "visibility_check/line_simplex.h"

/// Clearance: the least distance between the line and the line of any edge of a portal on the way. (The edge
/// itself may be further away, never nearer.)
typedef struct enf_sampler_line {
    double point[2][3];
    int32_t cell; ///< one that it goes through
} enf_sampler_line;

typedef struct enf_sampler {
    const enf_portal_graph *graph;
    uint64_t random;
    double (*edge)[6];   ///< of each corner: moment and direction of the edge to the next one, about `middle`
    double (*normal)[3]; ///< of each opening
    double middle[3], size;
    int32_t *corner_next;

    int32_t *pair_line;    ///< of each pair of cells (enf_sampler_pair): the line that joins them, or -1
    float *pair_clearance; ///< of that line
    enf_sampler_line *lines;
    size_t line_count, line_capacity;
    uint64_t pair_count; ///< found so far

    // The walk of the last line: the cells, and between them the portals.
    int32_t *walk_cell, *walk_portal;
    double *walk_clearance;
    int32_t walk_first, walk_last; ///< its cells are walk_cell[walk_first .. walk_last]

    // Pairs whose lines are to be led on, into the cells behind.
    int32_t (*queue)[2];
    size_t queue_count, queue_capacity;
    uint64_t *tried; ///< a row for each cell: the portals that lines from there were to be led through
    size_t tried_words;
    int32_t *sequence; ///< the portals of the line that is led on
    double (*columns)[ENF_LINE_ROWS];
    size_t column_capacity;

    uint64_t rays;      ///< thrown, led on, or jittered
    uint64_t crossings; ///< portals passed by them
    uint64_t led_on, programs;
    bool failed; ///< no memory
} enf_sampler;

/// The same seed and the same number of rays find the same pairs. The graph must outlive the sampler.
enf_status enf_sampler_make(enf_sampler *sampler, const enf_portal_graph *graph, uint64_t seed,
                            enf_error *error);
void enf_sampler_free(enf_sampler *sampler);

/// Goes on until `seconds` of processor time have passed or `rays` more were thrown; 0: no such limit.
enf_status enf_sampler_run(enf_sampler *sampler, double seconds, uint64_t rays, enf_error *error);

/// Where the pair i != j stands in pair_line and pair_clearance.
static inline size_t enf_sampler_pair(int32_t i, int32_t j) {
    size_t low = (size_t)(i < j ? i : j), high = (size_t)(i < j ? j : i);
    return high * (high - 1) / 2 + low;
}

/// The line that joins i and j; false if none was found. Nothing is certain until enf_witness_check agrees.
bool enf_sampler_witness(const enf_sampler *sampler, int32_t i, int32_t j, enf_witness *witness);

#endif
