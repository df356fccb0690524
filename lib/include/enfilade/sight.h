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
// A door is like a wall, but for ends that lie on it: they are on the side of the cell that they are in.
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
/// an edge at which several portals meet, it is one of the possible chains. One that runs within the plane of
/// a portal does not pass that portal, and its chain may end before its last cell.
ENF_API enf_status enf_sight_between(const enf_world *world, const enf_instance *instance,
                                     const enf_sight_query *query, enf_sight *sight, enf_error *error);

/// A ray. All zero but `size`, `origin` and `direction` is the default.
typedef struct enf_ray {
    size_t size;            ///< sizeof(enf_ray)
    double origin[3];       ///< world
    double direction[3];    ///< world, of any length but 0
    double length;          ///< world units; 0 or less: without end
    const enf_place *place; ///< of the origin, if that is known; or null
    int32_t depth_max;      ///< at most so many portals that transform; 0: 16
    int32_t *portals;       ///< room for the portals passed, or null
    int32_t portal_capacity;
    bool ignores_detail;
} enf_ray;

typedef enum enf_ray_end {
    ENF_RAY_NOTHING = 0, ///< it went its length, or left the world
    ENF_RAY_TRIANGLE,    ///< it hit what is drawn, or a sealed crack (triangle -1)
    ENF_RAY_DOOR,        ///< it hit a portal that is closed there
    ENF_RAY_TOO_DEEP,    ///< it would pass more portals that transform than allowed
    ENF_RAY_NOWHERE      ///< it begins in no cell
} enf_ray_end;

typedef struct enf_ray_hit {
    enf_ray_end end;
    double point[3];     ///< where it ended, world
    double direction[3]; ///< the way it went in the end, turned and scaled by transforms; 1 long at first
    double distance;  ///< from the origin along the ray; what lies behind a transform that scales is measured
                      ///< as before it
    int32_t triangle; ///< -1: none
    int32_t portal;   ///< the closed one, or the one that is one too many; -1: none
    int32_t cell;     ///< where it ended
    int32_t depth;    ///< portals that transform, passed
    int32_t portal_count; ///< portals passed, in order; may be more than the capacity
} enf_ray_hit;

/// The first thing that a ray meets, from cell to cell through portals; those that transform turn the ray.
/// Each straight part is a segment of the fine grid and meets walls by the rule above; distances are rounded.
/// Of a file without geometry `triangle` is -1. ENF_BAD_INPUT: the file has no sight part. ENF_BAD_USAGE: no
/// direction, or something is not finite (the length may be infinite).
ENF_API enf_status enf_ray_cast(const enf_world *world, const enf_instance *instance, const enf_ray *ray,
                                enf_ray_hit *hit, enf_error *error);

/// A step of a point that moves. All zero but `size`, `place`, `from` and `to` is the default.
typedef struct enf_step {
    size_t size;           ///< sizeof(enf_step)
    enf_place place;       ///< where it is, by the step before or enf_world_locate
    double from[3], to[3]; ///< world, a straight way
    int32_t depth_max;     ///< at most so many portals that transform; 0: 16
    int32_t *portals;      ///< room for the portals passed, or null
    int32_t portal_capacity;
} enf_step;

typedef struct enf_stepped {
    enf_place place;   ///< where it is now
    double point[3];   ///< `to`, or what transforms have made of it, or where it was stopped
    double matrix[12]; ///< from the world where it was to the world where it is: all transforms passed, 3 x 4
    int32_t portal;    ///< the one that stopped it, since closed or one too many; -1: none
    int32_t depth;     ///< portals that transform, passed
    int32_t portal_count; ///< portals passed, in order; may be more than the capacity
} enf_stepped;

/// Follows a moving point through portals, without a search: the way within a fine cell costs one point
/// location with a hint. Walls do not stop it (what stops a body is the caller's to say); doors do. Outside
/// of all cells it only locates. The portals passed are those of a chain of cells, as for enf_sight_between.
/// ENF_BAD_INPUT: the file has no sight part.
ENF_API enf_status enf_world_follow(const enf_world *world, const enf_instance *instance,
                                    const enf_step *step, enf_stepped *stepped, enf_error *error);

#ifdef __cplusplus
}
#endif
#endif
