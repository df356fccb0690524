// SPDX-License-Identifier: GPL-3.0-or-later
// The polygon soup: the input as it was read, before anything is judged or moved.
#ifndef ENF_BUILD_SOUP_H
#define ENF_BUILD_SOUP_H

#include "enfilade/base.h"

/// Why a polygon (or another line of the input) was left out, or changed.
typedef enum enf_reject {
    ENF_REJECT_NOT_FINITE,      ///< a corner's coordinate is NaN or infinite
    ENF_REJECT_TOO_LARGE,       ///< a corner's coordinate is beyond 1e100 (volumes would overflow)
    ENF_REJECT_INDEX_RANGE,     ///< a corner names a vertex that the file does not have
    ENF_REJECT_TOO_FEW_CORNERS, ///< fewer than three different corners after welding
    ENF_REJECT_NO_AREA,         ///< all corners on one line, exactly
    ENF_REJECT_DUPLICATE,       ///< the same corners in the same order (up to rotation) as a kept polygon
    ENF_REJECT_EXCLUDED,        ///< its group matches --exclude
    ENF_REJECT_SYNTAX,          ///< a line that could not be understood and could be skipped safely
    ENF_REJECT_TOO_COMPLEX,     ///< neither convex nor small enough to triangulate (see triangulate.h)
    ENF_REJECT_COUNT
} enf_reject;

/// "not-finite", "too-large", ... : the name used in reports and messages.
const char *enf_reject_name(enf_reject reason);

typedef struct enf_rejected {
    enf_reject reason;
    int32_t file;    ///< index into soup.files, or -1
    int64_t line;    ///< 1-based line (text) or 1-based element number (binary formats); 0 = unknown
    int32_t polygon; ///< soup polygon number, or -1 where no polygon was made of the line
} enf_rejected;

typedef struct enf_soup {
    double *points;                     ///< xyz, 3 * point_count, as read (may hold NaN or inf)
    size_t point_count, point_capacity; ///< capacity in doubles
    double *normals;                    ///< xyz, 3 * normal_count
    size_t normal_count, normal_capacity;
    double *texcoords; ///< uv, 2 * texcoord_count
    size_t texcoord_count, texcoord_capacity;

    size_t polygon_count, polygon_capacity;
    int64_t *polygon_corner;   ///< polygon_count + 1 offsets into the corner arrays
    int64_t *polygon_line;     ///< where the polygon stands in its file (see enf_rejected.line)
    int32_t *polygon_file;     ///< index into files
    int32_t *polygon_group;    ///< index into groups
    int32_t *polygon_material; ///< index into materials, or -1
    size_t polygon_offset_capacity, polygon_line_capacity, polygon_file_capacity, polygon_group_capacity,
        polygon_material_capacity;

    size_t corner_count;    ///< corners of all polygons; each polygon counter-clockwise seen from its front
    int32_t *corner_point;  ///< -1: the file named a vertex that it does not have (clean rejects the polygon)
    int32_t *corner_normal; ///< or -1; null if no corner has one
    int32_t *corner_texcoord; ///< the same
    size_t corner_point_capacity, corner_normal_capacity, corner_texcoord_capacity;

    char **groups; ///< OBJ "object", "group" or "object/group" names; groups[0] = "" (no name given yet)
    size_t group_count, group_capacity;
    char **materials;
    size_t material_count, material_capacity;
    int32_t *group_slots, *material_slots; ///< hash tables over the names; private to soup.c
    size_t group_slot_count, material_slot_count;
    char **files;
    size_t file_count, file_capacity;

    double *spawns; ///< xyz, 3 * spawn_count, from "# spawn x y z [name]" comments and --spawn
    size_t spawn_count, spawn_capacity;

    enf_rejected *rejected; ///< in the order found; every input polygon is kept or listed here
    size_t rejected_count, rejected_capacity;

    uint64_t content_hash; ///< of the decompressed bytes of all inputs, in order (provenance)
} enf_soup;

void enf_soup_free(enf_soup *soup);

/// Notes that something was left out. False when there is no memory.
bool enf_soup_reject(enf_soup *soup, enf_reject reason, int32_t file, int64_t line, int32_t polygon);

/// Adds a polygon of `corner_count` corners (point indices within point_count, or -1 for one that does not
/// exist; normals and texcoords may be null or hold -1). False when there is no memory, or no number left for
/// it.
bool enf_soup_add_polygon(enf_soup *soup, size_t corner_count, const int32_t *points, const int32_t *normals,
                          const int32_t *texcoords, int32_t file, int64_t line, int32_t group,
                          int32_t material);

/// Adds a point, a normal, a texture coordinate, a spawn point. False when there is no memory, or no number
/// left.
bool enf_soup_add_point(enf_soup *soup, double x, double y, double z);
bool enf_soup_add_normal(enf_soup *soup, double x, double y, double z);
bool enf_soup_add_texcoord(enf_soup *soup, double u, double v);
bool enf_soup_add_spawn(enf_soup *soup, double x, double y, double z);

/// Index of `name` in groups (made if new), or -1 without memory. The same for materials.
int32_t enf_soup_group(enf_soup *soup, const char *name);
int32_t enf_soup_material(enf_soup *soup, const char *name);

/// Reads one file ("-" = standard input, whose format is OBJ) and appends it to the soup. The format is told
/// by the name: .obj .ply .off .stl, each also with .gz (in fact gzip is recognised by its first bytes).
/// Errors name file, line and what to do: ENF_BAD_INPUT for what is wrong with the content (also a file
/// without any polygon), ENF_NO_RESOURCES for what can't be opened or held. After a failure the soup may hold
/// a part of the file.
enf_status enf_soup_read(enf_soup *soup, const char *path, enf_error *error);

#endif
