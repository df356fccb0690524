// SPDX-License-Identifier: MIT
// The one list of what a world file holds: for each section its tag, its element, where it stands in
// enf_file_view, how its count relates to the others, and what its numbers may be. Reader and writer both go
// by it.
#ifndef ENF_FORMAT_SECTIONS_H
#define ENF_FORMAT_SECTIONS_H

#include "enfilade/format.h"

/// What is counted. Sections that are parallel arrays have the same dimension.
typedef enum enf_dimension {
    ENF_DIMENSION_NONE, ///< always 1
    ENF_DIMENSION_STRING_BYTES,
    ENF_DIMENSION_REGIONS,
    ENF_DIMENSION_SPAWNS,
    ENF_DIMENSION_LEAK_POINTS,
    ENF_DIMENSION_CELLS,
    ENF_DIMENSION_PORTALS,
    ENF_DIMENSION_PORTAL_POLYGONS,
    ENF_DIMENSION_PORTAL_VERTICES,
    ENF_DIMENSION_CELL_PORTALS,
    ENF_DIMENSION_POINTS,
    ENF_DIMENSION_PLANES,
    ENF_DIMENSION_TETRAHEDRA,
    ENF_DIMENSION_NODES,
    ENF_DIMENSION_FINE,
    ENF_DIMENSION_BOXES,
    ENF_DIMENSION_VERTICES,
    ENF_DIMENSION_FINE_FACETS,
    ENF_DIMENSION_FACETS,
    ENF_DIMENSION_FACET_CORNERS,
    ENF_DIMENSION_COVERS,
    ENF_DIMENSION_COVER_CORNERS,
    ENF_DIMENSION_PIECES,
    ENF_DIMENSION_PIECE_CORNERS,
    ENF_DIMENSION_SEEN,
    ENF_DIMENSION_MESH_POLYGONS,
    ENF_DIMENSION_MESH_CORNERS,
    ENF_DIMENSION_PORTAL_LOOPS,
    ENF_DIMENSION_PORTAL_LOOP_CORNERS,
    ENF_DIMENSION_RENDER_POINTS,
    ENF_DIMENSION_RENDER_NORMALS,
    ENF_DIMENSION_RENDER_TEXCOORDS,
    ENF_DIMENSION_TRIANGLES,
    ENF_DIMENSION_CELL_TRIANGLES,
    ENF_DIMENSION_GROUPS,
    ENF_DIMENSION_MATERIALS,
    ENF_DIMENSION_PVS_BYTES,
    ENF_DIMENSION_STARTS,
    ENF_DIMENSION_BARRIERS,
    ENF_DIMENSION_BARRIER_VERTICES,
    ENF_DIMENSION_WALL_NODES,
    ENF_DIMENSION_PORTAL_NODES,
    ENF_DIMENSION_COUNT
} enf_dimension;

/// Which sections a file may leave out: none of a part that it has. Those that it may leave out one by one
/// are optional, or needed: without knowing these the others are misread, so their section says so
/// (ENF_FILE_MUST_KNOW). These two come last.
typedef enum enf_part {
    ENF_PART_CORE,
    ENF_PART_EXACT,
    ENF_PART_GEOMETRY,
    ENF_PART_PVS,
    ENF_PART_SIGHT,
    ENF_PART_START,
    ENF_PART_OPTIONAL,
    ENF_PART_NEEDED
} enf_part;

/// What the numbers of a section may be.
typedef enum enf_rule {
    ENF_RULE_NONE,      ///< nothing to check, or checked by hand in validate.c
    ENF_RULE_INDEX,     ///< int32: lowest <= value < count of target
    ENF_RULE_OFFSETS32, ///< int32: from 0, never falling, to the count of target
    ENF_RULE_OFFSETS64, ///< int64: the same
    ENF_RULE_CORNERS,   ///< enf_file_corner: a vertex and a plane
    ENF_RULE_FLAG,      ///< uint8: 0 or 1
    ENF_RULE_FINITE,    ///< double
    ENF_RULE_GRID,      ///< double, at most 2^53 in magnitude
} enf_rule;

typedef struct enf_section_spec {
    char tag[9];
    uint8_t part, dimension;
    uint8_t extra; ///< elements more than the dimension's count
    uint8_t rule, target;
    int8_t lowest;
    uint16_t pointer;      ///< offset in enf_file_view
    uint32_t element_size; ///< bytes
} enf_section_spec;

extern const enf_section_spec enf_section_specs[];
extern const int enf_section_spec_count;

/// The view's count of a dimension.
int64_t enf_view_count(const enf_file_view *view, enf_dimension dimension);

/// Sets it; false if it does not fit.
bool enf_view_set_count(enf_file_view *view, enf_dimension dimension, uint64_t count);

/// The view's array for a section.
const void *enf_view_array(const enf_file_view *view, const enf_section_spec *spec);
void enf_view_set_array(enf_file_view *view, const enf_section_spec *spec, const void *array);

#endif
