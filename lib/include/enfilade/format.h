// SPDX-License-Identifier: MIT
// The bytes of a world file (.enf) as C structs, and a view of a file whose every count and index has been
// checked. lib/format/layout.md describes the same byte by byte, with the rules for older and newer versions.
//
// Two coordinate systems: *world* is what the user gave; *grid* is whole numbers of grid steps in the
// canonical frame (see enf_file_frame). What a runtime draws or clips with is in world coordinates; the exact
// complex is in grid coordinates, where it is exact.
#ifndef ENFILADE_FORMAT_H
#define ENFILADE_FORMAT_H

#include "enfilade/base.h"

#define ENF_FILE_MAGIC "ENFILADE"            ///< 8 bytes, no terminating zero in the file
#define ENF_FILE_MAJOR 3                     ///< a reader refuses another major version
#define ENF_FILE_MINOR 0                     ///< a reader accepts any minor version of its major one
#define ENF_FILE_ALIGNMENT 16                ///< sections begin at multiples of this
#define ENF_FILE_GRID_MAX 9007199254740992.0 ///< 2^53: no grid coordinate is larger in magnitude

/// The first 64 bytes.
typedef struct enf_file_header {
    char magic[8];
    uint32_t major, minor;
    uint32_t header_size; ///< 64
    uint32_t entry_size;  ///< 48: bytes of one enf_file_section
    uint32_t section_count;
    uint32_t reserved; ///< 0
    uint64_t file_size;
    uint64_t table_offset;
    uint64_t table_checksum;  ///< enf_hash64 of the table, seed 0
    uint64_t header_checksum; ///< enf_hash64 of the 56 bytes before this field, seed 0
} enf_file_header;

/// One entry of the section table.
typedef struct enf_file_section {
    char tag[8];           ///< padded with zeros
    uint64_t offset, size; ///< bytes; offset is a multiple of 16
    uint64_t count;        ///< elements; count * element_size = size
    uint64_t checksum;     ///< enf_hash64 of the section's bytes, seed 0
    uint32_t element_size;
    uint32_t flags; ///< ENF_FILE_MUST_KNOW
} enf_file_section;

#define ENF_FILE_MUST_KNOW 1u ///< a reader that does not know this section must refuse the file

/// How the world was made. Neither times nor threads nor paths: the same input and options give the same
/// bytes.
typedef struct enf_file_provenance {
    uint32_t version[3]; ///< of the program: major, minor, patch
    uint32_t options;    ///< string: the options as JSON ("" if none were given)
    uint64_t input_hash; ///< enf_soup.content_hash
    int64_t input_vertices, input_polygons, input_rejected;
    int64_t welded, triangulated, two_sided; ///< by clean
    int64_t tetrahedra_cut;
    int64_t fine_cells_discarded, fine_cells_active;
    int64_t portals_initial, collapses;
    int64_t pieces_merged, slivers; ///< by the portal stage
    int64_t sealed;                 ///< cracks between regions that were closed
    double sealed_area;             ///< world units squared
    int64_t leak;                   ///< 1: a spawn's region reaches the outside
} enf_file_provenance;

/// grid[a] = sign[a] * turned[axis[a]] / step, where turned is the world's point, or what enf_file_turn makes
/// of it
typedef struct enf_file_frame {
    double step;        ///< a power of two, world units
    int32_t axis[3];    ///< a permutation of 0 1 2
    int32_t sign[3];    ///< +1 or -1
    int32_t handedness; ///< +1 or -1; -1: grid is a mirror image, loops turn the other way in the world
    int32_t reserved;
    double box_min[3], box_max[3];              ///< of all clean points, world
    double weld, plane_tolerance;               ///< the tolerances used, world units
    double displacement_max, displacement_mean; ///< how far clean moved points, world units
    double locate_scale;    ///< a power of two >= 1: points are located on a grid this many times finer
    double locate_rounding; ///< grid steps; a point this little outside the hull still counts as inside
} enf_file_frame;

/// A rotation: turned[a] = rows[a] . world. Worlds whose walls are parallel to no axis have one.
typedef struct enf_file_turn {
    double rows[3][3];
} enf_file_turn;

/// Corner of a loop: see enf_corner in lib/build/complex.h.
typedef struct enf_file_corner {
    int32_t vertex;
    int32_t edge_plane;
} enf_file_corner;

typedef struct enf_file_region {
    double volume;                ///< world units cubed
    double front_area, back_area; ///< of the occluders around it, world units squared
    int32_t winding;
    uint8_t kind; ///< 0 air, 1 rock, 2 outside
    uint8_t kept, touches_outside, ambiguous;
} enf_file_region;

typedef struct enf_file_spawn {
    double position[3]; ///< world
    int32_t fine_cell;  ///< -1: outside the hull
    int32_t cell;       ///< -1: in a discarded region
} enf_file_spawn;

/// A cell: a connected union of fine cells of one region.
typedef struct enf_file_cell {
    double box_min[3], box_max[3]; ///< world
    double volume;                 ///< world units cubed
    int64_t triangle_first;        ///< range of cell_triangles
    int32_t triangle_count;
    int32_t portal_first, portal_count; ///< range of cell_portals
    int32_t region;
} enf_file_cell;

/// A directed portal. Its twin, which leads back, is number i ^ 1; even ones lead to the higher cell number.
typedef struct enf_file_portal {
    int32_t from, to;                     ///< cells
    int32_t polygon_first, polygon_count; ///< range of portal_polygons, at least one
    double centre[3], radius;             ///< bounding sphere, world
} enf_file_portal;

/// One convex polygon of a directed portal. It faces the cell it leads from, like a wall would:
/// counter-clockwise seen from there, and the plane is positive there. The n-th polygon of the twin is the
/// same one turned over.
typedef struct enf_file_portal_polygon {
    double plane[4];                    ///< world; a x + b y + c z + d, (a, b, c) of length 1
    double area;                        ///< world units squared
    int32_t vertex_first, vertex_count; ///< range of portal_vertices, at least three
    int32_t loop;                       ///< the exact polygon: portal_loop_* of the view
    int32_t reserved;
} enf_file_portal_polygon;

/// How the visible set was found: the rungs of the ladder, each within the one before.
typedef enum enf_file_pvs_method {
    ENF_FILE_PVS_REACH,
    ENF_FILE_PVS_FACING,
    ENF_FILE_PVS_HOURGLASS,
    ENF_FILE_PVS_LP,
    ENF_FILE_PVS_EXACT,
    ENF_FILE_PVS_METHODS
} enf_file_pvs_method;

typedef struct enf_file_pvs {
    uint32_t method; ///< enf_file_pvs_method
    uint32_t reserved;
    int64_t pairs; ///< directed, every cell with itself included
} enf_file_pvs;

enum { ENF_FILE_BOX_TETRAHEDRA = 8 }; ///< so many are in a leaf of the hierarchy of boxes; fewer in the last

/// A node of the bounding volume hierarchy over tetrahedra, in depth-first order: walk forward, and where the
/// point is outside the box jump to `next`. A leaf holds tetrahedra with consecutive numbers.
typedef struct enf_file_box {
    float min[3], max[3]; ///< grid steps, rounded outwards
    int32_t next;         ///< > this node's number, <= box_count
    int32_t tetrahedron;  ///< the first one; -1: not a leaf
} enf_file_box;

/// The number after the last tetrahedron of a leaf, where there are `count` in all.
static inline int32_t enf_file_box_end(const enf_file_box *leaf, int32_t count) {
    const int32_t left = count - leaf->tetrahedron;
    return leaf->tetrahedron + (left < ENF_FILE_BOX_TETRAHEDRA ? left : ENF_FILE_BOX_TETRAHEDRA);
}

/// A box of equal bricks, count[0] * count[1] * count[2] of them; the last axis runs fastest. Each knows a
/// tetrahedron from which it is not far to the points in it.
typedef struct enf_file_start {
    double origin[3];   ///< grid steps
    double per_step[3]; ///< bricks per grid step, >= 0
    int32_t count[3];   ///< at least 1 each
    int32_t reserved;   ///< 0
} enf_file_start;

/// The fine grid: what lines of sight and barriers are decided on, exactly. Its coordinates are whole numbers
/// of grid steps / frame->locate_scale, at most 2^53 in magnitude.
typedef struct enf_file_sight {
    double box_min[3], box_max[3]; ///< around all barriers and clean points, fine grid
    double extent;                 ///< none of these is larger in magnitude; at least 1
} enf_file_sight;

/// What a line of sight may meet.
typedef enum enf_file_barrier_kind {
    ENF_FILE_BARRIER_WALL,   ///< a clean polygon at a cell; index: its first triangle, or -1
    ENF_FILE_BARRIER_DETAIL, ///< a triangle that is drawn, but does not cut; index: the triangle
    ENF_FILE_BARRIER_CRACK,  ///< a sealed crack at a cell; index: -1
    ENF_FILE_BARRIER_PORTAL, ///< a polygon of a portal; index: the even portal
    ENF_FILE_BARRIER_KINDS
} enf_file_barrier_kind;

/// A convex polygon, counter-clockwise from its front. Flat, but for cracks and portals, whose corners are
/// rounded.
typedef struct enf_file_barrier {
    double normal[3];                   ///< towards the front, length 1, rounded
    int32_t vertex_first, vertex_count; ///< range of barrier_vertices, at least three
    int32_t kind;                       ///< enf_file_barrier_kind
    int32_t index;                      ///< of what it is: see the kinds
} enf_file_barrier;

/// A node of a tree of boxes around barriers, with up to four children. Nodes are stored breadth first: the
/// inner children of all nodes, in order, are nodes 1, 2, 3 and so on.
typedef struct enf_file_barrier_node {
    float bound[3][2][4]; ///< fine grid: per axis the smallest and the largest coordinates of the children
    int32_t child[4];     ///< >= 0: a node; -1: none; < -1: barrier -2 - child
} enf_file_barrier_node;

#define ENF_FILE_BARRIER_DEPTH_MAX 96 ///< levels of such a tree

/// A triangle to draw, counter-clockwise from its front.
typedef struct enf_file_triangle {
    int32_t point[3];     ///< render_points
    int32_t normal[3];    ///< render_normals, or -1
    int32_t texcoord[3];  ///< render_texcoords, or -1
    int32_t polygon;      ///< input polygon, in the order of the input
    int32_t group;        ///< group_names
    int32_t material;     ///< material_names, or -1
    int32_t mesh_polygon; ///< clean polygon it belongs to; -1: detail (drawn, not cutting)
    int32_t cell;         ///< detail: the cell that holds its middle, or -1; otherwise -1
} enf_file_triangle;

/// The parts of a world that can be checked and used one by one, to be combined. What is in none of them (how
/// the world was made, its frame, regions, spawns and texts) is always there.
typedef enum enf_load {
    ENF_LOAD_CELLS = 1,    ///< cells and portals
    ENF_LOAD_LOCATION = 2, ///< where points are
    ENF_LOAD_SIGHT = 4,    ///< lines of sight
    ENF_LOAD_SEEN = 8,     ///< which cells a cell may see
    ENF_LOAD_DRAW = 16,    ///< triangles
    ENF_LOAD_EXACT = 32,   ///< the exact complex, for `enfilade check`
    ENF_LOAD_ALL = 63
} enf_load;

/// Pointers into a checked file. All arrays are the file's own bytes; "offsets" arrays have one entry more
/// than what they divide. Parts that a file may leave out have null pointers and counts of 0.
typedef struct enf_file_view {
    const uint8_t *bytes;
    size_t size;
    const enf_file_header *header;
    const enf_file_section *sections; ///< header->section_count

    const enf_file_provenance *provenance;
    const enf_file_frame *frame;
    const enf_file_turn *turn; ///< null: the world was not turned
    const char *strings;       ///< zero-terminated texts one after the other; a string is an offset into it
    int64_t string_bytes;

    // World: regions, cells, portals.
    int32_t region_count;
    const enf_file_region *regions;
    int32_t spawn_count;
    const enf_file_spawn *spawns;
    int32_t leak_point_count;
    const double (*leak_points)[3]; ///< world; from the spawn to the outside

    int32_t cell_count;
    const enf_file_cell *cells;
    int32_t portal_count; ///< directed ones: twice the number of openings
    const enf_file_portal *portals;
    int32_t portal_polygon_count;
    const enf_file_portal_polygon *portal_polygons;
    int32_t portal_vertex_count;
    const double (*portal_vertices)[3]; ///< world
    int32_t cell_portal_count;
    const int32_t *cell_portals; ///< portals that lead out of each cell, ascending

    // Point location, grid coordinates. Shared with the exact complex.
    int32_t point_count;
    const double (*points)[3];
    int32_t plane_count;
    const int32_t (*planes)[3]; ///< as in enf_complex
    int32_t tetrahedron_count;
    const int32_t (*tetrahedra)[4];
    const int32_t *tetrahedron_root; ///< >= 0: node; < 0: fine cell -1 - root; several may name the same one
    const int32_t (
        *tetrahedron_next)[4]; ///< the tetrahedron across the face opposite to each corner; -1: the hull
    int32_t node_count;
    const int32_t *node_plane;
    const int32_t (
        *node_child)[2]; ///< behind, in front; >= 0: a node with a higher number; < 0: fine cell -1 - child
    const double (
        *node_normal)[3]; ///< of the node's plane, length 1; the plane goes through points[planes[p][0]]
    int32_t fine_count;
    const int32_t *fine_region;
    const int32_t *fine_cell; ///< the cell it went into; -1: discarded
    int32_t box_count;
    const enf_file_box *boxes;
    const enf_file_start *start; ///< null: there is none, nor start_tetrahedra
    int32_t start_count;
    const int32_t *start_tetrahedra; ///< per brick the tetrahedron that holds its middle, or -1

    // The exact complex (all or nothing); the arrays of enf_complex and enf_mesh, see there.
    bool has_exact;
    int32_t vertex_count;
    const int32_t (*vertex_planes)[3];
    const double (*vertex_position)[3];
    const int32_t *fine_facet; ///< fine_count + 1 offsets into fine_facets
    int32_t fine_facet_count;
    const int32_t *fine_facets;
    int32_t facet_count;
    const int32_t *facet_offset;
    int64_t facet_corner_count;
    const enf_file_corner *facet_corners;
    const int32_t *facet_plane;
    const int32_t (*facet_fine)[2]; ///< the fine cells behind and in front; -1: outside the hull
    const int32_t *facet_cover;     ///< facet_count + 1
    const int32_t *facet_piece;     ///< facet_count + 1
    int32_t cover_count;
    const int32_t *cover_offset; ///< a cover or piece without corners is the whole facet
    int64_t cover_corner_count;
    const enf_file_corner *cover_corners;
    const int32_t *cover_polygon;
    const uint8_t *cover_side;
    int32_t piece_count;
    const int32_t *piece_offset;
    int64_t piece_corner_count;
    const enf_file_corner *piece_corners;
    const int32_t *piece_facet;
    const int32_t *piece_cover; ///< >= 0 occluded by that cover, -1 open, -2 a sealed crack
    const int32_t *seen_offset; ///< fine_count + 1
    int64_t seen_count;
    const int32_t *seen; ///< mesh polygons
    int32_t mesh_polygon_count;
    const int64_t *mesh_polygon_corner; ///< mesh_polygon_count + 1
    int64_t mesh_corner_count;
    const int32_t *mesh_corners;            ///< points
    const int32_t *mesh_polygon_source;     ///< input polygon
    const int32_t (*mesh_polygon_plane)[3]; ///< points
    int32_t portal_loop_count;              ///< enf_portals.polygons: half as many as portal_polygons
    const int32_t *portal_loop_offset;
    int64_t portal_loop_corner_count;
    const enf_file_corner *portal_loop_corners;
    const int32_t *portal_loop_plane;
    const uint8_t *portal_loop_side; ///< 1: the higher cell lies in front of the plane; 0: the lower does

    // The visible set (all or nothing).
    const enf_file_pvs *pvs;   ///< null: there is none
    const int64_t *pvs_offset; ///< cell_count + 1 offsets into pvs_rows
    int64_t pvs_byte_count;
    const uint8_t *pvs_rows; ///< per cell the cells it sees, coded: lib/format/layout.md

    // Lines of sight (all or nothing), fine grid.
    const enf_file_sight *sight; ///< null: there is none
    int32_t barrier_count;
    const enf_file_barrier *barriers;
    int32_t barrier_vertex_count;
    const double (*barrier_vertices)[3];
    int32_t wall_node_count; ///< the tree of all barriers but portals
    const enf_file_barrier_node *wall_nodes;
    int32_t portal_node_count; ///< the tree of the portals' polygons
    const enf_file_barrier_node *portal_nodes;

    // What is drawn (all or nothing), world coordinates.
    bool has_geometry;
    int32_t render_point_count;
    const double (*render_points)[3]; ///< the input's points in its order; then corners that only clean knows
    int32_t render_normal_count;
    const double (*render_normals)[3];
    int32_t render_texcoord_count;
    const double (*render_texcoords)[2];
    int32_t triangle_count;
    const enf_file_triangle *triangles; ///< those of clean polygons in their order, then detail
    int64_t cell_triangle_count;
    const int32_t
        *cell_triangles; ///< per cell the triangles whose front it sees, and detail near it; ascending
    int32_t group_count;
    const uint32_t *group_names; ///< strings
    int32_t material_count;
    const uint32_t *material_names; ///< strings
} enf_file_view;

typedef enum enf_world_kind { ENF_WORLD_AIR = 0, ENF_WORLD_ROCK = 1, ENF_WORLD_OUTSIDE = 2 } enf_world_kind;

/// Where a point is.
typedef struct enf_place {
    int32_t cell;        ///< -1: in no cell (a discarded region, or outside the hull)
    int32_t fine_cell;   ///< -1: outside the convex hull of the world, or not finite
    int32_t region;      ///< -1 likewise
    int32_t tetrahedron; ///< that the point was found in: a hint for the next query; -1 likewise
    enf_world_kind kind;
} enf_place;

#endif
