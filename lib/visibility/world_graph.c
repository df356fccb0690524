// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/world_graph.h"

#include "base/array.h"
#include "format/frame.h"
#include "visibility/hull.h"
#include "visibility/window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double same_plane = 0x1p-40; ///< of the size of coordinates: what rounding does to planes

// ---------------------------------------------------------------------------------------------- cells

/// Does the polygon lie in the other's plane? Portals are small beside the world, normals are unit vectors.
static bool is_in_plane(const enf_file_view *view, const enf_file_portal_polygon *polygon,
                        const enf_file_portal_polygon *other) {
    if (enf_dot(polygon->plane, other->plane) < 0) return false;
    for (int32_t i = 0; i < polygon->vertex_count; i++) {
        const double *at = view->portal_vertices[polygon->vertex_first + i];
        double size = fabs(at[0]) + fabs(at[1]) + fabs(at[2]) + fabs(other->plane[3]);
        if (fabs(enf_dot(other->plane, at) + other->plane[3]) > same_plane * size) return false;
    }
    return true;
}

/// The two coordinates in which the plane is seen best, so that its front turns counter-clockwise.
static void find_axes(const double normal[3], int32_t axes[2]) {
    int along = 0;
    for (int axis = 1; axis < 3; axis++)
        if (fabs(normal[axis]) > fabs(normal[along])) along = axis;
    int turned = normal[along] < 0;
    axes[turned] = (along + 1) % 3;
    axes[!turned] = (along + 2) % 3;
}

static const double (*polygon_corners(const enf_file_view *view, const enf_file_portal_polygon *polygon))[3] {
    return view->portal_vertices + polygon->vertex_first;
}

/// Takes all polygons of the portal that lie in the plane of polygon `first` and are not taken yet.
static bool add_plane(enf_portal_graph *graph, const enf_file_view *view, const enf_file_portal *portal,
                      int32_t first, bool *taken) {
    const enf_file_portal_polygon *polygons = view->portal_polygons + portal->polygon_first;
    const enf_file_portal_polygon *plane = &polygons[first];
    if (plane->vertex_count > ENF_WINDOW_MOST / 2) // by itself: a hull of such would not fit
        return enf_portal_graph_add(graph, portal->to, portal->from, polygon_corners(view, plane),
                                    plane->vertex_count);
    enf_window hull, next;
    int32_t axes[2];
    find_axes(plane->plane, axes);
    enf_window_copy(&hull, polygon_corners(view, plane), plane->vertex_count);
    for (int32_t i = first + 1; i < portal->polygon_count; i++) {
        if (taken[i] || hull.count + polygons[i].vertex_count > ENF_WINDOW_MOST) continue;
        if (!is_in_plane(view, &polygons[i], plane)) continue;
        taken[i] = true;
        enf_window_copy(&next, polygon_corners(view, &polygons[i]), polygons[i].vertex_count);
        const enf_outline other = enf_window_outline(&next);
        enf_hull_extend(&hull, &other, axes, 0);
    }
    double corners[ENF_WINDOW_MOST][3];
    const enf_outline outline = enf_window_outline(&hull);
    for (int32_t i = 0; i < hull.count; i++) enf_outline_corner(&outline, i, corners[i]);
    return enf_portal_graph_add(graph, portal->to, portal->from, (const double(*)[3])corners, hull.count);
}

enf_status enf_world_graph_make(enf_portal_graph *graph, const enf_file_view *view, enf_error *error) {
    *graph = (enf_portal_graph){.cell_count = view->cell_count};
    bool *taken = enf_array_new((size_t)view->portal_polygon_count, sizeof *taken), good = taken != NULL;
    for (int32_t i = 0; good && i < view->portal_count; i += 2) {
        const enf_file_portal *portal = &view->portals[i];
        memset(taken, 0, (size_t)portal->polygon_count * sizeof *taken);
        for (int32_t k = 0; good && k < portal->polygon_count; k++)
            if (!taken[k]) good = add_plane(graph, view, portal, k, taken);
    }
    free(taken);
    return good ? enf_portal_graph_finish(graph, error) : enf_fail_memory(error, "the portal graph");
}

// ---------------------------------------------------------------------------------------------- fine cells

/// The corners of a piece, or of its facet if it has none of its own.
static const enf_file_corner *piece_corners(const enf_file_view *view, int32_t piece, int64_t *count) {
    const int32_t *offset = &view->piece_offset[piece];
    const enf_file_corner *corners = view->piece_corners;
    if (offset[0] == offset[1]) {
        offset = &view->facet_offset[view->piece_facet[piece]];
        corners = view->facet_corners;
    }
    *count = offset[1] - offset[0];
    return corners + offset[0];
}

/// Of the largest coordinate: what is thinner has no plane, as corners are rounded, and no line passes it for
/// sure (sight.h).
static const double thinnest = 0x1p-40;

/// Is the polygon about as thin as rounding? Its area is that of a rectangle of its longest extent, at most.
static bool is_thin(const enf_file_view *view, const double (*corners)[3], int64_t count) {
    double area[3] = {0}, longest = 0, largest = 0;
    for (int axis = 0; axis < 3; axis++)
        largest = fmax(largest, fmax(fabs(view->frame->box_min[axis]), fabs(view->frame->box_max[axis])));
    for (int64_t i = 1; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            const int64_t next = i + 1 < count ? i + 1 : 0;
            area[axis] += ((corners[i][u] - corners[0][u]) * (corners[next][v] - corners[0][v]) -
                           (corners[i][v] - corners[0][v]) * (corners[next][u] - corners[0][u])) /
                          2;
            longest = fmax(longest, fabs(corners[i][axis] - corners[0][axis]));
        }
    return sqrt(enf_dot(area, area)) <= thinnest * largest * longest;
}

static bool add_piece(enf_portal_graph *graph, const enf_file_view *view, int32_t piece, double (**buffer)[3],
                      size_t *capacity) {
    const int32_t *fine = view->facet_fine[view->piece_facet[piece]];
    if (view->piece_cover[piece] != -1 || fine[0] < 0 || fine[1] < 0) return true;
    if (view->fine_cell[fine[0]] < 0 || view->fine_cell[fine[1]] < 0) return true;
    int64_t count;
    const enf_file_corner *corners = piece_corners(view, piece, &count);
    if (!enf_array_reserve(*buffer, *capacity, count)) return false;
    for (int64_t i = 0; i < count; i++)
        enf_view_to_world(view, view->vertex_position[corners[i].vertex], (*buffer)[i]);
    if (is_thin(view, (const double(*)[3]) * buffer, count)) return true;
    int mirrored = view->frame->handedness < 0;
    return enf_portal_graph_add(graph, fine[mirrored], fine[!mirrored], (const double(*)[3]) * buffer,
                                (int32_t)count);
}

enf_status enf_world_graph_make_fine(enf_portal_graph *graph, const enf_file_view *view, enf_error *error) {
    *graph = (enf_portal_graph){.cell_count = view->fine_count};
    double(*buffer)[3] = NULL;
    size_t capacity = 0;
    bool good = true;
    for (int32_t piece = 0; good && piece < view->piece_count; piece++)
        good = add_piece(graph, view, piece, &buffer, &capacity);
    free(buffer);
    return good ? enf_portal_graph_finish(graph, error) : enf_fail_memory(error, "the portal graph");
}
