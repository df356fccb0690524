// SPDX-License-Identifier: MIT
// The triangles of the cells that a query has reached.
#include "run/query.h"
#include "run/shape.h"

#include <math.h>
#include <string.h>

enum { TRIANGLES_MANY = 96 }; ///< of a cell: then those near the shape are found first

/// Voids the marks of all triangles.
static void begin_triangles(enf_query *query) {
    if (++query->triangle_mark) return;
    memset(query->triangle_seen, 0, (size_t)query->view->triangle_count * sizeof *query->triangle_seen);
    query->triangle_mark = 1;
}

/// Of length 1, or zero for a triangle without area.
static void find_normal(const double corner[3][3], double normal[3]) {
    double u[3], v[3];
    for (int a = 0; a < 3; a++) {
        u[a] = corner[1][a] - corner[0][a];
        v[a] = corner[2][a] - corner[0][a];
    }
    double length = 0;
    for (int a = 0; a < 3; a++) {
        int b = (a + 1) % 3, c = (a + 2) % 3;
        normal[a] = u[b] * v[c] - u[c] * v[b];
        length += normal[a] * normal[a];
    }
    length = sqrt(length);
    bool usable = length > 0 && isfinite(length);
    for (int a = 0; a < 3; a++) normal[a] = usable ? normal[a] / length : 0;
}

static bool meets_triangle(const enf_query *query, const enf_shape *shape, int32_t number, double slack) {
    if (!enf_near_has_box(query->view, shape, number, slack)) return false;
    double corner[3][3];
    for (int k = 0; k < 3; k++)
        memcpy(corner[k], query->view->render_points[query->view->triangles[number].point[k]],
               sizeof corner[k]);
    enf_face face = {.vertices = (const double(*)[3])corner, .count = 3};
    find_normal((const double(*)[3])corner, face.normal);
    return enf_shape_meets_face(shape, &face, slack);
}

/// What is being listed.
typedef struct listing {
    enf_query *query;
    int32_t image;
    const enf_shape *shape;
    double slack;
    enf_touched *out;
    int64_t capacity, count;
    bool has_near; ///< `near` was found
    enf_near near;
} listing;

static void take_triangle(listing *l, int32_t triangle) {
    enf_query *query = l->query;
    if (query->triangle_seen[triangle] == query->triangle_mark) return;
    query->triangle_seen[triangle] = query->triangle_mark;
    if (!meets_triangle(query, l->shape, triangle, l->slack)) return;
    if (l->count < l->capacity) l->out[l->count] = (enf_touched){triangle, l->image};
    l->count++;
}

/// Is a number in an ascending list?
static bool lists(const int32_t *list, int32_t count, int32_t number) {
    int32_t first = 0;
    while (first < count) {
        int32_t middle = first + (count - first) / 2;
        if (list[middle] == number) return true;
        if (list[middle] < number)
            first = middle + 1;
        else
            count = middle;
    }
    return false;
}

static void take_cell(listing *l, int32_t number) {
    const enf_file_view *view = l->query->view;
    const enf_file_cell *cell = &view->cells[number];
    const int32_t *list = view->cell_triangles + cell->triangle_first;
    if (cell->triangle_count >= TRIANGLES_MANY && !l->has_near) {
        enf_near_find(&l->near, &l->query->near_index, view, l->shape, l->slack);
        l->has_near = true;
    }
    bool by_near = cell->triangle_count >= TRIANGLES_MANY && l->near.is_known;
    for (int32_t k = 0; !by_near && k < cell->triangle_count; k++) take_triangle(l, list[k]);
    for (int32_t k = 0; by_near && k < l->near.count; k++)
        if (lists(list, cell->triangle_count, l->near.list[k])) take_triangle(l, l->near.list[k]);
}

int64_t enf_query_triangles(enf_query *query, enf_touched *out, int64_t capacity) {
    listing l = {.query = query, .out = out, .capacity = capacity};
    for (int32_t image = 0; query->triangle_seen && image < query->image_count; image++) {
        l.image = image;
        l.shape = &query->images[image].shape;
        l.slack = enf_query_slack(query, l.shape);
        l.has_near = false;
        begin_triangles(query);
        for (int32_t i = 0; i < query->flooded_count; i++)
            if (query->flooded[i].image == image) take_cell(&l, query->flooded[i].cell);
    }
    return l.count;
}
