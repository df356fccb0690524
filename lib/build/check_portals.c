// SPDX-License-Identifier: GPL-3.0-or-later
// Portals: pairs that cover exactly what is open between two cells.
#include "build/check_rows.h"

#include "base/array.h"
#include "format/frame.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// How far a rounded coordinate in the world may be off: this part of the world's size (2^53 grid steps).
static const double rounding = 0x1p-48;

static double allowed_error(const enf_file_view *view) {
    return rounding * 0x1p53 * view->frame->step;
}

// ---------------------------------------------------------------------------------------------- pairs

/// The vertices of one polygon are those of the other, the other way round.
static bool turned_over(const enf_file_view *view, const enf_file_portal_polygon *a,
                        const enf_file_portal_polygon *b) {
    if (a->vertex_count != b->vertex_count || a->loop != b->loop) return false;
    int32_t count = a->vertex_count;
    for (int32_t shift = 0; shift < count; shift++) {
        int32_t k = 0;
        while (k < count &&
               memcmp(view->portal_vertices[a->vertex_first + k],
                      view->portal_vertices[b->vertex_first + (2 * count - 1 - k - shift) % count],
                      sizeof *view->portal_vertices) == 0)
            k++;
        if (k == count) return true;
    }
    return false;
}

static bool check_pair(enf_checker *checker, int32_t portal) {
    const enf_file_view *view = checker->view;
    const enf_file_portal *there = &view->portals[portal], *back = &view->portals[portal + 1];
    if (there->from >= there->to || back->from != there->to || back->to != there->from)
        return enf_check_break(checker,
                               "portals %d and %d do not lead to and fro between a lower and a higher cell",
                               (int)portal, (int)portal + 1);
    if (there->polygon_count < 1 || there->polygon_count != back->polygon_count ||
        there->radius != back->radius || memcmp(there->centre, back->centre, sizeof there->centre) != 0)
        return enf_check_break(checker, "portals %d and %d are not the same opening", (int)portal,
                               (int)portal + 1);
    for (int32_t i = 0; i < there->polygon_count; i++) {
        const enf_file_portal_polygon *a = &view->portal_polygons[there->polygon_first + i],
                                      *b = &view->portal_polygons[back->polygon_first + i];
        bool opposite = a->area == b->area;
        for (int k = 0; k < 4; k++) opposite = opposite && a->plane[k] == -b->plane[k];
        if (!opposite || !turned_over(view, a, b))
            return enf_check_break(checker, "polygon %d of portal %d is not that of portal %d turned over",
                                   (int)i, (int)portal, (int)portal + 1);
    }
    return true;
}

static void check_pairs(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "portals: pairs",
                    "portals come in pairs that are the same polygons seen from both sides");
    if (view->portal_count % 2 != 0)
        enf_check_break(checker, "the number of portals, %d, is odd", (int)view->portal_count);
    for (int32_t i = 0; i + 1 < view->portal_count && check_pair(checker, i); i += 2) checker->row->tested++;
}

static void check_lists(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "portals: lists",
                    "every cell lists the portals that lead out of it, all of them, ascending");
    int64_t listed = 0;
    for (int32_t c = 0; c < view->cell_count; c++, checker->row->tested++) {
        const enf_file_cell *cell = &view->cells[c];
        listed += cell->portal_count;
        for (int32_t i = 0; i < cell->portal_count; i++) {
            const int32_t *at = &view->cell_portals[cell->portal_first + i];
            if (view->portals[*at].from == c && (i == 0 || at[-1] < at[0])) continue;
            enf_check_break(checker, "cell %d lists portal %d, which is not its own or out of order", (int)c,
                            (int)*at);
            return;
        }
    }
    if (listed != view->portal_count)
        enf_check_break(checker, "cells list %lld portals of %d", (long long)listed, (int)view->portal_count);
}

// ---------------------------------------------------------------------------------------------- polygons

/// Does vertex k of the polygon lie at corner k of the loop, counted forwards or backwards?
static bool corners_match(const enf_file_view *view, const enf_file_portal_polygon *polygon,
                          const enf_check_loop *loop, bool backwards) {
    double allowed = allowed_error(view);
    for (int32_t k = 0; k < loop->count; k++) {
        double at[3];
        enf_view_to_world(
            view, view->vertex_position[loop->corners[backwards ? loop->count - 1 - k : k].vertex], at);
        for (int i = 0; i < 3; i++) {
            double off = at[i] - view->portal_vertices[polygon->vertex_first + k][i];
            if (!(fabs(off) <= allowed)) return false;
        }
    }
    return true;
}

/// The rounded plane holds the rounded corners and is positive where the polygon's portal comes from.
static bool plane_matches(const enf_checker *checker, const enf_file_portal_polygon *polygon,
                          const enf_check_loop *loop, bool facing_front) {
    const enf_file_view *view = checker->view;
    double allowed = 4 * allowed_error(view), normal[3], dot = 0, length = 0, size = 0;
    int8_t sign = checker->exact.plane_sign[loop->plane];
    enf_view_direction_to_world(view, checker->exact.class_near[checker->exact.plane_class[loop->plane]],
                                normal);
    for (int i = 0; i < 3; i++) {
        dot += normal[i] * polygon->plane[i] * sign;
        length += normal[i] * normal[i];
        size += polygon->plane[i] * polygon->plane[i];
    }
    if (!(fabs(dot - (facing_front ? 1 : -1) * sqrt(length)) <= 1e-9 * sqrt(length)) ||
        !(fabs(size - 1) <= 1e-9))
        return false;
    for (int32_t k = 0; k < polygon->vertex_count; k++) {
        const double *at = view->portal_vertices[polygon->vertex_first + k];
        double height = polygon->plane[0] * at[0] + polygon->plane[1] * at[1] + polygon->plane[2] * at[2] +
                        polygon->plane[3];
        if (!(fabs(height) <= allowed)) return false;
    }
    return true;
}

static bool check_polygon(enf_checker *checker, int32_t polygon_number, int32_t portal, uint8_t *used) {
    const enf_file_view *view = checker->view;
    const enf_file_portal_polygon *polygon = &view->portal_polygons[polygon_number];
    enf_check_loop loop = enf_check_portal_loop(checker, polygon->loop);
    if (used[polygon->loop] & (1 << (portal & 1)))
        return enf_check_break(checker, "portal polygon %d uses exact loop %d, which another one has",
                               (int)polygon_number, (int)polygon->loop);
    used[polygon->loop] |= (uint8_t)(1 << (portal & 1));
    const char *fault = enf_check_loop_fault(&checker->exact, &loop);
    if (fault)
        return enf_check_break(checker, "the exact loop %d of portal %d %s", (int)polygon->loop, (int)portal,
                               fault);
    // Even portals come from the lower cell, which is in front of the plane if the higher one is not.
    bool facing_front = (view->portal_loop_side[polygon->loop] != 0) == (portal & 1);
    bool backwards = facing_front != (view->frame->handedness > 0);
    if (polygon->vertex_count != loop.count || !corners_match(view, polygon, &loop, backwards))
        return enf_check_break(checker,
                               "the corners of portal polygon %d are not those of its exact loop %d, rounded",
                               (int)polygon_number, (int)polygon->loop);
    if (!plane_matches(checker, polygon, &loop, facing_front))
        return enf_check_break(checker, "the plane of portal polygon %d is not that of its corners",
                               (int)polygon_number);
    return true;
}

static void check_polygons(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "portals: polygons",
                    "portal polygons are convex on exact planes; their rounded corners agree");
    uint8_t *used = enf_array_zeroed((size_t)view->portal_loop_count, 1);
    if (!used) {
        enf_check_no_memory(checker);
        return;
    }
    for (int32_t i = 0; i < view->portal_count && enf_check_holds(checker); i++) {
        const enf_file_portal *portal = &view->portals[i];
        for (int32_t p = 0; p < portal->polygon_count; p++, checker->row->tested++) {
            if (!check_polygon(checker, portal->polygon_first + p, i, used)) break;
        }
    }
    for (int32_t l = 0; l < view->portal_loop_count && enf_check_holds(checker); l++) {
        if (used[l] != 3)
            enf_check_break(checker, "exact loop %d is not used by both portals of an opening", (int)l);
    }
    free(used);
}

static void check_spheres(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "portals: spheres", "every portal's sphere holds its corners");
    for (int32_t i = 0; i < view->portal_count; i++, checker->row->tested++) {
        const enf_file_portal *portal = &view->portals[i];
        for (int32_t p = 0; p < portal->polygon_count; p++) {
            const enf_file_portal_polygon *polygon = &view->portal_polygons[portal->polygon_first + p];
            for (int32_t k = 0; k < polygon->vertex_count; k++) {
                const double *at = view->portal_vertices[polygon->vertex_first + k];
                double x = at[0] - portal->centre[0], y = at[1] - portal->centre[1],
                       z = at[2] - portal->centre[2];
                if (sqrt(x * x + y * y + z * z) <= portal->radius * (1 + 0x1p-44)) continue;
                enf_check_break(checker, "a corner of portal %d lies outside its sphere", (int)i);
                return;
            }
        }
    }
}

// ---------------------------------------------------------------------------------------------- openings

/// Open area between two cells, or a portal's; those that can be compared stand together when sorted.
typedef struct area {
    int32_t low, high;   ///< cells
    int32_t plane_class; ///< doubled, plus 1 if the higher cell is in front of the class's plane
    int32_t piece;       ///< >= 0: an open piece; < 0: portal loop -1 - piece
    int32_t facet;
} area;

static int compare_areas(const void *a, const void *b) {
    const area *x = a, *y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    if (x->high != y->high) return x->high < y->high ? -1 : 1;
    if (x->plane_class != y->plane_class) return x->plane_class < y->plane_class ? -1 : 1;
    return (x->piece > y->piece) - (x->piece < y->piece);
}

static int32_t class_and_side(const enf_checker *checker, int32_t plane, bool higher_in_front) {
    bool front = higher_in_front == (checker->exact.plane_sign[plane] > 0);
    return 2 * checker->exact.plane_class[plane] + front;
}

static size_t list_areas(const enf_checker *checker, area *areas) {
    const enf_file_view *view = checker->view;
    size_t count = 0;
    for (int32_t f = 0; f < view->facet_count; f++) {
        for (int32_t p = view->facet_piece[f]; p < view->facet_piece[f + 1]; p++) {
            const int32_t *fine = view->facet_fine[f];
            if (!enf_check_is_open(view, p) || fine[0] < 0 || fine[1] < 0) continue;
            int32_t behind = view->fine_cell[fine[0]], front = view->fine_cell[fine[1]];
            if (behind == front || behind < 0 || front < 0) continue;
            areas[count++] = (area){behind < front ? behind : front, behind < front ? front : behind,
                                    class_and_side(checker, view->facet_plane[f], front > behind), p, f};
        }
    }
    for (int32_t i = 0; i < view->portal_count; i += 2) {
        const enf_file_portal *portal = &view->portals[i];
        for (int32_t p = 0; p < portal->polygon_count; p++) {
            int32_t loop = view->portal_polygons[portal->polygon_first + p].loop;
            areas[count++] = (area){
                portal->from, portal->to,
                class_and_side(checker, view->portal_loop_plane[loop], view->portal_loop_side[loop] != 0),
                -1 - loop, -1};
        }
    }
    return count;
}

/// Adds the outlines of the open pieces, less those of the portal's loops, all turning the same way.
static void add_group(enf_checker *checker, const area *group, size_t count) {
    enf_check_chain_empty(&checker->chain);
    for (size_t i = 0; i < count; i++) {
        enf_check_loop loop = group[i].piece >= 0 ? enf_check_piece(checker, group[i].piece, group[i].facet)
                                                  : enf_check_portal_loop(checker, -1 - group[i].piece);
        int sign;
        enf_check_axis(&checker->exact, loop.plane, &sign);
        enf_check_chain_add_loop(&checker->chain, &checker->exact, &loop, group[i].piece >= 0 ? sign : -sign);
    }
}

/// Polygons whose rounded corners span no area are dropped and counted. What is left open because of them has
/// corners on one line but for rounding: no more area than two grid steps along its outline.
static bool is_sliver(const enf_checker *checker, const enf_check_edge *edges, size_t count) {
    // Slivers may lie far apart: summed exactly, so that what is common to all corners cancels.
    mpq_t sum[3], one, two;
    double length = 0, square = 0;
    mpq_inits(sum[0], sum[1], sum[2], one, two, NULL);
    for (size_t i = 0; i < count; i++) {
        const double *p = checker->exact.near[edges[i].low], *q = checker->exact.near[edges[i].high];
        length += hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]) * abs(edges[i].turns);
        for (int k = 0; k < 3; k++) {
            for (int swap = 0; swap < 2; swap++) {
                mpq_set_d(one, p[(k + 1 + swap) % 3]);
                mpq_set_d(two, q[(k + 2 - swap) % 3]);
                mpq_mul(one, one, two);
                mpq_set_si(two, swap ? -edges[i].turns : edges[i].turns, 1);
                mpq_mul(one, one, two);
                mpq_add(sum[k], sum[k], one);
            }
        }
    }
    for (int k = 0; k < 3; k++) square += mpq_get_d(sum[k]) * mpq_get_d(sum[k]) / 4;
    mpq_clears(sum[0], sum[1], sum[2], one, two, NULL);
    return sqrt(square) * checker->exact.unit <= 2 * length;
}

static void check_openings(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "portals: openings",
                    "the portals between two cells cover exactly what is open between them");
    area *areas =
        enf_array_new((size_t)view->piece_count + (size_t)view->portal_polygon_count, sizeof *areas);
    if (!areas) {
        enf_check_no_memory(checker);
        return;
    }
    size_t count = list_areas(checker, areas), slivers = 0;
    qsort(areas, count, sizeof *areas, compare_areas);
    for (size_t i = 0; i < count && enf_check_holds(checker); checker->row->tested++) {
        size_t end = i + 1;
        while (end < count && areas[end].low == areas[i].low && areas[end].high == areas[i].high &&
               areas[end].plane_class == areas[i].plane_class)
            end++;
        const double *normal = checker->exact.class_near[areas[i].plane_class / 2];
        int axis = fabs(normal[0]) >= fabs(normal[1]) ? 0 : 1;
        if (fabs(normal[2]) > fabs(normal[axis])) axis = 2;
        add_group(checker, areas + i, end - i);
        bool same =
            !checker->chain.failed && enf_check_chain_vanishes(&checker->chain, &checker->exact, axis, NULL);
        if (!same && !checker->chain.failed && view->provenance->slivers > 0) {
            add_group(checker, areas + i, end - i);
            enf_check_chain_reduce(&checker->chain);
            same = is_sliver(checker, checker->chain.edges, checker->chain.count) &&
                   (int64_t)++slivers <= view->provenance->slivers;
        }
        if (checker->chain.failed) enf_check_no_memory(checker);
        if (!same)
            enf_check_break(checker,
                            "the portals between cells %d and %d do not cover what is open between them",
                            (int)areas[i].low, (int)areas[i].high);
        i = end;
    }
    free(areas);
}

void enf_check_portals(enf_checker *checker) {
    check_pairs(checker);
    check_lists(checker);
    check_polygons(checker);
    bool good = enf_check_holds(checker);
    check_spheres(checker);
    if (good) check_openings(checker);
}
