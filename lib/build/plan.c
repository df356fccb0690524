// SPDX-License-Identifier: GPL-3.0-or-later
// Cuts convex things with a horizontal plane. A corner exactly on the plane counts as above it.
#include "build/plan.h"

#include "base/array.h"
#include "format/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PIECE_OPEN = -1 }; // see enf_complex.piece_cover

typedef struct cutter {
    const enf_plan *plan;
    const enf_file_view *view;
    double (*at)[3]; ///< per vertex: page x, page y, height
    enf_storey *storey;
    double (*points)[2]; ///< of the cell being cut
    size_t point_count, point_capacity;
} cutter;

void enf_plan_free(enf_plan *plan) {
    for (int i = 0; i < ENF_STOREYS_MAX; i++) {
        free(plan->storeys[i].areas);
        free(plan->storeys[i].corners);
        free(plan->storeys[i].lines);
    }
    *plan = (enf_plan){0};
}

void enf_plan_grid_to_world(const enf_file_view *view, const double grid[3], double world[3]) {
    enf_view_to_world(view, grid, world);
}

double enf_plan_project(const enf_plan *plan, const double world[3], double page[2]) {
    page[0] = world[plan->right];
    page[1] = plan->ahead_sign * world[plan->ahead];
    return world[plan->up];
}

static void set_axes(enf_plan *plan, int up) {
    static const int axes[3][2] = {{1, 2}, {0, 2}, {0, 1}};
    *plan = (enf_plan){.right = axes[up][0], .ahead = axes[up][1], .up = up, .ahead_sign = up == 1 ? -1 : 1};
}

static void set_box(enf_plan *plan, const enf_file_view *view) {
    for (int a = 0; a < 2; a++) {
        plan->low[a] = INFINITY;
        plan->high[a] = -INFINITY;
    }
    for (int32_t i = 0; i < 2 * view->cell_count; i++) {
        double page[2];
        enf_plan_project(plan, i % 2 ? view->cells[i / 2].box_max : view->cells[i / 2].box_min, page);
        for (int a = 0; a < 2; a++) {
            plan->low[a] = fmin(plan->low[a], page[a]);
            plan->high[a] = fmax(plan->high[a], page[a]);
        }
    }
    if (view->cell_count == 0) plan->low[0] = plan->low[1] = 0, plan->high[0] = plan->high[1] = 1;
}

/// Where the edge a-b meets the plane, computed from the lower end so that both its facets find the same
/// point.
static void cross(const double *a, const double *b, double height, double out[2]) {
    const double *low = a[2] < b[2] ? a : b, *high = a[2] < b[2] ? b : a;
    double t = (height - low[2]) / (high[2] - low[2]);
    for (int k = 0; k < 2; k++) out[k] = low[k] + t * (high[k] - low[k]);
}

static bool is_crossed(const double *a, const double *b, double height) {
    return (a[2] >= height) != (b[2] >= height);
}

static bool cut_facet(cutter *cut, int32_t facet) {
    const enf_file_view *view = cut->view;
    int64_t first = view->facet_offset[facet], end = view->facet_offset[facet + 1];
    const double *previous = first < end ? cut->at[view->facet_corners[end - 1].vertex] : NULL;
    for (int64_t c = first; c < end; c++) {
        const double *at = cut->at[view->facet_corners[c].vertex];
        if (is_crossed(previous, at, cut->storey->height)) {
            if (!enf_array_reserve(cut->points, cut->point_capacity, cut->point_count + 1)) return false;
            cross(previous, at, cut->storey->height, cut->points[cut->point_count++]);
        }
        previous = at;
    }
    return true;
}

static int compare_points(const void *a, const void *b) {
    const double *p = a, *q = b;
    if (p[0] != q[0]) return p[0] < q[0] ? -1 : 1;
    return (p[1] > q[1]) - (p[1] < q[1]);
}

static double turn(const double *a, const double *b, const double *c) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// The convex hull of cut->points (Andrew's monotone chain) becomes an area of the storey.
static bool add_area(cutter *cut, int32_t cell) {
    enf_storey *storey = cut->storey;
    size_t count = cut->point_count, made = 0;
    if (count < 3) return true;
    qsort(cut->points, count, sizeof *cut->points, compare_points);
    if (!enf_array_reserve(storey->corners, storey->corner_capacity, storey->corner_count + 2 * count) ||
        !enf_array_reserve(storey->areas, storey->area_capacity, storey->area_count + 1))
        return false;
    double(*hull)[2] = storey->corners + storey->corner_count;
    for (int pass = 0; pass < 2; pass++) { // the lower side, then the upper
        size_t start = made;
        for (size_t k = 0; k < count; k++) {
            const double *point = cut->points[pass ? count - 1 - k : k];
            while (made >= start + 2 && turn(hull[made - 2], hull[made - 1], point) <= 0) made--;
            memcpy(hull[made++], point, sizeof *hull);
        }
        made--; // the other side begins with it
    }
    if (made < 3) return true;
    storey->areas[storey->area_count++] = (enf_plan_area){
        .cell = cell, .corner_first = (int32_t)storey->corner_count, .corner_count = (int32_t)made};
    storey->corner_count += made;
    return true;
}

bool enf_plan_add_line(enf_storey *storey, const double from[2], const double to[2], int32_t portal) {
    if (!enf_array_reserve(storey->lines, storey->line_capacity, storey->line_count + 1)) return false;
    storey->lines[storey->line_count++] =
        (enf_plan_line){.from = {from[0], from[1]}, .to = {to[0], to[1]}, .portal = portal};
    return true;
}

/// Occluded pieces with a cell on a side are walls.
static bool cut_piece(cutter *cut, int32_t piece) {
    const enf_file_view *view = cut->view;
    if (view->piece_cover[piece] == PIECE_OPEN) return true;
    bool kept = false;
    for (int side = 0; side < 2; side++) {
        int32_t fine = view->facet_fine[view->piece_facet[piece]][side];
        kept = kept || (fine >= 0 && view->fine_cell[fine] >= 0);
    }
    if (!kept) return true;
    const enf_file_corner *corners = view->piece_corners;
    int64_t first = view->piece_offset[piece], end = view->piece_offset[piece + 1];
    if (first == end) { // the whole facet
        corners = view->facet_corners;
        first = view->facet_offset[view->piece_facet[piece]];
        end = view->facet_offset[view->piece_facet[piece] + 1];
    }
    double ends[2][2], height = cut->storey->height;
    int count = 0;
    const double *previous = first < end ? cut->at[corners[end - 1].vertex] : NULL;
    for (int64_t c = first; c < end && count < 2; c++) {
        const double *at = cut->at[corners[c].vertex];
        if (is_crossed(previous, at, height)) cross(previous, at, height, ends[count++]);
        previous = at;
    }
    return count < 2 || enf_plan_add_line(cut->storey, ends[0], ends[1], ENF_PLAN_WALL);
}

static bool cut_portal(cutter *cut, int32_t portal) {
    const enf_file_view *view = cut->view;
    const enf_file_portal *it = &view->portals[portal];
    for (int32_t i = 0; i < it->polygon_count; i++) {
        const enf_file_portal_polygon *polygon = &view->portal_polygons[it->polygon_first + i];
        const double(*vertices)[3] = view->portal_vertices + polygon->vertex_first;
        double ends[2][2], previous[3], at[3], height = cut->storey->height;
        int count = 0;
        previous[2] = enf_plan_project(cut->plan, vertices[polygon->vertex_count - 1], previous);
        for (int32_t k = 0; k < polygon->vertex_count && count < 2; k++) {
            at[2] = enf_plan_project(cut->plan, vertices[k], at);
            if (is_crossed(previous, at, height)) cross(previous, at, height, ends[count++]);
            memcpy(previous, at, sizeof at);
        }
        if (count == 2 && !enf_plan_add_line(cut->storey, ends[0], ends[1], portal)) return false;
    }
    return true;
}

static int compare_areas(const void *a, const void *b) {
    const enf_plan_area *x = a, *y = b;
    if (x->cell != y->cell) return x->cell < y->cell ? -1 : 1;
    return (x->corner_first > y->corner_first) - (x->corner_first < y->corner_first);
}

static bool cut_storey(cutter *cut, enf_storey *storey) {
    const enf_file_view *view = cut->view;
    bool good = true;
    cut->storey = storey;
    for (int32_t i = 0; good && i < view->fine_count; i++) {
        if (view->fine_cell[i] < 0) continue;
        cut->point_count = 0;
        for (int32_t f = view->fine_facet[i]; good && f < view->fine_facet[i + 1]; f++)
            good = cut_facet(cut, view->fine_facets[f]);
        good = good && add_area(cut, view->fine_cell[i]);
    }
    for (int32_t i = 0; good && i < view->piece_count; i++) good = cut_piece(cut, i);
    for (int32_t i = 0; good && i < view->portal_count; i += 2) good = cut_portal(cut, i);
    if (good) qsort(storey->areas, (size_t)storey->area_count, sizeof *storey->areas, compare_areas);
    return good;
}

static bool prepare(cutter *cut) {
    const enf_file_view *view = cut->view;
    cut->at = enf_array_new((size_t)view->vertex_count, sizeof *cut->at);
    if (!cut->at) return false;
    for (int32_t i = 0; i < view->vertex_count; i++) {
        double world[3];
        enf_plan_grid_to_world(view, view->vertex_position[i], world);
        cut->at[i][2] = enf_plan_project(cut->plan, world, cut->at[i]);
    }
    return true;
}

enf_status enf_plan_make(enf_plan *plan, const enf_file_view *view, int up, enf_error *error) {
    set_axes(plan, up);
    if (!view->has_exact)
        return enf_fail(error, ENF_BAD_INPUT, "the file holds no fine cells to cut; compile the world again");
    set_box(plan, view);
    double heights[ENF_STOREYS_MAX];
    plan->storey_count = enf_storeys_find(plan, view, heights);
    cutter cut = {.plan = plan, .view = view};
    bool good = plan->storey_count > 0 && prepare(&cut);
    for (int i = 0; good && i < plan->storey_count; i++) {
        plan->storeys[i].height = heights[i];
        good = cut_storey(&cut, &plan->storeys[i]);
    }
    good = good && enf_storeys_outline(plan, view);
    free(cut.at);
    free(cut.points);
    return good ? ENF_OK : enf_fail_memory(error, "the floor plans");
}
