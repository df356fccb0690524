// SPDX-License-Identifier: GPL-3.0-or-later
// What lines of sight meet: the clean polygons that kept cells touch, the cracks that were sealed, detail,
// and the portals; on the fine grid, where point location is decided, too. Then trees of boxes around them.
#include "build/barrier_tree.h"
#include "build/write_parts.h"

#include "base/array.h"
#include "build/wide.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Boxes are larger than what they hold by this share of the world, so that queries may round
/// (lib/run/walk.h).
#define PADDING 0x1p-19

/// Where a barrier comes from. Barriers are made twice, once for their boxes alone and once where the tree
/// wants them: there may be too many to have them in two orders.
typedef struct origin {
    int32_t kind;
    int32_t number; ///< a mesh polygon, a piece, a triangle, or a loop of the portals
    int32_t index;  ///< as in the file
} origin;

typedef struct sighter {
    enf_build_image *image;
    const enf_build *build;
    double scale;
    enf_file_sight sight;

    enf_file_barrier *barriers;
    size_t barrier_count, barrier_capacity;
    double (*vertices)[3];
    size_t vertex_count, vertex_capacity;

    origin *origins;
    size_t origin_count, origin_capacity;
    enf_barrier_box *boxes; ///< as many
    size_t box_capacity;
    size_t vertex_total; ///< of all barriers
    int32_t wall_count;  ///< the rest are portals
} sighter;

// --- Barriers
// ----------------------------------------------------------------------------------------------------

static bool add_barrier(sighter *s, const double normal[3], int32_t kind, int32_t index,
                        int64_t vertex_count) {
    if (s->barrier_count >= INT32_MAX - 1 || s->vertex_count + (size_t)vertex_count >= INT32_MAX - 1)
        return false;
    if (!enf_array_reserve(s->barriers, s->barrier_capacity, s->barrier_count + 1)) return false;
    if (!enf_array_reserve(s->vertices, s->vertex_capacity, s->vertex_count + (size_t)vertex_count))
        return false;
    s->barriers[s->barrier_count++] = (enf_file_barrier){
        {normal[0], normal[1], normal[2]}, (int32_t)s->vertex_count, (int32_t)vertex_count, kind, index};
    return true;
}

/// A point in grid steps.
static void add_vertex(sighter *s, const double grid[3]) {
    double *out = s->vertices[s->vertex_count++];
    for (int a = 0; a < 3; a++) {
        out[a] = fmax(-ENF_FILE_GRID_MAX, fmin(nearbyint(grid[a] * s->scale), ENF_FILE_GRID_MAX)) + 0.0;
    }
}

/// u x v with length 1: exact up to the last rounding.
static void normal_of(const int64_t u[3], const int64_t v[3], double normal[3]) {
    double largest = 0, length = 0;
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        normal[a] = (double)((enf_wide)u[b] * v[c] - (enf_wide)u[c] * v[b]);
        largest = fmax(largest, fabs(normal[a]));
    }
    for (int a = 0; a < 3 && largest > 0; a++) length += (normal[a] / largest) * (normal[a] / largest);
    length = sqrt(length) * largest;
    for (int a = 0; a < 3; a++) normal[a] = length > 0 ? normal[a] / length + 0.0 : 0;
}

/// The normal of a plane: three points, or two and an axis (complex.h).
static void plane_normal(const sighter *s, const int32_t through[3], double normal[3]) {
    const double *points = s->build->complex.points;
    int64_t u[3], v[3];
    for (int a = 0; a < 3; a++) {
        int64_t origin = (int64_t)points[3 * through[0] + a];
        u[a] = (int64_t)points[3 * through[1] + a] - origin;
        v[a] = through[2] >= 0 ? (int64_t)points[3 * through[2] + a] - origin : a == -1 - through[2];
    }
    normal_of(u, v, normal);
}

/// A loop of the complex, or the same turned over.
static bool add_loop(sighter *s, const enf_loops *loops, int32_t loop, int32_t plane, bool reverse,
                     int32_t kind, int32_t index) {
    const enf_complex *complex = &s->build->complex;
    int64_t first = loops->offset[loop], count = loops->offset[loop + 1] - first;
    double normal[3];
    plane_normal(s, complex->planes[plane], normal);
    for (int a = 0; reverse && a < 3; a++) normal[a] = 0.0 - normal[a];
    if (!add_barrier(s, normal, kind, index, count)) return false;
    for (int64_t k = 0; k < count; k++)
        add_vertex(s, complex->vertex_position[loops->corners[first + (reverse ? count - 1 - k : k)].vertex]);
    return true;
}

static bool add_polygon(sighter *s, int32_t polygon, int32_t triangle) {
    const enf_mesh *mesh = &s->build->mesh;
    int64_t first = mesh->polygon_corner[polygon], count = mesh->polygon_corner[polygon + 1] - first;
    double normal[3];
    plane_normal(s, mesh->polygon_plane[polygon], normal);
    if (!add_barrier(s, normal, ENF_FILE_BARRIER_WALL, triangle, count)) return false;
    for (int64_t k = 0; k < count; k++) add_vertex(s, mesh->points + 3 * (size_t)mesh->corners[first + k]);
    return true;
}

/// A detail triangle, unless it reaches out of the fine grid.
static bool add_detail(sighter *s, int32_t triangle) {
    const enf_file_view *view = &s->image->view;
    double grid[3][3], normal[3];
    int64_t at[3][3], u[3], v[3];
    for (int k = 0; k < 3; k++) {
        enf_frame_to_grid(&s->build->mesh.frame, view->render_points[view->triangles[triangle].point[k]],
                          grid[k]);
        for (int a = 0; a < 3; a++) {
            if (!(fabs(grid[k][a] * s->scale) < ENF_FILE_GRID_MAX)) return true;
            at[k][a] = (int64_t)nearbyint(grid[k][a] * s->scale);
        }
    }
    for (int a = 0; a < 3; a++) {
        u[a] = at[1][a] - at[0][a];
        v[a] = at[2][a] - at[0][a];
    }
    normal_of(u, v, normal);
    if (normal[0] == 0 && normal[1] == 0 && normal[2] == 0) return true;
    bool mirrored = s->build->mesh.frame.handedness < 0;
    for (int a = 0; mirrored && a < 3; a++) normal[a] = 0.0 - normal[a];
    if (!add_barrier(s, normal, ENF_FILE_BARRIER_DETAIL, triangle, 3)) return false;
    for (int k = 0; k < 3; k++) add_vertex(s, grid[mirrored ? 2 - k : k]);
    return true;
}

static bool add_crack(sighter *s, int32_t piece) {
    const enf_complex *complex = &s->build->complex;
    const int32_t facet = complex->piece_facet[piece];
    const bool whole = complex->pieces.offset[piece] == complex->pieces.offset[piece + 1];
    return add_loop(s, whole ? &complex->facets : &complex->pieces, whole ? facet : piece,
                    complex->facet_plane[facet], false, ENF_FILE_BARRIER_CRACK, -1);
}

/// The front of a portal's polygons is where the even portal leads from: the lower cell.
static bool add_portal(sighter *s, int32_t loop, int32_t portal) {
    const enf_portals *portals = &s->build->portals;
    return add_loop(s, &portals->polygons, loop, portals->polygon_plane[loop],
                    portals->polygon_side[loop] != 0, ENF_FILE_BARRIER_PORTAL, portal);
}

static bool add_from(sighter *s, const origin *from) {
    switch (from->kind) {
    case ENF_FILE_BARRIER_WALL:
        return add_polygon(s, from->number, from->index);
    case ENF_FILE_BARRIER_CRACK:
        return add_crack(s, from->number);
    case ENF_FILE_BARRIER_DETAIL:
        return add_detail(s, from->number);
    default:
        return add_portal(s, from->number, from->index);
    }
}

// --- Boxes
// -------------------------------------------------------------------------------------------------------

static float round_down(double value) {
    float rounded = (float)value;
    return (double)rounded > value ? nextafterf(rounded, -INFINITY) : rounded;
}

static float round_up(double value) {
    float rounded = (float)value;
    return (double)rounded < value ? nextafterf(rounded, INFINITY) : rounded;
}

/// Around all vertices there are.
static enf_barrier_box box_around(const sighter *s) {
    enf_barrier_box box = {.barrier = (int32_t)s->origin_count};
    for (int a = 0; a < 3; a++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t k = 0; k < s->vertex_count; k++) {
            low = fmin(low, s->vertices[k][a]);
            high = fmax(high, s->vertices[k][a]);
        }
        box.min[a] = round_down(low - PADDING * s->sight.extent);
        box.max[a] = round_up(high + PADDING * s->sight.extent);
    }
    return box;
}

/// Notes the box of a barrier, if there is one.
static bool note(sighter *s, int32_t kind, int32_t number, int32_t index) {
    const origin from = {kind, number, index};
    s->barrier_count = s->vertex_count = 0;
    if (!add_from(s, &from)) return false;
    if (s->barrier_count == 0) return true;
    if (!enf_array_reserve(s->origins, s->origin_capacity, s->origin_count + 1) ||
        !enf_array_reserve(s->boxes, s->box_capacity, s->origin_count + 1))
        return false;
    s->vertex_total += s->vertex_count;
    s->boxes[s->origin_count] = box_around(s);
    s->origins[s->origin_count++] = from;
    return true;
}

/// Marks the polygons with a kept cell on either side, and notes the cracks there.
static bool find_walls(sighter *s, uint8_t *is_wall) {
    const enf_complex *complex = &s->build->complex;
    for (int32_t facet = 0; facet < complex->facet_count; facet++) {
        const int32_t *fine = complex->facet_cell[facet];
        if ((fine[0] < 0 || s->build->cell_of[fine[0]] < 0) &&
            (fine[1] < 0 || s->build->cell_of[fine[1]] < 0))
            continue;
        for (int32_t piece = complex->facet_piece[facet]; piece < complex->facet_piece[facet + 1]; piece++) {
            int32_t cover = complex->piece_cover[piece];
            if (cover >= 0) is_wall[complex->cover_polygon[cover]] = 1;
            if (cover == ENF_PIECE_SEALED && !note(s, ENF_FILE_BARRIER_CRACK, piece, -1)) return false;
        }
    }
    return true;
}

static bool note_walls(sighter *s) {
    const enf_file_view *view = &s->image->view;
    size_t polygons = s->build->mesh.polygon_count;
    uint8_t *is_wall = enf_array_zeroed(polygons + 1, sizeof *is_wall);
    bool good = is_wall && find_walls(s, is_wall);
    int32_t triangle = 0; // they are in the order of the polygons
    for (int32_t i = 0; good && i < (int32_t)polygons; i++) {
        while (triangle < view->triangle_count && view->triangles[triangle].mesh_polygon >= 0 &&
               view->triangles[triangle].mesh_polygon < i)
            triangle++;
        bool drawn = triangle < view->triangle_count && view->triangles[triangle].mesh_polygon == i;
        if (is_wall[i]) good = note(s, ENF_FILE_BARRIER_WALL, i, drawn ? triangle : -1);
    }
    free(is_wall);
    return good;
}

static bool note_details(sighter *s) {
    const enf_file_view *view = &s->image->view;
    bool good = true;
    for (int32_t i = 0; good && i < view->triangle_count; i++)
        if (view->triangles[i].mesh_polygon < 0) good = note(s, ENF_FILE_BARRIER_DETAIL, i, i);
    return good;
}

static bool note_portals(sighter *s) {
    const enf_portals *portals = &s->build->portals;
    for (int32_t i = 0; i < portals->opening_count; i++) {
        for (int32_t loop = portals->opening_polygon[i]; loop < portals->opening_polygon[i + 1]; loop++)
            if (!note(s, ENF_FILE_BARRIER_PORTAL, loop, 2 * i)) return false;
    }
    return true;
}

/// A point of the fine grid.
static void hold(sighter *s, const double at[3]) {
    for (int a = 0; a < 3; a++) {
        s->sight.box_min[a] = fmin(s->sight.box_min[a], at[a]);
        s->sight.box_max[a] = fmax(s->sight.box_max[a], at[a]);
        s->sight.extent = fmax(s->sight.extent, fabs(at[a]));
    }
}

/// What the padding depends on: the box around all points, and details beyond them. Everything else lies
/// between points.
static bool find_extent(sighter *s) {
    const enf_file_view *view = &s->image->view;
    s->sight.extent = 1;
    for (int32_t i = 0; i < view->point_count; i++) {
        double at[3];
        for (int a = 0; a < 3; a++) at[a] = view->points[i][a] * s->scale;
        if (i == 0) {
            memcpy(s->sight.box_min, at, sizeof at);
            memcpy(s->sight.box_max, at, sizeof at);
        }
        hold(s, at);
    }
    for (int32_t i = 0; i < view->triangle_count; i++) {
        if (view->triangles[i].mesh_polygon >= 0) continue;
        s->barrier_count = s->vertex_count = 0;
        if (!add_detail(s, i)) return false;
        for (size_t k = 0; k < s->vertex_count; k++) hold(s, s->vertices[k]);
    }
    return true;
}

// --- Trees
// -------------------------------------------------------------------------------------------------------

/// The origins in the order of the boxes, in the place of the barriers: neither is needed any more then.
static bool order_origins(sighter *s) {
    free(s->barriers);
    s->barriers = enf_array_new(s->origin_count, sizeof *s->barriers);
    s->barrier_capacity = s->barriers ? s->origin_count : 0;
    for (size_t i = 0; s->barriers && i < s->origin_count; i++) {
        const origin *from = &s->origins[s->boxes[i].barrier];
        s->barriers[i] =
            (enf_file_barrier){.kind = from->kind, .index = from->index, .vertex_first = from->number};
    }
    free(s->origins);
    free(s->boxes);
    s->origins = NULL;
    s->boxes = NULL;
    return s->barriers;
}

/// The barriers in the order of their boxes.
static bool make_barriers(sighter *s) {
    const size_t count = s->origin_count;
    bool good = order_origins(s);
    free(s->vertices);
    s->vertices = NULL;
    s->vertex_capacity = s->barrier_count = s->vertex_count = 0;
    good = good && enf_array_reserve(s->vertices, s->vertex_capacity, s->vertex_total);
    for (size_t i = 0; good && i < count; i++) {
        const enf_file_barrier *place = &s->barriers[i];
        const origin from = {place->kind, place->vertex_first, place->index};
        good = add_from(s, &from);
    }
    return good;
}

static bool make_trees(sighter *s, enf_barrier_tree *walls, enf_barrier_tree *portals) {
    int32_t count = (int32_t)s->origin_count, wall_count = s->wall_count;
    return enf_barrier_tree_make(walls, s->boxes, wall_count, 0) &&
           enf_barrier_tree_make(portals, s->boxes + wall_count, count - wall_count, wall_count);
}

static bool set_view(sighter *s, const enf_barrier_tree *walls, const enf_barrier_tree *portals) {
    enf_file_view *view = &s->image->view;
    enf_file_sight *sight = enf_build_image_new(s->image, 1, sizeof *sight);
    if (!sight) return false;
    *sight = s->sight;
    view->sight = sight;
    view->barriers = s->barriers;
    view->barrier_count = (int32_t)s->barrier_count;
    view->barrier_vertices = (void *)s->vertices;
    view->barrier_vertex_count = (int32_t)s->vertex_count;
    view->wall_nodes = walls->nodes;
    view->wall_node_count = walls->node_count;
    view->portal_nodes = portals->nodes;
    view->portal_node_count = portals->node_count;
    return true;
}

enf_status enf_build_image_sight(enf_build_image *image, const enf_build *build, enf_error *error) {
    sighter s = {.image = image, .build = build, .scale = image->view.frame->locate_scale};
    enf_barrier_tree walls = {NULL, 0}, portals = {NULL, 0};
    bool good = find_extent(&s) && note_walls(&s) && note_details(&s);
    s.wall_count = (int32_t)s.origin_count;
    good = good && note_portals(&s) && make_trees(&s, &walls, &portals) && make_barriers(&s) &&
           set_view(&s, &walls, &portals);
    free(s.origins);
    free(s.boxes);
    enf_build_image_own(image, s.barriers);
    enf_build_image_own(image, s.vertices);
    enf_build_image_own(image, walls.nodes);
    enf_build_image_own(image, portals.nodes);
    return good ? ENF_OK : enf_fail_memory(error, "lines of sight");
}
