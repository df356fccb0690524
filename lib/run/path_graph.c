// SPDX-License-Identifier: MIT
// Files may hold any portals. A cell is taken for a link of a chain only if exactly two portals lead out of
// it and both are listed, as are those that lead into it; so a chain has one portal after each and one before
// each, and never runs into itself.
#include "run/path_graph.h"

#include "base/array.h"
#include "run/portal_shape.h"
#include "run/vector.h"

#include <stdlib.h>
#include <string.h>

enum { UNIT_BITS = 36, SUM_BITS = 60, EXPONENT_LEAST = -900 };
#define ROUNDING 0x1p-10 // units; more than the error of a length of 2^38 in doubles

int64_t enf_path_step(const enf_paths *paths, const double a[3], const double b[3]) {
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2], length = sqrt(x * x + y * y + z * z);
    if (!(length < paths->longest)) length = paths->longest; // also what is no number
    return (int64_t)(length + ROUNDING) + 2;
}

int64_t enf_path_straight(const enf_paths *paths, const double a[3], const double b[3]) {
    double x = a[0] - b[0], y = a[1] - b[1], z = a[2] - b[2], length = sqrt(x * x + y * y + z * z);
    if (!(length < paths->longest)) length = paths->longest;
    return length < ROUNDING ? 0 : (int64_t)(length - ROUNDING);
}

void enf_path_to_units(const enf_paths *paths, const double world[3], double units[3]) {
    for (int a = 0; a < 3; a++) units[a] = world[a] * paths->unit;
}

void enf_path_come_out(const enf_paths *paths, int32_t portal, const double *matrix, double place[3]) {
    const double *before = enf_path_place(paths, portal);
    memcpy(place, before, 3 * sizeof *place);
    for (int a = 0; matrix && a < 3; a++)
        place[a] = enf_dot(matrix + 4 * a, before) + matrix[4 * a + 3] * paths->unit;
}

static int32_t other_exit(const enf_paths *paths, int32_t cell, int32_t portal) {
    int32_t count;
    const int32_t *exits = enf_path_exits(paths, cell, &count);
    return exits[0] == portal ? exits[1] : exits[0];
}

int32_t enf_path_after(const enf_paths *paths, int32_t portal) {
    return other_exit(paths, paths->view->portals[portal].to, portal ^ 1);
}

int32_t enf_path_before(const enf_paths *paths, int32_t portal) {
    return other_exit(paths, paths->view->portals[portal].from, portal) ^ 1;
}

/// The unit: the largest coordinate is about 2^bits units, and no sum over all portals overflows.
static void choose_unit(enf_paths *paths) {
    const enf_file_view *view = paths->view;
    double largest = 0;
    for (int32_t i = 0; i < view->portal_vertex_count; i++)
        for (int a = 0; a < 3; a++) largest = fmax(largest, fabs(view->portal_vertices[i][a]));
    int exponent, bits = SUM_BITS - 3;
    frexp(largest, &exponent);
    if (exponent < EXPONENT_LEAST) exponent = EXPONENT_LEAST;
    for (int64_t count = view->portal_count + 2; count > 0; count /= 2) bits--;
    if (bits > UNIT_BITS) bits = UNIT_BITS;
    paths->unit = ldexp(1, bits - exponent);
    paths->longest = ldexp(1, bits + 2);
}

static void find_junctions(enf_paths *paths, int32_t *leaving, bool *is_listed, bool contract) {
    const enf_file_view *view = paths->view;
    for (int32_t i = 0; i < view->portal_count; i++) leaving[view->portals[i].from]++;
    for (int32_t i = 0; i < view->cell_count; i++) {
        int32_t count;
        const int32_t *exits = enf_path_exits(paths, i, &count);
        bool is_link = contract && leaving[i] == 2 && count == 2 && exits[0] != exits[1];
        for (int k = 0; is_link && k < 2; k++) is_link = view->portals[exits[k]].to != i;
        paths->is_junction[i] = !is_link;
        for (int32_t k = 0; k < count; k++) is_listed[exits[k]] = true;
    }
    for (int32_t i = 0; i < view->portal_count; i++)
        if (!is_listed[i]) paths->is_junction[view->portals[i].to] = true;
}

static void trace_chain(enf_paths *paths, int32_t head) {
    const enf_file_view *view = paths->view;
    int32_t tail = head;
    paths->head[head] = head;
    paths->offset[head] = 0;
    while (!paths->is_junction[view->portals[tail].to]) {
        int32_t next = enf_path_after(paths, tail);
        paths->offset[next] = paths->offset[tail] +
                              enf_path_step(paths, enf_path_place(paths, tail), enf_path_place(paths, next));
        paths->head[next] = head;
        tail = next;
    }
    for (int32_t at = tail; at != head; at = enf_path_before(paths, at)) paths->tail[at] = tail;
    paths->tail[head] = tail;
}

static void trace_chains_of(enf_paths *paths, int32_t cell) {
    int32_t count;
    const int32_t *exits = enf_path_exits(paths, cell, &count);
    for (int32_t i = 0; i < count; i++) trace_chain(paths, exits[i]);
}

/// Chains from all junctions; then from the lowest cell of each ring without one. Portals that no cell lists
/// are chains of their own: none leads there.
static void trace_chains(enf_paths *paths) {
    const enf_file_view *view = paths->view;
    for (int32_t i = 0; i < view->portal_count; i++) {
        paths->head[i] = -1;
        paths->tail[i] = i;
    }
    for (int32_t i = 0; i < view->cell_count; i++)
        if (paths->is_junction[i]) trace_chains_of(paths, i);
    for (int32_t i = 0; i < view->cell_count; i++) {
        int32_t count;
        const int32_t *exits = enf_path_exits(paths, i, &count);
        if (!paths->is_junction[i] && (paths->head[exits[0]] < 0 || paths->head[exits[1]] < 0)) {
            paths->is_junction[i] = true;
            trace_chains_of(paths, i);
        }
    }
    for (int32_t i = 0; i < view->cell_count; i++) paths->junction_count += paths->is_junction[i];
    for (int32_t i = 0; i < view->portal_count; i++)
        if (paths->head[i] < 0) paths->head[i] = i;
}

static void number_gates(enf_paths *paths) {
    const enf_file_view *view = paths->view;
    for (int32_t i = 0; i < view->portal_count / 2; i++) {
        bool is_gate =
            paths->is_junction[view->portals[2 * i].from] || paths->is_junction[view->portals[2 * i].to];
        paths->gate[i] = is_gate ? paths->gate_count : -1;
        if (is_gate) paths->gate_pair[paths->gate_count++] = i;
    }
}

bool enf_path_graph_make(enf_paths *paths, bool contract) {
    const enf_file_view *view = paths->view;
    size_t portals = (size_t)view->portal_count, pairs = portals / 2, cells = (size_t)view->cell_count;
    paths->place = enf_array_new(pairs, sizeof *paths->place);
    paths->is_junction = enf_array_zeroed(cells, sizeof *paths->is_junction);
    paths->head = enf_array_new(portals, sizeof *paths->head);
    paths->tail = enf_array_new(portals, sizeof *paths->tail);
    paths->offset = enf_array_zeroed(portals, sizeof *paths->offset);
    paths->gate = enf_array_new(pairs, sizeof *paths->gate);
    paths->gate_pair = enf_array_new(pairs, sizeof *paths->gate_pair);
    int32_t *leaving = enf_array_zeroed(cells, sizeof *leaving);
    bool *is_listed = enf_array_zeroed(portals, sizeof *is_listed);
    bool good = paths->place && paths->is_junction && paths->head && paths->tail && paths->offset &&
                paths->gate && paths->gate_pair && leaving && is_listed;
    if (good) {
        choose_unit(paths);
        for (size_t i = 0; i < pairs; i++)
            enf_portal_middle(view, (int32_t)(2 * i), paths->unit, paths->place[i]);
        find_junctions(paths, leaving, is_listed, contract);
        trace_chains(paths);
        number_gates(paths);
    }
    free(leaving);
    free(is_listed);
    return good;
}

void enf_path_graph_free(enf_paths *paths) {
    free(paths->place);
    free(paths->is_junction);
    free(paths->head);
    free(paths->tail);
    free(paths->offset);
    free(paths->gate);
    free(paths->gate_pair);
    free(paths->table);
    free(paths->component);
    free(paths->landmarks);
}
