// SPDX-License-Identifier: GPL-3.0-or-later
// The visible set, if the file has one: it is a relation of the kind it should be, and lines thrown through
// the fine cells join no two cells that it says are hidden from each other. Lines can't prove it complete;
// they find what is badly wrong.
#include "build/check_rows.h"

#include "base/array.h"
#include "base/hash.h"
#include "format/pvs_row.h"
#include "visibility/pvs.h"
#include "visibility/sight.h"
#include "visibility/world_graph.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { LINES = 20000, PASSED_MOST = 1024 };

/// Decodes all rows. (That they can be decoded was seen when the file was opened.)
static bool take_rows(const enf_file_view *view, enf_pvs *pvs) {
    enf_error error;
    size_t bytes = enf_pvs_row_bytes(view->cell_count);
    uint8_t *row = enf_array_new(bytes, 1);
    bool good = row && !enf_pvs_new(pvs, view->cell_count, &error);
    for (int32_t i = 0; good && i < view->cell_count; i++) {
        const int64_t *offset = &view->pvs_offset[i];
        uint64_t *words = enf_pvs_row(pvs, i);
        good = enf_pvs_row_decode(view->pvs_rows + offset[0], (size_t)(offset[1] - offset[0]), row,
                                  view->cell_count);
        memset(words, 0, pvs->row_words * sizeof *words);
        for (size_t k = 0; good && k < bytes; k++) words[k / 8] |= (uint64_t)row[k] << k % 8 * 8;
    }
    free(row);
    return good;
}

static void check_relation(enf_checker *checker, const enf_pvs *pvs) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "visibility: sets",
                    "each cell sees itself, its neighbours, and what sees it; pairs are counted right");
    for (int32_t i = 0; i < pvs->cell_count; i++, checker->row->tested++) {
        if (!enf_pvs_get(pvs, i, i)) enf_check_break(checker, "cell %" PRId32 " does not see itself", i);
        for (int32_t j = 0; j < i; j++)
            if (enf_pvs_get(pvs, i, j) != enf_pvs_get(pvs, j, i))
                enf_check_break(checker, "cells %" PRId32 " and %" PRId32 " do not agree", j, i);
    }
    for (int32_t i = 0; i < view->portal_count; i++) {
        const enf_file_portal *portal = &view->portals[i];
        if (!enf_pvs_get(pvs, portal->from, portal->to))
            enf_check_break(checker, "cell %" PRId32 " does not see its neighbour %" PRId32, portal->from,
                            portal->to);
    }
    if (enf_pvs_pairs(pvs) != view->pvs->pairs)
        enf_check_break(checker, "there are %" PRId64 " pairs, not %" PRId64, enf_pvs_pairs(pvs),
                        view->pvs->pairs);
}

// ---------------------------------------------------------------------------------------------- lines

static double next_share(uint64_t *seed) {
    *seed = enf_hash_mix(*seed + UINT64_C(0x9e3779b97f4a7c15));
    return (double)(*seed >> 11) * 0x1p-53;
}

/// A point in the opening: on the way from its middle to one of its edges.
static void find_point(const enf_shapes *shapes, int32_t opening, uint64_t *seed, double point[3]) {
    const enf_shape *shape = &shapes->shapes[opening];
    const double(*corners)[3] = enf_shape_corners(shapes, opening);
    int32_t corner = (int32_t)(next_share(seed) * shape->count), next = (corner + 1) % shape->count;
    double along = next_share(seed), out = next_share(seed);
    for (int axis = 0; axis < 3; axis++) {
        double edge = corners[corner][axis] + along * (corners[next][axis] - corners[corner][axis]);
        point[axis] = shape->centre[axis] + out * (edge - shape->centre[axis]);
    }
}

/// Follows a line through the fine cells, and asks for every two cells on its way.
static void follow_line(enf_checker *checker, const enf_sight *sight, const enf_pvs *pvs,
                        const enf_line *line, int32_t portal, int32_t *cells) {
    const enf_portal_graph *graph = sight->shapes->graph;
    const int32_t *cell_of = checker->view->fine_cell;
    int32_t *passed = cells + PASSED_MOST + 2;
    int32_t count = enf_sight_walk(sight, line, portal, passed, PASSED_MOST), kept = 0;
    if (count < 0) return;
    cells[kept++] = cell_of[enf_portal_from(graph, portal)];
    for (int32_t i = -1; i < count; i++) {
        int32_t cell = cell_of[enf_portal_to(graph, i < 0 ? portal : passed[i])];
        if (cell != cells[kept - 1]) cells[kept++] = cell;
    }
    for (int32_t i = 0; i < kept; i++)
        for (int32_t j = i + 1; j < kept; j++, checker->row->tested++)
            if (!enf_pvs_get(pvs, cells[i], cells[j])) {
                enf_check_break(checker,
                                "cell %" PRId32 " sees cell %" PRId32 " along a line through (%g %g %g)",
                                cells[i], cells[j], line->from[0], line->from[1], line->from[2]);
                return;
            }
}

static bool throw_lines(enf_checker *checker, const enf_portal_graph *graph, const enf_pvs *pvs) {
    enf_shapes shapes = {0};
    enf_sight sight = {0};
    int32_t *cells = enf_array_new(2 * PASSED_MOST + 4, sizeof *cells);
    bool good = cells && enf_shapes_make(&shapes, graph) && enf_sight_make(&sight, &shapes);
    uint64_t seed = 1;
    for (int i = 0; good && graph->opening_count > 0 && i < LINES && enf_check_holds(checker); i++) {
        enf_line line;
        int32_t opening = (int32_t)(next_share(&seed) * graph->opening_count);
        find_point(&shapes, opening, &seed, line.from);
        find_point(&shapes, (int32_t)(next_share(&seed) * graph->opening_count), &seed, line.to);
        follow_line(checker, &sight, pvs, &line, 2 * opening, cells);
        follow_line(checker, &sight, pvs, &line, 2 * opening + 1, cells);
    }
    enf_sight_free(&sight);
    enf_shapes_free(&shapes);
    free(cells);
    return good;
}

static void check_lines(enf_checker *checker, const enf_pvs *pvs) {
    enf_portal_graph graph;
    enf_error error;
    enf_check_begin(checker, "visibility: lines", "no line joins two cells that do not see each other");
    bool good =
        !enf_world_graph_make_fine(&graph, checker->view, &error) && throw_lines(checker, &graph, pvs);
    if (!good) enf_check_no_memory(checker);
    enf_portal_graph_free(&graph);
}

void enf_check_visibility(enf_checker *checker) {
    if (!checker->view->pvs) return;
    enf_pvs pvs = {0};
    if (take_rows(checker->view, &pvs)) {
        check_relation(checker, &pvs);
        if (enf_check_holds(checker)) check_lines(checker, &pvs);
    } else {
        enf_check_no_memory(checker);
    }
    enf_pvs_free(&pvs);
}
