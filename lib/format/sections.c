// SPDX-License-Identifier: MIT
#include "format/sections.h"

#include <string.h>

#define SECTION(tag, part, dimension, extra, rule, target, lowest, field)                                   \
    {                                                                                                       \
        tag, ENF_PART_##part, ENF_DIMENSION_##dimension, extra, ENF_RULE_##rule, ENF_DIMENSION_##target,    \
            lowest, (uint16_t)offsetof(enf_file_view, field), (uint32_t)sizeof *((enf_file_view *)0)->field \
    }

// clang-format off
const enf_section_spec enf_section_specs[] = {
    //      tag         part      dimension       extra  rule       target     lowest  field
    SECTION("PROVEN",   CORE,     NONE,               0, NONE,      NONE,          0, provenance),
    SECTION("FRAME",    CORE,     NONE,               0, NONE,      NONE,          0, frame),
    SECTION("TURN",     NEEDED,   NONE,               0, NONE,      NONE,          0, turn),
    SECTION("STRINGS",  CORE,     STRING_BYTES,       0, NONE,      NONE,          0, strings),
    SECTION("REGION",   CORE,     REGIONS,            0, NONE,      NONE,          0, regions),
    SECTION("SPAWN",    CORE,     SPAWNS,             0, NONE,      NONE,          0, spawns),
    SECTION("LEAK",     OPTIONAL, LEAK_POINTS,        0, FINITE,    NONE,          0, leak_points),

    SECTION("CELL",     CELLS,    CELLS,              0, NONE,      NONE,          0, cells),
    SECTION("PORTAL",   CELLS,    PORTALS,            0, NONE,      NONE,          0, portals),
    SECTION("PORTPOLY", CELLS,    PORTAL_POLYGONS,    0, NONE,      NONE,          0, portal_polygons),
    SECTION("PORTVERT", CELLS,    PORTAL_VERTICES,    0, FINITE,    NONE,          0, portal_vertices),
    SECTION("CELLPORT", CELLS,    CELL_PORTALS,       0, INDEX,     PORTALS,       0, cell_portals),

    SECTION("BOX",      LOCATION, BOXES,              0, NONE,      NONE,          0, boxes),
    SECTION("BRICKS",   START,    NONE,               0, NONE,      NONE,          0, start),
    SECTION("BRICKTET", START,    STARTS,             0, INDEX,     TETRAHEDRA,   -1, start_tetrahedra),
    SECTION("POINT",    LOCATION, POINTS,             0, GRID,      NONE,          0, points),
    SECTION("PLANE",    LOCATION, PLANES,             0, NONE,      NONE,          0, planes),
    SECTION("TET",      LOCATION, TETRAHEDRA,         0, INDEX,     POINTS,        0, tetrahedra),
    SECTION("TETROOT",  LOCATION, TETRAHEDRA,         0, NONE,      NONE,          0, tetrahedron_root),
    SECTION("TETNEXT",  LOCATION, TETRAHEDRA,         0, INDEX,     TETRAHEDRA,   -1, tetrahedron_next),
    SECTION("NODPLANE", LOCATION, NODES,              0, INDEX,     PLANES,        0, node_plane),
    SECTION("NODCHILD", LOCATION, NODES,              0, NONE,      NONE,          0, node_child),
    SECTION("FINEREG",  LOCATION, FINE,               0, INDEX,     REGIONS,       0, fine_region),
    SECTION("FINECELL", LOCATION, FINE,               0, INDEX,     CELLS,        -1, fine_cell),

    SECTION("RPOINT",   GEOMETRY, RENDER_POINTS,      0, FINITE,    NONE,          0, render_points),
    SECTION("RNORMAL",  GEOMETRY, RENDER_NORMALS,     0, FINITE,    NONE,          0, render_normals),
    SECTION("RTEXCO",   GEOMETRY, RENDER_TEXCOORDS,   0, FINITE,    NONE,          0, render_texcoords),
    SECTION("TRIANGLE", GEOMETRY, TRIANGLES,          0, NONE,      NONE,          0, triangles),
    SECTION("CELLTRI",  GEOMETRY, CELL_TRIANGLES,     0, INDEX,     TRIANGLES,     0, cell_triangles),
    SECTION("GROUP",    GEOMETRY, GROUPS,             0, NONE,      NONE,          0, group_names),
    SECTION("MATERIAL", GEOMETRY, MATERIALS,          0, NONE,      NONE,          0, material_names),

    SECTION("PVS",      PVS,      NONE,               0, NONE,      NONE,          0, pvs),
    SECTION("PVSOFF",   PVS,      CELLS,              1, OFFSETS64, PVS_BYTES,     0, pvs_offset),
    SECTION("PVSROW",   PVS,      PVS_BYTES,          0, NONE,      NONE,          0, pvs_rows),

    SECTION("SIGHT",    SIGHT,    NONE,               0, NONE,      NONE,          0, sight),
    SECTION("BARRIER",  SIGHT,    BARRIERS,           0, NONE,      NONE,          0, barriers),
    SECTION("BARRVERT", SIGHT,    BARRIER_VERTICES,   0, GRID,      NONE,          0, barrier_vertices),
    SECTION("WALLTREE", SIGHT,    WALL_NODES,         0, NONE,      NONE,          0, wall_nodes),
    SECTION("PORTTREE", SIGHT,    PORTAL_NODES,       0, NONE,      NONE,          0, portal_nodes),

    SECTION("VXPLANE",  EXACT,    VERTICES,           0, INDEX,     PLANES,       -1, vertex_planes),
    SECTION("VXPOS",    EXACT,    VERTICES,           0, GRID,      NONE,          0, vertex_position),
    SECTION("FINEFACT", EXACT,    FINE,               1, OFFSETS32, FINE_FACETS,   0, fine_facet),
    SECTION("FINELIST", EXACT,    FINE_FACETS,        0, INDEX,     FACETS,        0, fine_facets),
    SECTION("FACTOFF",  EXACT,    FACETS,             1, OFFSETS32, FACET_CORNERS, 0, facet_offset),
    SECTION("FACTCORN", EXACT,    FACET_CORNERS,      0, CORNERS,   NONE,          0, facet_corners),
    SECTION("FACTPLAN", EXACT,    FACETS,             0, INDEX,     PLANES,        0, facet_plane),
    SECTION("FACTFINE", EXACT,    FACETS,             0, INDEX,     FINE,         -1, facet_fine),
    SECTION("FACTCOVR", EXACT,    FACETS,             1, OFFSETS32, COVERS,        0, facet_cover),
    SECTION("FACTPIEC", EXACT,    FACETS,             1, OFFSETS32, PIECES,        0, facet_piece),
    SECTION("COVEROFF", EXACT,    COVERS,             1, OFFSETS32, COVER_CORNERS, 0, cover_offset),
    SECTION("COVERCOR", EXACT,    COVER_CORNERS,      0, CORNERS,   NONE,          0, cover_corners),
    SECTION("COVERPOL", EXACT,    COVERS,             0, INDEX,     MESH_POLYGONS, 0, cover_polygon),
    SECTION("COVERSID", EXACT,    COVERS,             0, FLAG,      NONE,          0, cover_side),
    SECTION("PIECEOFF", EXACT,    PIECES,             1, OFFSETS32, PIECE_CORNERS, 0, piece_offset),
    SECTION("PIECECOR", EXACT,    PIECE_CORNERS,      0, CORNERS,   NONE,          0, piece_corners),
    SECTION("PIECFACT", EXACT,    PIECES,             0, INDEX,     FACETS,        0, piece_facet),
    SECTION("PIECECOV", EXACT,    PIECES,             0, INDEX,     COVERS,       -2, piece_cover),
    SECTION("SEENOFF",  EXACT,    FINE,               1, OFFSETS32, SEEN,          0, seen_offset),
    SECTION("SEEN",     EXACT,    SEEN,               0, INDEX,     MESH_POLYGONS, 0, seen),
    SECTION("POLYOFF",  EXACT,    MESH_POLYGONS,      1, OFFSETS64, MESH_CORNERS,  0, mesh_polygon_corner),
    SECTION("POLYCORN", EXACT,    MESH_CORNERS,       0, INDEX,     POINTS,        0, mesh_corners),
    SECTION("POLYSRC",  EXACT,    MESH_POLYGONS,      0, NONE,      NONE,          0, mesh_polygon_source),
    SECTION("POLYPLAN", EXACT,    MESH_POLYGONS,      0, INDEX,     POINTS,        0, mesh_polygon_plane),
    SECTION("PORTOFF",  EXACT,    PORTAL_LOOPS,       1, OFFSETS32, PORTAL_LOOP_CORNERS, 0, portal_loop_offset),
    SECTION("PORTCORN", EXACT,    PORTAL_LOOP_CORNERS,0, CORNERS,   NONE,          0, portal_loop_corners),
    SECTION("PORTPLAN", EXACT,    PORTAL_LOOPS,       0, INDEX,     PLANES,        0, portal_loop_plane),
    SECTION("PORTSIDE", EXACT,    PORTAL_LOOPS,       0, FLAG,      NONE,          0, portal_loop_side),
};
// clang-format on

const int enf_section_spec_count = sizeof enf_section_specs / sizeof *enf_section_specs;

// Where each dimension's count stands in the view, and how many bytes it has.
#define COUNT(field) \
    { (uint16_t) offsetof(enf_file_view, field), (uint16_t)sizeof(((enf_file_view *)0)->field) }
static const struct {
    uint16_t offset, size;
} counts[ENF_DIMENSION_COUNT] = {
    [ENF_DIMENSION_STRING_BYTES] = COUNT(string_bytes),
    [ENF_DIMENSION_REGIONS] = COUNT(region_count),
    [ENF_DIMENSION_SPAWNS] = COUNT(spawn_count),
    [ENF_DIMENSION_LEAK_POINTS] = COUNT(leak_point_count),
    [ENF_DIMENSION_CELLS] = COUNT(cell_count),
    [ENF_DIMENSION_PORTALS] = COUNT(portal_count),
    [ENF_DIMENSION_PORTAL_POLYGONS] = COUNT(portal_polygon_count),
    [ENF_DIMENSION_PORTAL_VERTICES] = COUNT(portal_vertex_count),
    [ENF_DIMENSION_CELL_PORTALS] = COUNT(cell_portal_count),
    [ENF_DIMENSION_POINTS] = COUNT(point_count),
    [ENF_DIMENSION_PLANES] = COUNT(plane_count),
    [ENF_DIMENSION_TETRAHEDRA] = COUNT(tetrahedron_count),
    [ENF_DIMENSION_NODES] = COUNT(node_count),
    [ENF_DIMENSION_FINE] = COUNT(fine_count),
    [ENF_DIMENSION_BOXES] = COUNT(box_count),
    [ENF_DIMENSION_VERTICES] = COUNT(vertex_count),
    [ENF_DIMENSION_FINE_FACETS] = COUNT(fine_facet_count),
    [ENF_DIMENSION_FACETS] = COUNT(facet_count),
    [ENF_DIMENSION_FACET_CORNERS] = COUNT(facet_corner_count),
    [ENF_DIMENSION_COVERS] = COUNT(cover_count),
    [ENF_DIMENSION_COVER_CORNERS] = COUNT(cover_corner_count),
    [ENF_DIMENSION_PIECES] = COUNT(piece_count),
    [ENF_DIMENSION_PIECE_CORNERS] = COUNT(piece_corner_count),
    [ENF_DIMENSION_SEEN] = COUNT(seen_count),
    [ENF_DIMENSION_MESH_POLYGONS] = COUNT(mesh_polygon_count),
    [ENF_DIMENSION_MESH_CORNERS] = COUNT(mesh_corner_count),
    [ENF_DIMENSION_PORTAL_LOOPS] = COUNT(portal_loop_count),
    [ENF_DIMENSION_PORTAL_LOOP_CORNERS] = COUNT(portal_loop_corner_count),
    [ENF_DIMENSION_RENDER_POINTS] = COUNT(render_point_count),
    [ENF_DIMENSION_RENDER_NORMALS] = COUNT(render_normal_count),
    [ENF_DIMENSION_RENDER_TEXCOORDS] = COUNT(render_texcoord_count),
    [ENF_DIMENSION_TRIANGLES] = COUNT(triangle_count),
    [ENF_DIMENSION_CELL_TRIANGLES] = COUNT(cell_triangle_count),
    [ENF_DIMENSION_GROUPS] = COUNT(group_count),
    [ENF_DIMENSION_MATERIALS] = COUNT(material_count),
    [ENF_DIMENSION_PVS_BYTES] = COUNT(pvs_byte_count),
    [ENF_DIMENSION_STARTS] = COUNT(start_count),
    [ENF_DIMENSION_BARRIERS] = COUNT(barrier_count),
    [ENF_DIMENSION_BARRIER_VERTICES] = COUNT(barrier_vertex_count),
    [ENF_DIMENSION_WALL_NODES] = COUNT(wall_node_count),
    [ENF_DIMENSION_PORTAL_NODES] = COUNT(portal_node_count),
};

enf_loaded enf_section_load(const enf_section_spec *spec) {
    static const uint8_t loads[] = {
        [ENF_PART_CORE] = ENF_LOADED_ALWAYS,       [ENF_PART_CELLS] = ENF_LOADED_CELLS,
        [ENF_PART_LOCATION] = ENF_LOADED_LOCATION, [ENF_PART_EXACT] = ENF_LOADED_EXACT,
        [ENF_PART_GEOMETRY] = ENF_LOADED_DRAW,     [ENF_PART_PVS] = ENF_LOADED_SEEN,
        [ENF_PART_SIGHT] = ENF_LOADED_SIGHT,       [ENF_PART_START] = ENF_LOADED_LOCATION,
        [ENF_PART_OPTIONAL] = ENF_LOADED_ALWAYS,   [ENF_PART_NEEDED] = ENF_LOADED_ALWAYS,
    };
    return (enf_loaded)loads[spec->part];
}

int64_t enf_view_count(const enf_file_view *view, enf_dimension dimension) {
    if (counts[dimension].size == 0) return 1;
    const char *field = (const char *)view + counts[dimension].offset;
    if (counts[dimension].size == sizeof(int64_t)) return *(const int64_t *)(const void *)field;
    return *(const int32_t *)(const void *)field;
}

bool enf_view_set_count(enf_file_view *view, enf_dimension dimension, uint64_t count) {
    if (counts[dimension].size == 0) return count == 1;
    char *field = (char *)view + counts[dimension].offset;
    if (counts[dimension].size == sizeof(int64_t)) {
        if (count > INT64_MAX) return false;
        *(int64_t *)(void *)field = (int64_t)count;
        return true;
    }
    if (count >= INT32_MAX) return false; // one less, so that count + 1 is still a number
    *(int32_t *)(void *)field = (int32_t)count;
    return true;
}

const void *enf_view_array(const enf_file_view *view, const enf_section_spec *spec) {
    const void *array;
    memcpy(&array, (const char *)view + spec->pointer, sizeof array);
    return array;
}

void enf_view_set_array(enf_file_view *view, const enf_section_spec *spec, const void *array) {
    memcpy((char *)view + spec->pointer, &array, sizeof array);
}
