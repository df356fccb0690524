// SPDX-License-Identifier: GPL-3.0-or-later
// Levels that were turned and moved, and so rounded, see the same, but for sight lines that clear the portals
// by less than that rounding.
#include "visibility/visibility.h"

#include <inttypes.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "tests/shared_data.h"

/// What rounding does: 2^-53 of coordinates of some thousands, a few times.
static const double rounding = 1e-11;

static enf_visibility run(const enf_portal_graph *graph) {
    const enf_visibility_options options = {.method = ENF_METHOD_EXACT, .threads = 2, .want_witnesses = true};
    enf_visibility visibility;
    enf_error error = {0};
    if (enf_visibility_run(&visibility, graph, &options, &error)) fail_msg("%s", error.text);
    return visibility;
}

/// The distance between the line and the line of an edge.
static double distance(const enf_line *line, const double a[3], const double b[3]) {
    double d[3], e[3], w[3], c[3], square = 0, height = 0;
    for (int i = 0; i < 3; i++) {
        d[i] = line->to[i] - line->from[i];
        e[i] = b[i] - a[i];
        w[i] = a[i] - line->from[i];
    }
    for (int i = 0; i < 3; i++) c[i] = d[(i + 1) % 3] * e[(i + 2) % 3] - d[(i + 2) % 3] * e[(i + 1) % 3];
    for (int i = 0; i < 3; i++) {
        square += c[i] * c[i];
        height += c[i] * w[i];
    }
    return square > 0 ? fabs(height) / sqrt(square) : INFINITY;
}

/// How far the line stays clear of the edges of all portals that it passes from one cell to another.
static double find_clearance(const enf_portal_graph *graph, const enf_line *line, int32_t from, int32_t to) {
    double least = INFINITY;
    for (int32_t cell = from, before = -1, steps = 0; cell != to && steps < graph->cell_count; steps++) {
        int32_t next = -1;
        for (int32_t k = graph->cell_portal[cell]; k < graph->cell_portal[cell + 1]; k++)
            if (graph->cell_portals[k] >> 1 != before && enf_line_passes(line, graph, graph->cell_portals[k]))
                next = graph->cell_portals[k];
        if (next < 0) return 0; // it needs more digits than doubles have
        int32_t first = graph->opening_corner[next >> 1], end = graph->opening_corner[(next >> 1) + 1];
        for (int32_t i = first; i < end; i++)
            least =
                fmin(least, distance(line, graph->corners[i], graph->corners[i + 1 < end ? i + 1 : first]));
        before = next >> 1;
        cell = enf_portal_to(graph, next);
    }
    return least;
}

/// Pairs that are seen here and not there: their lines must be squeezed.
static int64_t compare(const enf_portal_graph *graph, const enf_visibility *here, const enf_visibility *there,
                       double *widest) {
    int64_t count = 0;
    for (int64_t i = 0; i < here->witness_count; i++) {
        const int32_t *cells = here->witness_cells[i];
        if (enf_pvs_get(&there->pvs, cells[0], cells[1])) continue;
        *widest = fmax(*widest, find_clearance(graph, &here->witnesses[i], cells[0], cells[1]));
        count++;
    }
    return count;
}

static void move(const char *level, const double rows[3][3], const double by[3]) {
    char path[1024];
    snprintf(path, sizeof path, "%s/quake/prt/%s.prt", shared_data(), level);
    enf_portal_graph graph, moved;
    enf_error error = {0};
    if (enf_portal_graph_read(&graph, path, &error) || enf_portal_graph_read(&moved, path, &error))
        fail_msg("%s", error.text);
    for (int32_t i = 0; i < graph.opening_corner[graph.opening_count]; i++)
        for (int axis = 0; axis < 3; axis++) {
            moved.corners[i][axis] = by[axis];
            for (int k = 0; k < 3; k++) moved.corners[i][axis] += rows[axis][k] * graph.corners[i][k];
        }
    enf_visibility here = run(&graph), there = run(&moved);
    double widest = 0;
    int64_t lost = compare(&graph, &here, &there, &widest), won = compare(&moved, &there, &here, &widest);
    printf("%s: %" PRId64 " pairs; %" PRId64 " lost, %" PRId64 " won, none wider than %g\n", level,
           enf_pvs_pairs(&here.pvs), lost, won, widest);
    assert_true(widest < rounding);
    assert_true((lost + won) * 20 < enf_pvs_pairs(&here.pvs));
    enf_visibility_free(&here);
    enf_visibility_free(&there);
    enf_portal_graph_free(&graph);
    enf_portal_graph_free(&moved);
}

static void moved_levels_see_the_same(void **state) {
    (void)state;
    static const double as_it_is[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    move("dm1", as_it_is, (const double[3]){10003.7, -5001.3, 77.77});
    move("end", as_it_is, (const double[3]){0.1, 0.2, 0.3});
}

static void turned_levels_see_the_same(void **state) {
    (void)state;
    static const double turned[3][3] = {{0.36, 0.48, -0.8}, {-0.8, 0.6, 0}, {0.48, 0.64, 0.6}};
    move("dm4", turned, (const double[3]){0, 0, 0});
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(moved_levels_see_the_same),
        cmocka_unit_test(turned_levels_see_the_same),
    };
    return cmocka_run_group_tests_name("moved", tests, NULL, NULL);
}
