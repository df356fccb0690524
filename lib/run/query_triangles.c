// SPDX-License-Identifier: MIT
// The triangles of the cells that a query has reached.
#include "run/query.h"
#include "run/shape.h"

#include <math.h>
#include <string.h>

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
    const enf_file_triangle *triangle = &query->view->triangles[number];
    double corner[3][3];
    const double *size = shape->half;
    for (int k = 0; k < 3; k++)
        memcpy(corner[k], query->view->render_points[triangle->point[k]], sizeof corner[k]);
    for (int a = 0; a < 3; a++) {
        double low = fmin(corner[0][a], fmin(corner[1][a], corner[2][a])) - shape->centre[a];
        double high = fmax(corner[0][a], fmax(corner[1][a], corner[2][a])) - shape->centre[a];
        double most = shape->radius + size[a] + slack;
        if (low > most || high < -most) return false;
    }
    enf_face face = {.vertices = (const double(*)[3])corner, .count = 3};
    find_normal((const double(*)[3])corner, face.normal);
    return enf_shape_meets_face(shape, &face, slack);
}

int64_t enf_query_triangles(enf_query *query, enf_touched *out, int64_t capacity) {
    const enf_file_view *view = query->view;
    int64_t count = 0;
    for (int32_t image = 0; query->triangle_seen && image < query->image_count; image++) {
        const enf_shape *shape = &query->images[image].shape;
        double slack = enf_query_slack(query, shape);
        begin_triangles(query);
        for (int32_t i = 0; i < query->flooded_count; i++) {
            if (query->flooded[i].image != image) continue;
            const enf_file_cell *cell = &view->cells[query->flooded[i].cell];
            for (int32_t k = 0; k < cell->triangle_count; k++) {
                int32_t triangle = view->cell_triangles[cell->triangle_first + k];
                if (query->triangle_seen[triangle] == query->triangle_mark) continue;
                query->triangle_seen[triangle] = query->triangle_mark;
                if (!meets_triangle(query, shape, triangle, slack)) continue;
                if (count < capacity) out[count] = (enf_touched){triangle, image};
                count++;
            }
        }
    }
    return count;
}
