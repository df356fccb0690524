// SPDX-License-Identifier: GPL-3.0-or-later
// Clean and tetrahedralize: polygons that are flat and convex, and tetrahedra that tile the convex hull.
#include "build/check_rows.h"

#include "base/array.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

__extension__ typedef __int128 wide;

// ---------------------------------------------------------------------------------------------- clean

static bool turns_right(enf_checker *checker, const int32_t *corners, int64_t count, int axis, int sign) {
    enf_check_exact *exact = &checker->exact;
    for (int64_t i = 0; i < count; i++) {
        if (enf_check_turn(exact, axis, corners[i], corners[(i + 1) % count], corners[(i + 2) % count]) !=
            sign)
            return false;
    }
    for (int64_t i = 2; i + 1 < count; i++) {
        if (enf_check_turn(exact, axis, corners[0], corners[i], corners[i + 1]) != sign ||
            enf_check_turn(exact, axis, corners[0], corners[1], corners[i + 1]) != sign)
            return false;
    }
    return true;
}

static const char *polygon_fault(enf_checker *checker, int32_t polygon) {
    const enf_file_view *view = checker->view;
    const int32_t *span = view->mesh_polygon_plane[polygon];
    int64_t first = view->mesh_polygon_corner[polygon],
            count = view->mesh_polygon_corner[polygon + 1] - first;
    if (count < 3) return "has fewer than three corners";
    int axis = 0, sign = 0;
    for (int i = 0; i < 3 && sign == 0; i++) {
        axis = i;
        sign = enf_check_normal_sign(&checker->exact, span, i);
    }
    if (sign == 0) return "has a plane whose points do not span it";
    int found = 0;
    for (int64_t i = 0; i < count; i++) {
        int32_t corner = view->mesh_corners[first + i];
        if (enf_check_orient(&checker->exact, span[0], span[1], span[2], corner) != 0) return "is not flat";
        found += corner == span[0] || corner == span[1] || corner == span[2];
    }
    if (found != 3) return "has a plane through points that are not its corners";
    return turns_right(checker, view->mesh_corners + first, count, axis, sign) ? NULL
                                                                               : "is not strictly convex";
}

static void check_polygons(enf_checker *checker) {
    enf_check_begin(checker, "clean: polygons", "every clean polygon is exactly flat and strictly convex");
    for (int32_t p = 0; p < checker->view->mesh_polygon_count; p++, checker->row->tested++) {
        const char *fault = polygon_fault(checker, p);
        if (fault) {
            enf_check_break(checker, "clean polygon %d %s", (int)p, fault);
            return;
        }
    }
}

/// Kept, drawn as detail, or rejected. One input polygon may be both (a part of it is kept), and lines that
/// made no polygon are listed as rejected too, so the sum may be larger than the number of polygons, never
/// smaller.
static void check_accounts(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    const enf_file_provenance *from = view->provenance;
    enf_check_begin(checker, "clean: accounting",
                    "every input polygon was kept, is detail, or was rejected with a reason");
    if (from->input_polygons < 0 || from->input_polygons > INT32_MAX || from->input_rejected < 0) {
        enf_check_break(checker, "the number of input polygons or rejections makes no sense");
        return;
    }
    uint8_t *known = enf_array_zeroed((size_t)from->input_polygons, 1);
    if (!known) {
        enf_check_no_memory(checker);
        return;
    }
    for (int32_t p = 0; p < view->mesh_polygon_count; p++) known[view->mesh_polygon_source[p]] = 1;
    for (int32_t t = 0; t < view->triangle_count; t++) {
        const enf_file_triangle *triangle = &view->triangles[t];
        known[triangle->polygon] = 1;
        if (triangle->mesh_polygon >= 0 &&
            view->mesh_polygon_source[triangle->mesh_polygon] != triangle->polygon)
            enf_check_break(checker,
                            "triangle %d names input polygon %d, but its clean polygon %d comes from %d",
                            (int)t, (int)triangle->polygon, (int)triangle->mesh_polygon,
                            (int)view->mesh_polygon_source[triangle->mesh_polygon]);
    }
    int64_t accounted = from->input_rejected;
    for (int64_t p = 0; p < from->input_polygons; p++) accounted += known[p];
    free(known);
    checker->row->tested = (uint64_t)from->input_polygons;
    if (accounted < from->input_polygons && view->has_geometry)
        enf_check_break(checker, "%lld of %lld input polygons are neither kept nor detail nor rejected",
                        (long long)(from->input_polygons - accounted), (long long)from->input_polygons);
}

void enf_check_clean(enf_checker *checker) {
    check_polygons(checker);
    check_accounts(checker);
}

// ---------------------------------------------------------------------------------------------- tetrahedra

typedef struct side {
    int32_t corner[3]; ///< ascending
    int32_t tetrahedron;
    int8_t opposite;
    int8_t front; ///< 1: the tetrahedron lies where the ascending corners turn counter-clockwise
} side;

static side make_side(const enf_file_view *view, int32_t t, int k) {
    side made = {.tetrahedron = t, .opposite = (int8_t)k};
    int odd = (3 - k) & 1;
    for (int i = 0, n = 0; i < 4; i++) {
        if (i != k) made.corner[n++] = view->tetrahedra[t][i];
    }
    for (int pass = 0; pass < 3; pass++) {
        int i = pass & 1;
        if (made.corner[i] <= made.corner[i + 1]) continue;
        int32_t swap = made.corner[i];
        made.corner[i] = made.corner[i + 1];
        made.corner[i + 1] = swap;
        odd ^= 1;
    }
    made.front = (int8_t)!odd;
    return made;
}

static int compare_sides(const void *a, const void *b) {
    const side *x = a, *y = b;
    for (int i = 0; i < 3; i++) {
        if (x->corner[i] != y->corner[i]) return x->corner[i] < y->corner[i] ? -1 : 1;
    }
    return (x->tetrahedron > y->tetrahedron) - (x->tetrahedron < y->tetrahedron);
}

static void check_orientation(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    enf_check_begin(checker, "tetrahedralize: orientation", "every tetrahedron has a positive volume");
    for (int32_t t = 0; t < view->tetrahedron_count; t++, checker->row->tested++) {
        const int32_t *c = view->tetrahedra[t];
        if (enf_check_orient(&checker->exact, c[0], c[1], c[2], c[3]) > 0) continue;
        enf_check_break(checker, "tetrahedron %d is flat or inside out", (int)t);
        return;
    }
}

static bool paired(enf_checker *checker, const side *a, const side *b) {
    const enf_file_view *view = checker->view;
    if (a->front == b->front)
        return enf_check_break(checker,
                               "tetrahedra %d and %d overlap: they lie on the same side of a shared face",
                               (int)a->tetrahedron, (int)b->tetrahedron);
    if (view->tetrahedron_next[a->tetrahedron][(int)a->opposite] != b->tetrahedron ||
        view->tetrahedron_next[b->tetrahedron][(int)b->opposite] != a->tetrahedron)
        return enf_check_break(checker, "tetrahedra %d and %d share a face, but are not listed as neighbours",
                               (int)a->tetrahedron, (int)b->tetrahedron);
    return true;
}

/// Pairs equal sides; those without a partner move to the front. Returns how many.
static size_t pair_sides(enf_checker *checker, side *sides, size_t count) {
    enf_check_begin(checker, "tetrahedralize: faces",
                    "every face is shared by two tetrahedra on opposite sides, or on the hull");
    checker->row->tested = count;
    size_t hull = 0;
    for (size_t i = 0; i < count && enf_check_holds(checker);) {
        size_t end = i + 1;
        while (end < count && memcmp(sides[end].corner, sides[i].corner, sizeof sides[i].corner) == 0) end++;
        if (end - i > 2) {
            enf_check_break(checker, "tetrahedra %d, %d and %d share one face", (int)sides[i].tetrahedron,
                            (int)sides[i + 1].tetrahedron, (int)sides[i + 2].tetrahedron);
        } else if (end - i == 2) {
            paired(checker, &sides[i], &sides[i + 1]);
        } else if (checker->view->tetrahedron_next[sides[i].tetrahedron][(int)sides[i].opposite] >= 0) {
            enf_check_break(
                checker, "tetrahedron %d lists a neighbour that does not share the face opposite corner %d",
                (int)sides[i].tetrahedron, (int)sides[i].opposite);
        } else {
            sides[hull++] = sides[i];
        }
        i = end;
    }
    return hull;
}

// ---------------------------------------------------------------------------------------------- the hull

enum { HULL_WORK_MAX = 50000000 }; ///< facets times vertices that are compared one by one

typedef struct hull_edge {
    int32_t low, high;
    int32_t facet;
    int32_t far; ///< the facet's third corner
    bool up;     ///< seen from outside it runs from low to high
} hull_edge;

static int compare_hull_edges(const void *a, const void *b) {
    const hull_edge *x = a, *y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    if (x->high != y->high) return x->high < y->high ? -1 : 1;
    return (x->facet > y->facet) - (x->facet < y->facet);
}

/// The corners of a hull facet, counter-clockwise seen from outside.
static void outward(const side *facet, int32_t corner[3]) {
    corner[0] = facet->corner[0];
    corner[1] = facet->corner[facet->front ? 2 : 1];
    corner[2] = facet->corner[facet->front ? 1 : 2];
}

/// Every edge of the hull has two facets, one on each side, and neither's far corner is in front of the
/// other.
static bool hull_is_closed(enf_checker *checker, const side *hull, size_t count) {
    hull_edge *edges = enf_array_new(3 * count, sizeof *edges);
    if (!edges) return enf_check_no_memory(checker);
    for (size_t f = 0; f < count; f++) {
        int32_t corner[3];
        outward(&hull[f], corner);
        for (int i = 0; i < 3; i++) {
            int32_t a = corner[i], b = corner[(i + 1) % 3];
            edges[3 * f + (size_t)i] =
                (hull_edge){a < b ? a : b, a < b ? b : a, (int32_t)f, corner[(i + 2) % 3], a < b};
        }
    }
    qsort(edges, 3 * count, sizeof *edges, compare_hull_edges);
    for (size_t i = 0; i < 3 * count && enf_check_holds(checker); i += 2) {
        const hull_edge *one = &edges[i], *two = one + 1;
        int32_t corner[3];
        if (i + 1 == 3 * count || one->low != two->low || one->high != two->high || one->up == two->up) {
            enf_check_break(checker, "the hull is not closed at the edge of points %d and %d", (int)one->low,
                            (int)one->high);
            break;
        }
        outward(&hull[one->facet], corner);
        if (enf_check_orient(&checker->exact, corner[0], corner[1], corner[2], two->far) > 0)
            enf_check_break(checker, "the hull is not convex at the edge of points %d and %d", (int)one->low,
                            (int)one->high);
    }
    free(edges);
    return enf_check_holds(checker);
}

/// No vertex of the hull is in front of a facet of the hull: so every facet lies on the boundary of the hull
/// of all.
static bool nothing_in_front(enf_checker *checker, const side *hull, size_t count) {
    const enf_file_view *view = checker->view;
    uint8_t *on_hull = enf_array_zeroed((size_t)view->point_count, 1);
    if (!on_hull) return enf_check_no_memory(checker);
    uint64_t points = 0;
    for (size_t f = 0; f < count; f++) {
        for (int i = 0; i < 3; i++) {
            points += !on_hull[hull[f].corner[i]];
            on_hull[hull[f].corner[i]] = 1;
        }
    }
    for (size_t f = 0; f < count && points * count <= HULL_WORK_MAX && enf_check_holds(checker); f++) {
        int32_t corner[3];
        outward(&hull[f], corner);
        for (int32_t p = 0; p < view->point_count; p++) {
            if (!on_hull[p] || enf_check_orient(&checker->exact, corner[0], corner[1], corner[2], p) <= 0)
                continue;
            enf_check_break(checker, "point %d lies in front of the hull's face %d %d %d", (int)p,
                            (int)corner[0], (int)corner[1], (int)corner[2]);
            break;
        }
    }
    free(on_hull);
    return enf_check_holds(checker);
}

/// Is the middle of triangle a inside triangle b of the same plane? Three times the middle is whole.
static bool middle_inside(const enf_file_view *view, const int32_t a[3], const int32_t b[3], int axis) {
    int u = (axis + 1) % 3, v = (axis + 2) % 3, first = 0;
    for (int i = 0; i < 3; i++) {
        const double *p = view->points[b[i]], *q = view->points[b[(i + 1) % 3]];
        int64_t middle[2] = {0, 0};
        for (int k = 0; k < 3; k++) {
            middle[0] += (int64_t)view->points[a[k]][u];
            middle[1] += (int64_t)view->points[a[k]][v];
        }
        wide turn = (wide)((int64_t)q[u] - (int64_t)p[u]) * (middle[1] - 3 * (int64_t)p[v]) -
                    (wide)((int64_t)q[v] - (int64_t)p[v]) * (middle[0] - 3 * (int64_t)p[u]);
        int sign = (turn > 0) - (turn < 0);
        if (i == 0) first = sign;
        if (sign == 0 || sign != first) return false;
    }
    return true;
}

/// A closed surface on the boundary of a convex body covers every part of it equally often: once, if it
/// covers the middle of one facet once.
static bool covered_once(enf_checker *checker, const side *hull, size_t count) {
    const int32_t *a = hull[0].corner;
    int axis = 0;
    while (axis < 2 && enf_check_normal_sign(&checker->exact, a, axis) == 0) axis++;
    for (size_t f = 1; f < count; f++) {
        bool same_plane = true;
        for (int i = 0; i < 3 && same_plane; i++)
            same_plane = enf_check_orient(&checker->exact, a[0], a[1], a[2], hull[f].corner[i]) == 0;
        if (same_plane && middle_inside(checker->view, a, hull[f].corner, axis))
            return enf_check_break(checker, "the hull's faces at tetrahedra %d and %d overlap",
                                   (int)hull[0].tetrahedron, (int)hull[f].tetrahedron);
    }
    return true;
}

static void check_hull(enf_checker *checker, const side *hull, size_t count) {
    enf_check_begin(checker, "tetrahedralize: hull",
                    "the outer faces are the convex hull, once around; so the tetrahedra tile it");
    checker->row->tested = count;
    if (count < 4) {
        enf_check_break(checker, "the hull has only %d faces", (int)count);
        return;
    }
    if (hull_is_closed(checker, hull, count) && nothing_in_front(checker, hull, count))
        covered_once(checker, hull, count);
}

void enf_check_tetrahedra(enf_checker *checker) {
    const enf_file_view *view = checker->view;
    check_orientation(checker);
    size_t count = 4 * (size_t)view->tetrahedron_count;
    side *sides = enf_array_new(count, sizeof *sides);
    if (!sides) {
        enf_check_no_memory(checker);
        return;
    }
    for (size_t i = 0; i < count; i++) sides[i] = make_side(view, (int32_t)(i / 4), (int)(i % 4));
    qsort(sides, count, sizeof *sides, compare_sides);
    size_t hull = pair_sides(checker, sides, count);
    if (enf_check_holds(checker)) check_hull(checker, sides, hull);
    free(sides);
}
