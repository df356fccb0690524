// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies and their separating planes against what they stand for: the corners hold all points, edges have the
// whole body in their wedge, and what lines from a body reach is in what separators leave.
#include "visibility/separator.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { ROUNDS = 3000, POINTS_MOST = 160 };

static uint64_t state = 1;

static double random_between(double low, double high) {
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return low + (high - low) * (double)(state >> 11) * 0x1p-53;
}

/// Points in the unit cube around a middle; now and then on a coarse grid, doubled, flat, or in a line.
static int32_t make_points(double (*points)[3], const double middle[3]) {
    const int32_t count = 1 + (int32_t)random_between(0, POINTS_MOST - 1);
    const bool is_coarse = random_between(0, 1) < 0.5;
    const int flat = (int)random_between(0, 6);
    for (int32_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) {
            double at = random_between(-1, 1);
            if (is_coarse) at = round(2 * at) / 2;
            if (axis < flat - 3) at = 0.5;
            points[i][axis] = middle[axis] + at;
        }
    return count;
}

static void random_direction(double direction[3]) {
    for (int axis = 0; axis < 3; axis++) direction[axis] = random_between(-1, 1);
}

static double support(const double (*points)[3], int32_t count, const double direction[3]) {
    double most = -HUGE_VAL;
    for (int32_t i = 0; i < count; i++) most = fmax(most, enf_dot(points[i], direction));
    return most;
}

static double body_support(const enf_body *body, const double direction[3]) {
    double most = -HUGE_VAL, corner[3];
    for (int32_t i = 0; i < body->corners.count; i++) {
        enf_outline_corner(&body->corners, i, corner);
        most = fmax(most, enf_dot(corner, direction));
    }
    return most;
}

static void take_edge(const enf_body *body, int32_t i, double from[3], double along[3], double left[3],
                      double right[3]) {
    for (int axis = 0; axis < 3; axis++) {
        from[axis] = body->from[axis][i];
        along[axis] = body->along[axis][i];
        left[axis] = body->left[axis][i];
        right[axis] = body->right[axis][i];
    }
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int axis = 0; axis < 3; axis++) {
        int u = (axis + 1) % 3, v = (axis + 2) % 3;
        out[axis] = a[u] * b[v] - a[v] * b[u];
    }
}

/// Planes through an edge that stay out of the wedge have all points behind them.
static int check_edges(const enf_body *body, const double (*points)[3], int32_t count) {
    int checked = 0;
    for (int32_t i = 0; i < body->edge_count; i++) {
        double from[3], along[3], left[3], right[3], any[3], normal[3];
        take_edge(body, i, from, along, left, right);
        random_direction(any);
        cross(along, any, normal);
        if (enf_dot(normal, left) > 0 || enf_dot(normal, right) > 0) continue;
        assert_true(support(points, count, normal) <= enf_dot(from, normal) + 1e-9);
        checked++;
    }
    return checked;
}

static void test_a_body_holds_its_points(void **unused) {
    (void)unused;
    const double middle[3] = {0};
    int checked = 0, full = 0;
    for (int round = 0; round < ROUNDS; round++) {
        double points[POINTS_MOST][3], direction[3];
        enf_body body;
        const int32_t count = make_points(points, middle);
        enf_body_make(&body, (const double(*)[3])points, count, 1e-12);
        assert_true(body.corners.count >= 1 && body.corners.count <= ENF_BODY_CORNERS);
        full += body.corners.count != 8;
        for (int i = 0; i < 20; i++) {
            random_direction(direction);
            assert_true(body_support(&body, direction) >=
                        support((const double(*)[3])points, count, direction) - 1e-11);
        }
        checked += check_edges(&body, (const double(*)[3])points, count);
        for (int axis = 0; axis < 3; axis++)
            assert_true(body.at[axis][body.corners.count] == body.at[axis][0]); // closed
    }
    assert_true(checked > ROUNDS && full > ROUNDS / 4);
}

/// Two openings above a body: the first a polygon, the second large enough for all.
/// Many points in an octahedron: its six corners are left, wherever they come, and not the box around it.
static void test_a_body_of_many_points_is_their_hull(void **unused) {
    enum { MANY = 500 };
    static double points[MANY][3];
    enf_body body;
    (void)unused;
    for (int round = 0; round < 50; round++) {
        for (int i = 0; i < MANY; i++) {
            double size = 0;
            for (int axis = 0; axis < 3; axis++) size += fabs(points[i][axis] = random_between(-1, 1));
            for (int axis = 0; axis < 3; axis++) points[i][axis] /= 1.001 * fmax(size, 1);
        }
        for (int corner = 0; corner < 6; corner++) {
            double *point = points[corner * 80 + (int)random_between(0, 80)];
            memset(point, 0, sizeof *points);
            point[corner / 2] = corner % 2 ? 1 : -1;
        }
        enf_body_make(&body, (const double(*)[3])points, MANY, 1e-13);
        assert_int_equal(body.corners.count, 6);
        assert_int_equal(body.edge_count, 12);
        for (int i = 0; i < 6; i++) {
            double corner[3];
            enf_outline_corner(&body.corners, i, corner);
            assert_true(fabs(corner[0]) + fabs(corner[1]) + fabs(corner[2]) == 1);
        }
    }
}

static void make_graph(enf_portal_graph *graph, double height) {
    double corners[5][3];
    *graph = (enf_portal_graph){.cell_count = 3};
    for (int i = 0; i < 5; i++) {
        const double angle = 2 * 3.14159265358979 * (i + random_between(0, 0.9)) / 5;
        corners[i][0] = cos(angle);
        corners[i][1] = sin(angle);
        corners[i][2] = height;
    }
    assert_true(enf_portal_graph_add(graph, 0, 1, (const double(*)[3])corners, 5));
    const double s = 1000, z = height + 3, square[4][3] = {{-s, -s, z}, {s, -s, z}, {s, s, z}, {-s, s, z}};
    assert_true(enf_portal_graph_add(graph, 1, 2, square, 4));
    enf_error error;
    assert_int_equal(enf_portal_graph_finish(graph, &error), ENF_OK);
}

/// As a cube around a point, that far to each side.
static bool meets_near(const enf_separators *separators, const double point[3], double distance) {
    const double half[3] = {distance, distance, distance};
    double points[8][3];
    for (int i = 0; i < 8; i++)
        for (int axis = 0; axis < 3; axis++)
            points[i][axis] = point[axis] + (i >> axis & 1 ? distance : -distance);
    return enf_separators_meet(separators, point, half, (const double(*)[3])points, 8);
}

/// As a body of a single point.
static bool meets(const enf_separators *separators, const double point[3]) {
    return meets_near(separators, point, 0);
}

/// A point of the hull of some points.
static void mix(const double (*points)[3], int32_t count, double point[3]) {
    double weights[POINTS_MOST], sum = 0;
    for (int32_t i = 0; i < count; i++) {
        weights[i] = random_between(0, 1) < 0.7 ? 0 : random_between(0, 1);
        sum += weights[i];
    }
    if (sum == 0) sum = weights[0] = 1;
    memset(point, 0, 3 * sizeof *point);
    for (int32_t i = 0; i < count; i++)
        for (int axis = 0; axis < 3; axis++) point[axis] += weights[i] / sum * points[i][axis];
}

/// Lines from the body through the first opening, along its edges and the body's, too, are within what is
/// left behind it, or as near to that as two tolerances.
static int check_lines(const enf_shapes *shapes, const enf_body *body, const double (*points)[3],
                       int32_t count) {
    enf_separators separators;
    const enf_outline to = enf_shape_outline(shapes, 0);
    double corners[8][3];
    int passed = 0;
    for (int32_t i = 0; i < to.count; i++) enf_outline_corner(&to, i, corners[i]);
    enf_separators_from_body(&separators, shapes, body, &to, 0);
    for (int i = 0; i < 50; i++) {
        double a[3], b[3], c[3];
        mix(points, count, a);
        mix((const double(*)[3])corners, to.count, b);
        if (b[2] - a[2] < 1e-3) continue;
        const double share = random_between(0, 3) / (b[2] - a[2]);
        for (int axis = 0; axis < 3; axis++) c[axis] = b[axis] + share * (b[axis] - a[axis]);
        assert_true(meets_near(&separators, c, 2 * shapes->tolerance));
        passed++;
    }
    return passed;
}

static void test_separators_leave_what_lines_from_a_body_reach(void **unused) {
    (void)unused;
    int passed = 0;
    for (int round = 0; round < ROUNDS; round++) {
        double points[POINTS_MOST][3];
        const double middle[3] = {random_between(-2, 2), random_between(-2, 2), 0},
                     height = random_between(0, 1) < 0.3 ? 1 : random_between(1, 4); // 1: they touch, maybe
        enf_portal_graph graph;
        enf_shapes shapes;
        enf_body body;
        const int32_t count = make_points(points, middle);
        make_graph(&graph, height);
        assert_true(enf_shapes_make(&shapes, &graph));
        enf_body_make(&body, (const double(*)[3])points, count, shapes.tolerance / 8);
        passed += check_lines(&shapes, &body, (const double(*)[3])points, count);
        enf_shapes_free(&shapes);
        enf_portal_graph_free(&graph);
    }
    assert_true(passed > 10 * ROUNDS);
}

/// A unit cube under a square of the same size, turned by 45 degrees: what lies a little outside of the exact
/// antipenumbra is cut off, where an edge of the square bounds it and where an edge of the cube does.
static void test_separators_from_a_body_are_tight(void **unused) {
    (void)unused;
    const double window[4][3] = {{1, 0, 2}, {0, 1, 2}, {-1, 0, 2}, {0, -1, 2}},
                 large[4][3] = {{-99, -99, 9}, {99, -99, 9}, {99, 99, 9}, {-99, 99, 9}};
    double points[8][3];
    enf_portal_graph graph = {.cell_count = 3};
    enf_error error;
    enf_shapes shapes;
    enf_body body;
    enf_separators separators;
    for (int i = 0; i < 8; i++)
        for (int axis = 0; axis < 3; axis++) points[i][axis] = i >> axis & 1 ? 1 : (axis == 2 ? 0 : -1);
    assert_true(enf_portal_graph_add(&graph, 0, 1, window, 4) &&
                enf_portal_graph_add(&graph, 1, 2, large, 4));
    assert_int_equal(enf_portal_graph_finish(&graph, &error), ENF_OK);
    assert_true(enf_shapes_make(&shapes, &graph));
    enf_body_make(&body, (const double(*)[3])points, 8, 1e-12);
    assert_int_equal(body.corners.count, 8);
    assert_int_equal(body.edge_count, 12);
    const enf_outline to = enf_shape_outline(&shapes, 0);
    enf_separators_from_body(&separators, &shapes, &body, &to, 0);
    // From height 1 through height 2 to height 3: x = 2 * 1 - (-1) at most, from the cube's side x = -1.
    const double inside[2][3] = {{2.999, 0, 3}, {1.499, 1.499, 3}},
                 outside[2][3] = {{3.001, 0, 3}, {2.001, 2.001, 3}};
    for (int i = 0; i < 2; i++) {
        assert_true(meets(&separators, inside[i]));
        assert_false(meets(&separators, outside[i]));
    }
    enf_shapes_free(&shapes);
    enf_portal_graph_free(&graph);
}

/// From a box below the ground through a window on it: what lies below the ground behind that, up to it, is
/// not seen, though all three touch its plane, and box and window each other, maybe.
static void test_sight_along_a_plane_is_none(void **unused) {
    (void)unused;
    const double window[4][3] = {{1, -1, 0}, {1, 1, 0}, {1, 1, 1}, {1, -1, 1}},
                 below[4][3] = {{2, -1, -1}, {2, 1, -1}, {2, 1, 0}, {2, -1, 0}},
                 above[4][3] = {{2, -1, -1}, {2, 1, -1}, {2, 1, 1e-6}, {2, -1, 1e-6}};
    double points[8][3];
    enf_portal_graph graph = {.cell_count = 4};
    enf_error error;
    enf_shapes shapes;
    enf_body body;
    enf_separators separators;
    enf_window left;
    for (int i = 0; i < 8; i++)
        for (int axis = 0; axis < 3; axis++) points[i][axis] = (i >> axis & 1) - (axis == 2);
    assert_true(enf_portal_graph_add(&graph, 0, 1, window, 4) &&
                enf_portal_graph_add(&graph, 1, 2, below, 4) && enf_portal_graph_add(&graph, 1, 3, above, 4));
    assert_int_equal(enf_portal_graph_finish(&graph, &error), ENF_OK);
    assert_true(enf_shapes_make(&shapes, &graph));
    for (int k = 0; k < 2; k++) { // the box touches the window, or does not
        for (int i = 0; i < 8; i++) points[i][0] -= k;
        enf_body_make(&body, (const double(*)[3])points, 8, shapes.tolerance / 8);
        const enf_outline to = enf_shape_outline(&shapes, 0);
        enf_separators_from_body(&separators, &shapes, &body, &to, 0);
        assert_int_equal(enf_separators_cut(&separators, &shapes, 2, &left), ENF_REMAINS_NOTHING);
        assert_int_equal(enf_separators_cut(&separators, &shapes, 4, &left), ENF_REMAINS_PART);
    }
    enf_shapes_free(&shapes);
    enf_portal_graph_free(&graph);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_a_body_holds_its_points),
                                       cmocka_unit_test(test_a_body_of_many_points_is_their_hull),
                                       cmocka_unit_test(test_separators_leave_what_lines_from_a_body_reach),
                                       cmocka_unit_test(test_separators_from_a_body_are_tight),
                                       cmocka_unit_test(test_sight_along_a_plane_is_none)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
