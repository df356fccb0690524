// SPDX-License-Identifier: GPL-3.0-or-later
// Where point location starts when it has no hint: a quarter as many bricks as there are tetrahedra, each
// with the one that holds its middle, or one of the hull that has it in front.
#include "build/write_parts.h"

#include "format/locate.h"

#include <math.h>

/// No side of the bricks' box counts as shorter than this share of the longest.
static const double flattest = 1e-3;

static const double brick_max = 0x1p26;

static void find_box(const enf_file_view *view, double low[3], double high[3]) {
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
        for (int32_t i = 0; i < view->point_count; i++) {
            low[a] = fmin(low[a], view->points[i][a]);
            high[a] = fmax(high[a], view->points[i][a]);
        }
        if (!(low[a] <= high[a])) low[a] = high[a] = 0;
    }
}

/// Bricks that are nearly cubes.
static void choose_bricks(enf_file_start *start, const enf_file_view *view) {
    double low[3], high[3], size[3], largest = 1, volume = 1;
    find_box(view, low, high);
    for (int a = 0; a < 3; a++) largest = fmax(largest, high[a] - low[a]);
    for (int a = 0; a < 3; a++) {
        size[a] = fmax(high[a] - low[a], largest * flattest);
        volume *= size[a] / largest;
    }
    double wanted = fmax(1, fmin(floor(view->tetrahedron_count / 4.0), brick_max)),
           edge = largest * cbrt(volume / wanted);
    for (int a = 0; a < 3; a++) {
        start->count[a] = (int32_t)fmax(1, size[a] / edge);
        start->origin[a] = low[a];
        start->per_step[a] = start->count[a] / size[a];
    }
}

/// The bricks in an order in which each lies beside the one before it.
static void fill_bricks(const enf_file_start *start, const enf_file_view *view, int32_t *tetrahedra) {
    int32_t hint = view->tetrahedron_count > 0 ? 0 : -1, rows = 0;
    for (int32_t x = 0; x < start->count[0]; x++) {
        for (int32_t j = 0; j < start->count[1]; j++, rows++) {
            int32_t y = x % 2 ? start->count[1] - 1 - j : j;
            for (int32_t k = 0; k < start->count[2]; k++) {
                int32_t z = rows % 2 ? start->count[2] - 1 - k : k;
                const double middle[3] = {start->origin[0] + (x + 0.5) / start->per_step[0],
                                          start->origin[1] + (y + 0.5) / start->per_step[1],
                                          start->origin[2] + (z + 0.5) / start->per_step[2]};
                hint = enf_view_locate_near(view, middle, hint);
                tetrahedra[((int64_t)x * start->count[1] + y) * start->count[2] + z] = hint;
            }
        }
    }
}

enf_status enf_build_image_start(enf_build_image *image, enf_error *error) {
    enf_file_view *view = &image->view;
    enf_file_start *start = enf_build_image_new(image, 1, sizeof *start);
    if (!start) return enf_fail_memory(error, "starts for point location");
    choose_bricks(start, view);
    int64_t count = (int64_t)start->count[0] * start->count[1] * start->count[2];
    int32_t *tetrahedra = enf_build_image_new(image, (size_t)count, sizeof *tetrahedra);
    if (!tetrahedra) return enf_fail_memory(error, "starts for point location");
    fill_bricks(start, view, tetrahedra);
    view->start = start;
    view->start_tetrahedra = tetrahedra;
    view->start_count = (int32_t)count;
    return ENF_OK;
}
