// SPDX-License-Identifier: MIT
// Paths through portals: the next portal towards a cell, how far it is, and a line to walk along.
//
// A path is a chain of portals. Its length is that of the straight steps between the middles of its portals,
// from its start to its end; inside a cell there are no walls for a step. (Cells may be concave, so a step
// may cut a corner. Who needs to walk around corners and furniture does so within the cell.) The shortest
// path is found exactly by this measure. Of equally short ones it is the one whose first portal has the
// lowest number, then the second, and so on, with or without a table.
//
// Cells with exactly two portals are no places to decide: they are contracted into chains (the thesis, 3.3.4;
// it did so by hand for a game). If a table of lengths between all remaining portals fits into the memory
// allowed, answers come from it; otherwise, and when a door on the path is closed, from a search (A*, guided
// by straight lengths and landmarks).
//
// Doors that are closed are not passed; those partly open are, as if they were open. Portals that transform
// cost nothing and lead on in their target cell; as long as an instance has any, paths are searched portal by
// portal, and ties go to the last portal with the lowest number, then the last but one.
//
// Threads: enf_paths is immutable, any number of threads may share it. A finder holds the scratch memory of
// one thread; every thread makes its own, once. No call but the two that create takes memory. Doors may be
// set meanwhile (see instance.h); one query may then see some doors before and others after a change.
#ifndef ENFILADE_PATH_H
#define ENFILADE_PATH_H

#include "enfilade/instance.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct enf_paths enf_paths;
typedef struct enf_path_finder enf_path_finder;

/// Options of paths; null or all zero but `size` is the default.
typedef struct enf_paths_options {
    size_t size;              ///< sizeof(enf_paths_options)
    uint64_t table_bytes_max; ///< no larger table is made; 0: 4 MiB (about 1000 portals next to junctions)
    bool skip_table;          ///< always search
    int32_t landmarks;        ///< that searches are guided by, at most 16; 0: 4
    bool skip_landmarks;      ///< searches are guided by straight lengths alone
    bool skip_contraction;    ///< every cell counts as a junction
} enf_paths_options;

/// Prepares the paths of a world, which must stay open as long as they live. Takes 64 bytes for each pair of
/// portals and 5 for each cell. For n pairs next to junctions, each landmark takes 8 n bytes and one search
/// of the whole world, and the table 4 n^2 bytes and n such searches. ENF_BAD_USAGE for options out of range,
/// ENF_NO_RESOURCES without memory.
ENF_API enf_status enf_paths_create(enf_paths **paths, const enf_world *world,
                                    const enf_paths_options *options, enf_error *error);

/// Null is fine.
ENF_API void enf_paths_free(enf_paths *paths);

typedef struct enf_paths_info {
    int32_t cells, junctions; ///< all cells; those that are left by contraction
    int32_t portals, gates;   ///< pairs of portals; those next to junctions
    bool has_table;
    uint64_t table_bytes; ///< of the table, whether it was made or not
    double precision;     ///< of lengths: so many world units for each portal passed
} enf_paths_info;

ENF_API void enf_paths_get_info(const enf_paths *paths, enf_paths_info *info);

/// Options of a finder; null or all zero but `size` is the default.
typedef struct enf_path_finder_options {
    size_t size;             ///< sizeof(enf_path_finder_options)
    int32_t sound_steps_max; ///< steps of a search for several sound paths (sound.h); 0: 4096
} enf_path_finder_options;

/// The paths must live as long as the finder. Takes 80 bytes for each pair of portals, 4 for each cell,
/// and at most 84 for each step. ENF_BAD_USAGE for
/// options out of range, ENF_NO_RESOURCES without memory.
ENF_API enf_status enf_path_finder_create(enf_path_finder **finder, const enf_paths *paths,
                                          const enf_path_finder_options *options, enf_error *error);

/// Null is fine.
ENF_API void enf_path_finder_free(enf_path_finder *finder);

/// From where to where. All zero but `size`, the cells and the points is the default.
typedef struct enf_path_query {
    size_t size;                ///< sizeof(enf_path_query)
    int32_t from_cell, to_cell; ///< -1: the cell of the point, which is then searched for
    const double *from, *to;    ///< points, world, or null: anywhere in the cell, so the path begins at its
                                ///< first portal, or ends at its last one
    int32_t *portals;           ///< room for the portals passed, or null
    int32_t portal_capacity;
    double (*points)[3]; ///< room for the line, or null; needs both points
    int32_t point_capacity;
    double tolerance;   ///< of the line: it is pulled until no point moves farther, as a share of the line's
                        ///< length; 0: 1e-5
    int32_t sweeps_max; ///< of the line: at most so many times each point is moved; 0: 200
} enf_path_query;

typedef struct enf_path {
    bool is_found; ///< there is a way; all else is 0 or -1 if not
    int32_t first; ///< portal: the next one towards the goal; -1: in the same cell
    double length; ///< world units; 0 within a cell unless both ends are points
    int32_t
        portal_count; ///< may be more than the capacity. -1: not known, as nobody asked for portals or points
    int32_t
        point_count;    ///< of the line: start, a point in each portal (for one that transforms also where it
                        ///< comes out), end. More than the capacity: no point was written. 0: not asked for
    double line_length; ///< of the line, without jumps of portals that transform
    int32_t sweeps;     ///< that it took
} enf_path;

/// Finds the shortest path. Written are the first `portal_capacity` portals.
///
/// The line is the path pulled tight like a string: every point lies in its portal, and the line is as short
/// as relaxation gets it. First all points move at once towards shorter ways (a sum of smoothed lengths,
/// where each point goes to the mean of its neighbours, weighted by nearness, or what is next to that in its
/// portal: E. Weiszfeld, Tohoku Mathematical Journal 43, 1937), which gets strings off edges that several
/// portals share; then each goes to the exact best point between its neighbours, in turn, until none moves.
/// The length is convex in the points if portals are convex, so this ends at or near the shortest line
/// through these portals (not: through other portals, which may be shorter once pulled).
///
/// ENF_BAD_USAGE: a cell that the world does not have, a point that is not finite, neither cell nor point, or
/// a line between ends without points. A point in no cell has no path.
ENF_API enf_status enf_path_find(enf_path_finder *finder, const enf_instance *instance,
                                 const enf_path_query *query, enf_path *path, enf_error *error);

/// A cell near a point.
typedef struct enf_near_cell {
    int32_t cell;
    int32_t portal;  ///< through which it is reached first; -1: it is where the point is
    double distance; ///< along the shortest path to the middle of that portal, world units; 0 for the first
} enf_near_cell;

/// Lists the cells within a distance along the graph, nearest first, equally near ones by their portal's
/// number: what a radar or a map shows (the thesis, 3.3.4). Closed doors are not passed. `cell` is that of
/// the point, or -1: it is searched for. Writes at most `capacity` cells to `out`; *count receives how many
/// there are, but the search ends with one more than the capacity. ENF_BAD_USAGE as above, or for a distance
/// that is no number.
ENF_API enf_status enf_path_near(enf_path_finder *finder, const enf_instance *instance, int32_t cell,
                                 const double point[3], double distance, enf_near_cell *out, int32_t capacity,
                                 int32_t *count, enf_error *error);

#ifdef __cplusplus
}
#endif
#endif
