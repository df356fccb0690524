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

typedef struct sighter {
    enf_build_image *image;
    const enf_build *build;
    double scale;
    enf_file_sight sight;

    enf_file_barrier *barriers;
    size_t barrier_count, barrier_capacity;
    double (*vertices)[3];
    size_t vertex_count, vertex_capacity;
    int32_t wall_count; ///< the rest are portals
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

/// A point of the fine grid.
static void hold(sighter *s, const double at[3]) {
    for (int a = 0; a < 3; a++) {
        s->sight.box_min[a] = fmin(s->sight.box_min[a], at[a]);
        s->sight.box_max[a] = fmax(s->sight.box_max[a], at[a]);
        s->sight.extent = fmax(s->sight.extent, fabs(at[a]));
    }
}

/// A point in grid steps.
static void add_vertex(sighter *s, const double grid[3]) {
    double *out = s->vertices[s->vertex_count++];
    for (int a = 0; a < 3; a++) {
        out[a] = fmax(-ENF_FILE_GRID_MAX, fmin(nearbyint(grid[a] * s->scale), ENF_FILE_GRID_MAX)) + 0.0;
    }
    hold(s, out);
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

/// Marks the polygons with a kept cell on either side, and adds the cracks there.
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
            if (cover != ENF_PIECE_SEALED) continue;
            bool whole = complex->pieces.offset[piece] == complex->pieces.offset[piece + 1];
            if (!add_loop(s, whole ? &complex->facets : &complex->pieces, whole ? facet : piece,
                          complex->facet_plane[facet], false, ENF_FILE_BARRIER_CRACK, -1))
                return false;
        }
    }
    return true;
}

static bool add_walls(sighter *s) {
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
        if (is_wall[i]) good = add_polygon(s, i, drawn ? triangle : -1);
    }
    free(is_wall);
    return good;
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

static bool add_details(sighter *s) {
    const enf_file_view *view = &s->image->view;
    for (int32_t i = 0; i < view->triangle_count; i++) {
        if (view->triangles[i].mesh_polygon < 0 && !add_detail(s, i)) return false;
    }
    return true;
}

/// The front of a portal's polygons is where the even portal leads from: the lower cell.
static bool add_portals(sighter *s) {
    const enf_portals *portals = &s->build->portals;
    for (int32_t i = 0; i < portals->opening_count; i++) {
        for (int32_t loop = portals->opening_polygon[i]; loop < portals->opening_polygon[i + 1]; loop++) {
            if (!add_loop(s, &portals->polygons, loop, portals->polygon_plane[loop],
                          portals->polygon_side[loop] != 0, ENF_FILE_BARRIER_PORTAL, 2 * i))
                return false;
        }
    }
    return true;
}

// --- Trees
// -------------------------------------------------------------------------------------------------------

static float round_down(double value) {
    float rounded = (float)value;
    return (double)rounded > value ? nextafterf(rounded, -INFINITY) : rounded;
}

static float round_up(double value) {
    float rounded = (float)value;
    return (double)rounded < value ? nextafterf(rounded, INFINITY) : rounded;
}

static enf_barrier_box box_around(const sighter *s, int32_t barrier) {
    const enf_file_barrier *at = &s->barriers[barrier];
    enf_barrier_box box = {.barrier = barrier};
    for (int a = 0; a < 3; a++) {
        double low = INFINITY, high = -INFINITY;
        for (int32_t k = 0; k < at->vertex_count; k++) {
            low = fmin(low, s->vertices[at->vertex_first + k][a]);
            high = fmax(high, s->vertices[at->vertex_first + k][a]);
        }
        box.min[a] = round_down(low - PADDING * s->sight.extent);
        box.max[a] = round_up(high + PADDING * s->sight.extent);
    }
    return box;
}

/// Moves the barriers to where the tree has put their boxes, their vertices along with them.
static bool arrange(sighter *s, const enf_barrier_box *boxes) {
    enf_file_barrier *barriers = enf_array_new(s->barrier_count, sizeof *barriers);
    double(*vertices)[3] = enf_array_new(s->vertex_count, sizeof *vertices);
    bool good = barriers && vertices;
    int32_t next = 0;
    for (size_t i = 0; good && i < s->barrier_count; i++) {
        barriers[i] = s->barriers[boxes[i].barrier];
        memcpy(vertices[next], s->vertices[barriers[i].vertex_first],
               (size_t)barriers[i].vertex_count * sizeof *vertices);
        barriers[i].vertex_first = next;
        next += barriers[i].vertex_count;
    }
    if (!good) {
        free(barriers);
        free(vertices);
        return false;
    }
    free(s->barriers);
    free(s->vertices);
    s->barriers = barriers;
    s->vertices = vertices;
    return true;
}

static bool make_trees(sighter *s, enf_barrier_tree *walls, enf_barrier_tree *portals) {
    enf_barrier_box *boxes = enf_array_new(s->barrier_count, sizeof *boxes);
    bool good = boxes != NULL;
    int32_t count = (int32_t)s->barrier_count, wall_count = s->wall_count;
    for (int32_t i = 0; good && i < count; i++) boxes[i] = box_around(s, i);
    good = good && enf_barrier_tree_make(walls, boxes, wall_count, 0) &&
           enf_barrier_tree_make(portals, boxes + wall_count, count - wall_count, wall_count) &&
           arrange(s, boxes);
    free(boxes);
    return good;
}

static void hold_points(sighter *s) {
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
    hold_points(&s);
    bool good = add_walls(&s) && add_details(&s);
    s.wall_count = (int32_t)s.barrier_count;
    good = good && add_portals(&s) && make_trees(&s, &walls, &portals) && set_view(&s, &walls, &portals);
    enf_build_image_own(image, s.barriers);
    enf_build_image_own(image, s.vertices);
    enf_build_image_own(image, walls.nodes);
    enf_build_image_own(image, portals.nodes);
    return good ? ENF_OK : enf_fail_memory(error, "lines of sight");
}
