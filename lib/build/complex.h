// SPDX-License-Identifier: GPL-3.0-or-later
// The fine complex: convex fine cells, the facets between them and the pieces of those facets, all exact.
//
// Everything is defined by planes, and every plane by three points with whole-number coordinates (grid
// steps), so that every question about the complex has an exact answer (base/exact.h):
//
//   point   grid coordinates of a clean vertex
//   plane   three points, or two points and an axis it is parallel to (the plane through a polygon's edge)
//   vertex  a point, or the crossing of three planes
//   loop    a convex polygon on a plane: corners (vertex, plane of the edge that leaves it),
//   counter-clockwise
//           seen from the plane's front (positive) side
//   facet   a flat convex area with one fine cell on each side (or one, and the outside of the hull): a share
//   of a
//           tetrahedron's face, or of the cut made by an input polygon. A cell may have several in one plane.
//   cover   the share of an input polygon that lies on a facet
//   piece   a part of a facet, open or occluded: most facets are one piece
//
// Facets are shared by the two cells, so a loop is kept once; a cover or piece that is the whole facet has no
// corners of its own (see enf_complex_piece).
#ifndef ENF_BUILD_COMPLEX_H
#define ENF_BUILD_COMPLEX_H

#include "build/clean.h"
#include "build/geometry.h"

/// What a piece is, where it is not the number of a cover.
enum {
    ENF_PIECE_OPEN = -1,
    ENF_PIECE_SEALED =
        -2, ///< a crack between two regions, narrower than the weld distance; counts as occluded
};

typedef struct enf_corner {
    int32_t vertex;
    int32_t edge_plane; ///< holds the edge from this corner to the next; never parallel to the loop's plane
} enf_corner;

/// Loops: an offsets array into a flat corner array.
typedef struct enf_loops {
    int32_t count;
    size_t offset_capacity;
    int32_t *offset; ///< count + 1
    enf_corner *corners;
    size_t corner_count, corner_capacity;
} enf_loops;

typedef struct enf_complex {
    int32_t point_count;
    const double *points; ///< xyz, grid steps; borrowed from the mesh

    int32_t plane_count;
    /// Three point numbers; the front side is where they turn counter-clockwise. If [2] is -1 - a (a = 0, 1,
    /// 2), the plane goes through points [0] and [1], parallel to axis a: as if its third point were [0] plus
    /// one step along a.
    int32_t (*planes)[3];

    int32_t vertex_count;         ///< the first point_count vertices are the points
    int32_t (*vertex_planes)[3];  ///< vertex_count entries; -1 -1 -1 for points
    double (*vertex_position)[3]; ///< grid steps; rounded for crossings

    // Tetrahedra and, where one was cut, a tree of cuts: the exact way to find a point's cell. Tetrahedra
    // that were joined before they were cut share a tree. Cells were joined where that made one convex cell
    // of two: leaves may share a cell.
    int32_t tetrahedron_count;
    int32_t (*tetrahedra)[4];  ///< point numbers, positively oriented
    int32_t *tetrahedron_root; ///< >= 0: a node; < 0: the fine cell -1 - root
    int32_t node_count;
    int32_t *node_plane;
    int32_t (*node_child)[2]; ///< behind, in front of the plane; >= 0 node, < 0 fine cell -1 - child

    int32_t cell_count;
    int32_t *cell_facet;  ///< cell_count + 1 offsets into cell_facets
    int32_t *cell_facets; ///< the facets around each cell, ascending; which side: see facet_cell

    int32_t facet_count;
    enf_loops facets; ///< strictly convex; neighbours in one cell may share only part of an edge
    int32_t *facet_plane;
    int32_t (*facet_cell)[2]; ///< the cell behind, the cell in front; -1: outside the hull
    int32_t *facet_cover;     ///< facet_count + 1 offsets into covers
    int32_t *facet_piece;     ///< facet_count + 1 offsets into pieces

    enf_loops covers;       ///< no corners: the whole facet
    int32_t *cover_polygon; ///< mesh polygon
    uint8_t *cover_side;    ///< the side of the facet that sees the polygon's front: 0 behind, 1 in front

    enf_loops pieces;     ///< no corners: the whole facet
    int32_t *piece_facet; ///< ascending
    int32_t *piece_cover; ///< a cover that the whole piece lies in, ENF_PIECE_OPEN or ENF_PIECE_SEALED

    int32_t *seen_offset; ///< cell_count + 1 offsets
    int32_t *seen;        ///< mesh polygons whose front a fine cell sees, ascending

    // Work done and work skipped, for the report.
    int32_t tetrahedra_cut; ///< tetrahedra that some polygon crosses; the others are one fine cell each
    int32_t cells_joined;   ///< that went into others: tetrahedra before they were cut, pieces of them after
    uint64_t predicates[ENF_TIERS]; ///< by what decided them
} enf_complex;

void enf_complex_free(enf_complex *complex);

/// The share of the predicates that a tier decided (see geometry.h); 0 if there were none.
static inline double enf_complex_tier_share(const enf_complex *complex, int tier) {
    double all = 0;
    for (int i = 0; i < ENF_TIERS; i++) all += (double)complex->predicates[i];
    return all > 0 ? (double)complex->predicates[tier] / all : 0;
}

/// The corners of a cover or piece: its own, or its facet's. *count receives their number.
const enf_corner *enf_complex_cover(const enf_complex *complex, int32_t cover, int32_t facet, int32_t *count);
const enf_corner *enf_complex_piece(const enf_complex *complex, int32_t piece, int32_t *count);

/// The cells behind and in front of a piece; -1: outside the hull.
static inline const int32_t *enf_complex_piece_cells(const enf_complex *complex, int32_t piece) {
    return complex->facet_cell[complex->piece_facet[piece]];
}

/// Volume in grid steps cubed, from rounded coordinates.
double enf_complex_cell_volume(const enf_complex *complex, int32_t cell);

/// What tells a hairline from a body: a crack, or a needle, left by rounded coordinates.
typedef struct enf_body_size {
    double volume, surface, low[3], high[3];
} enf_body_size;

/// Thinner than `thin`: twice the volume is less than `thin` times the surface, or (a needle; rounding leaves
/// nothing of its volume) the surface is less than `thin` times the length of the bounding box.
bool enf_body_is_hairline(const enf_body_size *body, double thin);

/// Adds a fine cell, with all its facets as surface, to a body that was {.low = +inf, .high = -inf} or had
/// others before.
void enf_complex_measure_cell(const enf_complex *complex, int32_t cell, enf_body_size *body);

/// Area vector of a piece, grid steps squared, pointing to the facet's front.
void enf_complex_piece_area(const enf_complex *complex, int32_t piece, double area[3]);

/// The least distance between two parallel lines in the piece's plane that have it between them, from rounded
/// coordinates, grid steps.
double enf_complex_piece_width(const enf_complex *complex, int32_t piece);

/// The mean of a piece's corners: a point inside it, up to rounding.
void enf_complex_piece_centre(const enf_complex *complex, int32_t piece, double centre[3]);

#endif
