// SPDX-License-Identifier: GPL-3.0-or-later
// Windows and separators against what they stand for: hulls hold both windows and nothing else, and what a
// line reaches after two windows is in what separators leave.
#include "visibility/hull.h"
#include "visibility/separator.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { ROUNDS = 20000, CORNERS = 12 };

static uint64_t state = 1;

static double random_between(double low, double high) {
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return low + (high - low) * (double)(state >> 11) * 0x1p-53;
}

/// A convex polygon with up to CORNERS corners in the square from -1 to 1, some of them on a coarse grid, so
/// that windows share corners and edges; it turns counter-clockwise.
static int32_t make_polygon(double (*corners)[3]) {
    double points[CORNERS][2];
    int32_t count = 3 + (int32_t)random_between(0, CORNERS - 3), made = 0, at = 0;
    const bool is_coarse = random_between(0, 1) < 0.5;
    for (int32_t i = 0; i < count; i++)
        for (int a = 0; a < 2; a++) {
            points[i][a] = random_between(-1, 1);
            if (is_coarse) points[i][a] = round(2 * points[i][a]) / 2;
        }
    for (int32_t i = 1; i < count; i++)
        if (points[i][0] < points[at][0] || (points[i][0] == points[at][0] && points[i][1] < points[at][1]))
            at = i;
    for (const int32_t start = at; made < count;) { // R. A. Jarvis, 1973
        memcpy(corners[made++], (double[3]){points[at][0], points[at][1], 0}, sizeof *corners);
        int32_t best = -1;
        for (int32_t i = 0; i < count; i++) {
            if (points[i][0] == points[at][0] && points[i][1] == points[at][1]) continue;
            if (best < 0) best = i;
            const double u = points[best][0] - points[at][0], v = points[best][1] - points[at][1],
                         s = points[i][0] - points[at][0], t = points[i][1] - points[at][1],
                         turn = u * t - v * s;
            if (turn < 0 || (turn == 0 && s * s + t * t > u * u + v * v)) best = i;
        }
        if (best < 0 || (points[best][0] == points[start][0] && points[best][1] == points[start][1])) break;
        at = best;
    }
    return made;
}

static double turn_at(const enf_window *window, int32_t i, double u, double v) {
    const double *us = window->at[0], *vs = window->at[1];
    return (us[i + 1] - us[i]) * (v - vs[i]) - (vs[i + 1] - vs[i]) * (u - us[i]);
}

/// How far outside of a window a point is, at least, times the length of an edge.
static double outside(const enf_window *window, double u, double v) {
    double out = 0;
    for (int32_t i = 0; i < window->count; i++) out = fmax(out, -turn_at(window, i, u, v));
    return out;
}

static bool has_corner(const enf_window *window, const enf_window *hull, int32_t k) {
    for (int32_t i = 0; i < window->count; i++)
        if (window->at[0][i] == hull->at[0][k] && window->at[1][i] == hull->at[1][k]) return true;
    return false;
}

static void test_a_hull_holds_both(void **unused) {
    (void)unused;
    const int32_t axes[2] = {0, 1};
    for (int round = 0; round < ROUNDS; round++) {
        double corners[CORNERS][3];
        enf_window one, other, hull;
        enf_window_copy(&one, (const double(*)[3])corners, make_polygon(corners));
        enf_window_copy(&other, (const double(*)[3])corners, make_polygon(corners));
        if (one.count < 3) continue;
        const enf_outline outline = enf_window_outline(&one);
        enf_window_take(&hull, &outline);
        const enf_outline added = enf_window_outline(&other);
        const bool grown = enf_hull_extend(&hull, &added, axes, 0x1p-40);
        for (int32_t i = 0; i < one.count; i++)
            assert_true(outside(&hull, one.at[0][i], one.at[1][i]) < 1e-12);
        for (int32_t i = 0; i < other.count; i++)
            assert_true(outside(&hull, other.at[0][i], other.at[1][i]) < 1e-11);
        assert_true(grown || hull.count == one.count);
        for (int32_t k = 0; k < hull.count; k++) {
            assert_true(has_corner(&one, &hull, k) || has_corner(&other, &hull, k));
            assert_true(turn_at(&hull, k, hull.at[0][(k + 2) % hull.count],
                                hull.at[1][(k + 2) % hull.count]) > (grown ? -1e-12 : -1));
        }
        for (int axis = 0; axis < 3; axis++)
            for (int32_t i = 0; i < ENF_OUTLINE_MORE; i++)
                assert_true(hull.at[axis][hull.count + i] == hull.at[axis][i % hull.count]);
    }
}

/// Three openings, one above the other, tilted a little.
static void make_graph(enf_portal_graph *graph) {
    *graph = (enf_portal_graph){.cell_count = 4};
    for (int32_t k = 0; k < 3; k++) {
        double corners[CORNERS][3], tilt[2] = {random_between(-0.5, 0.5), random_between(-0.5, 0.5)};
        if (random_between(0, 1) < 0.3) tilt[0] = tilt[1] = 0;
        int32_t count;
        do count = make_polygon(corners);
        while (count < 3);
        const double height = (k ? 2 : 0.5) + 2 * k - (k == 1 ? random_between(0, 2) : 0);
        for (int32_t i = 0; i < count; i++)
            corners[i][2] = height + tilt[0] * corners[i][0] + tilt[1] * corners[i][1];
        assert_true(enf_portal_graph_add(graph, k, k + 1, (const double(*)[3])corners, count));
    }
    enf_error error;
    assert_int_equal(enf_portal_graph_finish(graph, &error), ENF_OK);
}

/// A point of an opening: corners, weighted.
static void find_point(const enf_outline *outline, double point[3]) {
    double weights[CORNERS], sum = 0;
    for (int32_t i = 0; i < outline->count; i++) {
        weights[i] = random_between(0, 1) < 0.6 ? 0 : random_between(0, 1);
        sum += weights[i];
    }
    if (sum == 0) sum = weights[0] = 1;
    memset(point, 0, 3 * sizeof *point);
    for (int32_t i = 0; i < outline->count; i++)
        for (int axis = 0; axis < 3; axis++) point[axis] += weights[i] / sum * outline->at[axis][i];
}

/// Where the line from a through b passes the plane of the opening.
static void extend(const enf_shapes *shapes, int32_t portal, const double a[3], const double b[3],
                   double at[3]) {
    const double from = enf_shape_height(shapes, portal, a), to = enf_shape_height(shapes, portal, b),
                 share = from / (from - to);
    for (int axis = 0; axis < 3; axis++) at[axis] = a[axis] + share * (b[axis] - a[axis]);
}

/// By how much a point is out of a window, in the plane that it is seen best from; all turn there as in 0, 1.
static bool holds(const enf_window *window, const double point[3]) {
    return outside(window, point[0], point[1]) < 1e-9;
}

static void check_lines(const enf_shapes *shapes, int *passed) {
    enf_separators separators;
    enf_window from, to, left;
    enf_shape_window(shapes, 0, &from);
    enf_shape_window(shapes, 2, &to);
    enf_separators_find(&separators, shapes, &from, 0, &to, 2);
    const enf_remains remains = enf_separators_pass(&separators, shapes, 4, &left);
    enf_window whole;
    enf_shape_window(shapes, 4, &whole);
    for (int i = 0; i < 50; i++) {
        double a[3], b[3], c[3];
        const enf_outline one = enf_shape_outline(shapes, 0), two = enf_shape_outline(shapes, 1);
        find_point(&one, a);
        find_point(&two, b);
        if (enf_shape_height(shapes, 0, b) <= 0 || enf_shape_height(shapes, 2, a) >= 0) continue;
        extend(shapes, 4, a, b, c);
        if (enf_shape_height(shapes, 2, c) <= 0 || outside(&whole, c[0], c[1]) > 0) continue;
        assert_int_not_equal(remains, ENF_REMAINS_NOTHING);
        assert_true(holds(&left, c));
        ++*passed;
    }
}

static void test_separators_leave_what_lines_reach(void **unused) {
    (void)unused;
    int passed = 0;
    for (int round = 0; round < ROUNDS / 10; round++) {
        enf_portal_graph graph;
        enf_shapes shapes;
        make_graph(&graph);
        assert_true(enf_shapes_make(&shapes, &graph));
        check_lines(&shapes, &passed);
        enf_shapes_free(&shapes);
        enf_portal_graph_free(&graph);
    }
    assert_true(passed > ROUNDS / 10);
}

/// Two squares above each other: through them a third is seen up to a line, and no further.
static void test_separators_are_tight(void **unused) {
    (void)unused;
    enf_portal_graph graph = {.cell_count = 4};
    for (int32_t k = 0; k < 3; k++) {
        const double s = k < 2 ? 1 : 8, z = 1 + k,
                     corners[4][3] = {{-s, -s, z}, {s, -s, z}, {s, s, z}, {-s, s, z}};
        assert_true(enf_portal_graph_add(&graph, k, k + 1, corners, 4));
    }
    enf_error error;
    enf_shapes shapes;
    enf_separators separators;
    enf_window from, to, left;
    assert_int_equal(enf_portal_graph_finish(&graph, &error), ENF_OK);
    assert_true(enf_shapes_make(&shapes, &graph));
    enf_shape_window(&shapes, 0, &from);
    enf_shape_window(&shapes, 2, &to);
    enf_separators_find(&separators, &shapes, &from, 0, &to, 2);
    assert_int_equal(enf_separators_pass(&separators, &shapes, 4, &left), ENF_REMAINS_PART);
    for (int32_t i = 0; i < left.count; i++)
        for (int axis = 0; axis < 2; axis++) assert_true(fabs(fabs(left.at[axis][i]) - 3) < 1e-8);
    enf_shapes_free(&shapes);
    enf_portal_graph_free(&graph);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_a_hull_holds_both),
                                       cmocka_unit_test(test_separators_leave_what_lines_reach),
                                       cmocka_unit_test(test_separators_are_tight)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
