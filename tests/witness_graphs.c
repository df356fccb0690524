// SPDX-License-Identifier: GPL-3.0-or-later
#include "witness_graphs.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>

void add_door(enf_portal_graph *graph, int32_t from, int32_t to, int axis, double at, const double low[2],
              const double high[2]) {
    double corners[4][3];
    for (int c = 0; c < 4; ++c) {
        corners[c][axis] = at;
        corners[c][(axis + 1) % 3] = c == 1 || c == 2 ? high[0] : low[0];
        corners[c][(axis + 2) % 3] = c >= 2 ? high[1] : low[1];
    }
    assert_true(enf_portal_graph_add(graph, from, to, (const double(*)[3])corners, 4));
}

void add_square(enf_portal_graph *graph, int32_t from, int32_t to, double at) {
    add_door(graph, from, to, 0, at, (const double[2]){0, 0}, (const double[2]){2, 2});
}

void finish(enf_portal_graph *graph) {
    enf_error error;
    assert_int_equal(enf_portal_graph_finish(graph, &error), ENF_OK);
}

void scale_graph(enf_portal_graph *graph, double factor) {
    for (int32_t c = 0; c < graph->opening_corner[graph->opening_count]; ++c)
        for (int i = 0; i < 3; ++i) graph->corners[c][i] *= factor;
}

enf_portal_graph row_of_rooms(int32_t count) {
    enf_portal_graph graph = {.cell_count = count};
    for (int32_t k = 1; k < count; ++k) add_square(&graph, k - 1, k, k);
    finish(&graph);
    return graph;
}

enf_portal_graph bend(void) {
    enf_portal_graph graph = {.cell_count = 4};
    add_door(&graph, 0, 1, 0, 1, (const double[2]){0, 0}, (const double[2]){1, 1}); // y, z
    add_door(&graph, 1, 2, 1, 1, (const double[2]){0, 1}, (const double[2]){1, 2}); // z, x
    add_door(&graph, 3, 2, 0, 1, (const double[2]){1, 0}, (const double[2]){2, 1});
    finish(&graph);
    return graph;
}

enf_portal_graph slit(double width) {
    enf_portal_graph graph = {.cell_count = 5};
    add_door(&graph, 0, 1, 0, 0, (const double[2]){-4, 0}, (const double[2]){width, 8});
    add_door(&graph, 1, 2, 0, 1, (const double[2]){0, 0}, (const double[2]){8, 8});
    add_door(&graph, 2, 3, 0, 1.5, (const double[2]){-8, 1}, (const double[2]){8, 1.25});
    add_door(&graph, 3, 4, 0, 2, (const double[2]){-4, 0}, (const double[2]){width, 8});
    finish(&graph);
    return graph;
}

enf_portal_graph three_doors(void) {
    enf_portal_graph graph = {.cell_count = 4};
    const double first[4][3] = {{-240, 960, 160}, {-240, 960, 0}, {-184, 960, 0}, {-184, 960, 160}};
    const double second[4][3] = {{-184, 880, 0}, {-376, 880, 0}, {-376, 928, 0}, {-184, 928, 0}};
    const double third[4][3] = {{344, 928, 0}, {344, 928, -12}, {344, 904, -12}, {344, 904, 0}};
    assert_true(enf_portal_graph_add(&graph, 0, 1, first, 4));
    assert_true(enf_portal_graph_add(&graph, 1, 2, second, 4));
    assert_true(enf_portal_graph_add(&graph, 3, 2, third, 4));
    finish(&graph);
    return graph;
}

enf_portal_graph six_doors(void) {
    static const double corners[6][4][3] = {
        {{-736, -928, 160}, {-736, -928, 224}, {-824, -928, 224}, {-824, -928, 160}},
        {{-736, -1216, 224}, {-736, -1216, 158}, {-736, -1152, 158}, {-736, -1152, 224}},
        {{-700, -1216, 158}, {-700, -1216, 175.00000000000003}, {-710.9677419354839, -1216, 158}},
        {{-700, -1216, 158}, {-672, -1216, 158}, {-672, -1248, 158}, {-700, -1248, 158}},
        {{-700, -1248, 144}, {-672, -1248, 144}, {-672, -1248, 158}, {-700, -1248, 158}},
        {{-700, -1312, 144}, {-672, -1312, 144}, {-672, -1312, 158}, {-700, -1312, 158}}};
    enf_portal_graph graph = {.cell_count = 7};
    for (int32_t k = 0; k < 6; ++k)
        assert_true(enf_portal_graph_add(&graph, k, k + 1, corners[k], k == 2 ? 3 : 4));
    finish(&graph);
    return graph;
}

double random_unit(uint64_t *seed) {
    uint64_t z = *seed += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (double)((z ^ z >> 31) >> 11) * 0x1p-53;
}

static int32_t random_below(uint64_t *seed, int32_t count) {
    return (int32_t)(random_unit(seed) * count);
}

/// A parallelogram about (at, y, z) whose normal points forwards.
static void add_tilted(enf_portal_graph *graph, int32_t from, int32_t at, uint64_t *seed) {
    int32_t u[3] = {random_below(seed, 9) - 4, 1 + random_below(seed, 12), random_below(seed, 9) - 4};
    int32_t v[3] = {random_below(seed, 9) - 4, random_below(seed, 5) - 2, 4 + random_below(seed, 12)};
    int32_t y = random_below(seed, 17) - 8, z = random_below(seed, 17) - 8;
    double corners[4][3];
    for (int c = 0; c < 4; ++c) {
        int32_t a = c == 1 || c == 2 ? 1 : -1, b = c >= 2 ? 1 : -1;
        const int32_t middle[3] = {at, y, z};
        for (int i = 0; i < 3; ++i) corners[c][i] = middle[i] + a * u[i] + b * v[i];
    }
    assert_true(enf_portal_graph_add(graph, from, from + 1, (const double(*)[3])corners, 4));
}

enf_portal_graph random_chain(uint64_t *seed) {
    int32_t doors = 2 + random_below(seed, 5);
    enf_portal_graph graph = {.cell_count = doors + 1};
    for (int32_t k = 0; k < doors; ++k) add_tilted(&graph, k, 24 * k, seed);
    finish(&graph);
    return graph;
}
