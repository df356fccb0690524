// SPDX-License-Identifier: GPL-3.0-or-later
// Space while it is being cut: convex cells, the facets that they share, and the half-edges around these, as
// a radial-edge structure (K. Weiler, "The radial edge structure", 1988). Every vertex and every edge exists
// once, however many cells meet there, so a cut asks about each of them once, and neighbours always fit.
//
// Cuts are local: a cut divides one cell, and of the others only facets and edges that they share with it.
#ifndef ENF_BUILD_SUBDIVISION_H
#define ENF_BUILD_SUBDIVISION_H

#include "build/geometry.h"
#include "build/tetrahedra.h"

/// One side of a facet's outline. Around a facet, halves turn counter-clockwise seen from its plane's front.
typedef struct enf_half {
    int32_t vertex; ///< where it starts
    int32_t next;   ///< around the facet
    int32_t edge;
    int32_t radial;     ///< the next half at the same edge; 0: the last
    int32_t before;     ///< the one whose next this is; 0: the first
    int32_t edge_plane; ///< holds the edge; never parallel to the facet. Collinear halves have the same one
    int32_t facet;
} enf_half;

typedef struct enf_share {
    int32_t source;  ///< >= 0: lies on this facet of the tetrahedra; < 0: on the cut of node -1 - source
    int32_t cell[2]; ///< behind, in front; -1: outside the hull; -2 - t: tetrahedron t, which stays as it is
    int32_t next[2]; ///< the next facet around that cell; -1: the last
    int32_t first;   ///< a half; -1: the facet is gone
    int32_t cover;   ///< the owner's: see settle.c
} enf_share;

/// A part of the tetrahedra that is cut by itself: no facet lies between tetrahedra of different parts that
/// may be cut.
typedef struct enf_tet_part {
    int32_t tetrahedron_count, facet_count;
    const int32_t *tetrahedra; ///< ascending; cell i is this one
    const int32_t *facets;     ///< ascending: all of theirs, and others that must be looked at closely
    const int32_t *cell_of;    ///< per tetrahedron of the world: its cell; -1: it stays as it is
} enf_tet_part;

enum { ENF_CELL_WAITS, ENF_CELL_CUT, ENF_CELL_CLOSED }; ///< what becomes of a cell: see settle.h

typedef struct enf_cut_edge {
    int32_t from, to;   ///< vertices, on different sides
    int32_t half, edge; ///< a half on the edge
    int32_t vertex;     ///< the crossing with the plane, if it has been made, else -1
} enf_cut_edge;

/// A facet of the cell that is held against the plane.
typedef struct enf_beside {
    int32_t facet;
    bool behind, front; ///< has corners there
    bool along;         ///< has an edge on the plane
} enf_beside;

typedef struct enf_subdivision {
    enf_geometry geometry; ///< points, planes and crossings; the vertices

    enf_half *halves; ///< number 0 is none: it is written to where one would have to be told from it
    size_t half_count, half_capacity;
    enf_share *facets;
    size_t facet_count, facet_capacity;
    int32_t free_half, free_facet, free_edge; ///< lists of what can be used again; -1: none
    int32_t *edge_half;                       ///< the first half at each edge; 0: none
    int32_t *edge_slot;                       ///< scratch: where an edge is in `cut_edges`
    size_t edge_count, edge_capacity, slot_capacity;

    int32_t *cell_facet;  ///< the first facet around each cell; -1: the cell is gone
    int32_t *cell_parent; ///< 2 * node + child, or -1 - cell: a tetrahedron
    uint8_t *cell_state;
    size_t cell_count, cell_capacity, parent_capacity, state_capacity;

    int32_t tetrahedron_count, tetrahedron_planes; ///< planes below the latter are the tetrahedra's
    int32_t *tetrahedron_root;                     ///< per cell that was one; as in enf_complex
    size_t root_capacity;
    int32_t *node_plane;
    int32_t (*node_child)[2];
    size_t node_count, node_capacity, child_capacity;

    // The plane that cells are held against, and what is known of it.
    int32_t plane, plane_mark;
    bool joined; ///< the cell at hand is a part of several tetrahedra: facets of these may lie in one plane
    enf_plane_filter filter;
    int32_t *vertex_sign; ///< per vertex: plane_mark * 4 + sign + 1, where the sign is known
    size_t sign_capacity;

    // Scratch of one cell: its facets, its edges that the plane crosses, and the outline of the cut.
    enf_beside *shares;
    size_t share_count, share_capacity;
    enf_cut_edge *cut_edges;
    size_t cut_edge_count, cut_edge_capacity;
    int32_t *touching; ///< its corners on the plane, some of them more than once
    size_t touching_count, touching_capacity;
    struct enf_outline {
        int32_t from, to, edge, edge_plane;
    } * outline;
    size_t outline_count, outline_capacity;
    int32_t *outline_at; ///< per vertex: the outline's part that starts there
    size_t outline_at_capacity;
    struct enf_pairing {
        int32_t half, mark, edge;
    } * pairing; ///< per point, see pair_halves
    size_t pairing_capacity;
    int32_t pairing_mark;
} enf_subdivision;

/// Begins with the tetrahedra of a part as cells; a subdivision that has been used (or is all zero) is used
/// again. The geometry must hold points and the planes of the tetrahedra's facets, plane f for facet f; its
/// crossings are not taken. About how many cuts there will be saves moving arrays. False without memory; free
/// it in any case.
bool enf_subdivision_start(enf_subdivision *subdivision, const enf_geometry *geometry,
                           const enf_tet_mesh *tets, const enf_tet_part *part, size_t cuts);
void enf_subdivision_free(enf_subdivision *subdivision);

/// Frees the facets and their edges; the trees of cuts and the vertices stay.
void enf_subdivision_forget_facets(enf_subdivision *subdivision);

/// From now on cells are held against this plane.
void enf_subdivision_take_plane(enf_subdivision *subdivision, int32_t plane);

/// The side of the plane on which a vertex lies; asked once per plane.
static inline int enf_subdivision_sign(enf_subdivision *subdivision, int32_t vertex) {
    int32_t known = subdivision->vertex_sign[vertex];
    if (known >> 2 == subdivision->plane_mark) return (known & 3) - 1;
    int sign = enf_geometry_side_by(&subdivision->geometry, vertex, subdivision->plane, &subdivision->filter);
    subdivision->vertex_sign[vertex] = subdivision->plane_mark * 4 + sign + 1;
    return sign;
}

/// Does the plane pass through the inside of the cell? If so, `shares`, `cut_edges` and `touching` are filled
/// for what follows. Negative without memory.
int enf_subdivision_crosses(enf_subdivision *subdivision, int32_t cell);

/// The vertex where the plane crosses cut_edges[i], made if need be; -1 without memory.
int32_t enf_subdivision_cut_vertex(enf_subdivision *subdivision, size_t i);

/// Forgets the vertices that have been made for a cell which is not cut after all.
void enf_subdivision_leave(enf_subdivision *subdivision);

/// Cuts the cell that the plane was last found to cross: a new node, the cell behind keeps its number, the
/// one in front is new. Returns the node, or -1 without memory (the subdivision can only be freed then).
int32_t enf_subdivision_cut(enf_subdivision *subdivision, int32_t cell);

/// Takes a facet out of the lists at its edges; its number, its halves' and those of edges without facets
/// will be used again. It stays in the lists of its cells.
void enf_subdivision_remove(enf_subdivision *subdivision, int32_t facet);

/// Where a facet of the tetrahedra has its three sides: corner i of it, and the plane (of another facet) that
/// holds the edge from there to the next.
void enf_subdivision_triangle(const enf_tet_mesh *tets, int32_t facet, int32_t corner[3],
                              int32_t edge_plane[3]);

/// The plane that a facet lies on.
static inline int32_t enf_subdivision_plane(const enf_subdivision *subdivision, int32_t facet) {
    int32_t source = subdivision->facets[facet].source;
    return source >= 0 ? source : subdivision->node_plane[-1 - source];
}

#endif
