// SPDX-License-Identifier: GPL-3.0-or-later
// Lines of sight: the barriers are the clean polygons at kept cells, corner by corner, the sealed cracks
// there and the polygons of the portals; and a walk through the trees finds each of them.
#include "build/check_rows.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>

static bool is_kept(const enf_file_view *view, int32_t fine) {
    return fine >= 0 && view->fine_cell[fine] >= 0;
}

/// Marks the clean polygons that occlude a kept cell. Returns how many cracks were sealed there.
static int32_t find_walls(const enf_file_view *view, uint8_t *is_wall) {
    int32_t cracks = 0;
    for (int32_t piece = 0; piece < view->piece_count; piece++) {
        const int32_t *fine = view->facet_fine[view->piece_facet[piece]];
        if (!is_kept(view, fine[0]) && !is_kept(view, fine[1])) continue;
        int32_t cover = view->piece_cover[piece];
        if (cover >= 0) is_wall[view->cover_polygon[cover]] = 1;
        cracks += cover == -2;
    }
    return cracks;
}

/// Is the barrier the clean polygon, in the same order of corners?
static bool is_polygon(const enf_file_view *view, const enf_file_barrier *barrier, int32_t polygon) {
    int64_t first = view->mesh_polygon_corner[polygon],
            count = view->mesh_polygon_corner[polygon + 1] - first;
    if (barrier->vertex_count != count) return false;
    for (int32_t k = 0; k < count; k++) {
        const double *point = view->points[view->mesh_corners[first + k]];
        const double *at = view->barrier_vertices[barrier->vertex_first + k];
        for (int a = 0; a < 3; a++)
            if (at[a] != point[a] * view->frame->locate_scale) return false;
    }
    return true;
}

/// Walls that are not drawn are only counted.
static bool check_barriers(enf_checker *checker, uint8_t *is_wall) {
    const enf_file_view *view = checker->view;
    int64_t many[ENF_FILE_BARRIER_KINDS] = {0}, walls = 0;
    int32_t cracks = find_walls(view, is_wall);
    for (int32_t i = 0; i < view->mesh_polygon_count; i++) walls += is_wall[i];
    for (int32_t i = 0; i < view->barrier_count; i++, checker->row->tested++) {
        const enf_file_barrier *barrier = &view->barriers[i];
        many[barrier->kind]++;
        if (barrier->kind != ENF_FILE_BARRIER_WALL || barrier->index < 0 || !view->has_geometry) continue;
        int32_t polygon = view->triangles[barrier->index].mesh_polygon;
        if (polygon < 0 || !is_wall[polygon] || !is_polygon(view, barrier, polygon))
            return enf_check_break(
                checker, "barrier %d is not clean polygon %d, or that is no wall, or is there twice", (int)i,
                (int)polygon);
        is_wall[polygon] = 0;
    }
    if (many[ENF_FILE_BARRIER_WALL] != walls || many[ENF_FILE_BARRIER_CRACK] != cracks ||
        many[ENF_FILE_BARRIER_PORTAL] != view->portal_loop_count)
        return enf_check_break(
            checker, "there are %lld walls, %lld cracks and %lld portal polygons; not all, or more",
            (long long)many[ENF_FILE_BARRIER_WALL], (long long)many[ENF_FILE_BARRIER_CRACK],
            (long long)many[ENF_FILE_BARRIER_PORTAL]);
    return true;
}

/// Does a child's box hold the barrier, and the room that walks need around it?
static bool child_holds(const enf_file_view *view, const enf_file_barrier_node *node, int child,
                        const enf_file_barrier *barrier) {
    double room = view->sight->extent * 0x1p-20; // half of it: rounded
    for (int32_t k = 0; k < barrier->vertex_count; k++) {
        const double *at = view->barrier_vertices[barrier->vertex_first + k];
        for (int a = 0; a < 3; a++)
            if (at[a] - room < node->bound[a][0][child] || at[a] + room > node->bound[a][1][child])
                return false;
    }
    return true;
}

static bool child_holds_node(const enf_file_barrier_node *node, int child,
                             const enf_file_barrier_node *inner) {
    for (int k = 0; k < 4; k++) {
        for (int a = 0; a < 3 && inner->child[k] != -1; a++)
            if (inner->bound[a][0][k] < node->bound[a][0][child] ||
                inner->bound[a][1][k] > node->bound[a][1][child])
                return false;
    }
    return true;
}

static bool check_tree(enf_checker *checker, const enf_file_barrier_node *nodes, int32_t count,
                       bool of_portals, uint8_t *met) {
    const enf_file_view *view = checker->view;
    for (int32_t n = 0; n < count; n++) {
        for (int k = 0; k < 4; k++, checker->row->tested++) {
            int32_t child = nodes[n].child[k];
            if (child == -1) continue;
            bool good = true;
            if (child >= 0) {
                good = child_holds_node(&nodes[n], k, &nodes[child]);
            } else {
                const enf_file_barrier *barrier = &view->barriers[-2 - child];
                good = !met[-2 - child]++ && child_holds(view, &nodes[n], k, barrier) &&
                       (barrier->kind == ENF_FILE_BARRIER_PORTAL) == of_portals;
            }
            if (!good)
                return enf_check_break(checker,
                                       "child %d of node %d of the tree of %s reaches out of its box", k,
                                       (int)n, of_portals ? "portals" : "walls");
        }
    }
    return true;
}

static void check_all(enf_checker *checker, uint8_t *is_wall, uint8_t *met) {
    const enf_file_view *view = checker->view;
    if (!check_barriers(checker, is_wall) ||
        !check_tree(checker, view->wall_nodes, view->wall_node_count, false, met) ||
        !check_tree(checker, view->portal_nodes, view->portal_node_count, true, met))
        return;
    for (int32_t i = 0; i < view->barrier_count; i++) {
        if (met[i]) continue;
        enf_check_break(checker, "barrier %d is in no tree", (int)i);
        return;
    }
}

void enf_check_sight(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    if (!view->sight) return;
    enf_check_begin(checker, "file: sight",
                    "barriers are the walls, cracks and portals, each in the boxes of its tree");
    uint8_t *is_wall = enf_array_zeroed((size_t)view->mesh_polygon_count, 1);
    uint8_t *met = enf_array_zeroed((size_t)view->barrier_count, 1);
    if (!is_wall || !met)
        enf_check_no_memory(checker);
    else
        check_all(checker, is_wall, met);
    free(is_wall);
    free(met);
}
