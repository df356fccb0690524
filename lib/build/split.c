// SPDX-License-Identifier: GPL-3.0-or-later
// The split of the thesis (4.2.1) done exactly: each polygon cuts the cells that it really enters, and only
// those, by its plane; what is left of a tetrahedron is a small BSP tree (Fuchs, Kedem and Naylor 1980).
//
// A tetrahedron's tree of cuts leads each polygon to the cells that it may enter; whether the polygon's
// inside meets a cell's is decided in the plane, by the separating axis theorem for two convex polygons:
// flood.c has asked for the tetrahedron's facets, the tree for the cuts, and here it is the polygon's own
// lines.
#include "build/split.h"

#include "base/array.h"
#include "build/flood.h"
#include "build/join.h"
#include "build/polygon_lines.h"

#include <stdlib.h>
#include <string.h>

typedef struct cutter {
    enf_arrangement *arrangement;
    enf_subdivision *space;
    enf_polygon_lines lines;
    int32_t *refs; ///< of the tree: nodes and cells
    enf_candidate *candidates;
    size_t candidate_capacity;
    size_t ref_capacity;
    int32_t joined; ///< tetrahedra that went into others
    bool failed;    ///< out of memory
} cutter;

static void add_hit(cutter *c, int32_t source) {
    enf_arrangement *arrangement = c->arrangement;
    if (!enf_array_reserve(arrangement->hits, arrangement->hit_capacity, arrangement->hit_count + 1)) {
        c->failed = true;
        return;
    }
    arrangement->hits[arrangement->hit_count++] = (enf_hit){c->lines.polygon, source, c->lines.wanted};
}

// ---------------------------------------------------------------------------------------------- one cell

/// The vertex where a cut edge meets the plane; false without memory.
static bool cut_vertex(cutter *c, size_t i, int32_t *vertex) {
    *vertex = enf_subdivision_cut_vertex(c->space, i);
    if (*vertex < 0) c->failed = true;
    return *vertex >= 0;
}

/// The same as below for one line of a polygon with very many.
static bool line_lets_in(cutter *c, int32_t line) {
    enf_subdivision *space = c->space;
    int32_t plane = c->lines.first_plane + line, vertex;
    for (size_t i = 0; i < space->cut_edge_count; i++) {
        if (!cut_vertex(c, i, &vertex)) return false;
        if (enf_geometry_side(&space->geometry, vertex, plane) < 0) return true;
    }
    for (size_t i = 0; i < space->touching_count; i++) {
        if (enf_geometry_side(&space->geometry, space->touching[i], plane) < 0) return true;
    }
    return false;
}

/// Does the polygon's inside meet the part of its plane that is in the cell, as far as the polygon's edges
/// tell? It does not if a line has no corner of that part strictly inside.
static bool lines_let_in(cutter *c) {
    enf_subdivision *space = c->space;
    enf_geometry *geometry = &space->geometry;
    uint32_t wanted = c->lines.wanted, sure = 0, maybe = 0;
    size_t vertices =
        (size_t)geometry->point_count + (size_t)geometry->crossing_count + space->cut_edge_count;
    if (!enf_polygon_lines_reserve(&c->lines, vertices)) {
        c->failed = true;
        return false;
    }
    for (size_t i = 0; i < space->touching_count; i++)
        sure |= enf_polygon_lines_at(&c->lines, geometry, space->touching[i])->inside;
    for (size_t i = 0; i < space->cut_edge_count && sure != wanted; i++) {
        uint32_t from = enf_polygon_lines_at(&c->lines, geometry, space->cut_edges[i].from)->inside,
                 to = enf_polygon_lines_at(&c->lines, geometry, space->cut_edges[i].to)->inside;
        sure |= from & to;
        maybe |= from | to;
    }
    if (wanted & ~(sure | maybe)) return false;
    for (size_t i = 0; i < space->cut_edge_count && sure != wanted; i++) {
        const enf_cut_edge *cut = &space->cut_edges[i];
        int32_t vertex;
        if (!(wanted & ~sure & (c->lines.known[cut->from].inside | c->lines.known[cut->to].inside))) continue;
        if (!cut_vertex(c, i, &vertex)) return false;
        sure |= enf_polygon_lines_at(&c->lines, geometry, vertex)->inside;
    }
    if (sure != wanted) return false;
    for (int32_t i = ENF_LINES_FEW; i < c->lines.count; i++) {
        if (!line_lets_in(c, i)) return false;
    }
    return true;
}

static void leave_cell(cutter *c) {
    for (size_t i = 0; i < c->space->cut_edge_count; i++) {
        int32_t vertex = c->space->cut_edges[i].vertex;
        if (vertex >= 0 && (size_t)vertex < c->lines.known_capacity)
            enf_polygon_lines_forget(&c->lines, vertex);
    }
    enf_subdivision_leave(c->space);
}

static void cut_cell(cutter *c, int32_t cell) {
    int crosses = enf_subdivision_crosses(c->space, cell);
    if (crosses < 0) c->failed = true;
    if (crosses <= 0) return;
    bool near = c->lines.wanted || c->lines.count > ENF_LINES_FEW;
    if (near && !lines_let_in(c)) {
        leave_cell(c);
        return;
    }
    int32_t node = enf_subdivision_cut(c->space, cell);
    if (node < 0) {
        c->failed = true;
    } else {
        add_hit(c, -1 - node);
    }
}

// ---------------------------------------------------------------------------------------------- one
// tetrahedron

/// The sides of a plane on which the polygon's corners lie: 1 some behind, 2 some in front.
static int corner_sides(const cutter *c, int32_t plane) {
    int sides = 0;
    for (int32_t i = 0; i < c->lines.count && sides != 3; i++) {
        int side = enf_geometry_side(&c->space->geometry, c->lines.corners[i], plane);
        sides |= side < 0 ? 1 : side > 0 ? 2 : 0;
    }
    return sides;
}

/// Down the tree of cuts to the cells that the polygon may enter.
static void cut_tetrahedron(cutter *c, int32_t t) {
    enf_subdivision *space = c->space;
    size_t depth = 0;
    if (!enf_array_reserve(c->refs, c->ref_capacity, 1)) c->failed = true;
    if (!c->failed) c->refs[depth++] = space->tetrahedron_root[t];
    while (depth > 0 && !c->failed) {
        int32_t ref = c->refs[--depth];
        if (ref < 0) {
            cut_cell(c, -1 - ref);
            continue;
        }
        int32_t plane = space->node_plane[ref];
        int sides = plane == space->plane ? 0 : corner_sides(c, plane);
        if (sides == 0) add_hit(c, -1 - ref);
        if (!enf_array_reserve(c->refs, c->ref_capacity, depth + 2)) {
            c->failed = true;
            return;
        }
        for (int k = 1; k >= 0; k--) {
            if (sides & (1 << k)) c->refs[depth++] = space->node_child[ref][k];
        }
    }
}

// ---------------------------------------------------------------------------------------------- all of them

/// Tetrahedra that will be cut are joined first where that makes a convex cell: a polygon then cuts one cell,
/// not several. Returns the cell that each tetrahedron is in.
static int32_t *join_tetrahedra(cutter *c, const enf_candidates *candidates) {
    enf_arrangement *arrangement = c->arrangement;
    size_t count = (size_t)arrangement->tets.count;
    int32_t *into = enf_array_new(count, sizeof *into);
    uint8_t *may = enf_array_new(count, sizeof *may),
            *covered = enf_array_zeroed(c->space->facet_count, sizeof *covered);
    if (into && may && covered) {
        for (size_t t = 0; t < count; t++) {
            into[t] = (int32_t)t;
            may[t] = candidates->offset[t] < candidates->offset[t + 1];
        }
        for (size_t i = 0; i < arrangement->hit_count; i++) covered[arrangement->hits[i].source] = 1;
        arrangement->reflex = enf_tetrahedra_reflex(&arrangement->tets, arrangement->geometry.points, may);
    }
    if (arrangement->reflex) {
        enf_subdivision_join(c->space, covered, may, arrangement->reflex, into);
    } else {
        c->failed = true;
    }
    free(may);
    free(covered);
    return into;
}

static int compare_ranks(const void *a, const void *b) {
    const enf_candidate *x = a, *y = b;
    return (x->rank > y->rank) - (x->rank < y->rank);
}

/// The candidates of the tetrahedra in a cell, each once. `next` lists them, from the one that gave the cell
/// its number.
static size_t gather(cutter *c, const enf_candidates *candidates, const int32_t *next, int32_t first) {
    size_t count = 0, kept = 0, members = 0;
    for (int32_t t = first; t >= 0; t = next[t]) {
        size_t more = (size_t)(candidates->offset[t + 1] - candidates->offset[t]);
        if (!enf_array_reserve(c->candidates, c->candidate_capacity, count + more)) {
            c->failed = true;
            return 0;
        }
        memcpy(c->candidates + count, candidates->candidates + candidates->offset[t],
               more * sizeof *c->candidates);
        count += more;
        members++;
    }
    if (members == 1) return count;
    qsort(c->candidates, count, sizeof *c->candidates, compare_ranks);
    for (size_t i = 0, end; i < count; i = end) {
        enf_candidate one = c->candidates[i];
        for (end = i + 1; end < count && c->candidates[end].rank == one.rank; end++)
            one.lines |= c->candidates[end].lines;
        if (end - i < members)
            one.lines = UINT32_MAX; // nothing is known of the tetrahedra that it stays out of
        c->candidates[kept++] = one;
    }
    return kept;
}

enum { WATCH_EVERY = 512 };

/// The watch sees one stage where there are two.
typedef struct half_watch {
    const enf_crew *crew;
    double begun, share;
} half_watch;

static bool watch_half(void *user, double fraction) {
    const half_watch *half = user;
    return !half->crew->watch || half->crew->watch(half->crew->user, half->begun + half->share * fraction);
}

/// All tetrahedra in turn; false if stopped.
static bool cut_all(cutter *c, const enf_candidates *candidates, const enf_crew *crew) {
    int32_t count = c->arrangement->tets.count;
    int32_t *into = join_tetrahedra(c, candidates), *next = enf_array_new((size_t)count, sizeof *next);
    if (!next) c->failed = true;
    for (int32_t t = 0; !c->failed && t < count; t++) next[t] = -1;
    for (int32_t t = count - 1; !c->failed && t >= 0; t--) {
        if (into[t] == t) continue;
        next[t] = next[into[t]];
        next[into[t]] = t;
        c->joined++;
    }
    bool stopped = false;
    for (int32_t t = 0; t < count && !c->failed && !stopped; t++) {
        stopped = t % WATCH_EVERY == 0 && crew->watch && !crew->watch(crew->user, (double)t / (double)count);
        if (into[t] != t) continue;
        size_t polygons = gather(c, candidates, next, t);
        c->space->plane = -1;
        for (size_t i = 0; i < polygons && !c->failed; i++) {
            int32_t polygon = candidates->order[c->candidates[i].rank];
            int32_t plane = c->arrangement->polygon_plane[polygon];
            if (plane != c->space->plane) enf_subdivision_take_plane(c->space, plane);
            enf_polygon_lines_take(&c->lines, c->arrangement, polygon, c->candidates[i].lines);
            cut_tetrahedron(c, t);
        }
    }
    for (int32_t t = 0; t < count && !c->failed; t++)
        c->space->tetrahedron_root[t] = c->space->tetrahedron_root[into[t]];
    free(into);
    free(next);
    return !stopped;
}

enf_status enf_complex_split(enf_complex *complex, enf_arrangement *arrangement, const enf_crew *crew,
                             enf_error *error) {
    memset(complex, 0, sizeof *complex);
    cutter c = {.arrangement = arrangement, .space = &arrangement->subdivision};
    enf_candidates candidates;
    half_watch half = {.crew = crew, .share = 0.3};
    enf_crew watched = {.threads = crew->threads, .watch = watch_half, .user = &half};
    bool stopped, good = enf_candidates_find(&candidates, arrangement, &watched, &stopped);
    half = (half_watch){.crew = crew, .begun = 0.3, .share = 0.7};
    good = good && enf_subdivision_start(c.space, &arrangement->geometry, &arrangement->tets,
                                         (size_t)candidates.offset[arrangement->tets.count]);
    if (good) stopped = !cut_all(&c, &candidates, &watched);
    good = good && !c.failed;
    enf_candidates_free(&candidates);
    free(c.refs);
    free(c.candidates);
    enf_polygon_lines_free(&c.lines);
    if (stopped) return enf_fail(error, ENF_NO_RESOURCES, "cancelled");
    if (!good) return enf_fail_memory(error, "the fine cells");
    complex->tetrahedron_count = arrangement->tets.count;
    complex->cell_count = (int32_t)c.space->cell_count;
    complex->cells_joined = c.joined;
    for (int32_t t = 0; t < complex->tetrahedron_count; t++)
        complex->tetrahedra_cut += c.space->tetrahedron_root[t] >= 0;
    return ENF_OK;
}
