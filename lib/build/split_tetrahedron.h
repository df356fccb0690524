// SPDX-License-Identifier: GPL-3.0-or-later
// One tetrahedron cut by the polygons that cross it, into a small tree of cuts whose leaves are convex cells.
#ifndef ENF_BUILD_SPLIT_TETRAHEDRON_H
#define ENF_BUILD_SPLIT_TETRAHEDRON_H

#include "build/arrangement.h"
#include "build/loop.h"

/// Growing results of a run of tetrahedra. Numbers are local: facets from `facet_count` of the tetrahedra up
/// are cuts of this block, vertices from point_count up are its own crossings.
typedef struct enf_split_block {
    enf_crossing *crossings; ///< taken from the pool after each tetrahedron
    size_t crossing_count, crossing_capacity;

    int32_t *root; ///< per tetrahedron of the block: node, or -1 - cell; both local
    size_t root_count, root_capacity;
    int32_t (*node_child)[2];
    int32_t *node_plane; ///< node i made cut facet i
    size_t node_count, node_child_capacity, node_plane_capacity;

    int32_t *cell_tetrahedron;
    int32_t *cell_face; ///< first face of each cell
    size_t cell_count, cell_tetrahedron_capacity, cell_face_capacity;

    enf_loops faces;
    int32_t *face_facet; ///< >= 0: the tetrahedra's facet; < 0: -1 - cut facet (local)
    uint8_t *face_side;
    size_t face_facet_capacity, face_side_capacity;

    enf_loops covers;
    int32_t *cover_facet; ///< as face_facet
    int32_t *cover_polygon;
    uint8_t *cover_side;
    size_t cover_facet_capacity, cover_polygon_capacity, cover_side_capacity;

    int32_t tetrahedra_cut;
} enf_split_block;

typedef struct enf_splitter enf_splitter; ///< working memory of one thread

enf_splitter *enf_splitter_new(const enf_arrangement *arrangement);
void enf_splitter_free(enf_splitter *splitter);
void enf_splitter_counts(const enf_splitter *splitter, uint64_t *filter, uint64_t *exact);

/// Cuts tetrahedron `t` and appends its cells to the block. False without memory.
bool enf_splitter_cut(enf_splitter *splitter, enf_split_block *block, int32_t t);

void enf_split_block_free(enf_split_block *block);

#endif
