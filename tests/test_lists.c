// SPDX-License-Identifier: GPL-3.0-or-later
// What cells list to be drawn: a triangle whose front can be seen from some cell is in some cell's list.
#include "build/build.h"
#include "build/gen.h"
#include "build/write.h"
#include "format/locate.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "shared_data.h"

/// Points in front of a triangle are this far from it, as a part of the world's size: beyond rounding.
static const double away = 1e-9;

/// A point in front of the triangle: above the mean of its corners, one of which counts more. False if it has
/// no area.
static bool find_point(const enf_file_view *view, const enf_file_triangle *triangle, int corner,
                       double point[3]) {
    const double *p = view->render_points[triangle->point[corner]],
                 *q = view->render_points[triangle->point[(corner + 1) % 3]],
                 *r = view->render_points[triangle->point[(corner + 2) % 3]];
    double normal[3], length = 0, size = 0;
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        normal[a] = (q[b] - p[b]) * (r[c] - p[c]) - (q[c] - p[c]) * (r[b] - p[b]);
        length += normal[a] * normal[a];
        size = fmax(size, view->frame->box_max[a] - view->frame->box_min[a]);
    }
    length = sqrt(length);
    if (!(length > away * size * size)) return false;
    for (int a = 0; a < 3; a++) point[a] = (2 * p[a] + q[a] + r[a]) / 4 + away * size * normal[a] / length;
    return true;
}

static bool is_before_a_cell(const enf_file_view *view, const enf_file_triangle *triangle) {
    for (int corner = 0; corner < 3; corner++) {
        double point[3];
        if (find_point(view, triangle, corner, point) && enf_view_locate(view, point, -1).cell >= 0)
            return true;
    }
    return false;
}

static void check_lists(const char *path) {
    enf_build build = {0};
    enf_build_image image = {0};
    enf_error error = {0};
    const enf_build_options options = {.clean = {.weld = -1, .plane_tolerance = -1}, .threads = 1};
    enf_status status = enf_soup_read(&build.soup, path, &error);
    if (!status) status = enf_build_run(&build, &options, &error);
    if (!status) status = enf_build_image_make(&image, &build, "{}", &error);
    if (status) fail_msg("%s: %s", path, error.text);
    const enf_file_view *view = &image.view;
    bool *is_listed = calloc((size_t)view->triangle_count + 1, sizeof *is_listed);
    assert_non_null(is_listed);
    for (int64_t i = 0; i < view->cell_triangle_count; i++) is_listed[view->cell_triangles[i]] = true;
    int32_t listed = 0;
    for (int32_t t = 0; t < view->triangle_count; t++) {
        listed += is_listed[t];
        if (!is_listed[t] && is_before_a_cell(view, &view->triangles[t]))
            fail_msg("%s: triangle %d is in no list", path, (int)t);
    }
    assert_true(listed > 0);
    free(is_listed);
    enf_build_image_free(&image);
    enf_build_free(&build);
}

static void test_built_in_worlds(void **state) {
    static const char *const names[] = {"four-rooms", "four-rooms-distorted", "cavern", "furnished"};
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        char path[] = "lists-XXXXXX.obj";
        int file = mkstemps(path, 4);
        assert_true(file >= 0);
        FILE *out = fdopen(file, "w");
        enf_error error = {0};
        assert_int_equal(enf_gen_write(names[i], NULL, 0, out, &error), ENF_OK);
        fclose(out);
        check_lists(path);
        remove(path);
    }
}

/// It has cracks between cells and rock, sealed, with polygons in them.
static void test_a_level_with_sealed_cracks(void **state) {
    char path[4096];
    (void)state;
    snprintf(path, sizeof path, "%s/quake/obj/e4m4.obj.gz", shared_data());
    check_lists(path);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_built_in_worlds),
                                       cmocka_unit_test(test_a_level_with_sealed_cracks)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
