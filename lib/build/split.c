// SPDX-License-Identifier: GPL-3.0-or-later
// The split of the thesis (4.2.1) done exactly: each polygon cuts the cells that it really enters, and only
// those, by its plane; what is left of a tetrahedron is a small BSP tree (Fuchs, Kedem and Naylor 1980).
//
// Polygons go plane by plane, so that a vertex is held against each plane once. Most polygons of a finely drawn
// world are facets of the triangulation already, or tiled by a few: these are looked up. Others are flooded: the
// tetrahedra that a polygon touches are connected through their facets, so a walk that starts at one of its
// corners and enters every neighbour that may touch it meets them all, in time proportional to what it meets.
// Inside a tetrahedron the tree leads to the cells; whether the polygon's inside meets a cell's is decided in the
// plane, by the separating axis theorem for two convex polygons.
#include "build/split.h"

#include "base/array.h"
#include "base/exact.h"
#include "build/polygon_lines.h"

#include <stdlib.h>
#include <string.h>

typedef struct cutter {
    enf_arrangement *arrangement;
    enf_subdivision *space;
    enf_polygon_lines lines;
    int32_t plane;  ///< of the polygon
    int32_t *stamp; ///< per tetrahedron: the last polygon + 1 that looked at it
    int32_t *stack; ///< tetrahedra
    size_t stack_capacity;
    int32_t *refs; ///< of the tree: nodes and cells
    size_t ref_capacity;
    bool failed; ///< out of memory
} cutter;

static void add_hit(cutter *c, int32_t source) {
    enf_arrangement *arrangement = c->arrangement;
    if (!enf_array_reserve(arrangement->hits, arrangement->hit_capacity, arrangement->hit_count + 1)) {
        c->failed = true;
        return;
    }
    arrangement->hits[arrangement->hit_count++] = (enf_hit){c->lines.polygon, source};
}

// ---------------------------------------------------------------------------------------------- one cell

/// Does the polygon's inside meet the part of its plane that is in the cell, as far as the polygon's edges tell?
static bool lines_let_in(cutter *c) {
    enf_subdivision *space = c->space;
    enf_geometry *geometry = &space->geometry;
    size_t vertices = (size_t)geometry->point_count + (size_t)geometry->crossing_count + space->cut_edge_count;
    if (!enf_polygon_lines_reserve(&c->lines, vertices)) {
        c->failed = true;
        return false;
    }
    for (int32_t i = 0; i < c->lines.count; i++) {
        bool inside = false;
        for (size_t k = 0; k < space->cut_edge_count && !inside; k++) {
            const enf_cut_edge *cut = &space->cut_edges[k];
            int from = enf_polygon_lines_side(&c->lines, geometry, cut->from, i),
                to = enf_polygon_lines_side(&c->lines, geometry, cut->to, i);
            if (from >= 0 && to >= 0) continue;
            inside = true;
            if (from <= 0 && to <= 0) continue;
            int32_t vertex = enf_subdivision_cut_vertex(space, k);
            if (vertex < 0) {
                c->failed = true;
                return false;
            }
            inside = enf_polygon_lines_side(&c->lines, geometry, vertex, i) < 0;
        }
        for (size_t k = 0; k < space->share_count && !inside; k++) { // corners on the plane
            int32_t first = space->facets[space->shares[k]].first, h = first;
            do {
                int32_t vertex = space->halves[h].vertex;
                inside = (space->vertex_sign[vertex] & 3) == 1 &&
                         enf_polygon_lines_side(&c->lines, geometry, vertex, i) < 0;
                h = space->halves[h].next;
            } while (h != first && !inside);
        }
        if (!inside) return false;
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

/// Is a facet of the tetrahedron between it and the polygon?
static bool facet_separates(const cutter *c, int32_t t) {
    const enf_tet_mesh *tets = &c->arrangement->tets;
    const double *points = c->space->geometry.points;
    for (int k = 0; k < 4; k++) {
        int32_t facet = tets->facets[t][k];
        const int32_t *corner = tets->facet_corners[facet];
        int inner = tets->facet_sides[facet][1] == t ? 1 : -1;
        bool outside = true;
        for (int32_t i = 0; i < c->lines.count && outside; i++) {
            int32_t point = c->lines.corners[i];
            if (point == corner[0] || point == corner[1] || point == corner[2]) continue;
            outside = enf_points_orient(points + 3 * (size_t)corner[0], points + 3 * (size_t)corner[1],
                                        points + 3 * (size_t)corner[2], points + 3 * (size_t)point) != inner;
        }
        if (outside) return true;
    }
    return false;
}

static void cut_cell(cutter *c, int32_t cell) {
    int crosses = enf_subdivision_crosses(c->space, cell);
    if (crosses < 0) c->failed = true;
    if (crosses <= 0) return;
    if (!lines_let_in(c)) {
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

// ---------------------------------------------------------------------------------------------- one tetrahedron

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
    if (facet_separates(c, t)) return;
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
        int sides = plane == c->plane ? 0 : corner_sides(c, plane);
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

// ---------------------------------------------------------------------------------------------- one polygon

typedef enum contact {
    APART,   ///< the polygon's inside stays away
    TOUCHES, ///< it may meet the tetrahedron's boundary, not its inside
    COVERS,  ///< it may cover a facet
    ACROSS,  ///< it may go through
} contact;

/// How the polygon's inside meets a tetrahedron. `sign` receives the sides of its plane on which the corners
/// lie.
static contact meets(cutter *c, const int32_t corner[4], int sign[4]) {
    int behind = 0, front = 0;
    for (int k = 0; k < 4; k++) {
        sign[k] = enf_subdivision_sign(c->space, corner[k]);
        behind += sign[k] < 0;
        front += sign[k] > 0;
    }
    if (behind == 4 || front == 4) return APART;
    bool across = behind && front;
    // Some part of the tetrahedron that is in the plane must be inside each of the polygon's lines.
    for (int32_t i = 0; i < c->lines.count; i++) {
        bool inside = false;
        for (int k = 0; k < 4 && !inside; k++) {
            inside = (across || sign[k] == 0) &&
                     enf_polygon_lines_side(&c->lines, &c->space->geometry, corner[k], i) < 0;
        }
        if (!inside) return APART;
    }
    return across ? ACROSS : behind + front == 1 ? COVERS : TOUCHES;
}

static bool has_corner(const int32_t corner[4], int32_t point) {
    return corner[0] == point || corner[1] == point || corner[2] == point || corner[3] == point;
}

/// The tetrahedra that a polygon's inside meets are connected through facets, and some of them are around its
/// first corner.
static void flood(cutter *c) {
    const enf_tet_mesh *tets = &c->arrangement->tets;
    const int32_t mark = c->lines.polygon + 1, corner = c->lines.corners[0];
    size_t depth = 0;
    if (!enf_array_reserve(c->stack, c->stack_capacity, 1)) c->failed = true;
    if (c->failed) return;
    c->stack[depth++] = tets->point_tetrahedron[corner];
    c->stamp[c->stack[0]] = mark;
    while (depth > 0 && !c->failed) {
        int32_t t = c->stack[--depth];
        int sign[4];
        contact how = meets(c, tets->corners[t], sign);
        if (how == ACROSS) cut_tetrahedron(c, t);
        if (how == COVERS) {
            int k = 0;
            while (sign[k] == 0) k++;
            const int32_t facet = tets->facets[t][k], *sides = tets->facet_sides[facet];
            if (sides[0] == t || sides[0] < 0) add_hit(c, facet);
        }
        if (how == APART && !has_corner(tets->corners[t], corner)) continue;
        if (!enf_array_reserve(c->stack, c->stack_capacity, depth + 4)) {
            c->failed = true;
            return;
        }
        for (int k = 0; k < 4; k++) {
            int one = sign[(k + 1) & 3], two = sign[(k + 2) & 3], three = sign[(k + 3) & 3];
            if (one != 0 && one == two && two == three) continue; // the facet is off the plane
            const int32_t *sides = tets->facet_sides[tets->facets[t][k]];
            int32_t next = sides[0] == t ? sides[1] : sides[0];
            if (next < 0 || c->stamp[next] == mark) continue;
            c->stamp[next] = mark;
            c->stack[depth++] = next;
        }
    }
}

enum { FACETED_CORNERS_MAX = 16 }; ///< polygons with more are flooded at once

/// The facets that tile the polygon, where the triangulation carries it already: facets do not overlap, so
/// there is at most one way to triangulate it with them, and the facet at each edge is found by trying all
/// apexes. Returns their number (corners - 2), or 0 if they do not tile it.
static int tiling_facets(const enf_tet_mesh *tets, const int32_t *corner, int corners, int32_t *facets) {
    int count = 0;
    if (corners > FACETED_CORNERS_MAX) return 0;
    struct {
        int first, last;
    } stack[FACETED_CORNERS_MAX] = {{0, corners - 1}}; // chains of corners still to be closed by a facet
    for (int depth = 1; depth > 0;) {
        int first = stack[--depth].first, last = stack[depth].last, apex = first + 1;
        int32_t facet = -1;
        for (; apex < last; apex++) {
            facet = enf_tet_mesh_facet(tets, corner[first], corner[apex], corner[last]);
            if (facet >= 0) break;
        }
        if (facet < 0) return 0;
        facets[count++] = facet;
        if (apex > first + 1) {
            stack[depth].first = first;
            stack[depth++].last = apex;
        }
        if (last > apex + 1) {
            stack[depth].first = apex;
            stack[depth++].last = last;
        }
    }
    return count;
}

static void take_polygon(cutter *c, int32_t polygon) {
    int32_t facets[FACETED_CORNERS_MAX];
    const enf_geometry *geometry = &c->space->geometry;
    size_t vertices = (size_t)geometry->point_count + (size_t)geometry->crossing_count;
    if (!enf_polygon_lines_reserve(&c->lines, vertices) ||
        !enf_polygon_lines_take(&c->lines, c->arrangement, polygon)) {
        c->failed = true;
        return;
    }
    int tiling = tiling_facets(&c->arrangement->tets, c->lines.corners, c->lines.count, facets);
    for (int i = 0; i < tiling; i++) add_hit(c, facets[i]); // it crosses nothing
    if (tiling == 0) flood(c);
}

// ---------------------------------------------------------------------------------------------- all of them

/// Polygons sorted by plane (free() it), or null without memory.
static int32_t *sort_by_plane(const enf_arrangement *arrangement) {
    size_t count = arrangement->mesh->polygon_count;
    int32_t first = arrangement->tets.facet_count;
    size_t planes = (size_t)(arrangement->edge_plane_first - first);
    int32_t *order = enf_array_new(count, sizeof *order), *next = enf_array_zeroed(planes + 1, sizeof *next);
    if (!order || !next) {
        free(order);
        free(next);
        return NULL;
    }
    for (size_t p = 0; p < count; p++) next[arrangement->polygon_plane[p] - first + 1]++;
    for (size_t i = 0; i < planes; i++) next[i + 1] += next[i];
    for (size_t p = 0; p < count; p++) order[next[arrangement->polygon_plane[p] - first]++] = (int32_t)p;
    free(next);
    return order;
}

enum { WATCH_EVERY = 4096 };

/// All polygons in turn; false if stopped.
static bool take_polygons(cutter *c, const int32_t *order, const enf_crew *crew) {
    size_t count = c->arrangement->mesh->polygon_count;
    for (size_t i = 0; i < count && !c->failed; i++) {
        if (i % WATCH_EVERY == 0 && crew->watch && !crew->watch(crew->user, (double)i / (double)count))
            return false;
        int32_t plane = c->arrangement->polygon_plane[order[i]];
        if (plane != c->plane) enf_subdivision_take_plane(c->space, c->plane = plane);
        take_polygon(c, order[i]);
    }
    return true;
}

enf_status enf_complex_split(enf_complex *complex, enf_arrangement *arrangement, const enf_crew *crew,
                             enf_error *error) {
    memset(complex, 0, sizeof *complex);
    cutter c = {.arrangement = arrangement, .space = &arrangement->subdivision, .plane = -1};
    int32_t *order = sort_by_plane(arrangement);
    c.stamp = enf_array_zeroed((size_t)arrangement->tets.count, sizeof *c.stamp);
    bool good = order && c.stamp &&
                enf_subdivision_start(c.space, &arrangement->geometry, &arrangement->tets);
    bool stopped = good && !take_polygons(&c, order, crew);
    good = good && !c.failed;
    free(order);
    free(c.stamp);
    free(c.stack);
    free(c.refs);
    enf_polygon_lines_free(&c.lines);
    if (stopped) return enf_fail(error, ENF_NO_RESOURCES, "cancelled");
    if (!good) return enf_fail_memory(error, "the fine cells");
    complex->tetrahedron_count = arrangement->tets.count;
    complex->cell_count = (int32_t)c.space->cell_count;
    for (int32_t t = 0; t < complex->tetrahedron_count; t++)
        complex->tetrahedra_cut += c.space->tetrahedron_root[t] >= 0;
    return ENF_OK;
}
