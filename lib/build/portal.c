// SPDX-License-Identifier: GPL-3.0-or-later
// From open pieces to openings: the pieces between two cells are sorted by plane, joined to few convex
// polygons (merge.h), and gathered to openings where they touch.
#include "build/portal.h"

#include "base/array.h"
#include "build/loop.h"
#include "build/merge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/// Rounded coordinates of a crossing are off by less than this many grid steps (geometry.h), so equal
/// vertices differ by less than twice that; used only to choose what is then compared exactly.
#define POSITION_ERROR 2.0

void enf_portals_free(enf_portals *portals) {
    free(portals->opening_cell);
    free(portals->opening_polygon);
    free(portals->opening_centre);
    free(portals->opening_radius);
    enf_loops_free(&portals->polygons);
    free(portals->polygon_plane);
    free(portals->polygon_side);
    free(portals->polygon_area);
    memset(portals, 0, sizeof *portals);
}

/// An open piece between two different cells.
typedef struct gap {
    int32_t low, high; ///< cells
    int32_t piece;
    uint8_t side; ///< 1: the higher cell is in front of the facet's plane
} gap;

static int compare_gaps(const void *a, const void *b) {
    const gap *x = a, *y = b;
    if (x->low != y->low) return x->low < y->low ? -1 : 1;
    if (x->high != y->high) return x->high < y->high ? -1 : 1;
    return (x->piece > y->piece) - (x->piece < y->piece);
}

/// A polygon of the pair at hand: first the pieces themselves, then what they were joined to.
typedef struct sheet {
    enf_loop loop;
    uint64_t bucket;
    int32_t group;   ///< the sheet that began its plane
    int32_t opening; ///< while gathering: union-find parent
    uint8_t side;
} sheet;

typedef struct finder {
    const enf_complex *complex;
    enf_portals *portals;
    enf_pool pool;           ///< its crossings are the complex's vertices, as far as they were needed
    int32_t *pool_vertex;    ///< per crossing of the complex: vertex in the pool, or -1
    int32_t *complex_vertex; ///< per crossing of the pool
    size_t complex_vertex_capacity;
    sheet *sheets;
    size_t sheet_capacity;
    enf_loop *group;
    size_t group_capacity;
    size_t area_capacity, plane_capacity, side_capacity, cell_capacity, polygon_capacity, centre_capacity,
        radius_capacity;
} finder;

// ---------------------------------------------------------------------------------------------- vertices

static int32_t pool_vertex(finder *f, int32_t vertex) {
    enf_geometry *geometry = &f->pool.geometry;
    if (vertex < geometry->point_count) return vertex;
    int32_t *known = &f->pool_vertex[vertex - geometry->point_count];
    if (*known >= 0) return *known;
    const int32_t *planes = f->complex->vertex_planes[vertex];
    *known = enf_geometry_cross(geometry, planes[0], planes[1], planes[2]);
    if (*known < 0 ||
        !enf_array_reserve(f->complex_vertex, f->complex_vertex_capacity, (size_t)geometry->crossing_count)) {
        f->pool.failed = true;
        return 0;
    }
    f->complex_vertex[geometry->crossing_count - 1] = vertex;
    return *known;
}

static int32_t complex_vertex(const finder *f, int32_t vertex) {
    int32_t points = f->pool.geometry.point_count;
    return vertex < points ? vertex : f->complex_vertex[vertex - points];
}

static const double *position(const finder *f, int32_t vertex) {
    return f->complex->vertex_position[complex_vertex(f, vertex)];
}

/// Are two vertices the same point? Exact: a crossing equals a vertex that lies on all its three planes.
static bool same_vertex(finder *f, int32_t a, int32_t b) {
    enf_geometry *geometry = &f->pool.geometry;
    if (a == b) return true;
    if (a < geometry->point_count && b < geometry->point_count) return false;
    if (b < geometry->point_count) {
        int32_t swap = a;
        a = b;
        b = swap;
    }
    const enf_crossing crossing = *enf_geometry_crossing(geometry, b);
    for (int k = 0; k < 3; k++) {
        if (enf_geometry_side(geometry, a, crossing.plane[k]) != 0) return false;
    }
    return true;
}

typedef struct placed {
    double x;
    int32_t vertex, canonical;
} placed;

static int compare_placed(const void *a, const void *b) {
    const placed *p = a, *q = b;
    if (p->x != q->x) return p->x < q->x ? -1 : 1;
    return (p->vertex > q->vertex) - (p->vertex < q->vertex);
}

static int compare_vertices(const void *a, const void *b) {
    const placed *p = a, *q = b;
    return (p->vertex > q->vertex) - (p->vertex < q->vertex);
}

/// Gives every vertex of the sheets' loops the smallest number among the vertices at the same point.
static bool unify_vertices(finder *f, size_t sheet_count) {
    size_t count = 0, kept = 0;
    for (size_t s = 0; s < sheet_count; s++) count += (size_t)f->sheets[s].loop.count;
    placed *all = enf_array_new(count, sizeof *all);
    if (!all) return false;
    count = 0;
    for (size_t s = 0; s < sheet_count; s++) {
        for (int32_t i = 0; i < f->sheets[s].loop.count; i++) {
            int32_t vertex = f->pool.corners[f->sheets[s].loop.first + i].vertex;
            all[count++] = (placed){position(f, vertex)[0], vertex, vertex};
        }
    }
    qsort(all, count, sizeof *all, compare_placed);
    for (size_t i = 0; i < count; i++) {
        if (i == 0 || all[i].vertex != all[kept - 1].vertex) all[kept++] = all[i];
    }
    for (size_t i = 0; i < kept; i++) {
        for (size_t k = i; k-- > 0 && all[i].x - all[k].x <= 2 * POSITION_ERROR;) {
            const double *p = position(f, all[i].vertex), *q = position(f, all[k].vertex);
            if (fabs(p[1] - q[1]) > 2 * POSITION_ERROR || fabs(p[2] - q[2]) > 2 * POSITION_ERROR) continue;
            if (!same_vertex(f, all[i].vertex, all[k].vertex)) continue;
            all[i].canonical = all[k].canonical;
            break;
        }
    }
    qsort(all, kept, sizeof *all, compare_vertices);
    for (size_t s = 0; s < sheet_count; s++) {
        for (int32_t i = 0; i < f->sheets[s].loop.count; i++) {
            enf_corner *corner = &f->pool.corners[f->sheets[s].loop.first + i];
            placed key = {0, corner->vertex, 0};
            const placed *found = bsearch(&key, all, kept, sizeof *all, compare_vertices);
            corner->vertex = found->canonical;
        }
    }
    free(all);
    return true;
}

// ---------------------------------------------------------------------------------------------- planes

static bool loop_on_plane(finder *f, enf_loop loop, int32_t plane) {
    return loop.plane == plane || enf_pool_classify(&f->pool, loop, plane) == ENF_POSITION_ON;
}

typedef struct keyed {
    uint64_t key;
    int32_t sheet;
} keyed;

static int compare_keyed(const void *a, const void *b) {
    const keyed *x = a, *y = b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return (x->sheet > y->sheet) - (x->sheet < y->sheet);
}

/// Puts a sheet into the group of `root` if it lies in the same plane and is entered from the same side,
/// turned to face the same way. (The same plane from the other side is a pocket of one cell in the other; it
/// stays apart.)
static bool joins_group(finder *f, sheet *here, const sheet *root) {
    if (!loop_on_plane(f, here->loop, root->loop.plane)) return false;
    bool turn = here->loop.plane != root->loop.plane &&
                !enf_geometry_same_way(&f->pool.geometry, here->loop.plane, root->loop.plane);
    if ((here->side ^ turn) != root->side) return false;
    if (turn) here->loop = enf_pool_reversed(&f->pool, here->loop);
    here->loop.plane = root->loop.plane;
    here->side = root->side;
    return true;
}

/// Gives every sheet the number of the first sheet of its plane and side. `order` has room for all.
static void group_sheets(finder *f, size_t count, keyed *order) {
    for (size_t s = 0; s < count; s++) order[s] = (keyed){f->sheets[s].bucket, (int32_t)s};
    qsort(order, count, sizeof *order, compare_keyed);
    for (size_t first = 0, s = 0; s < count && !f->pool.failed; s++) {
        if (order[s].key != order[first].key) first = s;
        sheet *here = &f->sheets[order[s].sheet];
        here->group = order[s].sheet;
        for (size_t k = first; k < s; k++) {
            const sheet *root = &f->sheets[order[k].sheet];
            if (root->group != order[k].sheet || !joins_group(f, here, root)) continue;
            here->group = order[k].sheet;
            break;
        }
    }
}

/// Joins each group; the results replace the sheets. Returns how many are left.
static size_t merge_groups(finder *f, size_t count, keyed *order) {
    size_t left = 0;
    if (!enf_array_reserve(f->sheets, f->sheet_capacity, 2 * count) ||
        !enf_array_reserve(f->group, f->group_capacity, count)) {
        f->pool.failed = true;
        return 0;
    }
    for (size_t s = 0; s < count; s++) order[s] = (keyed){(uint64_t)f->sheets[s].group, (int32_t)s};
    qsort(order, count, sizeof *order, compare_keyed);
    for (size_t s = 0, end; s < count && !f->pool.failed; s = end) {
        int32_t members = 0;
        for (end = s; end < count && order[end].key == order[s].key; end++) {
            f->group[members++] = f->sheets[order[end].sheet].loop;
        }
        uint8_t side = f->sheets[order[s].sheet].side;
        int32_t merged = enf_pool_merge(&f->pool, f->group, members);
        // The results wait behind the sheets that are still to be read.
        for (int32_t m = 0; m < merged; m++)
            f->sheets[count + left++] = (sheet){.loop = f->group[m], .side = side};
    }
    if (!f->pool.failed) memmove(f->sheets, f->sheets + count, left * sizeof *f->sheets);
    return left;
}

// ---------------------------------------------------------------------------------------------- openings

typedef struct bounds {
    double low[3], high[3];
} bounds;

static bounds loop_bounds(const finder *f, enf_loop loop) {
    bounds box = {{HUGE_VAL, HUGE_VAL, HUGE_VAL}, {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
    for (int32_t i = 0; i < loop.count; i++) {
        const double *at = position(f, f->pool.corners[loop.first + i].vertex);
        for (int k = 0; k < 3; k++) {
            box.low[k] = fmin(box.low[k], at[k]);
            box.high[k] = fmax(box.high[k], at[k]);
        }
    }
    return box;
}

static bool bounds_meet(const bounds *a, const bounds *b) {
    for (int k = 0; k < 3; k++) {
        if (a->low[k] > b->high[k] + 2 * POSITION_ERROR || b->low[k] > a->high[k] + 2 * POSITION_ERROR)
            return false;
    }
    return true;
}

/// Does a corner of one lie on the other (closed)? Exact.
static bool corner_on(finder *f, enf_loop one, enf_loop other) {
    for (int32_t i = 0; i < one.count; i++) {
        int32_t vertex = f->pool.corners[one.first + i].vertex;
        if (enf_geometry_side(&f->pool.geometry, vertex, other.plane) != 0) continue;
        int32_t e = 0;
        for (; e < other.count; e++) {
            int side =
                enf_geometry_side(&f->pool.geometry, vertex, f->pool.corners[other.first + e].edge_plane);
            if (side != 0 && side != enf_pool_edge_side(&f->pool, other, e)) break;
        }
        if (e == other.count) return true;
    }
    return false;
}

static int32_t opening_root(sheet *sheets, int32_t s) {
    while (sheets[s].opening != s) {
        sheets[s].opening = sheets[sheets[s].opening].opening;
        s = sheets[s].opening;
    }
    return s;
}

typedef struct boxed {
    bounds box;
    int32_t sheet;
} boxed;

static int compare_boxed(const void *a, const void *b) {
    const boxed *x = a, *y = b;
    if (x->box.low[0] != y->box.low[0]) return x->box.low[0] < y->box.low[0] ? -1 : 1;
    return (x->sheet > y->sheet) - (x->sheet < y->sheet);
}

/// Joins sheets that touch; the smallest number stands for each opening. A sweep along x finds the pairs to
/// look at.
static bool gather_openings(finder *f, size_t count) {
    boxed *boxes = enf_array_new(count, sizeof *boxes);
    if (!boxes) return false;
    for (size_t s = 0; s < count; s++) {
        boxes[s] = (boxed){loop_bounds(f, f->sheets[s].loop), (int32_t)s};
        f->sheets[s].opening = (int32_t)s;
    }
    qsort(boxes, count, sizeof *boxes, compare_boxed);
    for (size_t i = 0; i < count; i++) {
        for (size_t k = i + 1; k < count; k++) {
            if (boxes[k].box.low[0] > boxes[i].box.high[0] + 2 * POSITION_ERROR) break;
            const sheet *one = &f->sheets[boxes[i].sheet], *other = &f->sheets[boxes[k].sheet];
            int32_t a = opening_root(f->sheets, boxes[i].sheet), b = opening_root(f->sheets, boxes[k].sheet);
            if (a == b || !bounds_meet(&boxes[i].box, &boxes[k].box)) continue;
            if (!corner_on(f, one->loop, other->loop) && !corner_on(f, other->loop, one->loop)) continue;
            f->sheets[a > b ? a : b].opening = a < b ? a : b;
        }
    }
    free(boxes);
    return true;
}

// ---------------------------------------------------------------------------------------------- results

static bool add_polygon(finder *f, const sheet *sheet) {
    enf_portals *portals = f->portals;
    size_t count = (size_t)portals->polygons.count + 1;
    if (!enf_array_reserve(portals->polygon_plane, f->plane_capacity, count) ||
        !enf_array_reserve(portals->polygon_side, f->side_capacity, count) ||
        !enf_array_reserve(portals->polygon_area, f->area_capacity, count) ||
        !enf_loops_append(&portals->polygons, f->pool.corners + sheet->loop.first, sheet->loop.count)) {
        return false;
    }
    enf_corner *corners = portals->polygons.corners + portals->polygons.offset[count - 1];
    for (int32_t i = 0; i < sheet->loop.count; i++) corners[i].vertex = complex_vertex(f, corners[i].vertex);
    double area[3];
    enf_loop_area(corners, sheet->loop.count, (const double(*)[3])f->complex->vertex_position, area);
    portals->polygon_area[count - 1] = sqrt(area[0] * area[0] + area[1] * area[1] + area[2] * area[2]);
    portals->polygon_plane[count - 1] = sheet->loop.plane;
    portals->polygon_side[count - 1] = sheet->side;
    if (portals->polygon_area[count - 1] > 0) return true;
    portals->polygons.count--; // nothing of it is left after rounding
    portals->polygons.corner_count -= (size_t)sheet->loop.count;
    portals->slivers++;
    return true;
}

/// The sphere around the middle of the bounding box; the factor covers the rounding of the distances.
static void bound_opening(enf_portals *portals, const enf_complex *complex, int32_t opening) {
    const enf_loops *polygons = &portals->polygons;
    int64_t begin = polygons->offset[portals->opening_polygon[opening]],
            end = polygons->offset[polygons->count];
    double low[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, high[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, radius = 0;
    for (int64_t c = begin; c < end; c++) {
        for (int k = 0; k < 3; k++) {
            low[k] = fmin(low[k], complex->vertex_position[polygons->corners[c].vertex][k]);
            high[k] = fmax(high[k], complex->vertex_position[polygons->corners[c].vertex][k]);
        }
    }
    for (int k = 0; k < 3; k++) portals->opening_centre[opening][k] = low[k] / 2 + high[k] / 2;
    for (int64_t c = begin; c < end; c++) {
        double square = 0;
        for (int k = 0; k < 3; k++) {
            double d = complex->vertex_position[polygons->corners[c].vertex][k] -
                       portals->opening_centre[opening][k];
            square += d * d;
        }
        radius = fmax(radius, square);
    }
    portals->opening_radius[opening] = sqrt(radius) * (1 + 0x1p-48);
}

static bool add_openings(finder *f, size_t count, int32_t low, int32_t high) {
    enf_portals *portals = f->portals;
    for (size_t root = 0; root < count; root++) {
        if (f->sheets[root].opening != (int32_t)root) continue;
        size_t opening = (size_t)portals->opening_count;
        if (!enf_array_reserve(portals->opening_cell, f->cell_capacity, opening + 1) ||
            !enf_array_reserve(portals->opening_polygon, f->polygon_capacity, opening + 2) ||
            !enf_array_reserve(portals->opening_centre, f->centre_capacity, opening + 1) ||
            !enf_array_reserve(portals->opening_radius, f->radius_capacity, opening + 1)) {
            return false;
        }
        int32_t first = portals->polygons.count;
        for (size_t s = root; s < count; s++) {
            if (opening_root(f->sheets, (int32_t)s) == (int32_t)root && !add_polygon(f, &f->sheets[s]))
                return false;
        }
        if (portals->polygons.count == first) continue; // slivers only
        portals->opening_cell[opening][0] = low;
        portals->opening_cell[opening][1] = high;
        portals->opening_polygon[opening] = first;
        portals->opening_polygon[opening + 1] = portals->polygons.count;
        bound_opening(portals, f->complex, (int32_t)opening);
        portals->opening_count++;
    }
    return true;
}

/// All openings between two cells.
static bool find_between(finder *f, const gap *gaps, size_t count) {
    const enf_complex *complex = f->complex;
    f->pool.corner_count = 0;
    if (!enf_array_reserve(f->sheets, f->sheet_capacity, count)) return false;
    for (size_t i = 0; i < count; i++) {
        int32_t corner_count, plane = complex->facet_plane[complex->piece_facet[gaps[i].piece]];
        const enf_corner *corners = enf_complex_piece(complex, gaps[i].piece, &corner_count);
        enf_loop loop = enf_pool_loop(&f->pool, plane, corners, corner_count);
        if (f->pool.failed) return false;
        for (int32_t c = 0; c < loop.count; c++) {
            enf_corner *corner = &f->pool.corners[loop.first + c];
            corner->vertex = pool_vertex(f, corner->vertex);
        }
        f->sheets[i] = (sheet){.loop = loop,
                               .bucket = enf_geometry_plane_bucket(&f->pool.geometry, plane),
                               .side = gaps[i].side};
    }
    if (f->pool.failed || !unify_vertices(f, count)) return false;
    keyed *order = enf_array_new(count, sizeof *order);
    if (!order) return false;
    f->portals->pieces_merged += (int32_t)count;
    group_sheets(f, count, order);
    count = merge_groups(f, count, order);
    free(order);
    return !f->pool.failed && gather_openings(f, count) &&
           add_openings(f, count, gaps[0].low, gaps[0].high) && !f->pool.failed;
}

static bool collect_gaps(const enf_complex *complex, const int32_t *cell_of, gap **gaps, size_t *gap_count) {
    size_t count = 0, capacity = 0;
    *gaps = NULL;
    for (int32_t p = 0; p < complex->pieces.count; p++) {
        const int32_t *cell = enf_complex_piece_cells(complex, p);
        if (complex->piece_cover[p] != ENF_PIECE_OPEN || cell[0] < 0 || cell[1] < 0) continue;
        int32_t behind = cell_of[cell[0]], front = cell_of[cell[1]];
        if (behind == front || behind < 0 || front < 0) continue;
        if (!enf_array_reserve(*gaps, capacity, count + 1)) return false;
        bool ordered = behind < front;
        (*gaps)[count++] = (gap){ordered ? behind : front, ordered ? front : behind, p, ordered};
    }
    if (count) qsort(*gaps, count, sizeof **gaps, compare_gaps);
    *gap_count = count;
    return true;
}

/// The geometry of the finished complex once more: planes, whose filters are made when they are asked for
/// (most never are), and crossings as they are needed.
static bool set_up(finder *f, const enf_complex *complex) {
    size_t crossings = (size_t)(complex->vertex_count - complex->point_count);
    f->complex = complex;
    enf_geometry *geometry = &f->pool.geometry;
    geometry->points = complex->points;
    geometry->point_count = complex->point_count;
    geometry->planes = complex->planes;
    geometry->plane_count = complex->plane_count;
    geometry->filter_first = geometry->filter_end = complex->plane_count;
    f->pool_vertex = enf_array_new(crossings, sizeof *f->pool_vertex);
    if (!f->pool_vertex) return false;
    for (size_t i = 0; i < crossings; i++) f->pool_vertex[i] = -1;
    return true;
}

enf_status enf_portals_find(enf_portals *portals, const enf_complex *complex, const int32_t *cell_of,
                            enf_error *error) {
    memset(portals, 0, sizeof *portals);
    finder f = {.portals = portals};
    gap *gaps = NULL;
    size_t gap_count = 0;
    bool good = set_up(&f, complex) && collect_gaps(complex, cell_of, &gaps, &gap_count);
    good = good && enf_array_reserve(portals->polygons.offset, portals->polygons.offset_capacity, 1) &&
           enf_array_reserve(portals->opening_polygon, f.polygon_capacity, 1);
    if (good) portals->polygons.offset[0] = portals->opening_polygon[0] = 0;
    for (size_t i = 0, end; good && i < gap_count; i = end) {
        end = i + 1;
        while (end < gap_count && gaps[end].low == gaps[i].low && gaps[end].high == gaps[i].high) end++;
        good = find_between(&f, gaps + i, end - i);
    }
    free(gaps);
    enf_pool_free(&f.pool);
    free(f.pool_vertex);
    free(f.complex_vertex);
    free(f.sheets);
    free(f.group);
    if (good) return ENF_OK;
    enf_portals_free(portals);
    return enf_fail_memory(error, "the portals");
}
