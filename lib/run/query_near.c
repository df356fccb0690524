// SPDX-License-Identifier: MIT
#include "run/query_near.h"

#include "format/frame.h"

#include <math.h>
#include <string.h>

enum { WAITING_MAX = 3 * ENF_FILE_BARRIER_DEPTH_MAX + 4, TRIES_MAX = 4096 };

/// The triangles of a barrier: a wall's follow each other. Returns the end.
static int32_t end_of_run(const enf_file_view *view, const enf_file_barrier *barrier) {
    int32_t end = barrier->index + 1;
    if (barrier->kind != ENF_FILE_BARRIER_WALL) return end;
    while (end < view->triangle_count && end - barrier->index <= TRIES_MAX &&
           view->triangles[end].mesh_polygon == view->triangles[barrier->index].mesh_polygon)
        end++;
    return end;
}

static bool has_triangles(const enf_file_barrier *barrier) {
    return barrier->index >= 0 &&
           (barrier->kind == ENF_FILE_BARRIER_WALL || barrier->kind == ENF_FILE_BARRIER_DETAIL);
}

/// Marks what the tree's barriers draw. False if that is more than it can be.
static bool mark_runs(const enf_file_view *view, uint32_t *marks) {
    int64_t left = (int64_t)view->triangle_count + view->wall_node_count;
    for (int32_t n = 0; n < view->wall_node_count; n++) {
        for (int k = 0; k < 4; k++) {
            int32_t child = view->wall_nodes[n].child[k];
            if (child >= -1 || !has_triangles(&view->barriers[-2 - child])) continue;
            const enf_file_barrier *barrier = &view->barriers[-2 - child];
            int32_t end = end_of_run(view, barrier);
            left -= end - barrier->index;
            if (left < 0) return false;
            for (int32_t i = barrier->index; i < end; i++) marks[i] = 1;
        }
    }
    return true;
}

void enf_near_prepare(enf_near_index *index, const enf_file_view *view, uint32_t *marks) {
    index->is_complete = view->wall_nodes && view->wall_node_count > 0 && mark_runs(view, marks);
    index->loose_count = 0;
    for (int64_t i = 0; index->is_complete && i < view->cell_triangle_count; i++) {
        int32_t triangle = view->cell_triangles[i];
        if (marks[triangle]) continue;
        marks[triangle] = 1;
        if (index->loose_count == ENF_LOOSE_MAX)
            index->is_complete = false;
        else
            index->loose[index->loose_count++] = triangle;
    }
    memset(marks, 0, (size_t)view->triangle_count * sizeof *marks);
}

bool enf_near_has_box(const enf_file_view *view, const enf_shape *shape, int32_t number, double slack) {
    const int32_t *point = view->triangles[number].point;
    const double *p = view->render_points[point[0]], *q = view->render_points[point[1]],
                 *r = view->render_points[point[2]];
    for (int a = 0; a < 3; a++) {
        double low = fmin(p[a], fmin(q[a], r[a])) - shape->centre[a];
        double high = fmax(p[a], fmax(q[a], r[a])) - shape->centre[a];
        double most = shape->radius + shape->half[a] + slack;
        if (low > most || high < -most) return false;
    }
    return true;
}

/// Adds a triangle behind those that are less.
static void add(enf_near *near, int32_t triangle) {
    if (near->count == ENF_NEAR_MAX) {
        near->is_known = false;
        return;
    }
    int32_t at = near->count++;
    for (; at > 0 && near->list[at - 1] > triangle; at--) near->list[at] = near->list[at - 1];
    near->list[at] = triangle;
}

/// A box of the fine grid around the shape, and as much more as walls may be away from what is drawn of them:
/// clean has moved their corners.
static void find_box(const enf_file_view *view, const enf_shape *shape, double slack, float low[3],
                     float high[3]) {
    const double scale = view->frame->locate_scale;
    double centre[3], size[3] = {0, 0, 0}, more = slack + view->frame->displacement_max;
    enf_view_to_grid(view, shape->centre, centre);
    for (int a = 0; a < 3; a++) {
        double side[3] = {0, 0, 0}, turned[3];
        side[a] = shape->radius + shape->half[a] + more;
        enf_view_to_grid(view, side, turned);
        for (int i = 0; i < 3; i++) size[i] += fabs(turned[i]);
    }
    for (int a = 0; a < 3; a++) {
        low[a] = (float)((centre[a] - size[a]) * scale);
        high[a] = (float)((centre[a] + size[a]) * scale);
    }
}

/// A box without a place is everywhere.
static bool meets_child(const enf_file_barrier_node *node, int k, const float low[3], const float high[3]) {
    for (int a = 0; a < 3; a++)
        if (node->bound[a][0][k] > high[a] || node->bound[a][1][k] < low[a]) return false;
    return true;
}

static void take_barrier(enf_near *near, const enf_file_view *view, const enf_file_barrier *barrier,
                         const enf_shape *shape, double slack, int *tries) {
    if (!has_triangles(barrier)) return;
    int32_t end = end_of_run(view, barrier);
    *tries += end - barrier->index;
    if (*tries > TRIES_MAX) near->is_known = false;
    for (int32_t i = barrier->index; i < end && near->is_known; i++)
        if (enf_near_has_box(view, shape, i, slack)) add(near, i);
}

void enf_near_find(enf_near *near, const enf_near_index *index, const enf_file_view *view,
                   const enf_shape *shape, double slack) {
    float low[3], high[3];
    int32_t waiting[WAITING_MAX];
    int count = 0, tries = 0;
    near->is_known = index->is_complete;
    near->count = 0;
    find_box(view, shape, slack, low, high);
    waiting[count++] = 0;
    while (count > 0 && near->is_known) {
        const enf_file_barrier_node *node = &view->wall_nodes[waiting[--count]];
        for (int k = 0; k < 4; k++) {
            int32_t child = node->child[k];
            if (child == -1 || !meets_child(node, k, low, high)) continue;
            if (child >= 0)
                waiting[count++] = child;
            else
                take_barrier(near, view, &view->barriers[-2 - child], shape, slack, &tries);
        }
    }
    for (int32_t i = 0; i < index->loose_count && near->is_known; i++)
        if (enf_near_has_box(view, shape, index->loose[i], slack)) add(near, index->loose[i]);
}
