// SPDX-License-Identifier: GPL-3.0-or-later
// Lines thrown through the fine cells of a compiled world: which of its cells see each other for sure. They
// know nothing of what beams and partitions say.
#ifndef ENF_VISIBILITY_WORLD_LINES_H
#define ENF_VISIBILITY_WORLD_LINES_H

#include "enfilade/format.h"
#include "visibility/pvs.h"
#include "visibility/sight.h"

typedef struct enf_world_lines {
    const enf_file_view *view; ///< not owned
    enf_portal_graph graph;    ///< of the fine cells
    enf_shapes shapes;
    enf_sight sight;
    int32_t *cell_first; ///< cell_count + 1 offsets into cell_openings
    int32_t *cell_openings;
    int32_t *passed, *cells; ///< scratch: portals and cells along a line
    uint64_t seed;
    enf_pvs seen;  ///< symmetric; at the start every cell sees itself
    int64_t count; ///< lines thrown
} enf_world_lines;

/// Needs the exact part of the file. The same seed throws the same lines. *lines is overwritten; free it in
/// any case.
enf_status enf_world_lines_make(enf_world_lines *lines, const enf_file_view *view, uint64_t seed,
                                enf_error *error);
void enf_world_lines_free(enf_world_lines *lines);

/// Throws a line through random points of two openings of the fine graph, and follows it both ways from the
/// first one: all cells on the way see each other.
void enf_world_lines_throw(enf_world_lines *lines, int32_t opening, int32_t other);

/// The same, through random openings.
void enf_world_lines_throw_any(enf_world_lines *lines);

/// Follows a line onwards from all openings of the cell that it passes, on either side of its ends.
void enf_world_lines_follow(enf_world_lines *lines, const enf_line *line, int32_t cell);

/// The next random number, from 0 up to 1.
double enf_world_lines_share(enf_world_lines *lines);

/// For each pair of `claimed` that has not been seen throws up to `tries` lines between openings of the two,
/// until it is; stops when there are `most` lines in all. Returns how many pairs (i < j) it tried.
int64_t enf_world_lines_aim(enf_world_lines *lines, const enf_pvs *claimed, int tries, int64_t most);

#endif
