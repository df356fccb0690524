// SPDX-License-Identifier: GPL-3.0-or-later
// Clean: from a soup to a mesh that the exact stages can trust. See clean.c for the order of the steps.
#ifndef ENF_BUILD_CLEAN_H
#define ENF_BUILD_CLEAN_H

#include "build/soup.h"

/// What came of the search for a rotation (turn.h).
typedef enum enf_turn_outcome {
    ENF_TURN_OFF,     ///< the plane tolerance is 0
    ENF_TURN_ROUND,   ///< the coordinates are round numbers already: no rotation has touched them
    ENF_TURN_ALIGNED, ///< enough area is axis-parallel already
    ENF_TURN_NONE,    ///< no rotation makes enough area axis-parallel
    ENF_TURN_FOUND,
} enf_turn_outcome;

/// "off", "round", ... : the name used in reports.
const char *enf_turn_outcome_name(enf_turn_outcome outcome);

typedef struct enf_clean_options {
    double weld; ///< world units; corners closer than this become one; < 0: default; 0: only equal ones
    double plane_tolerance;     ///< world units; how far a point may move to be on a plane again (turn.h,
                                ///< flatten.h); < 0: default; 0: off
    const char *const *exclude; ///< globs (fnmatch) over group names; matching polygons are left out
    size_t exclude_count;
    const char *const *detail; ///< globs over group names; matching polygons are drawn but do not cut
    size_t detail_count;
} enf_clean_options;

/// The canonical frame. All stages from clean to portals work in grid coordinates: whole numbers of grid
/// steps, at most 2^53 in magnitude, held in doubles, with the axes permuted and mirrored so that a world and
/// its copy turned by right angles or mirrored look the same to every later stage. A world that most of its
/// area shows to be turned by an odd angle is turned back first (turn.h): grid[a] = sign[a] * turned[axis[a]]
/// / step, where turned[a] = turn[a] . user, or user itself
typedef struct enf_frame {
    double step;    ///< a power of two, in world units
    int axis[3];    ///< a permutation of 0 1 2
    int sign[3];    ///< +1 or -1
    int handedness; ///< +1: a rotation; -1: a mirror (polygons have been turned over so that fronts stay
                    ///< fronts)
    bool is_turned;
    double turn[3][3]; ///< if so: a rotation, its rows are the turned axes in world coordinates
} enf_frame;

/// Clean polygons: exactly planar, convex, counter-clockwise from the front, at least three corners, none of
/// them on the line of its neighbours, in canonical order (so the order of the input does not matter).
typedef struct enf_mesh {
    enf_frame frame;
    size_t point_count;
    double *points; ///< xyz in grid steps; sorted lexicographically; only points that a polygon uses (details
                    ///< keep the soup's)

    size_t polygon_count;
    int64_t *polygon_corner; ///< polygon_count + 1 offsets
    int32_t *corners;        ///< point indices; each polygon starts at its smallest index
    int32_t *polygon_source; ///< soup polygon it came from
    int32_t *polygon_copies; ///< how many equal polygons it stands for, itself included
    /// Three of its corners that span its plane best, in the polygon's orientation.
    int32_t (*polygon_plane)[3];

    size_t detail_count;
    int32_t *details; ///< soup polygons that are detail: drawn, not cutting

    size_t spawn_count;
    double *spawns; ///< xyz in grid steps, not rounded

    // What clean did, for the report.
    double weld, plane_tolerance;               ///< the tolerances used, world units
    double displacement_max, displacement_mean; ///< how far used points moved, world units
    enf_turn_outcome turn_outcome;              ///< whether the world was turned, or why not
    double aligned;      ///< share of the area square to an axis of the frame; 0: nobody looked
    bool flattened;      ///< coordinates were moved to planes or to a lattice
    int lattices;        ///< axes along which most coordinates were round numbers before they were torn
    size_t welded;       ///< points that were merged into another
    size_t triangulated; ///< soup polygons that were cut into several because not planar or not convex
    size_t two_sided;    ///< polygons with a kept twin that faces the other way
} enf_mesh;

void enf_mesh_free(enf_mesh *mesh);

/// Cleans the soup; rejections are added to soup->rejected. ENF_BAD_INPUT when nothing is left.
enf_status enf_mesh_clean(enf_mesh *mesh, enf_soup *soup, const enf_clean_options *options, enf_error *error);

/// Grid coordinates to world coordinates and back (back: not rounded).
void enf_frame_to_world(const enf_frame *frame, const double grid[3], double world[3]);
void enf_frame_to_grid(const enf_frame *frame, const double world[3], double grid[3]);

/// The same for directions: no step, so lengths stay.
void enf_frame_direction_to_world(const enf_frame *frame, const double grid[3], double world[3]);

#endif
