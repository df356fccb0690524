// SPDX-License-Identifier: MIT
// Lines of sight, rays, and points that move: what a straight line meets on its way.
//
// Three things stop a line: walls, that is clean polygons that a cell touches, from the front and from
// behind; cracks between them that the compiler sealed; and doors, that is portals that are closed at the
// moment, and the closed part of those that are partly open. Detail (drawn, but not cutting) stops rays, and
// lines of sight if asked to.
//
// All points are rounded to the fine grid, as those of enf_world_locate are; that is far below a millionth of
// the world's size. From there on, what is hit is decided exactly, by this rule: a polygon stops a segment
// whose ends lie on different sides of its plane and which meets the polygon, border included. Hence
// - walls that share an edge let nothing through between them;
// - a segment that touches the edge of a pillar is stopped, as if it had hit it;
// - a polygon does not stop segments that begin or end in its plane, or run in it: two points of a flat floor
//   see each other along it, and an eye on a wall sees the room;
// - the answer from a to b is that from b to a.
//
// Boxes around walls (a tree of four children a node) find the few that a line comes near: C. Ericson,
// "Real-Time Collision Detection", 2004, chapter 6. No call allocates; any number of threads may call at
// once. The compiler stores what is needed in the file's sight part; of worlds without it, calls return
// ENF_BAD_INPUT.
#ifndef ENFILADE_SIGHT_H
#define ENFILADE_SIGHT_H

#include "enfilade/instance.h"

#ifdef __cplusplus
extern "C" {
#endif

/// Two points. All zero but `size`, `from` and `to` is the default.
typedef struct enf_sight_query {
    size_t size;                 ///< sizeof(enf_sight_query)
    double from[3], to[3];       ///< world
    const enf_place *from_place; ///< where they are, if that is known, as enf_world_locate says it; or null
    const enf_place *to_place;
    int32_t *portals; ///< room for the portals passed, or null
    int32_t portal_capacity;
    bool stopped_by_detail;
} enf_sight_query;

typedef struct enf_sight {
    bool is_free;         ///< nothing stops the segment, no portal that transforms is on its way, and both
                          ///< points are in cells
    enf_place from, to;   ///< where the points are
    int32_t triangle;     ///< one that stops it, not always the first; -1: none that is drawn
    int32_t portal;       ///< one that is closed or transforms; -1: it is not that
    int32_t portal_count; ///< portals passed, in order, from cell to cell; may be more than the capacity. 0
                          ///< without room for them, or if it is not free
} enf_sight;

/// Is the segment between two points free? With an instance its doors count; a portal that transforms leads
/// elsewhere, so a segment through it does not see its end. Null: all portals are open. ENF_BAD_INPUT: the
/// file has no sight part. A point that is in no cell, or not finite, sees nothing.
///
/// The portals passed are those of a chain of cells from the one point to the other. Where the segment passes
/// an edge at which several portals meet, it is one of the possible chains.
ENF_API enf_status enf_sight_between(const enf_world *world, const enf_instance *instance,
                                     const enf_sight_query *query, enf_sight *sight, enf_error *error);

#ifdef __cplusplus
}
#endif
#endif
