// SPDX-License-Identifier: GPL-3.0-or-later
// The exact arrays go into the file as they are; portals, cells and regions are turned into world coordinates
// here.
#include "build/write_parts.h"

#include "base/array.h"
#include "build/wide.h"
#include "format/read.h"
#include "format/save.h"
#include "format/sections.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(enf_corner) == sizeof(enf_file_corner), "corners are written as they are");
_Static_assert(sizeof(bool) == sizeof(uint8_t), "flags are written as they are");
_Static_assert((int)ENF_KIND_AIR == (int)ENF_WORLD_AIR && (int)ENF_KIND_ROCK == (int)ENF_WORLD_ROCK &&
                   (int)ENF_KIND_OUTSIDE == (int)ENF_WORLD_OUTSIDE,
               "kinds are written as they are");

void *enf_build_image_new(enf_build_image *image, size_t count, size_t size) {
    if (image->owned_count == ENF_BUILD_IMAGE_OWNED_MAX) return NULL;
    void *memory = enf_array_zeroed(count, size);
    if (memory) image->owned[image->owned_count++] = memory;
    return memory;
}

void enf_build_image_own(enf_build_image *image, void *memory) {
    if (image->owned_count < ENF_BUILD_IMAGE_OWNED_MAX)
        image->owned[image->owned_count++] = memory;
    else
        free(memory);
}

void enf_build_image_free(enf_build_image *image) {
    for (int i = 0; i < image->owned_count; i++) free(image->owned[i]);
    *image = (enf_build_image){0};
}

bool enf_build_image_add_string(enf_build_image_strings *strings, const char *text, uint32_t *offset) {
    size_t length = strlen(text) + 1;
    if (length > UINT32_MAX - strings->count) return false;
    if (!enf_array_reserve(strings->bytes, strings->capacity, strings->count + length)) return false;
    memcpy(strings->bytes + strings->count, text, length);
    *offset = (uint32_t)strings->count;
    strings->count += length;
    return true;
}

// --- What the build has already
// ----------------------------------------------------------------------------------

static void lend_complex(enf_file_view *view, const enf_complex *complex) {
    view->point_count = complex->point_count;
    view->points = (const double(*)[3])(const void *)complex->points;
    view->plane_count = complex->plane_count;
    view->planes = (void *)complex->planes;
    view->vertex_count = complex->vertex_count;
    view->vertex_planes = (void *)complex->vertex_planes;
    view->vertex_position = (void *)complex->vertex_position;
    view->tetrahedron_count = complex->tetrahedron_count;
    view->tetrahedra = (void *)complex->tetrahedra;
    view->tetrahedron_root = complex->tetrahedron_root;
    view->node_count = complex->node_count;
    view->node_plane = complex->node_plane;
    view->node_child = (void *)complex->node_child;
    view->fine_count = complex->cell_count;
    view->fine_facet = complex->cell_facet;
    view->fine_facets = complex->cell_facets;
    view->fine_facet_count = complex->cell_facet ? complex->cell_facet[complex->cell_count] : 0;
    view->facet_plane = complex->facet_plane;
    view->facet_fine = (void *)complex->facet_cell;
    view->facet_cover = complex->facet_cover;
    view->facet_piece = complex->facet_piece;
    view->cover_polygon = complex->cover_polygon;
    view->cover_side = complex->cover_side;
    view->piece_facet = complex->piece_facet;
    view->piece_cover = complex->piece_cover;
    view->seen_offset = complex->seen_offset;
    view->seen = complex->seen;
    view->seen_count = complex->seen_offset ? complex->seen_offset[complex->cell_count] : 0;
}

static void lend_loops(const enf_loops *loops, int32_t *count, const int32_t **offset, int64_t *corner_count,
                       const enf_file_corner **corners) {
    *count = loops->count;
    *offset = loops->offset;
    *corner_count = loops->offset ? loops->offset[loops->count] : 0;
    *corners = (const void *)loops->corners;
}

static void lend_arrays(enf_file_view *view, const enf_build *build) {
    const enf_complex *complex = &build->complex;
    lend_complex(view, complex);
    lend_loops(&complex->facets, &view->facet_count, &view->facet_offset, &view->facet_corner_count,
               &view->facet_corners);
    lend_loops(&complex->covers, &view->cover_count, &view->cover_offset, &view->cover_corner_count,
               &view->cover_corners);
    lend_loops(&complex->pieces, &view->piece_count, &view->piece_offset, &view->piece_corner_count,
               &view->piece_corners);
    lend_loops(&build->portals.polygons, &view->portal_loop_count, &view->portal_loop_offset,
               &view->portal_loop_corner_count, &view->portal_loop_corners);
    view->portal_loop_plane = build->portals.polygon_plane;
    view->portal_loop_side = build->portals.polygon_side;

    const enf_mesh *mesh = &build->mesh;
    view->mesh_polygon_count = (int32_t)mesh->polygon_count;
    view->mesh_polygon_corner = mesh->polygon_corner;
    view->mesh_corner_count = mesh->polygon_corner ? mesh->polygon_corner[mesh->polygon_count] : 0;
    view->mesh_corners = mesh->corners;
    view->mesh_polygon_source = mesh->polygon_source;
    view->mesh_polygon_plane = (void *)mesh->polygon_plane;
    view->fine_region = build->regions.cell_region;
    view->fine_cell = build->cell_of;
    view->has_exact = true;
}

/// Empty arrays may be null in the build, not in the file. False if an array is missing that should hold
/// something.
static bool fill_empty(enf_file_view *view) {
    static const double nothing[1] = {0}; // also the one offset of an empty offsets array
    for (int i = 0; i < enf_section_spec_count; i++) {
        const enf_section_spec *spec = &enf_section_specs[i];
        if (enf_view_array(view, spec) || spec->part == ENF_PART_PVS || spec->part >= ENF_PART_OPTIONAL)
            continue;
        if (enf_view_count(view, spec->dimension) != 0) return false;
        enf_view_set_array(view, spec, nothing);
    }
    return true;
}

// --- Provenance, frame, regions
// ----------------------------------------------------------------------------------

static enf_status make_provenance(enf_build_image *image, const enf_build *build, const char *options,
                                  enf_build_image_strings *strings, enf_error *error) {
    enf_file_provenance *made = enf_build_image_new(image, 1, sizeof *made);
    if (!made || !enf_build_image_add_string(strings, options ? options : "", &made->options))
        return enf_fail_memory(error, "the provenance");
    const uint32_t version[3] = {ENF_VERSION_MAJOR, ENF_VERSION_MINOR, ENF_VERSION_PATCH};
    memcpy(made->version, version, sizeof version);
    made->input_hash = build->soup.content_hash;
    made->input_vertices = (int64_t)build->soup.point_count;
    made->input_polygons = (int64_t)build->soup.polygon_count;
    made->input_rejected = (int64_t)build->soup.rejected_count;
    made->welded = (int64_t)build->mesh.welded;
    made->triangulated = (int64_t)build->mesh.triangulated;
    made->two_sided = (int64_t)build->mesh.two_sided;
    made->tetrahedra_cut = build->complex.tetrahedra_cut;
    for (int32_t i = 0; i < build->complex.cell_count; i++)
        *(build->cell_of[i] >= 0 ? &made->fine_cells_active : &made->fine_cells_discarded) += 1;
    made->portals_initial = build->portals_initial;
    made->collapses = (int64_t)build->decimation.collapse_count;
    made->pieces_merged = build->portals.pieces_merged;
    made->slivers = build->portals.slivers;
    made->sealed = build->regions.sealed;
    made->sealed_area = build->regions.sealed_area * build->mesh.frame.step * build->mesh.frame.step;
    made->leak = build->regions.leak;
    image->view.provenance = made;
    return ENF_OK;
}

static void grow_box(double low[3], double high[3], const double at[3]) {
    for (int a = 0; a < 3; a++) {
        low[a] = fmin(low[a], at[a]);
        high[a] = fmax(high[a], at[a]);
    }
}

static void empty_box(double low[3], double high[3]) {
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
    }
}

static void close_box(double low[3], double high[3]) {
    if (low[0] <= high[0]) return;
    for (int a = 0; a < 3; a++) low[a] = high[a] = 0;
}

/// Located points are whole numbers of as fine a grid as keeps all points below 2^53 of its steps. Sixteen of
/// them (16 units in the last place of the world's size) are granted to a caller who computed a point on the
/// hull.
static void choose_locate_grid(enf_file_frame *out, double largest) {
    out->locate_scale = 1;
    while (out->locate_scale < 0x1p52 && largest * out->locate_scale * 2 <= ENF_FILE_GRID_MAX)
        out->locate_scale *= 2;
    out->locate_rounding = 16 / out->locate_scale;
}

static enf_status make_frame(enf_build_image *image, const enf_build *build, enf_error *error) {
    enf_file_frame *out = enf_build_image_new(image, 1, sizeof *out);
    if (!out) return enf_fail_memory(error, "the frame");
    const enf_frame *frame = &build->mesh.frame;
    out->step = frame->step;
    double largest = 0;
    for (int a = 0; a < 3; a++) {
        out->axis[a] = frame->axis[a];
        out->sign[a] = frame->sign[a];
    }
    out->handedness = frame->handedness;
    if (frame->is_turned) {
        enf_file_turn *turn = enf_build_image_new(image, 1, sizeof *turn);
        if (!turn) return enf_fail_memory(error, "the frame");
        memcpy(turn->rows, frame->turn, sizeof turn->rows);
        image->view.turn = turn;
    }
    empty_box(out->box_min, out->box_max);
    for (int32_t i = 0; i < image->view.point_count; i++) {
        double world[3];
        enf_frame_to_world(frame, image->view.points[i], world);
        grow_box(out->box_min, out->box_max, world);
        for (int a = 0; a < 3; a++) largest = fmax(largest, fabs(image->view.points[i][a]));
    }
    close_box(out->box_min, out->box_max);
    out->weld = build->mesh.weld;
    out->plane_tolerance = build->mesh.plane_tolerance;
    out->displacement_max = build->mesh.displacement_max;
    out->displacement_mean = build->mesh.displacement_mean;
    choose_locate_grid(out, largest);
    image->view.frame = out;
    return ENF_OK;
}

static enf_status make_regions(enf_build_image *image, const enf_build *build, enf_error *error) {
    const enf_regions *regions = &build->regions;
    double step = build->mesh.frame.step;
    enf_file_region *out = enf_build_image_new(image, (size_t)regions->region_count, sizeof *out);
    if (!out) return enf_fail_memory(error, "the regions");
    for (int32_t i = 0; i < regions->region_count; i++) {
        out[i].volume = regions->volume[i] * step * step * step;
        out[i].front_area = regions->front_area[i] * step * step;
        out[i].back_area = regions->back_area[i] * step * step;
        out[i].winding = regions->winding[i];
        out[i].kind = regions->kind[i];
        out[i].kept = regions->kept[i];
        out[i].touches_outside = regions->touches_outside[i];
        out[i].ambiguous = regions->ambiguous[i];
    }
    image->view.regions = out;
    image->view.region_count = regions->region_count;
    return ENF_OK;
}

static enf_status make_spawns(enf_build_image *image, const enf_build *build, enf_error *error) {
    const enf_regions *regions = &build->regions;
    enf_file_spawn *spawns = enf_build_image_new(image, (size_t)regions->spawn_count, sizeof *spawns);
    int32_t leak_count = regions->leak ? regions->leak_point_count : 0;
    double(*leak)[3] = enf_build_image_new(image, (size_t)leak_count, sizeof *leak);
    if (!spawns || !leak) return enf_fail_memory(error, "the spawn points");
    for (int32_t i = 0; i < regions->spawn_count; i++) {
        if (i < (int64_t)build->soup.spawn_count) // the input's own numbers, which the grid may not hold
            memcpy(spawns[i].position, &build->soup.spawns[3 * i], sizeof spawns[i].position);
        else
            enf_frame_to_world(&build->mesh.frame, &build->mesh.spawns[3 * i], spawns[i].position);
        spawns[i].fine_cell = regions->spawn_cell[i];
        spawns[i].cell = spawns[i].fine_cell >= 0 ? build->cell_of[spawns[i].fine_cell] : -1;
    }
    for (int32_t i = 0; i < leak_count; i++)
        enf_frame_to_world(&build->mesh.frame, regions->leak_points[i], leak[i]);
    image->view.spawns = spawns;
    image->view.spawn_count = regions->spawn_count;
    image->view.leak_points = leak_count ? (void *)leak : NULL;
    image->view.leak_point_count = leak_count;
    return ENF_OK;
}

// --- Cells
// -------------------------------------------------------------------------------------------------------

/// Volume of the cone from `apex` over a facet: positive if the apex lies behind it. Grid steps cubed.
static double cone_volume(const enf_complex *complex, int32_t facet, const double apex[3]) {
    const enf_corner *corners = complex->facets.corners + complex->facets.offset[facet];
    int64_t count = complex->facets.offset[facet + 1] - complex->facets.offset[facet];
    double sum = 0;
    for (int64_t k = 1; k + 1 < count; k++) {
        const int64_t pick[3] = {0, k, k + 1};
        double e[3][3];
        for (int i = 0; i < 3; i++) {
            const double *at = complex->vertex_position[corners[pick[i]].vertex];
            for (int a = 0; a < 3; a++) e[i][a] = at[a] - apex[a];
        }
        sum += e[0][0] * (e[1][1] * e[2][2] - e[1][2] * e[2][1]) +
               e[0][1] * (e[1][2] * e[2][0] - e[1][0] * e[2][2]) +
               e[0][2] * (e[1][0] * e[2][1] - e[1][1] * e[2][0]);
    }
    return sum / 6;
}

/// Adds a fine cell to the box (world) and volume (grid steps cubed) of its cell.
static void add_fine_cell(enf_file_cell *cell, const enf_build *build, int32_t fine) {
    const enf_complex *complex = &build->complex;
    const double *apex = NULL;
    for (int32_t i = complex->cell_facet[fine]; i < complex->cell_facet[fine + 1]; i++) {
        int32_t facet = complex->cell_facets[i];
        for (int64_t k = complex->facets.offset[facet]; k < complex->facets.offset[facet + 1]; k++) {
            const double *at = complex->vertex_position[complex->facets.corners[k].vertex];
            double world[3];
            enf_frame_to_world(&build->mesh.frame, at, world);
            grow_box(cell->box_min, cell->box_max, world);
            if (!apex) apex = at;
        }
        double cone = apex ? cone_volume(complex, facet, apex) : 0;
        cell->volume += complex->facet_cell[facet][0] == fine ? cone : -cone;
    }
}

static enf_status make_cells(enf_build_image *image, const enf_build *build, enf_error *error) {
    enf_file_cell *cells = enf_build_image_new(image, (size_t)build->cell_count, sizeof *cells);
    if (!cells) return enf_fail_memory(error, "the cells");
    for (int32_t i = 0; i < build->cell_count; i++) empty_box(cells[i].box_min, cells[i].box_max);
    for (int32_t fine = 0; fine < build->complex.cell_count; fine++) {
        if (build->cell_of[fine] < 0) continue;
        enf_file_cell *cell = &cells[build->cell_of[fine]];
        cell->region = build->regions.cell_region[fine];
        add_fine_cell(cell, build, fine);
    }
    double step = build->mesh.frame.step;
    for (int32_t i = 0; i < build->cell_count; i++) {
        // The cube alone may underflow; of hairlines, rounding may leave less than nothing.
        cells[i].volume = fmax(cells[i].volume, 0) * step * step * step;
        close_box(cells[i].box_min, cells[i].box_max);
    }
    image->view.cells = cells;
    image->view.cell_count = build->cell_count;
    return ENF_OK;
}

// --- Portals
// -----------------------------------------------------------------------------------------------------

/// The unit normal of a plane of the complex, from its exact integer normal; world coordinates.
static void world_normal(const enf_build *build, int32_t plane, double normal[3]) {
    const int32_t *through = build->complex.planes[plane];
    const double *points = build->complex.points;
    int64_t u[3], v[3];
    for (int a = 0; a < 3; a++) {
        int64_t origin = (int64_t)points[3 * through[0] + a];
        u[a] = (int64_t)points[3 * through[1] + a] - origin;
        v[a] = through[2] >= 0 ? (int64_t)points[3 * through[2] + a] - origin : a == -1 - through[2];
    }
    double grid[3], largest = 0;
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        grid[a] = (double)((enf_wide)u[b] * v[c] - (enf_wide)u[c] * v[b]);
        largest = fmax(largest, fabs(grid[a]));
    }
    double length = 0;
    for (int a = 0; a < 3 && largest > 0; a++) length += (grid[a] / largest) * (grid[a] / largest);
    length = sqrt(length) * largest;
    for (int a = 0; a < 3; a++) grid[a] = length > 0 ? grid[a] / length : 0;
    enf_frame_direction_to_world(&build->mesh.frame, grid, normal);
}

typedef struct portal_writer {
    const enf_build *build;
    enf_file_portal *portals;
    enf_file_portal_polygon *polygons;
    double (*vertices)[3];
    int32_t polygon_count, vertex_count;
} portal_writer;

/// One polygon of one direction. It must face the cell it leads from (format.h): the exact loop turns
/// counter-clockwise seen from the front of its plane, in the grid; a mirrored frame turns it over.
static void add_portal_polygon(portal_writer *writer, int32_t loop, int direction) {
    const enf_build *build = writer->build;
    const enf_portals *portals = &build->portals;
    const enf_frame *frame = &build->mesh.frame;
    enf_file_portal_polygon *out = &writer->polygons[writer->polygon_count++];
    int64_t first = portals->polygons.offset[loop], count = portals->polygons.offset[loop + 1] - first;

    // Even portals lead to the higher cell. The plane's front is where they come from if that is the lower
    // one's side.
    bool front_is_higher = portals->polygon_side[loop] != 0;
    bool front_is_from = (direction == 0) != front_is_higher;
    bool reverse = front_is_from == (frame->handedness < 0);

    double normal[3];
    world_normal(build, portals->polygon_plane[loop], normal);
    double anchor[3];
    enf_frame_to_world(
        frame, &build->complex.points[3 * build->complex.planes[portals->polygon_plane[loop]][0]], anchor);
    for (int a = 0; a < 3; a++) {
        out->plane[a] = front_is_from ? normal[a] : -normal[a];
        out->plane[a] += 0.0; // no negative zeros
        out->plane[3] -= out->plane[a] * anchor[a];
    }
    out->area = portals->polygon_area[loop] * frame->step * frame->step;
    out->loop = loop;
    out->vertex_first = writer->vertex_count;
    out->vertex_count = (int32_t)count;
    for (int64_t k = 0; k < count; k++) {
        const enf_corner *corner = &portals->polygons.corners[first + (reverse ? count - 1 - k : k)];
        enf_frame_to_world(frame, build->complex.vertex_position[corner->vertex],
                           writer->vertices[writer->vertex_count++]);
    }
}

/// A turn rounds the corners, so the sphere has to be made for them.
static void grow_sphere(const portal_writer *writer, enf_file_portal *portal, int32_t first) {
    for (int32_t k = first; k < writer->vertex_count; k++) {
        double square = 0;
        for (int a = 0; a < 3; a++) {
            double d = writer->vertices[k][a] - portal->centre[a];
            square += d * d;
        }
        portal->radius = fmax(portal->radius, sqrt(square) * (1 + 0x1p-48));
    }
}

static void add_opening(portal_writer *writer, int32_t opening) {
    const enf_portals *portals = &writer->build->portals;
    int32_t first = portals->opening_polygon[opening], end = portals->opening_polygon[opening + 1];
    for (int direction = 0; direction < 2; direction++) {
        enf_file_portal *out = &writer->portals[2 * opening + direction];
        out->from = portals->opening_cell[opening][direction];
        out->to = portals->opening_cell[opening][1 - direction];
        out->polygon_first = writer->polygon_count;
        out->polygon_count = end - first;
        enf_frame_to_world(&writer->build->mesh.frame, portals->opening_centre[opening], out->centre);
        out->radius = portals->opening_radius[opening] * writer->build->mesh.frame.step;
        int32_t vertex = writer->vertex_count;
        for (int32_t loop = first; loop < end; loop++) add_portal_polygon(writer, loop, direction);
        if (writer->build->mesh.frame.is_turned) grow_sphere(writer, out, vertex);
    }
}

static enf_status make_portals(enf_build_image *image, const enf_build *build, enf_error *error) {
    const enf_portals *portals = &build->portals;
    size_t loops = (size_t)portals->polygons.count, openings = (size_t)portals->opening_count;
    size_t corners = portals->polygons.offset ? (size_t)portals->polygons.offset[loops] : 0;
    if (2 * openings >= INT32_MAX || 2 * loops >= INT32_MAX || 2 * corners >= INT32_MAX)
        return enf_fail(error, ENF_NO_RESOURCES,
                        "the world has too many portals for a file; stop decimation later");
    portal_writer writer = {.build = build};
    writer.portals = enf_build_image_new(image, 2 * openings, sizeof *writer.portals);
    writer.polygons = enf_build_image_new(image, 2 * loops, sizeof *writer.polygons);
    writer.vertices = enf_build_image_new(image, 2 * corners, sizeof *writer.vertices);
    if (!writer.portals || !writer.polygons || !writer.vertices) return enf_fail_memory(error, "the portals");
    for (int32_t i = 0; i < portals->opening_count; i++) add_opening(&writer, i);
    enf_file_view *view = &image->view;
    view->portals = writer.portals;
    view->portal_count = 2 * portals->opening_count;
    view->portal_polygons = writer.polygons;
    view->portal_polygon_count = writer.polygon_count;
    view->portal_vertices = (void *)writer.vertices;
    view->portal_vertex_count = writer.vertex_count;
    return ENF_OK;
}

/// The portals that lead out of each cell: count, prefix sum, fill.
static enf_status make_cell_portals(enf_build_image *image, enf_error *error) {
    enf_file_view *view = &image->view;
    enf_file_cell *cells = (enf_file_cell *)view->cells; // the image's own
    int32_t *list = enf_build_image_new(image, (size_t)view->portal_count, sizeof *list), sum = 0;
    if (!list) return enf_fail_memory(error, "the portals of cells");
    for (int32_t i = 0; i < view->portal_count; i++) cells[view->portals[i].from].portal_count++;
    for (int32_t i = 0; i < view->cell_count; i++) {
        cells[i].portal_first = sum;
        sum += cells[i].portal_count;
        cells[i].portal_count = 0;
    }
    for (int32_t i = 0; i < view->portal_count; i++) {
        enf_file_cell *cell = &cells[view->portals[i].from];
        list[cell->portal_first + cell->portal_count++] = i;
    }
    view->cell_portals = list;
    view->cell_portal_count = view->portal_count;
    return ENF_OK;
}

// --- The whole
// ---------------------------------------------------------------------------------------------------

/// What the code here indexes with, before it does.
static enf_status check_build(const enf_build *build, enf_error *error) {
    bool good = build->mesh.polygon_count < INT32_MAX && build->soup.polygon_count < INT32_MAX &&
                build->soup.point_count < INT32_MAX && build->soup.normal_count < INT32_MAX &&
                build->soup.texcoord_count < INT32_MAX &&
                build->complex.vertex_count >= build->complex.point_count;
    for (int32_t i = 0; good && i < build->complex.cell_count; i++)
        good = build->cell_of[i] >= -1 && build->cell_of[i] < build->cell_count;
    for (int32_t i = 0; good && i < build->portals.opening_count; i++) {
        const int32_t *cell = build->portals.opening_cell[i];
        good = cell[0] >= 0 && cell[0] < cell[1] && cell[1] < build->cell_count;
    }
    return good ? ENF_OK
                : enf_fail(error, ENF_CHECK_FAILED, "the compiled world does not hold together (a bug)");
}

static enf_status fill_image(enf_build_image *image, const enf_build *build, const char *options,
                             enf_build_image_strings *strings, enf_error *error) {
    enf_status status = check_build(build, error);
    if (status) return status;
    lend_arrays(&image->view, build);
    status = make_provenance(image, build, options, strings, error);
    if (!status) status = make_frame(image, build, error);
    if (!status) status = make_regions(image, build, error);
    if (!status) status = make_spawns(image, build, error);
    if (!status) status = make_cells(image, build, error);
    if (!status) status = make_portals(image, build, error);
    if (!status) status = make_cell_portals(image, error);
    if (!status) status = enf_build_image_neighbours(image, error);
    if (!status) status = enf_build_image_boxes(image, error);
    if (!status) status = enf_build_image_start(image, error);
    if (!status) status = enf_build_image_draw(image, build, strings, error);
    if (!status) status = enf_build_image_sight(image, build, error);
    return status;
}

enf_status enf_build_image_make(enf_build_image *image, const enf_build *build, const char *options,
                                enf_error *error) {
    *image = (enf_build_image){0};
    enf_build_image_strings strings = {0};
    enf_status status = fill_image(image, build, options, &strings, error);
    image->view.strings = strings.bytes;
    image->view.string_bytes = (int64_t)strings.count;
    enf_build_image_own(image, strings.bytes);
    enf_error wrong = {0};
    if (!status && (!fill_empty(&image->view) || enf_view_check(&image->view, &wrong)))
        status =
            enf_fail(error, ENF_CHECK_FAILED, "the compiled world does not hold together (a bug): %.900s",
                     wrong.text[0] ? wrong.text : "an array is missing");
    if (status) enf_build_image_free(image);
    return status;
}

enf_status enf_build_write(const enf_build *build, const char *options, const char *path, enf_error *error) {
    enf_build_image image;
    enf_status status = enf_build_image_make(&image, build, options, error);
    if (status) return status;
    status = enf_view_save(&image.view, path, error);
    enf_build_image_free(&image);
    return status;
}
