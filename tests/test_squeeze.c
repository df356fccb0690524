// SPDX-License-Identifier: GPL-3.0-or-later
// Solids and windows squeezed against random lines: where one gets through, something is left; a line that is
// found gets through; and where a row of windows lets no line through, though every two of them do, it is
// told.
#include "visibility/squeeze.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { ROUNDS = 2000, LINES = 2000, WINDOWS_MOST = 3, CORNERS = 5, POINTS = 6, STEPS = 5000 };

static uint64_t state = 1;

static double random_between(double low, double high) {
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return low + (high - low) * (double)(state >> 11) * 0x1p-53;
}

/// Windows in planes x = 1, 2, ..., with a solid before them and one behind.
typedef struct scene {
    int32_t count;
    double corners[WINDOWS_MOST][CORNERS][3];
    double points[2][POINTS][3];
    enf_portal_graph graph;
    enf_shapes shapes;
    int32_t portals[WINDOWS_MOST];
    enf_window windows[WINDOWS_MOST];
    enf_solid solids[2];
} scene;

static void make_shapes(scene *scene) {
    enf_error error;
    scene->graph = (enf_portal_graph){.cell_count = scene->count + 1};
    for (int32_t w = 0; w < scene->count; w++)
        assert_true(
            enf_portal_graph_add(&scene->graph, w, w + 1, (const double(*)[3])scene->corners[w], CORNERS));
    assert_int_equal(enf_portal_graph_finish(&scene->graph, &error), ENF_OK);
    assert_true(enf_shapes_make(&scene->shapes, &scene->graph));
    for (int32_t w = 0; w < scene->count; w++) {
        scene->portals[w] = 2 * w;
        enf_shape_window(&scene->shapes, 2 * w, &scene->windows[w]);
    }
    for (int end = 0; end < 2; end++)
        enf_solid_make(&scene->solids[end], (const double(*)[3])scene->points[end], POINTS);
}

static void make_window(scene *scene, int32_t w, double y, double z, double radius) {
    for (int i = 0; i < CORNERS; i++) {
        const double angle = 2 * 3.14159265358979 * (i + random_between(0, 0.9)) / CORNERS;
        scene->corners[w][i][0] = w + 1;
        scene->corners[w][i][1] = y + radius * cos(angle);
        scene->corners[w][i][2] = z + radius * sin(angle);
    }
}

static void make_scene(scene *scene) {
    scene->count = (int32_t)random_between(1, WINDOWS_MOST + 1);
    for (int32_t w = 0; w < scene->count; w++)
        make_window(scene, w, random_between(-0.6, 0.6), random_between(-0.6, 0.6),
                    random_between(0.05, 0.8));
    for (int end = 0; end < 2; end++) {
        const double x = end ? scene->count + random_between(1.2, 3) : random_between(-2, -0.2),
                     y = random_between(-1.2, 1.2), z = random_between(-1.2, 1.2),
                     size = random_between(0.05, 1);
        for (int i = 0; i < POINTS; i++) {
            scene->points[end][i][0] = x + random_between(-1, 1) * fmin(size, 0.2);
            scene->points[end][i][1] = y + random_between(-1, 1) * size;
            scene->points[end][i][2] = z + random_between(-1, 1) * size;
        }
    }
    make_shapes(scene);
}

static void drop_scene(scene *scene) {
    enf_shapes_free(&scene->shapes);
    enf_portal_graph_free(&scene->graph);
}

/// On the inner side of all edges of all windows, by as much?
static bool gets_through(const scene *scene, const enf_line *line, double room) {
    for (int32_t w = 0; w < scene->count; w++) {
        const double share = (w + 1 - line->from[0]) / (line->to[0] - line->from[0]);
        const double y = line->from[1] + share * (line->to[1] - line->from[1]);
        const double z = line->from[2] + share * (line->to[2] - line->from[2]);
        for (int i = 0; i < CORNERS; i++) {
            const double *a = scene->corners[w][i], *b = scene->corners[w][(i + 1) % CORNERS];
            const double length = hypot(b[1] - a[1], b[2] - a[2]);
            if (!((b[1] - a[1]) * (z - a[2]) - (b[2] - a[2]) * (y - a[1]) > room * length)) return false;
        }
    }
    return true;
}

static void mix(const double (*points)[3], double point[3]) {
    double weights[POINTS], sum = 0;
    for (int i = 0; i < POINTS; i++) sum += weights[i] = pow(random_between(0, 1), 4);
    memset(point, 0, 3 * sizeof *point);
    for (int i = 0; i < POINTS; i++)
        for (int axis = 0; axis < 3; axis++) point[axis] += weights[i] / sum * points[i][axis];
}

static bool finds_line(const scene *scene, int32_t lines) {
    for (int32_t i = 0; i < lines; i++) {
        enf_line line;
        mix((const double(*)[3])scene->points[0], line.from);
        mix((const double(*)[3])scene->points[1], line.to);
        if (gets_through(scene, &line, 1e-6)) return true;
    }
    return false;
}

static bool try_line(void *user, const enf_line *line) {
    assert_true(line->from[0] < 1 && line->to[0] > ((const scene *)user)->count);
    return gets_through(user, line, 0);
}

static enf_squeeze_answer squeeze(scene *scene, int64_t *steps) {
    enf_squeeze squeeze = {
        .shapes = &scene->shapes, .try_line = try_line, .user = scene, .seed = 1, .steps = *steps};
    enf_squeeze_answer answer;
    enf_error error;
    assert_int_equal(enf_squeeze_run(&squeeze, &scene->solids[0], scene->portals, scene->windows,
                                     scene->count, &scene->solids[1], &answer, &error),
                     ENF_OK);
    *steps = squeeze.steps;
    return answer;
}

static void test_what_lines_pass_is_not_hidden(void **unused) {
    (void)unused;
    int counts[3] = {0}, found = 0;
    for (int round = 0; round < ROUNDS; round++) {
        scene scene;
        int64_t steps = STEPS;
        const uint64_t seed = state;
        make_scene(&scene);
        const enf_squeeze_answer answer = squeeze(&scene, &steps);
        const bool is_found = finds_line(&scene, LINES);
        if (is_found && answer != ENF_SQUEEZE_SEEN)
            fail_msg("state %" PRIu64 ": a line was found, but not by squeezing: %d", seed, (int)answer);
        counts[answer]++;
        found += is_found;
        drop_scene(&scene);
    }
    assert_true(counts[ENF_SQUEEZE_HIDDEN] > ROUNDS / 10 && counts[ENF_SQUEEZE_SEEN] > ROUNDS / 10);
    assert_true(counts[ENF_SQUEEZE_SEEN] > found); // better than so many lines
    assert_true(counts[ENF_SQUEEZE_OPEN] < ROUNDS / 50);
}

/// Three windows that would be in line, were it not for the one in the middle, which is a bit above: small
/// solids near the axis see each other through each two of them, but not through all.
static void test_three_windows_hide_what_two_do_not(void **unused) {
    (void)unused;
    for (int k = 0; k < 2; k++) {
        scene scene = {.count = 3};
        int64_t steps = STEPS;
        for (int32_t w = 0; w < 3; w++) make_window(&scene, w, 0, 0, 0.1);
        for (int i = 0; i < CORNERS; i++) scene.corners[1][i][2] += k ? 0.25 : 0.1;
        for (int end = 0; end < 2; end++)
            for (int i = 0; i < POINTS; i++) {
                scene.points[end][i][0] = (end ? 4 : -1) + (i & 1);
                scene.points[end][i][1] = (i >> 1 & 1) - 0.5;
                scene.points[end][i][2] = (i >> 2 & 1) - 0.5;
            }
        make_shapes(&scene);
        assert_int_equal(squeeze(&scene, &steps), k ? ENF_SQUEEZE_HIDDEN : ENF_SQUEEZE_SEEN);
        drop_scene(&scene);
    }
}

/// Volumes of the halves of a solid are not asked for here, only that all corners are where they should be
/// and that no corner of the whole is lost.
static void test_halves_hold_the_whole(void **unused) {
    (void)unused;
    for (int round = 0; round < ROUNDS; round++) {
        double points[POINTS][3];
        enf_solid whole;
        enf_cut cut = {.least = random_between(-0.5, 0.5)};
        for (int i = 0; i < POINTS; i++)
            for (int axis = 0; axis < 3; axis++) points[i][axis] = random_between(-1, 1);
        for (int axis = 0; axis < 3; axis++) cut.normal[axis] = random_between(-1, 1);
        const double length = sqrt(enf_dot(cut.normal, cut.normal));
        for (int axis = 0; axis < 3; axis++) cut.normal[axis] /= length;
        enf_solid_make(&whole, (const double(*)[3])points, POINTS);
        for (int side = 0; side < 2; side++) {
            enf_solid half = whole;
            int32_t there = 0, kept = 0;
            for (int i = 0; i < POINTS; i++) there += enf_dot(cut.normal, points[i]) >= cut.least;
            assert_int_equal(enf_solid_cut(&half, &cut), there > 0);
            for (int32_t i = 0; there > 0 && i < half.count; i++) {
                const double height = enf_dot(cut.normal, half.corners[i]) - cut.least;
                assert_true(height > -1e-12);
                kept += height > 1e-12;
            }
            if (there > 0) assert_true(kept >= there - 1 && half.count >= there);
            cut.least = -cut.least;
            for (int axis = 0; axis < 3; axis++) cut.normal[axis] = -cut.normal[axis];
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_what_lines_pass_is_not_hidden),
                                       cmocka_unit_test(test_three_windows_hide_what_two_do_not),
                                       cmocka_unit_test(test_halves_hold_the_whole)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
