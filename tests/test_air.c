// SPDX-License-Identifier: GPL-3.0-or-later
// Partitions of the air: every wall lies in the planes of nodes or on the borders of leafs, thin walls are
// kept with their planes, and threads do not matter: trees, parts and openings are the same, also where
// there is none.
#include "base/array.h"
#include "build/build.h"
#include "build/gen.h"
#include "build/write.h"
#include "visibility/air_tree.h"
#include "visibility/window.h"
#include "visibility/world_air.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

static const int thread_counts[] = {2, 3, 8};
enum { THREAD_COUNTS = sizeof thread_counts / sizeof *thread_counts };

static double share(uint64_t *seed) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return (double)(*seed >> 11) * 0x1p-53;
}

/// A square of some size, parallel to two axes as most walls of buildings, or turned by a bit.
static void add_square(enf_walls *walls, bool turned, uint64_t *seed) {
    const int axis = (int)(3 * share(seed));
    const double half = 0.2 + share(seed), tilt = turned ? 0.3 * (share(seed) - 0.5) : 0;
    enf_wall wall = {.has_air_behind = share(seed) < 0.3};
    double middle[3], corners[4][3], u[3] = {0}, v[3] = {0};
    for (int k = 0; k < 3; k++) middle[k] = 0.25 * floor(40 * share(seed)) + (turned ? share(seed) : 0);
    u[(axis + 1) % 3] = cos(tilt), u[axis] = sin(tilt);
    v[(axis + 2) % 3] = 1;
    for (int k = 0; k < 3; k++)
        wall.normal[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    wall.offset = enf_dot(wall.normal, middle);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++)
            corners[i][k] =
                middle[k] + (i == 1 || i == 2 ? half : -half) * u[k] + (i < 2 ? -half : half) * v[k];
    assert_true(enf_walls_add(walls, &wall, (const double(*)[3])corners, 4));
}

static enf_walls make_squares(int count, double turned, uint64_t seed) {
    enf_walls walls = {0};
    for (int i = 0; i < count; i++) add_square(&walls, share(&seed) < turned, &seed);
    return walls;
}

static void assert_same_tree(const enf_air_tree *a, const enf_air_tree *b) {
    assert_int_equal(a->node_count, b->node_count);
    assert_int_equal(a->leaf_count, b->leaf_count);
    assert_memory_equal(a->nodes, b->nodes, (size_t)a->node_count * sizeof *a->nodes);
    assert_int_equal(a->thin.count, b->thin.count);
    assert_int_equal(a->thin.corner_count, b->thin.corner_count);
    for (int32_t i = 0; i < a->thin.count; i++) {
        assert_int_equal(a->thin.walls[i].first, b->thin.walls[i].first);
        assert_int_equal(a->thin.walls[i].count, b->thin.walls[i].count);
        assert_memory_equal(a->thin.walls[i].normal, b->thin.walls[i].normal, sizeof a->thin.walls[i].normal);
    }
    if (a->thin.corner_count > 0)
        assert_memory_equal(a->thin.corners, b->thin.corners,
                            (size_t)a->thin.corner_count * sizeof *a->thin.corners);
}

/// Is a point of a wall in the plane of a node on its way down, or on the border of one?
static bool is_on_a_plane(const enf_air_tree *tree, const double point[3]) {
    for (int32_t at = 0; at >= 0;) {
        const enf_air_node *node = &tree->nodes[at];
        const double height = enf_dot(node->normal, point) - node->offset;
        if (fabs(height) < 1e-9) return true;
        at = node->child[height > 0];
    }
    return false;
}

static void assert_walls_are_in_planes(const enf_air_tree *tree, const enf_walls *squares, uint64_t *seed) {
    for (int32_t i = 0; i < squares->count; i++) {
        const double(*c)[3] = (const double(*)[3])(squares->corners + squares->walls[i].first);
        for (int n = 0; n < 20; n++) {
            double point[3], a = share(seed), b = share(seed);
            for (int k = 0; k < 3; k++)
                point[k] = c[0][k] + a * (c[1][k] - c[0][k]) + b * (c[3][k] - c[0][k]);
            assert_true(is_on_a_plane(tree, point));
        }
    }
}

static void assert_thin_walls_are_in_their_planes(const enf_air_tree *tree) {
    int32_t next = 0;
    for (int32_t n = 0; n < tree->node_count; n++) {
        const enf_air_node *node = &tree->nodes[n];
        assert_int_equal(node->wall_first, next);
        next += node->wall_count;
        for (int32_t i = 0; i < node->wall_count; i++) {
            const enf_wall *wall = &tree->thin.walls[node->wall_first + i];
            assert_true(wall->has_air_behind);
            for (int32_t k = 0; k < wall->count; k++)
                assert_true(fabs(enf_dot(node->normal, tree->thin.corners[wall->first + k]) - node->offset) <
                            1e-9);
        }
    }
    assert_int_equal(next, tree->thin.count);
}

static void test_trees_of_squares(void **unused) {
    (void)unused;
    uint64_t seed = 33;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 8; round++) {
        const uint64_t squares = seed + (uint64_t)round;
        const int count = round < 2 ? 150 : 1500;
        enf_walls walls = make_squares(count, round % 3 * 0.1, squares);
        const enf_walls given = make_squares(count, round % 3 * 0.1, squares);
        enf_air_tree tree;
        assert_int_equal(enf_air_tree_make(&tree, &walls, 16, 1000000, 1), ENF_AIR_DONE);
        assert_int_equal(tree.leaf_count, tree.node_count + 1);
        assert_walls_are_in_planes(&tree, &given, &seed);
        assert_thin_walls_are_in_their_planes(&tree);
        for (int i = 0; i < THREAD_COUNTS; i++)
            for (int less = 0; less < 2; less++) { // leafs than there are, or not
                enf_walls again = make_squares(count, round % 3 * 0.1, squares);
                enf_air_tree other;
                assert_int_equal(
                    enf_air_tree_make(&other, &again, 16, tree.leaf_count - less, thread_counts[i]),
                    less ? ENF_AIR_TOO_DEEP : ENF_AIR_DONE);
                if (!less) assert_same_tree(&tree, &other);
                enf_air_tree_free(&other);
                enf_walls_free(&again);
            }
        enf_air_tree_free(&tree);
        enf_walls_free(&walls);
        enf_walls_free((enf_walls *)&given);
    }
}

// ---------------------------------------------------------------------------------------------- worlds

static void assert_same_bodies(const enf_bodies *a, const enf_bodies *b) {
    assert_int_equal(a->count, b->count);
    assert_int_equal(a->cell_count, b->cell_count);
    assert_memory_equal(a->cell_first, b->cell_first, ((size_t)a->cell_count + 1) * sizeof *a->cell_first);
    assert_memory_equal(a->owner, b->owner, (size_t)a->count * sizeof *a->owner);
    assert_memory_equal(a->corner_first, b->corner_first, ((size_t)a->count + 1) * sizeof *a->corner_first);
    assert_memory_equal(a->corners, b->corners, (size_t)a->corner_first[a->count] * sizeof *a->corners);
    assert_memory_equal(a->whole_first, b->whole_first,
                        ((size_t)a->owner_count + 1) * sizeof *a->whole_first);
    assert_memory_equal(a->wholes, b->wholes, (size_t)a->whole_first[a->owner_count] * sizeof *a->wholes);
}

static void assert_same_graph(const enf_portal_graph *a, const enf_portal_graph *b) {
    assert_int_equal(a->opening_count, b->opening_count);
    assert_memory_equal(a->opening_cell, b->opening_cell, (size_t)a->opening_count * sizeof *a->opening_cell);
    assert_memory_equal(a->opening_corner, b->opening_corner,
                        ((size_t)a->opening_count + 1) * sizeof *a->opening_corner);
    assert_memory_equal(a->corners, b->corners,
                        (size_t)a->opening_corner[a->opening_count] * sizeof *a->corners);
}

static void compare_worlds(const enf_file_view *view) {
    enf_world_air one, other;
    enf_error error = {0};
    assert_int_equal(enf_world_air_make(&one, view, false, 1, &error), ENF_OK);
    assert_true(one.has_partition);
    for (int i = 0; i < THREAD_COUNTS; i++) {
        assert_int_equal(enf_world_air_make(&other, view, false, thread_counts[i], &error), ENF_OK);
        assert_true(other.has_partition);
        assert_same_graph(&one.leafs, &other.leafs);
        assert_same_bodies(&one.parts.bodies, &other.parts.bodies);
        assert_int_equal(one.parts.lost_count, other.parts.lost_count);
        enf_world_air_free(&other);
    }
    enf_world_air_free(&one);
}

static void test_an_office(void **unused) {
    (void)unused;
    static const char *const settings[] = {"floors=1", "rooms=8", "detail=1"};
    char path[] = "air-XXXXXX.obj";
    int file = mkstemps(path, 4);
    assert_true(file >= 0);
    FILE *out = fdopen(file, "w");
    enf_error error = {0};
    assert_int_equal(enf_gen_write("office", settings, 3, out, &error), ENF_OK);
    fclose(out);
    enf_build build = {0};
    enf_build_image image = {0};
    const enf_build_options options = {.clean = {.weld = -1, .plane_tolerance = -1}, .threads = 1};
    enf_status status = enf_soup_read(&build.soup, path, &error);
    remove(path);
    if (!status) status = enf_build_run(&build, &options, &error);
    if (!status) status = enf_build_image_make(&image, &build, "{}", &error);
    if (status) fail_msg("%s", error.text);
    compare_worlds(&image.view);
    enf_build_image_free(&image);
    enf_build_free(&build);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_trees_of_squares),
                                       cmocka_unit_test(test_an_office)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
