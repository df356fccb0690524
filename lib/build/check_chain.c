// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/check_chain.h"

#include "base/array.h"

#include <stdlib.h>
#include <string.h>

void enf_check_chain_free(enf_check_chain *chain) {
    free(chain->edges);
    memset(chain, 0, sizeof *chain);
}

void enf_check_chain_empty(enf_check_chain *chain) {
    chain->count = 0;
}

void enf_check_chain_add(enf_check_chain *chain, const enf_check_exact *exact, int32_t from, int32_t to,
                         int32_t times) {
    int32_t a = exact->place[from], b = exact->place[to];
    if (a == b) return;
    if (!enf_array_reserve(chain->edges, chain->capacity, chain->count + 1)) {
        chain->failed = true;
        return;
    }
    chain->edges[chain->count++] = (enf_check_edge){a < b ? a : b, a < b ? b : a, a < b ? times : -times};
}

void enf_check_chain_add_loop(enf_check_chain *chain, const enf_check_exact *exact,
                              const enf_check_loop *loop, int32_t times) {
    for (int32_t i = 0; i < loop->count; i++) {
        int32_t next = i + 1 < loop->count ? i + 1 : 0;
        enf_check_chain_add(chain, exact, loop->corners[i].vertex, loop->corners[next].vertex, times);
    }
}

static int compare_edges(const void *a, const void *b) {
    const enf_check_edge *x = a, *y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    return (x->high > y->high) - (x->high < y->high);
}

static void sort_edges(enf_check_edge *edges, size_t count) {
    if (count > 24) {
        qsort(edges, count, sizeof *edges, compare_edges);
        return;
    }
    for (size_t i = 1; i < count; i++) {
        enf_check_edge moved = edges[i];
        size_t k = i;
        for (; k > 0 && compare_edges(&edges[k - 1], &moved) > 0; k--) edges[k] = edges[k - 1];
        edges[k] = moved;
    }
}

void enf_check_chain_reduce(enf_check_chain *chain) {
    sort_edges(chain->edges, chain->count);
    size_t kept = 0;
    for (size_t i = 0; i < chain->count;) {
        enf_check_edge sum = chain->edges[i++];
        while (i < chain->count && compare_edges(&chain->edges[i], &sum) == 0)
            sum.turns += chain->edges[i++].turns;
        if (sum.turns != 0) chain->edges[kept++] = sum;
    }
    chain->count = kept;
}

/// The ends of edges on one line: along the line the chain cancels if at every place as much begins as ends.
static bool line_vanishes(enf_check_edge *ends, size_t count) {
    sort_edges(ends, count);
    for (size_t i = 0; i < count;) {
        int64_t sum = 0;
        int32_t place = ends[i].low;
        for (; i < count && ends[i].low == place; i++) sum += ends[i].turns;
        if (sum != 0) return false;
    }
    return true;
}

/// Does the vertex lie on the line through two others? In a plane one projection tells, in space three do.
static bool on_line(enf_check_exact *exact, int axis, const enf_check_edge *line, int32_t vertex) {
    if (axis != ENF_CHECK_ANYWHERE) return enf_check_turn(exact, axis, line->low, line->high, vertex) == 0;
    for (int k = 0; k < 3; k++) {
        if (enf_check_turn(exact, k, line->low, line->high, vertex) != 0) return false;
    }
    return true;
}

/// Takes the edges on the line of the last one out of the chain, which has room for twice as many more. Do
/// they cancel along it?
static bool take_line(enf_check_chain *chain, enf_check_exact *exact, int axis) {
    enf_check_edge *ends = chain->edges + chain->count, line = chain->edges[chain->count - 1];
    size_t end_count = 0, kept = 0;
    for (size_t i = 0; i < chain->count; i++) {
        enf_check_edge edge = chain->edges[i];
        if (on_line(exact, axis, &line, edge.low) && on_line(exact, axis, &line, edge.high)) {
            ends[end_count++] = (enf_check_edge){edge.low, 0, edge.turns};
            ends[end_count++] = (enf_check_edge){edge.high, 0, -edge.turns};
        } else {
            chain->edges[kept++] = edge;
        }
    }
    chain->count = kept;
    return line_vanishes(ends, end_count);
}

bool enf_check_chain_vanishes(enf_check_chain *chain, enf_check_exact *exact, int axis,
                              enf_check_edge *left) {
    enf_check_chain_reduce(chain);
    if (chain->count && !enf_array_reserve(chain->edges, chain->capacity, 3 * chain->count))
        chain->failed = true;
    bool good = !chain->failed;
    while (good && chain->count > 0) {
        if (left) *left = chain->edges[chain->count - 1];
        good = take_line(chain, exact, axis);
    }
    chain->count = 0;
    return good;
}

// ---------------------------------------------------------------------------------------------- loops

static int32_t corner(const enf_check_loop *loop, int32_t i) {
    return loop->corners[i % loop->count].vertex;
}

/// Every corner turns the right way, and so does every triangle with the first edge and every triangle of the
/// fan around the first corner: then the outline runs around once.
static bool strictly_convex(enf_check_exact *exact, const enf_check_loop *loop, int axis, int sign) {
    for (int32_t i = 0; i < loop->count; i++) {
        if (enf_check_turn(exact, axis, corner(loop, i), corner(loop, i + 1), corner(loop, i + 2)) != sign)
            return false;
    }
    for (int32_t i = 2; i + 1 < loop->count; i++) {
        if (enf_check_turn(exact, axis, corner(loop, 0), corner(loop, i), corner(loop, i + 1)) != sign)
            return false;
        if (enf_check_turn(exact, axis, corner(loop, 0), corner(loop, 1), corner(loop, i + 1)) != sign)
            return false;
    }
    return true;
}

const char *enf_check_loop_fault(enf_check_exact *exact, const enf_check_loop *loop) {
    if (loop->count < 3) return "has fewer than three corners";
    for (int32_t i = 0; i < loop->count; i++) {
        int32_t edge = loop->corners[i].edge_plane;
        if (enf_check_side(exact, corner(loop, i), loop->plane) != 0) return "has a corner off its plane";
        if (exact->plane_class[edge] == exact->plane_class[loop->plane])
            return "has an edge plane that is its own plane";
        if (enf_check_side(exact, corner(loop, i), edge) != 0 ||
            enf_check_side(exact, corner(loop, i + 1), edge) != 0)
            return "has an edge that is off its edge plane";
    }
    int sign, axis = enf_check_axis(exact, loop->plane, &sign);
    return strictly_convex(exact, loop, axis, sign) ? NULL : "is not convex, or turned over";
}

bool enf_check_same_loop(const enf_check_exact *exact, const enf_check_loop *a, const enf_check_loop *b) {
    if (a->count != b->count) return false;
    int32_t shift = 0, count = a->count;
    while (shift < count && exact->place[b->corners[shift].vertex] != exact->place[a->corners[0].vertex])
        shift++;
    if (shift == count) return false;
    for (int32_t i = 1; i < count; i++) {
        if (exact->place[a->corners[i].vertex] != exact->place[corner(b, i + shift)]) return false;
    }
    return true;
}

bool enf_check_loop_holds(enf_check_exact *exact, const enf_check_loop *loop, int32_t vertex) {
    int sign, axis = enf_check_axis(exact, loop->plane, &sign);
    for (int32_t i = 0; i < loop->count; i++) {
        if (enf_check_turn(exact, axis, corner(loop, i), corner(loop, i + 1), vertex) == -sign) return false;
    }
    return true;
}

/// Is all of b on or beyond one edge of a?
static bool edge_parts(enf_check_exact *exact, const enf_check_loop *a, const enf_check_loop *b, int axis,
                       int sign) {
    for (int32_t i = 0; i < a->count; i++) {
        int32_t k = 0;
        while (k < b->count &&
               enf_check_turn(exact, axis, corner(a, i), corner(a, i + 1), corner(b, k)) != sign)
            k++;
        if (k == b->count) return true;
    }
    return false;
}

bool enf_check_loops_apart(enf_check_exact *exact, const enf_check_loop *a, const enf_check_loop *b) {
    int sign, axis = enf_check_axis(exact, a->plane, &sign);
    return edge_parts(exact, a, b, axis, sign) || edge_parts(exact, b, a, axis, sign);
}
