// SPDX-License-Identifier: GPL-3.0-or-later
// The surfaces of the cells while they merge: which pieces bound a cell, and the area of its silhouette from
// any direction.
//
// A silhouette needs only the contour: the edges between pieces that face the direction and pieces that
// don't. Edges inside the facing part cancel by their numbers, so the sweep sees a small part of a large
// surface.
#ifndef ENF_BUILD_SURFACE_H
#define ENF_BUILD_SURFACE_H

#include "build/contour.h"
#include "build/graph.h"
#include "build/moments.h"
#include "build/silhouette.h"

/// A piece. As its cell s (0, 1) sees it, it is side number 2 * piece + s.
typedef struct enf_surface_piece {
    double area[3]; ///< area vector, pointing out of cell 0, into cell 1; [0] is NaN when the piece is gone:
                    ///< its cells have become one
    int32_t first_corner, corner_count; ///< the outline, counter-clockwise seen from cell 1's side
} enf_surface_piece;

/// What is known of a cell as a body.
typedef struct enf_body {
    int32_t *sides;        ///< possibly with gone pieces among them
    int32_t side_count;    ///< length of that list
    int32_t side_capacity; ///< 0: the list is a part of fine_sides
    int32_t fine_count;    ///< fine cells in it; 1: convex
    int32_t moments;       ///< where they are kept; -1: it is a fine cell
    double volume;
    float low[3], high[3]; ///< bounding box, rounded outwards
} enf_body;

/// Pieces are numbered canonically (by their cells, then their corners), so nothing depends on their order in
/// the graph.
typedef struct enf_surface {
    int32_t piece_count;
    int32_t (*piece_cell)[2]; ///< fine cells; the smaller number first, -1 last
    bool *piece_open;         ///< these two until enf_surface_forget_cells
    enf_surface_piece *pieces;
    int32_t *corners; ///< vertex numbers

    int32_t vertex_count;
    double (*vertices)[3]; ///< corners that are equal to the last bit are one vertex
    size_t vertex_capacity;

    int32_t cell_count;
    enf_body *bodies;
    int32_t *fine_sides;  ///< the sides of all fine cells
    enf_moments *moments; ///< of bodies of several fine cells
    int32_t moments_count;
    int32_t *moments_free; ///< places in moments that a body has left
    int32_t moments_free_count;

    bool *piece_hidden; ///< working memory, all false between calls: pieces that plugs cover
    int32_t *hidden;    ///< those pieces
    int32_t *plugs;     ///< cells taken as part of the cell whose silhouette is next
    size_t hidden_count, hidden_capacity, plug_count, plug_capacity;
    int32_t *facing; ///< sides that face the direction
    size_t facing_capacity;
    enf_contour contour;
    enf_silhouette silhouette;
} enf_surface;

/// Copies what it needs of the graph. ENF_BAD_INPUT for cell numbers or offsets out of range.
enf_status enf_surface_create(enf_surface *surface, const enf_graph *graph, enf_error *error);
void enf_surface_free(enf_surface *surface);

/// Frees what tells which piece belongs to which fine cells: nothing below asks for it.
void enf_surface_forget_cells(enf_surface *surface);

/// The true area of a piece that is not gone.
double enf_surface_piece_area(const enf_surface *surface, int32_t piece);

/// An open piece whose cells have become one.
void enf_surface_drop(enf_surface *surface, int32_t piece);

/// Adds the body of `gone` to that of `kept`. The pieces between them must be dropped before the next
/// silhouette, but after the last one. Returns false when there is no memory: then the surface is of no more
/// use.
bool enf_surface_merge(enf_surface *surface, int32_t kept, int32_t gone);

/// Area of the cell's silhouette seen along the unit vector `direction`. When half the sum of all projected
/// pieces, an upper bound, is at most `enough`, returns that instead. Negative when there is no memory.
double enf_surface_silhouette(enf_surface *surface, int32_t cell, const double direction[3], double enough);

/// For the next silhouette only: hides a piece of the cell that leads to a neighbour.
bool enf_surface_hide(enf_surface *surface, int32_t piece);

/// For the next silhouette only: takes a neighbour as part of the cell when that changes nothing, since all
/// its pieces that face the direction, or all that don't, are hidden ones, that is, lie on the cell.
/// Otherwise the pieces hidden since there were `hidden_before` come back. Small neighbours that fill dents
/// make the contour of a large cell a lot shorter.
bool enf_surface_plug(enf_surface *surface, int32_t neighbour, const double direction[3],
                      size_t hidden_before);

/// A lower bound of the silhouette, in constant time: from the moments, and from the volume and the longest
/// way along the direction through the bounding box.
double enf_surface_silhouette_bound(const enf_surface *surface, int32_t cell, const double direction[3]);

/// An upper bound of the silhouette, in constant time: that of the bounding box.
double enf_surface_box_silhouette(const enf_surface *surface, int32_t cell, const double direction[3]);

/// True when the remaining pieces of the cell all have the same normal: then a body that has been joined to
/// it along all its other pieces gained no silhouette by that, in any direction. Looks at no more than a few
/// pieces.
bool enf_surface_is_lid(const enf_surface *surface, int32_t cell);

#endif
