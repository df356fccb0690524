// SPDX-License-Identifier: GPL-3.0-or-later
// Clean: from a soup to a mesh that the exact stages can trust. See clean.c for the order of the steps.
#ifndef ENF_BUILD_CLEAN_H
#define ENF_BUILD_CLEAN_H

#include "build/soup.h"

typedef struct enf_clean_options {
    double weld; ///< world units; corners closer than this become one; < 0: default; 0: only equal ones
    double plane_tolerance;     ///< world units; see clean.c; < 0: a tenth of weld; 0: off
    const char *const *exclude; ///< globs (fnmatch) over group names; matching polygons are left out
    size_t exclude_count;
    const char *const *detail; ///< globs over group names; matching polygons are drawn but do not cut
    size_t detail_count;
} enf_clean_options;

/// The canonical frame. All stages from clean to portals work in grid coordinates: whole numbers of grid
/// steps, at most 2^53 in magnitude, held in doubles, with the axes permuted and mirrored so that a world and
/// its copy turned by right angles or mirrored look the same to every later stage.   grid[a] = sign[a] *
/// user[axis[a]] / step
typedef struct enf_frame {
    double step;    ///< a power of two, in world units
    int axis[3];    ///< a permutation of 0 1 2
    int sign[3];    ///< +1 or -1
    int handedness; ///< +1: a rotation; -1: a mirror (polygons have been turned over so that fronts stay
                    ///< fronts)
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
    size_t welded;                              ///< points that were merged into another
    size_t triangulated; ///< soup polygons that were cut into several because not planar or not convex
    size_t two_sided;    ///< polygons with a kept twin that faces the other way
} enf_mesh;

void enf_mesh_free(enf_mesh *mesh);

/// Cleans the soup; rejections are added to soup->rejected. ENF_BAD_INPUT when nothing is left.
enf_status enf_mesh_clean(enf_mesh *mesh, enf_soup *soup, const enf_clean_options *options, enf_error *error);

/// Grid coordinates to world coordinates and back (back: not rounded).
void enf_frame_to_world(const enf_frame *frame, const double grid[3], double world[3]);
void enf_frame_to_grid(const enf_frame *frame, const double world[3], double grid[3]);

#endif
