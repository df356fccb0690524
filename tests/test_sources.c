// SPDX-License-Identifier: GPL-3.0-or-later
// Sources of beams: all owners of bodies, each in one, and only with others that make none of them much
// wider.
#include "base/array.h"
#include "base/hash.h"
#include "visibility/sources.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include <cmocka.h>

enum { OWNERS = 60, CELLS = 12, CORNERS = 8, WAYS = 500 };

static uint64_t state;

/// In [0, 1).
static double draw(void) {
    state += UINT64_C(0x9E3779B97F4A7C15);
    return (double)(enf_hash_mix(state) >> 11) * 0x1p-53;
}

typedef struct box {
    double low[3], high[3];
} box;

static void corner_of(const box *box, int index, double corner[3]) {
    for (int axis = 0; axis < 3; axis++) corner[axis] = index >> axis & 1 ? box->high[axis] : box->low[axis];
}

/// Owner k has the box k, if that is not empty, in cell k % CELLS and in the next one.
static void make_bodies(enf_bodies *bodies, const box *boxes) {
    *bodies = (enf_bodies){.cell_count = CELLS, .owner_count = OWNERS};
    bodies->cell_first = enf_array_zeroed(CELLS + 1, sizeof *bodies->cell_first);
    bodies->owner = enf_array_zeroed(2 * OWNERS, sizeof *bodies->owner);
    bodies->corner_first = enf_array_zeroed(2 * OWNERS + 1, sizeof *bodies->corner_first);
    bodies->corners = enf_array_zeroed((size_t)2 * OWNERS * CORNERS, sizeof *bodies->corners);
    for (int32_t cell = 0; cell < CELLS; cell++) {
        for (int32_t owner = 0; owner < OWNERS; owner++) {
            const bool is_here = owner % CELLS == cell || (owner + 1) % CELLS == cell;
            if (!is_here || boxes[owner].high[0] <= boxes[owner].low[0]) continue;
            const int32_t first = bodies->corner_first[bodies->count];
            for (int i = 0; i < CORNERS; i++) corner_of(&boxes[owner], i, bodies->corners[first + i]);
            bodies->owner[bodies->count++] = owner;
            bodies->corner_first[bodies->count] = first + CORNERS;
        }
        bodies->cell_first[cell + 1] = bodies->count;
    }
    assert_true(enf_bodies_finish(bodies, 1));
}

static void draw_boxes(box *boxes) {
    for (int k = 0; k < OWNERS; k++)
        for (int axis = 0; axis < 3; axis++) {
            boxes[k].low[axis] = 10 * draw();
            boxes[k].high[axis] = boxes[k].low[axis] + exp(4 * draw() - 2);
        }
    boxes[7] = (box){{0}, {0}}; // has no body
    boxes[9] = boxes[9 + CELLS];
}

/// The width of some boxes together, seen from a random side.
static double find_width(const box *boxes, const int32_t *owners, int32_t count, const double way[3]) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (int32_t i = 0; i < count; i++)
        for (int k = 0; k < CORNERS; k++) {
            double corner[3];
            corner_of(&boxes[owners[i]], k, corner);
            const double at = way[0] * corner[0] + way[1] * corner[1] + way[2] * corner[2];
            low = fmin(low, at);
            high = fmax(high, at);
        }
    return high - low;
}

static void draw_way(double way[3]) {
    double square = 2;
    while (square > 1 || square < 0.01) {
        square = 0;
        for (int axis = 0; axis < 3; axis++) {
            way[axis] = 2 * draw() - 1;
            square += way[axis] * way[axis];
        }
    }
    for (int axis = 0; axis < 3; axis++) way[axis] /= sqrt(square);
}

/// The mean widths of a source, and of each of its owners, over the same sides.
static void assert_not_much_wider(const box *boxes, const int32_t *owners, int32_t count) {
    double whole = 0, own[OWNERS] = {0};
    for (int k = 0; k < WAYS; k++) {
        double way[3];
        draw_way(way);
        whole += find_width(boxes, owners, count, way);
        for (int32_t i = 0; i < count; i++) own[i] += find_width(boxes, &owners[i], 1, way);
    }
    for (int32_t i = 0; i < count; i++) assert_true(whole < 1.8 * own[i]);
}

static bool has(const int32_t *items, int32_t count, int32_t item) {
    for (int32_t i = 0; i < count; i++)
        if (items[i] == item) return true;
    return false;
}

static void assert_has_bodies(const enf_sources *sources, int32_t source, const enf_bodies *bodies) {
    const int32_t *cells = sources->cells + sources->cell_first[source],
                  cell_count = sources->cell_first[source + 1] - sources->cell_first[source];
    int32_t corners = 0;
    for (int32_t i = 1; i < cell_count; i++) assert_true(cells[i - 1] < cells[i]);
    for (int32_t i = sources->owner_first[source]; i < sources->owner_first[source + 1]; i++) {
        const int32_t owner = sources->owners[i];
        assert_true(has(cells, cell_count, owner % CELLS));
        assert_true(has(cells, cell_count, (owner + 1) % CELLS));
        for (int32_t k = bodies->whole_first[owner]; k < bodies->whole_first[owner + 1]; k++, corners++)
            assert_memory_equal(sources->corners[sources->corner_first[source] + corners], bodies->wholes[k],
                                sizeof *bodies->wholes);
    }
    assert_int_equal(sources->corner_first[source + 1] - sources->corner_first[source], corners);
}

static void test_owners(void **user) {
    (void)user;
    int32_t joined = 0;
    for (int round = 0; round < 50; round++) {
        box boxes[OWNERS];
        bool found[OWNERS] = {false};
        enf_bodies bodies;
        enf_sources sources;
        int32_t source_of[OWNERS] = {0};
        draw_boxes(boxes);
        make_bodies(&bodies, boxes);
        assert_true(enf_sources_make(&sources, &bodies));
        for (int32_t s = 0; s < sources.count; s++) {
            const int32_t first = sources.owner_first[s], count = sources.owner_first[s + 1] - first;
            assert_true(count > 0);
            for (int32_t i = first; i < first + count; i++) {
                assert_false(found[sources.owners[i]]);
                found[sources.owners[i]] = true;
                source_of[sources.owners[i]] = s;
            }
            assert_has_bodies(&sources, s, &bodies);
            assert_not_much_wider(boxes, sources.owners + first, count);
            joined += count - 1;
        }
        for (int k = 0; k < OWNERS; k++) assert_true(found[k] == (k != 7));
        assert_int_equal(source_of[9], source_of[9 + CELLS]); // the same box
        enf_sources_free(&sources);
        enf_bodies_free(&bodies);
    }
    assert_true(joined > 100);
}

static void test_nothing(void **user) {
    (void)user;
    box boxes[OWNERS] = {{{0}, {0}}};
    enf_bodies bodies;
    enf_sources sources;
    make_bodies(&bodies, boxes);
    assert_true(enf_sources_make(&sources, &bodies));
    assert_int_equal(sources.count, 0);
    enf_sources_free(&sources);
    enf_bodies_free(&bodies);
}

int main(int argc, char **argv) {
    state = argc > 1 ? strtoull(argv[1], NULL, 10) : 1;
    printf("seed %llu\n", (unsigned long long)state);
    const struct CMUnitTest tests[] = {cmocka_unit_test(test_owners), cmocka_unit_test(test_nothing)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
