// SPDX-License-Identifier: GPL-3.0-or-later
// Decimation block by block: blocks tell the lightest portals that one heap tells, and a large world that is
// collapsed in blocks ends about where strict order would have brought it.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "build/portal_heap.h"
#include "decimate_worlds.h"

static enf_portal_heap open_heap(const world *w, vertex *vertices) {
    enf_graph graph = graph_of(w, (const vertex *)vertices);
    enf_portal_heap portals;
    enf_error error;
    if (enf_portal_heap_create(&portals, &graph, ENF_HEURISTIC_ASPECT, false, &error) != ENF_OK)
        fail_msg("%s", error.text);
    return portals;
}

/// The lightest portal of all blocks; of several the one whose cells have the smaller numbers.
static int32_t lightest_of(enf_portal_heap *portals, double *lightest) {
    int32_t best = -1;
    enf_heap_key least = {INFINITY, INT32_MAX, INT32_MAX};
    for (int32_t block = 0; block < portals->heap.block_count; ++block) {
        int32_t portal;
        double weight;
        enf_error error;
        assert_int_equal(enf_portal_heap_top(portals, block, &portal, &weight, &error), ENF_OK);
        if (portal < 0) continue;
        assert_int_equal(portal >> portals->heap.block_bits, block);
        const int32_t *cell = portals->portals[portal].cell;
        int32_t a = portals->cells[cell[0]].smallest, b = portals->cells[cell[1]].smallest;
        enf_heap_key key = {weight, a < b ? a : b, a < b ? b : a};
        if (best >= 0 && !enf_heap_key_less(key, least)) continue;
        best = portal;
        least = key;
    }
    *lightest = least.weight;
    return best;
}

static void blocks_know_the_lightest_portal(void **state) {
    (void)state;
    uint64_t seed = 515;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 12; ++round) {
        world w = cut_world(120, &seed);
        vertex *vertices = vertices_of(&w);
        enf_portal_heap one = open_heap(&w, vertices), many = open_heap(&w, vertices);
        size_t collapses = 0;
        for (;; ++collapses) {
            if (collapses % 16 == 0) { // back to one block, and to others
                int bits = collapses % 32 == 0 ? round % 6 : ENF_ONE_BLOCK_BITS;
                assert_true(enf_block_heap_divide(&many.heap, bits));
                assert_int_equal(many.heap.block_count == 1, bits == ENF_ONE_BLOCK_BITS);
            }
            double weight, expected_weight;
            int32_t expected = lightest_of(&one, &expected_weight), portal = lightest_of(&many, &weight);
            assert_int_equal(portal, expected);
            if (portal < 0) break;
            assert_true(weight == expected_weight);
            int32_t kept[2], gone[2];
            assert_true(enf_portal_heap_collapse(&one, portal, &kept[0], &gone[0]));
            assert_true(enf_portal_heap_collapse(&many, portal, &kept[1], &gone[1]));
            assert_int_equal(kept[0], kept[1]);
            assert_int_equal(gone[0], gone[1]);
        }
        assert_true(collapses > 80);
        enf_portal_heap_free(&one);
        enf_portal_heap_free(&many);
        free(vertices);
        free(w.pieces);
    }
}

enum { SIDE = 36, CELLS = SIDE * SIDE * SIDE, FACES = 3 * SIDE * SIDE * (SIDE + 1) };

typedef struct lattice {
    double vertices[SIDE + 1][SIDE + 1][SIDE + 1][3];
    int32_t piece_cell[FACES][2], corners[FACES][4];
    bool piece_open[FACES];
    int64_t piece_corner[FACES + 1];
    int32_t pieces;
} lattice;

static int32_t vertex_number(const int at[3]) {
    return (int32_t)((at[2] * (SIDE + 1) + at[1]) * (SIDE + 1) + at[0]);
}

static void add_lattice_face(lattice *l, int axis, const int at[3], bool open) {
    static const int steps[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    int32_t face = l->pieces++;
    for (int s = 0; s < 2; ++s) {
        int p[3] = {at[0], at[1], at[2]};
        p[axis] += s - 1;
        bool in = p[axis] >= 0 && p[axis] < SIDE;
        l->piece_cell[face][s] = in ? (p[2] * SIDE + p[1]) * SIDE + p[0] : -1;
    }
    l->piece_open[face] = open && l->piece_cell[face][0] >= 0 && l->piece_cell[face][1] >= 0;
    for (int i = 0; i < 4; ++i) {
        int p[3] = {at[0], at[1], at[2]};
        p[(axis + 1) % 3] += steps[i][0];
        p[(axis + 2) % 3] += steps[i][1];
        l->corners[face][i] = vertex_number(p);
    }
    l->piece_corner[face + 1] = l->piece_corner[face] + 4;
}

/// Boxes between planes at random distances, and walls between some of them: more portals than a block has.
static lattice *make_lattice(uint64_t seed) {
    lattice *l = calloc(1, sizeof *l);
    assert_non_null(l);
    double planes[3][SIDE + 1];
    for (int axis = 0; axis < 3; ++axis)
        for (int i = 0; i <= SIDE; ++i)
            planes[axis][i] = -1 + (2 * i + (i > 0 && i < SIDE ? 1.8 * random_unit(&seed) - 0.9 : 0)) / SIDE;
    for (int z = 0; z <= SIDE; ++z)
        for (int y = 0; y <= SIDE; ++y)
            for (int x = 0; x <= SIDE; ++x) {
                const int at[3] = {x, y, z};
                for (int axis = 0; axis < 3; ++axis) {
                    l->vertices[z][y][x][axis] = planes[axis][at[axis]];
                    if (at[(axis + 1) % 3] < SIDE && at[(axis + 2) % 3] < SIDE)
                        add_lattice_face(l, axis, at, next_random(&seed) % 8 < 5);
                }
            }
    assert_int_equal(l->pieces, FACES);
    return l;
}

static void *copy(const void *data, size_t bytes) {
    void *out = malloc(bytes);
    assert_non_null(out);
    return memcpy(out, data, bytes);
}

static enf_decimation decimate(const lattice *l, enf_stop stop) {
    enf_graph graph = {.cell_count = CELLS,
                       .piece_count = FACES,
                       .piece_cell = copy(l->piece_cell, sizeof l->piece_cell),
                       .piece_open = copy(l->piece_open, sizeof l->piece_open),
                       .piece_corner = copy(l->piece_corner, sizeof l->piece_corner),
                       .corners = copy(l->corners, sizeof l->corners),
                       .vertices = (const double(*)[3])l->vertices,
                       .scale = 1};
    enf_decimation out;
    enf_error error;
    if (enf_graph_decimate(&graph, ENF_HEURISTIC_ASPECT, &stop, 1, NULL, NULL, &out, &error) != ENF_OK)
        fail_msg("%s", error.text);
    return out;
}

static void large_worlds_end_where_strict_order_ends(void **state) {
    (void)state;
    uint64_t seed = 616;
    print_message("seed %llu\n", (unsigned long long)seed);
    lattice *l = make_lattice(seed);
    enf_decimation strict = decimate(l, (enf_stop){ENF_STOP_CELLS, 0, CELLS / 10});
    for (double limit = 2; limit <= 4; limit *= 2) {
        enf_decimation blocks = decimate(l, (enf_stop){ENF_STOP_WEIGHT, limit, 0});
        assert_true(blocks.next_weight >= limit); // nothing lighter is left
        for (size_t i = 0; i < blocks.collapse_count; ++i) assert_true(blocks.collapses[i].weight < limit);
        size_t expected = 0;
        while (expected < strict.collapse_count && strict.collapses[expected].weight < limit) ++expected;
        double cells = (double)(CELLS - expected);
        print_message("up to %g: %d cells, in strict order %g\n", limit, blocks.cell_count, cells);
        assert_true(expected < strict.collapse_count);
        assert_true(blocks.cell_count > 0.97 * cells && blocks.cell_count < 1.03 * cells);
        enf_decimation again = decimate(l, (enf_stop){ENF_STOP_WEIGHT, limit, 0});
        assert_int_equal(again.collapse_count, blocks.collapse_count);
        assert_memory_equal(again.cell_of, blocks.cell_of, CELLS * sizeof *blocks.cell_of);
        enf_decimation_free(&again);
        enf_decimation_free(&blocks);
    }
    enf_decimation_free(&strict);
    free(l);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(blocks_know_the_lightest_portal),
        cmocka_unit_test(large_worlds_end_where_strict_order_ends),
    };
    return cmocka_run_group_tests_name("decimate_blocks", tests, NULL, NULL);
}
