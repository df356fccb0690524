// SPDX-License-Identifier: GPL-3.0-or-later
// The polygons of regions: hulls, edges that go, and the lines around them, which lose no corner.
#include "run_worlds.h"

#include "run/view_clip.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static int32_t random_polygon(uint64_t *seed, double (*corners)[2], int32_t count) {
    double flat = run_random(seed) % 3 ? 1 : pow(10, -6 * run_random_share(seed));
    for (int32_t i = 0; i < count; i++) {
        double angle = 7 * run_random_share(seed), r = 0.5 + 0.1 * run_random_share(seed);
        corners[i][0] = r * cos(angle);
        corners[i][1] = r * sin(angle) * flat;
    }
    return enf_hull(corners, count);
}

/// How much a polygon grows without an edge, by areas alone.
static double growth(const double (*c)[2], int32_t count, int32_t edge) {
    const double *p = c[(edge + count - 1) % count], *a = c[edge], *b = c[(edge + 1) % count],
                 *q = c[(edge + 2) % count];
    double d = (a[0] - p[0]) * (b[1] - q[1]) - (a[1] - p[1]) * (b[0] - q[0]);
    double s = ((q[0] - a[0]) * (b[1] - q[1]) - (q[1] - a[1]) * (b[0] - q[0])) / d;
    double x = a[0] + s * (a[0] - p[0]), y = a[1] + s * (a[1] - p[1]);
    double ahead = (x - b[0]) * (b[0] - q[0]) + (y - b[1]) * (b[1] - q[1]);
    if (!(s >= 0) || !(ahead >= 0)) return INFINITY;
    return 0.5 * fabs((b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]));
}

static void edges_removed_add_least(void **state) {
    uint64_t seed = 10;
    (void)state;
    print_message("seed %" PRIu64 "\n", seed);
    for (int n = 0; n < 20000; n++) {
        double corners[12][2], before[12][2];
        int32_t count = random_polygon(&seed, corners, 5 + (int32_t)(run_random(&seed) % 8));
        if (count < 5) continue;
        memcpy(before, corners, sizeof corners);
        double least = INFINITY, area = enf_polygon_area((const double(*)[2])before, count);
        for (int32_t i = 0; i < count; i++) least = fmin(least, growth((const double(*)[2])before, count, i));
        int32_t target = n % 2 ? 4 : count - 1;
        target = enf_polygon_simplify(corners, count, target);
        assert_true(target == 4 || target == count - 1);
        double grown = enf_polygon_area((const double(*)[2])corners, target) - area;
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int32_t i = 0; i < count; i++)
            for (int a = 0; a < 2; a++) {
                low[a] = fmin(low[a], before[i][a]);
                high[a] = fmax(high[a], before[i][a]);
            }
        const double most = (high[0] - low[0]) * (high[1] - low[1]) - area;
        if (grown > most + 1e-12) fail_msg("%g is more than the rectangle's %g", grown, most);
        if (n % 2 == 0 && least < most && fabs(grown - least) > 1e-9 * (1 + least))
            fail_msg("%g for %g", grown, least);
        for (int32_t i = 0; i < target; i++)
            for (int32_t k = 0; k < count; k++) {
                const double *a = corners[i], *b = corners[(i + 1) % target], *p = before[k];
                double side = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
                assert_true(side >= -1e-9 * hypot(b[0] - a[0], b[1] - a[1]) - 1e-15);
            }
    }
}

/// Whose edges are nearly parallel, so that they would meet far away.
static void long_polygons_become_rectangles(void **state) {
    double corners[6][2] = {{0, 0}, {1, 0}, {1 + 1e-9, 0.5}, {1, 1}, {0, 1}, {-1e-9, 0.5}};
    (void)state;
    assert_int_equal(enf_polygon_simplify(corners, 6, 4), 4);
    const double area = enf_polygon_area((const double(*)[2])corners, 4);
    assert_true(area >= 1 && area < 1 + 1e-8);
    double pencil[5][2] = {{0, 0}, {1, 1}, {1e6, 1e6 + 1}, {1e6, 1e6 + 2}, {-1e-7, 1}};
    assert_int_equal(enf_polygon_simplify(pencil, 5, 4), 4);
    assert_true(enf_polygon_area((const double(*)[2])pencil, 4) <= 1.0001e12);
}

/// Hulls are convex and contain their points, also of corners that are the same but for rounding.
static void hulls_are_convex(void **state) {
    uint64_t seed = 13;
    (void)state;
    for (int n = 0; n < 50000; n++) {
        double points[32][2], before[32][2];
        int32_t count = random_polygon(&seed, points, 3 + (int32_t)(run_random(&seed) % 12)), all = count;
        for (int32_t i = 0; i < count; i++) // once more, moved by a few roundings
            for (int a = 0; a < 2; a++)
                points[all + i][a] = points[i][a] + (double)(run_random(&seed) % 5) * 0x1p-53;
        all += count;
        memcpy(before, points, sizeof points);
        count = enf_hull(points, all);
        for (int32_t i = 0; count > 2 && i < count; i++)
            for (int32_t k = 0; k < all; k++) {
                const double *a = points[i], *b = points[(i + 1) % count], *p = before[k];
                double side = (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
                if (hypot(b[0] - a[0], b[1] - a[1]) > 1e-4) assert_true(side >= -1e-10);
                const double *c = points[(i + 2) % count];
                assert_true((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) >= 0);
            }
    }
}

/// Lines have all corners within, also those of polygons as thin as rounding, and simplified ones.
static void lines_lose_no_corner(void **state) {
    uint64_t seed = 11;
    double memory[2][ENF_VIEW_EDGES_MAX][2];
    enf_view_line lines[2][ENF_VIEW_LINES];
    (void)state;
    for (int n = 0; n < 20000; n++) {
        double corners[24][2], before[24][2];
        int32_t count = random_polygon(&seed, corners, 1 + (int32_t)(run_random(&seed) % 20));
        for (int32_t i = 0; n % 3 == 0 && i < count; i++) // not quite convex
            for (int a = 0; a < 2; a++) corners[i][a] += 1e-9 * run_random_share(&seed);
        memcpy(before, corners, sizeof corners);
        enf_view_region region = {.corners = memory[0], .lines = lines[0]};
        enf_view_region simple = {.corners = memory[1], .lines = lines[1]};
        enf_region_outline(&region, corners, count);
        enf_region_draw(&region, NULL, NULL);
        enf_region_simplify(&simple, &region, 4);
        assert_true(enf_region_contains(&region, &region));
        double moved[24][2]; // out of it by two slacks
        enf_view_region other = {.corners = memory[1], .lines = lines[1]};
        for (int32_t i = 0; i < region.count; i++) {
            moved[i][0] = region.corners[i][0] + 3 * ENF_VIEW_SLACK;
            moved[i][1] = region.corners[i][1];
        }
        enf_region_outline(&other, moved, region.count);
        assert_false(enf_region_contains(&region, &other));
        for (int32_t k = 0; k < count; k++)
            for (int s = 0; s < 2; s++) {
                const enf_view_region *r = s ? &simple : &region;
                for (int32_t i = 0; i < r->line_count; i++) {
                    const enf_view_line *l = &r->lines[i];
                    assert_true(l->a * before[k][0] + l->b * before[k][1] + l->c >= 0.4 * ENF_VIEW_SLACK);
                }
            }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(edges_removed_add_least),
        cmocka_unit_test(long_polygons_become_rectangles),
        cmocka_unit_test(hulls_are_convex),
        cmocka_unit_test(lines_lose_no_corner),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
