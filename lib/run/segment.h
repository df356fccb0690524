// SPDX-License-Identifier: MIT
// Segments between points of the fine grid, and what they meet. Which side, hit or missed: always decided
// exactly.
#ifndef ENF_RUN_SEGMENT_H
#define ENF_RUN_SEGMENT_H

#include "enfilade/format.h"

typedef struct enf_segment {
    double from[3], to[3]; ///< whole numbers, at most 2^53 in magnitude
} enf_segment;

/// The nearest point of the fine grid. False for a point beyond it.
bool enf_fine_point(const enf_file_view *view, const double world[3], double fine[3]);

/// How a segment and a barrier meet.
typedef struct enf_meeting {
    double share;    ///< how far along the segment: 0 to 1, rounded
    bool from_front; ///< it comes from the barrier's front, or goes to its back
    bool touches;    ///< it begins or ends in the barrier's plane
} enf_meeting;

/// Does the segment pass through the barrier? Its ends must lie on different sides of the barrier's plane,
/// and the point between them on the polygon, border included. So what touches an edge or a corner is hit, on
/// whichever of the polygons there; a polygon in whose plane an end or the whole segment lies is not. The
/// answer is the same from the other end. *share: how far along (0 to 1, rounded); may be null.
bool enf_segment_passes(const enf_file_view *view, const enf_segment *segment,
                        const enf_file_barrier *barrier, double *share);

/// The same, or one end lies on the polygon and the other beside its plane.
bool enf_segment_meets(const enf_file_view *view, const enf_segment *segment, const enf_file_barrier *barrier,
                       enf_meeting *meeting);

#endif
