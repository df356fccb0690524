// SPDX-License-Identifier: MIT
// The runtime: opens a compiled world and answers questions about it.
//
// A world is immutable once open: any number of threads may query it at once. No query allocates, and nothing
// in a file is trusted: what can be asked about has been checked, every count and index of it. That is one
// pass over the file at the speed of memory when it is opened; or, when it is opened lazily, over each part
// of it when that is loaded, and parts that are not loaded are never touched.
#ifndef ENFILADE_RUN_H
#define ENFILADE_RUN_H

#include "enfilade/format.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct enf_world enf_world;

typedef enum enf_open_mode {
    ENF_OPEN_WHOLE = 0, ///< all parts are checked and loaded
    ENF_OPEN_LAZY       ///< header, table, and what is small: see enf_world_load
} enf_open_mode;

/// Options for opening; null or all zero but `size` is the default.
typedef struct enf_open_options {
    size_t size;         ///< sizeof(enf_open_options)
    bool skip_checksums; ///< trust the disk: counts and indices are checked all the same
    enf_open_mode mode;
} enf_open_options;

/// Maps the file at `path` and checks it. ENF_BAD_INPUT: not a world, damaged, or of a newer major version;
/// ENF_NO_RESOURCES: can't be read. The file must not be changed in place while it is open (the compiler
/// never does that: it renames a new file over the old one).
ENF_API enf_status enf_world_open_path(enf_world **world, const char *path, const enf_open_options *options,
                                       enf_error *error);

/// The same for a file that lies in memory, which the caller keeps unchanged until the world is closed.
/// `bytes` must be aligned to 8 bytes, as malloc and mmap give it (ENF_BAD_USAGE otherwise).
ENF_API enf_status enf_world_open_memory(enf_world **world, const void *bytes, size_t size,
                                         const enf_open_options *options, enf_error *error);

/// Null is fine.
ENF_API void enf_world_close(enf_world *world);

/// Checks parts (enf_load, combined) of a world that was opened lazily, and those that they refer to; from
/// then on they can be used. A part that is loaded already costs nothing, and one that the file does not have
/// counts as loaded. ENF_BAD_INPUT: damaged; then nothing of these is loaded, and what was stays.
/// ENF_NO_RESOURCES without memory.
///
/// Before that, a world answers as one that has nothing in these parts: their arrays are null and their
/// counts 0, points are nowhere, lines of sight fail with ENF_BAD_USAGE. No query loads anything, for it
/// might take long; but instances, views and whatever else is made from a world load what they need when they
/// are made.
///
/// Any thread may load at any time, while others ask. What was made before a part was loaded does not know
/// it.
ENF_API enf_status enf_world_load(enf_world *world, uint32_t loads, enf_error *error);

/// The parts (enf_load) that are loaded.
ENF_API uint32_t enf_world_loaded(const enf_world *world);

/// Everything in the file that is loaded, in place. Lives as long as the world and never changes: ask again
/// after loading more.
ENF_API const enf_file_view *enf_world_file(const enf_world *world);

/// The text at a string offset of the file ("" for one out of range).
ENF_API const char *enf_world_string(const enf_world *world, uint32_t string);

/// A summary, for people and reports. Volumes in world units cubed. Parts that are not loaded count nothing.
typedef struct enf_world_info {
    uint32_t file_major, file_minor;
    uint32_t version[3]; ///< of the compiler
    uint64_t input_hash;
    const char *options; ///< JSON, or ""
    uint64_t file_size;
    uint32_t section_count;
    int64_t points, polygons; ///< clean ones; polygons 0 without the exact part
    int64_t tetrahedra, tetrahedra_cut, fine_cells, fine_cells_discarded, fine_cells_active;
    int64_t regions, regions_kept, regions_of_kind[3];
    double volume_of_kind[3], volume_kept;
    int64_t spawns, spawns_in_cells;
    int64_t portals_initial, collapses;
    int64_t sealed;         ///< cracks between regions that were closed
    double sealed_area;     ///< world units squared
    int64_t cells, portals; ///< openings: pairs of directed portals
    int64_t portal_polygons, portals_of_cell_max;
    int64_t triangles, detail_triangles, groups, materials;
    int64_t input_vertices, input_polygons, input_rejected;
    double box_min[3], box_max[3];
    double grid_step, weld, plane_tolerance, displacement_max, displacement_mean;
    bool leak, has_exact, has_geometry;
} enf_world_info;

ENF_API void enf_world_get_info(const enf_world *world, enf_world_info *info);

/// "air", "rock" or "outside".
ENF_API const char *enf_world_kind_name(enf_world_kind kind);

/// Finds a point given in world coordinates. `hint`: the tetrahedron of an earlier answer nearby, or -1; it
/// changes the time, never the answer. A walk from the hint, or else from a grid of bricks that the compiler
/// stores, takes a few steps as a rule and ends where the point is, or where it leaves the hull. On a border
/// the tetrahedra around the point are looked at, too. Only where a walk takes hundreds of steps, hundreds of
/// tetrahedra meet in the point, or the file has no bricks there, a tree of boxes is searched, O(log n) as
/// far as its boxes do not overlap.
///
/// The point is rounded to the nearest of a grid as fine as doubles of the world's size are; from there on
/// the answer is exact. Of several fine cells that share a point (on a face, edge or vertex) it is the lowest
/// numbered one, where those that belong to a cell come first: a point on a floor is in the room. A point
/// that lies outside the hull by less than frame->locate_rounding counts as inside.
ENF_API enf_place enf_world_locate(const enf_world *world, const double point[3], int32_t hint);

#ifdef __cplusplus
}
#endif
#endif
