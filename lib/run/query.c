// SPDX-License-Identifier: MIT
// The flood from the cell of a shape's centre through the portals that the shape meets. What has been reached
// serves as the queue, so it comes out in breadth-first order. A cell takes a further image of the shape only
// if none that it has holds it: what the smaller one reaches, the larger one does.
#include "run/query.h"

#include "run/affine.h"
#include "run/instance.h"
#include "run/shape.h"
#include "run/vector.h"

#include <math.h>
#include <string.h>

double enf_query_slack(const enf_query *query, const enf_shape *shape) {
    double size = fmax(enf_shape_reach(shape), query->world_size);
    for (int a = 0; a < 3; a++) size = fmax(size, fabs(shape->centre[a]));
    return size * 0x1p-40;
}

void enf_query_begin(enf_query *query) {
    if (++query->mark) return;
    memset(query->seen, 0, (size_t)query->view->cell_count * sizeof *query->seen);
    query->mark = 1;
}

/// True if one of the images that have reached the cell holds the shape.
static bool is_covered(const enf_query *query, int32_t cell, int32_t image) {
    if (!enf_query_has(query, cell)) return false;
    const enf_shape *shape = &query->images[image].shape;
    for (int32_t i = query->first[cell]; i >= 0; i = query->flooded[i].next) {
        int32_t other = query->flooded[i].image;
        if (other == image || enf_shape_holds(&query->images[other].shape, shape)) return true;
    }
    return false;
}

static void reach(enf_query *query, int32_t cell, int32_t portal, int32_t image) {
    if (is_covered(query, cell, image)) return;
    if (query->flooded_count == query->flooded_max) {
        query->complete = false;
        return;
    }
    enf_flooded *flooded = &query->flooded[query->flooded_count];
    *flooded = (enf_flooded){cell, portal, image, enf_query_has(query, cell) ? query->first[cell] : -1};
    enf_query_mark(query, cell, query->flooded_count++);
}

static void reach_transformed(enf_query *query, int32_t cell, int32_t portal, int32_t image,
                              const double matrix[12]) {
    if (query->image_count == query->images_max) {
        query->complete = false;
        return;
    }
    enf_image *next = &query->images[query->image_count];
    enf_affine_multiply(next->matrix, matrix, query->images[image].matrix);
    next->shape = enf_shape_image(&query->images[0].shape, next->matrix);
    if (!enf_shape_is_valid(&next->shape)) {
        query->complete = false; // too large for doubles
    } else if (!is_covered(query, cell, query->image_count)) {
        reach(query, cell, portal, query->image_count++);
    }
}

static bool meets_sphere(const enf_shape *shape, double reach, const enf_file_portal *portal, double slack) {
    double square = 0, limit = reach + portal->radius + slack;
    for (int a = 0; a < 3; a++) {
        double away = shape->centre[a] - portal->centre[a];
        square += away * away;
    }
    return !(square > limit * limit);
}

/// `before`: only polygons that do not have the shape's centre behind them.
static bool meets_portal(const enf_file_view *view, const enf_shape *shape, const enf_file_portal *portal,
                         const enf_passage *passage, double slack, bool before) {
    for (int32_t i = 0; i < portal->polygon_count; i++) {
        const enf_file_portal_polygon *polygon = &view->portal_polygons[portal->polygon_first + i];
        if (before && enf_dot(polygon->plane, shape->centre) + polygon->plane[3] < -slack) continue;
        enf_face face = {.vertices = view->portal_vertices + polygon->vertex_first,
                         .count = polygon->vertex_count,
                         .normal = {polygon->plane[0], polygon->plane[1], polygon->plane[2]},
                         .cut = passage->cut ? passage->plane : NULL};
        if (enf_shape_meets_face(shape, &face, slack)) return true;
    }
    return false;
}

static void cross_portals(enf_query *query, const enf_instance *instance, enf_flooded from) {
    const enf_file_view *view = query->view;
    const enf_shape *shape = &query->images[from.image].shape;
    const enf_file_cell *cell = &view->cells[from.cell];
    const double size = enf_shape_reach(shape), slack = enf_query_slack(query, shape);
    for (int32_t i = 0; i < cell->portal_count; i++) {
        int32_t number = view->cell_portals[cell->portal_first + i];
        const enf_file_portal *portal = &view->portals[number];
        if (!meets_sphere(shape, size, portal, slack)) continue;
        enf_passage passage = enf_instance_passage(instance, view, number);
        if (passage.to < 0 || (!passage.matrix && is_covered(query, passage.to, from.image))) continue;
        if (!meets_portal(view, shape, portal, &passage, slack, false)) continue;
        if (passage.matrix)
            reach_transformed(query, passage.to, number, from.image, passage.matrix);
        else
            reach(query, passage.to, number, from.image);
    }
}

bool enf_query_enters(const enf_query *query, const enf_shape *shape, int32_t number,
                      const enf_passage *passage) {
    const enf_file_portal *portal = &query->view->portals[number];
    const double slack = enf_query_slack(query, shape);
    return meets_sphere(shape, enf_shape_reach(shape), portal, slack) &&
           meets_portal(query->view, shape, portal, passage, slack, true);
}

void enf_query_flood(enf_query *query, const enf_instance *instance, int32_t start, const enf_shape *shape) {
    enf_query_begin(query);
    query->flooded_count = query->image_count = 0;
    query->complete = true;
    if (start < 0) return;
    query->images[query->image_count++] = (enf_image){{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}, *shape};
    reach(query, start, -1, 0);
    for (int32_t i = 0; i < query->flooded_count; i++) cross_portals(query, instance, query->flooded[i]);
}

enf_status enf_query_cells(enf_query *query, const enf_instance *instance, int32_t start,
                           const enf_shape *shape, enf_reached *out, int32_t capacity, enf_reach *reach,
                           enf_error *error) {
    *reach = (enf_reach){0, 0, true};
    query->flooded_count = query->image_count = 0;
    enf_shape own;
    enf_status status = enf_shape_take(&own, shape, error);
    if (status) return status;
    if (start < -1 || start >= query->view->cell_count)
        return enf_fail(error, ENF_BAD_USAGE, "cell %ld: the world has cells 0 to %ld", (long)start,
                        (long)query->view->cell_count - 1);
    if (start < 0) start = enf_world_locate(query->world, own.centre, -1).cell;
    enf_query_flood(query, instance, start, &own);
    for (int32_t i = 0; i < query->flooded_count && i < capacity; i++) {
        const enf_flooded *flooded = &query->flooded[i];
        out[i] = (enf_reached){flooded->cell, flooded->portal, flooded->image};
    }
    *reach = (enf_reach){query->flooded_count, query->image_count, query->complete};
    return ENF_OK;
}

enf_image enf_query_image(const enf_query *query, int32_t image) {
    return image >= 0 && image < query->image_count ? query->images[image] : (enf_image){0};
}
