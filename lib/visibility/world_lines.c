// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/world_lines.h"

#include "base/array.h"
#include "base/hash.h"
#include "visibility/world_graph.h"

#include <math.h>
#include <stdlib.h>

enum { PASSED_MOST = 4096 };

/// The cell of a fine cell.
static int32_t cell_of(const enf_world_lines *lines, int32_t fine) {
    return lines->view->fine_cell[fine];
}

/// Lists the openings at the fine cells of each cell.
static void list_openings(enf_world_lines *lines) {
    const enf_portal_graph *graph = &lines->graph;
    int32_t cells = lines->view->cell_count, *end = lines->cell_first;
    for (int32_t c = 0; c <= cells; c++) end[c] = 0;
    for (int32_t k = 0; k < graph->opening_count; k++) {
        int32_t one = cell_of(lines, graph->opening_cell[k][0]);
        int32_t other = cell_of(lines, graph->opening_cell[k][1]);
        end[one]++;
        end[other] += other != one;
    }
    for (int32_t c = 1; c <= cells; c++) end[c] += end[c - 1];
    for (int32_t k = 0; k < graph->opening_count; k++) { // from the ends back to the firsts
        int32_t one = cell_of(lines, graph->opening_cell[k][0]);
        int32_t other = cell_of(lines, graph->opening_cell[k][1]);
        lines->cell_openings[--end[one]] = k;
        if (other != one) lines->cell_openings[--end[other]] = k;
    }
}

enf_status enf_world_lines_make(enf_world_lines *lines, const enf_file_view *view, uint64_t seed,
                                enf_error *error) {
    *lines = (enf_world_lines){.view = view, .seed = seed};
    enf_status status = enf_world_graph_make_fine(&lines->graph, view, error);
    if (!status) status = enf_pvs_new(&lines->seen, view->cell_count, error);
    if (status) return status;
    lines->cell_first = enf_array_new((size_t)view->cell_count + 1, sizeof *lines->cell_first);
    lines->cell_openings =
        enf_array_new(2 * (size_t)lines->graph.opening_count, sizeof *lines->cell_openings);
    lines->passed = enf_array_new(PASSED_MOST, sizeof *lines->passed);
    lines->cells = enf_array_new(PASSED_MOST + 2, sizeof *lines->cells);
    if (!lines->cell_first || !lines->cell_openings || !lines->passed || !lines->cells ||
        !enf_shapes_make(&lines->shapes, &lines->graph) || !enf_sight_make(&lines->sight, &lines->shapes))
        return enf_fail_memory(error, "the fine cells");
    lines->sight.trusts_order = true;
    list_openings(lines);
    return ENF_OK;
}

void enf_world_lines_free(enf_world_lines *lines) {
    enf_sight_free(&lines->sight);
    enf_shapes_free(&lines->shapes);
    enf_portal_graph_free(&lines->graph);
    enf_pvs_free(&lines->seen);
    free(lines->cell_first);
    free(lines->cell_openings);
    free(lines->passed);
    free(lines->cells);
    *lines = (enf_world_lines){0};
}

double enf_world_lines_share(enf_world_lines *lines) {
    lines->seed = enf_hash_mix(lines->seed + UINT64_C(0x9e3779b97f4a7c15));
    return (double)(lines->seed >> 11) * 0x1p-53;
}

/// A point in the opening: on the way from its middle to one of its edges.
static void find_point(enf_world_lines *lines, int32_t opening, double point[3]) {
    const enf_shape *shape = &lines->shapes.shapes[opening];
    const enf_outline outline = enf_shape_outline(&lines->shapes, opening);
    int32_t corner = (int32_t)(enf_world_lines_share(lines) * shape->count);
    double along = enf_world_lines_share(lines), out = sqrt(enf_world_lines_share(lines));
    for (int axis = 0; axis < 3; axis++) {
        const double *at = outline.at[axis] + corner; // outlines are closed
        point[axis] = shape->centre[axis] + out * (at[0] + along * (at[1] - at[0]) - shape->centre[axis]);
    }
}

static void follow(enf_world_lines *lines, const enf_line *line, int32_t portal) {
    const enf_portal_graph *graph = &lines->graph;
    int32_t count = enf_sight_walk(&lines->sight, line, portal, lines->passed, PASSED_MOST), kept = 0;
    if (count < 0) return;
    lines->cells[kept++] = cell_of(lines, enf_portal_from(graph, portal));
    for (int32_t i = -1; i < count; i++) {
        int32_t cell = cell_of(lines, enf_portal_to(graph, i < 0 ? portal : lines->passed[i]));
        if (cell != lines->cells[kept - 1]) lines->cells[kept++] = cell;
    }
    for (int32_t i = 0; i < kept; i++)
        for (int32_t k = i + 1; k < kept; k++) {
            enf_pvs_set(&lines->seen, lines->cells[i], lines->cells[k]);
            enf_pvs_set(&lines->seen, lines->cells[k], lines->cells[i]);
        }
}

void enf_world_lines_throw(enf_world_lines *lines, int32_t opening, int32_t other) {
    enf_line line;
    find_point(lines, opening, line.from);
    find_point(lines, other, line.to);
    follow(lines, &line, 2 * opening);
    follow(lines, &line, 2 * opening + 1);
    lines->count++;
}

void enf_world_lines_throw_any(enf_world_lines *lines) {
    int32_t count = lines->graph.opening_count;
    if (count == 0) return;
    int32_t opening = (int32_t)(enf_world_lines_share(lines) * count);
    enf_world_lines_throw(lines, opening, (int32_t)(enf_world_lines_share(lines) * count));
}

void enf_world_lines_follow(enf_world_lines *lines, const enf_line *line, int32_t cell) {
    lines->count++;
    for (int32_t k = lines->cell_first[cell]; k < lines->cell_first[cell + 1]; k++) {
        follow(lines, line, 2 * lines->cell_openings[k]);
        follow(lines, line, 2 * lines->cell_openings[k] + 1);
    }
}

/// A random opening of the cell; -1: it has none.
static int32_t any_opening(enf_world_lines *lines, int32_t cell) {
    int32_t first = lines->cell_first[cell], count = lines->cell_first[cell + 1] - first;
    return count > 0 ? lines->cell_openings[first + (int32_t)(enf_world_lines_share(lines) * count)] : -1;
}

int64_t enf_world_lines_aim(enf_world_lines *lines, const enf_pvs *claimed, int tries, int64_t most) {
    int64_t pairs = 0;
    for (int32_t i = 0; i < claimed->cell_count; i++)
        for (int32_t j = i + 1; j < claimed->cell_count && lines->count < most; j++) {
            if (!enf_pvs_get(claimed, i, j) || enf_pvs_get(&lines->seen, i, j)) continue;
            pairs++;
            for (int k = 0; k < tries && !enf_pvs_get(&lines->seen, i, j); k++) {
                int32_t one = any_opening(lines, i), other = any_opening(lines, j);
                if (one >= 0 && other >= 0) enf_world_lines_throw(lines, one, other);
            }
        }
    return pairs;
}
