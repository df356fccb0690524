// SPDX-License-Identifier: MIT
// The runtime: opens a compiled world and answers questions about it.
//
// A world is immutable once open: any number of threads may query it at once. No query allocates, and nothing
// in a file is trusted: what opens has been checked, every count and index of it.
#ifndef ENFILADE_RUN_H
#define ENFILADE_RUN_H

#include "enfilade/format.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct enf_world enf_world;

/// Options for opening; null or all zero but `size` is the default.
typedef struct enf_open_options {
    size_t size;         ///< sizeof(enf_open_options)
    bool skip_checksums; ///< trust the disk: counts and indices are checked all the same
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

/// Everything in the file, in place. Lives as long as the world.
ENF_API const enf_file_view *enf_world_file(const enf_world *world);

/// The text at a string offset of the file ("" for one out of range).
ENF_API const char *enf_world_string(const enf_world *world, uint32_t string);

/// A summary, for people and reports. Volumes in world units cubed.
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
/// stores, takes a bounded number of steps, a few as a rule; where it does not end inside a fine cell (on
/// borders, outside of the hull, from bad hints in files without bricks) a tree of boxes is searched, O(log
/// n) as far as its boxes do not overlap.
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
