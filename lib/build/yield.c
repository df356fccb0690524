// SPDX-License-Identifier: GPL-3.0-or-later
#include "build/yield.h"

#include "base/array.h"
#include "build/loop.h"

#include <stdlib.h>
#include <string.h>

void enf_yield_free(enf_yield *yield) {
    enf_complex_free(&yield->complex);
    free(yield->cell_into);
    memset(yield, 0, sizeof *yield);
}

/// Room for loops and their corners, which have numbers.
static bool reserve_loops(enf_loops *loops, size_t count, size_t corners) {
    return corners <= INT32_MAX && enf_array_reserve(loops->offset, loops->offset_capacity, count + 1) &&
           enf_array_reserve(loops->corners, loops->corner_capacity, corners);
}

/// The same for each array by itself.
static bool reserve(enf_yield *yield, size_t facets, size_t covers, size_t pieces) {
    enf_complex *complex = &yield->complex;
    return enf_array_reserve(complex->facet_plane, yield->plane_capacity, facets) &&
           enf_array_reserve(complex->facet_cell, yield->cell_capacity, facets) &&
           enf_array_reserve(complex->facet_cover, yield->facet_cover_capacity, facets + 1) &&
           enf_array_reserve(complex->facet_piece, yield->facet_piece_capacity, facets + 1) &&
           enf_array_reserve(complex->cover_polygon, yield->cover_polygon_capacity, covers) &&
           enf_array_reserve(complex->cover_side, yield->cover_side_capacity, covers) &&
           enf_array_reserve(complex->piece_facet, yield->piece_facet_capacity, pieces) &&
           enf_array_reserve(complex->piece_cover, yield->piece_cover_capacity, pieces);
}

bool enf_yield_reserve(enf_yield *yield, size_t facets, size_t corners, size_t covers, size_t pieces) {
    enf_complex *complex = &yield->complex;
    return reserve(yield, facets, covers, pieces) && reserve_loops(&complex->facets, facets, corners) &&
           reserve_loops(&complex->covers, covers, 0) && reserve_loops(&complex->pieces, pieces, 0);
}

// ---------------------------------------------------------------------------------------------- one part

/// Corners that are not the world's already.
static enf_corner *own_corners(const enf_yield *yield, const enf_loops *loops, size_t *count) {
    size_t still = loops == &yield->complex.facets ? 3 * (size_t)yield->still_count : 0;
    *count = loops->corner_count - still;
    return loops->corners + still;
}

/// Points mark the number before the first, so that there is nothing to guess.
static void mark_vertices(const enf_yield *yield, const enf_loops *loops, int32_t points, int32_t *number) {
    size_t count;
    const enf_corner *corners = own_corners(yield, loops, &count);
    for (size_t i = 0; i < count; i++) {
        int32_t crossing = corners[i].vertex - points;
        number[crossing | -(crossing < 0)] = 1;
    }
}

static void renumber_vertices(const enf_yield *yield, const enf_loops *loops, int32_t points,
                              const int32_t *number) {
    size_t count;
    enf_corner *corners = own_corners(yield, loops, &count);
    for (size_t i = 0; i < count; i++) {
        int32_t vertex = corners[i].vertex, crossing = vertex - points, is_point = -(crossing < 0);
        corners[i].vertex = (vertex & is_point) | ((points + number[crossing | is_point]) & ~is_point);
    }
}

/// Keeps the crossings that a loop uses, in order, and rounds them to coordinates.
static bool take_vertices(enf_yield *yield, enf_geometry *geometry) {
    enf_complex *complex = &yield->complex;
    const enf_loops *loops[] = {&complex->facets, &complex->covers, &complex->pieces};
    int32_t points = geometry->point_count, made = geometry->crossing_count, count = 0;
    int32_t *numbers = enf_array_zeroed((size_t)made + 1, sizeof *numbers);
    if (!numbers) return false;
    int32_t *number = numbers + 1;
    for (int i = 0; i < 3; i++) mark_vertices(yield, loops[i], points, number);
    for (int32_t i = 0; i < made; i++) number[i] = number[i] ? count++ : -1;
    complex->vertex_count = count;
    complex->vertex_planes = enf_array_new((size_t)count, sizeof *complex->vertex_planes);
    complex->vertex_position = enf_array_new((size_t)count, sizeof *complex->vertex_position);
    bool good = complex->vertex_planes && complex->vertex_position;
    for (int32_t i = 0; good && i < made; i++) {
        if (number[i] < 0) continue;
        memcpy(complex->vertex_planes[number[i]], geometry->crossings[i].plane,
               sizeof *complex->vertex_planes);
        enf_geometry_position(geometry, points + i, complex->vertex_position[number[i]]);
    }
    for (int i = 0; good && i < 3; i++) renumber_vertices(yield, loops[i], points, number);
    free(numbers);
    return good;
}

bool enf_yield_finish(enf_yield *yield, enf_subdivision *space, int32_t *into) {
    enf_complex *complex = &yield->complex;
    yield->cell_into = into;
    yield->cell_count = (int32_t)space->cell_count;
    complex->tetrahedron_count = space->tetrahedron_count;
    complex->node_count = (int32_t)space->node_count;
    complex->tetrahedron_root = space->tetrahedron_root;
    complex->node_plane = space->node_plane;
    complex->node_child = space->node_child;
    space->tetrahedron_root = space->node_plane = NULL;
    space->node_child = NULL;
    space->root_capacity = space->node_capacity = space->child_capacity = 0;
    for (int32_t t = 0; t < complex->tetrahedron_count; t++)
        complex->tetrahedra_cut += complex->tetrahedron_root[t] >= 0;
    memcpy(complex->predicates, space->geometry.decided, sizeof complex->predicates);
    return take_vertices(yield, &space->geometry);
}

// ---------------------------------------------------------------------------------------------- all parts

/// Where a part's numbers begin among all.
typedef struct base {
    size_t facet_corner, cover_corner, piece_corner;
    int32_t facet, cover, piece, vertex, node, cell;
} base;

typedef struct gathering {
    enf_yield *yields;
    const enf_parts *parts;
    base *bases; ///< per part, and one more
    int32_t tetrahedron_count, point_count;
    const double *points; ///< xyz
    enf_complex *complex;
    int32_t *into;
} gathering;

static base base_after(base before, const enf_yield *yield) {
    const enf_complex *complex = &yield->complex;
    before.facet_corner += complex->facets.corner_count;
    before.cover_corner += complex->covers.corner_count;
    before.piece_corner += complex->pieces.corner_count;
    before.facet += complex->facets.count;
    before.cover += complex->covers.count;
    before.piece += complex->pieces.count;
    before.vertex += complex->vertex_count;
    before.node += complex->node_count;
    before.cell += yield->cell_count - complex->tetrahedron_count;
    return before;
}

/// The number among all of what a part has on a side of a facet.
static int32_t world_cell(const gathering *all, int32_t part, int32_t cell) {
    if (cell < 0) return cell == -1 ? -1 : -2 - cell;
    int32_t own = all->yields[part].complex.tetrahedron_count;
    if (cell >= own) return all->tetrahedron_count + all->bases[part].cell + cell - own;
    return all->parts->tetrahedra[all->parts->tetrahedron_first[part] + cell];
}

/// Copies a part's loops behind those of the parts before it.
static void place_loops(const gathering *all, int32_t part, const enf_loops *from, enf_loops *to,
                        int32_t loop, size_t corner) {
    for (int32_t i = 0; i < from->count; i++)
        to->offset[(size_t)loop + (size_t)i + 1] = from->offset[i + 1] + (int32_t)corner;
    for (size_t i = 0; i < from->corner_count; i++) {
        enf_corner one = from->corners[i];
        if (one.vertex >= all->point_count) one.vertex += all->bases[part].vertex;
        to->corners[corner + i] = one;
    }
}

static void place_facets(const gathering *all, int32_t part) {
    const enf_complex *from = &all->yields[part].complex;
    enf_complex *to = all->complex;
    base at = all->bases[part];
    place_loops(all, part, &from->facets, &to->facets, at.facet, at.facet_corner);
    place_loops(all, part, &from->covers, &to->covers, at.cover, at.cover_corner);
    place_loops(all, part, &from->pieces, &to->pieces, at.piece, at.piece_corner);
    for (int32_t f = 0; f < from->facets.count; f++) {
        to->facet_plane[at.facet + f] = from->facet_plane[f];
        memcpy(to->facet_cell[at.facet + f], from->facet_cell[f], sizeof *to->facet_cell);
        to->facet_cover[at.facet + f + 1] = from->facet_cover[f + 1] + at.cover;
        to->facet_piece[at.facet + f + 1] = from->facet_piece[f + 1] + at.piece;
    }
    for (int32_t i = 0; i < from->covers.count; i++) {
        to->cover_polygon[at.cover + i] = from->cover_polygon[i];
        to->cover_side[at.cover + i] = from->cover_side[i];
    }
    for (int32_t i = 0; i < from->pieces.count; i++) {
        int32_t cover = from->piece_cover[i];
        to->piece_facet[at.piece + i] = from->piece_facet[i] + at.facet;
        to->piece_cover[at.piece + i] = cover < 0 ? cover : cover + at.cover;
    }
}

/// Trees of cuts, cells that went into others, vertices.
static void place_cells(const gathering *all, int32_t part) {
    const enf_yield *yield = &all->yields[part];
    const enf_complex *from = &yield->complex;
    enf_complex *to = all->complex;
    base at = all->bases[part];
    for (int32_t i = 0; i < from->node_count; i++) {
        to->node_plane[at.node + i] = from->node_plane[i];
        for (int k = 0; k < 2; k++) {
            int32_t child = from->node_child[i][k];
            to->node_child[at.node + i][k] =
                child < 0 ? -1 - world_cell(all, part, -1 - child) : child + at.node;
        }
    }
    for (int32_t c = 0; c < from->tetrahedron_count; c++) {
        int32_t root = from->tetrahedron_root[c];
        to->tetrahedron_root[world_cell(all, part, c)] =
            root < 0 ? -1 - world_cell(all, part, -1 - root) : root + at.node;
    }
    for (int32_t c = 0; c < yield->cell_count; c++)
        all->into[world_cell(all, part, c)] = world_cell(all, part, yield->cell_into[c]);
    size_t vertex = (size_t)all->point_count + (size_t)at.vertex, count = (size_t)from->vertex_count;
    memcpy(to->vertex_planes + vertex, from->vertex_planes, count * sizeof *to->vertex_planes);
    memcpy(to->vertex_position + vertex, from->vertex_position, count * sizeof *to->vertex_position);
}

static void place_part(void *user, int32_t part, int thread) {
    (void)thread;
    gathering *all = user;
    if (part > 0) place_facets(all, part); // those of the first part stand there already
    place_cells(all, part);
    int32_t first = part == 0 ? all->yields[0].still_count : all->bases[part].facet;
    for (int32_t f = first; f < all->bases[part + 1].facet; f++) {
        for (int side = 0; side < 2; side++) {
            int32_t *cell = &all->complex->facet_cell[f][side];
            *cell = world_cell(all, part, *cell);
        }
    }
    if (part > 0) enf_yield_free(&all->yields[part]);
}

/// Room for all in the first yield.
static bool make_room(gathering *all, enf_yield *first, base end) {
    enf_complex *complex = &first->complex;
    if (!reserve(first, (size_t)end.facet, (size_t)end.cover, (size_t)end.piece) ||
        !reserve_loops(&complex->facets, (size_t)end.facet, end.facet_corner) ||
        !reserve_loops(&complex->covers, (size_t)end.cover, end.cover_corner) ||
        !reserve_loops(&complex->pieces, (size_t)end.piece, end.piece_corner)) {
        return false;
    }
    size_t tets = (size_t)all->tetrahedron_count, vertices = (size_t)all->point_count + (size_t)end.vertex;
    enf_complex *to = all->complex;
    all->into = enf_array_new(tets + (size_t)end.cell, sizeof *all->into);
    to->tetrahedron_root = enf_array_new(tets, sizeof *to->tetrahedron_root);
    to->node_plane = enf_array_new((size_t)end.node, sizeof *to->node_plane);
    to->node_child = enf_array_new((size_t)end.node, sizeof *to->node_child);
    to->vertex_planes = enf_array_new(vertices, sizeof *to->vertex_planes);
    to->vertex_position = enf_array_new(vertices, sizeof *to->vertex_position);
    return all->into && to->tetrahedron_root && to->node_plane && to->node_child && to->vertex_planes &&
           to->vertex_position;
}

enum { BLOCK = 1 << 15 }; ///< tetrahedra or points a job

static int32_t block_end(int32_t count, int32_t block) {
    return count - block * (int64_t)BLOCK < BLOCK ? count : (block + 1) * BLOCK;
}

/// What does not come from the parts: points, and tetrahedra that stay as they are.
static void place_block(void *user, int32_t block, int thread) {
    (void)thread;
    const gathering *all = user;
    enf_complex *to = all->complex;
    for (int32_t t = block * BLOCK; t < block_end(all->tetrahedron_count, block); t++) {
        if (all->parts->cell_of[t] >= 0) continue;
        to->tetrahedron_root[t] = -1 - t;
        all->into[t] = t;
    }
    for (int32_t v = block * BLOCK; v < block_end(all->point_count, block); v++) {
        for (int k = 0; k < 3; k++) {
            to->vertex_planes[v][k] = -1;
            to->vertex_position[v][k] = all->points[3 * (size_t)v + (size_t)k];
        }
    }
}

/// The arrays that grew in the first part become those of the whole.
static void take_first(gathering *all, base end) {
    enf_complex *to = all->complex, *from = &all->yields[0].complex;
    to->facets = from->facets;
    to->covers = from->covers;
    to->pieces = from->pieces;
    to->facet_plane = from->facet_plane;
    to->facet_cell = from->facet_cell;
    to->facet_cover = from->facet_cover;
    to->facet_piece = from->facet_piece;
    to->cover_polygon = from->cover_polygon;
    to->cover_side = from->cover_side;
    to->piece_facet = from->piece_facet;
    to->piece_cover = from->piece_cover;
    memset(&from->facets, 0, sizeof from->facets);
    memset(&from->covers, 0, sizeof from->covers);
    memset(&from->pieces, 0, sizeof from->pieces);
    from->facet_plane = from->facet_cover = from->facet_piece = NULL;
    from->facet_cell = NULL;
    from->cover_polygon = from->piece_facet = from->piece_cover = NULL;
    from->cover_side = NULL;
    to->facet_count = to->facets.count = end.facet;
    to->covers.count = end.cover;
    to->pieces.count = end.piece;
    to->facets.corner_count = end.facet_corner;
    to->covers.corner_count = end.cover_corner;
    to->pieces.corner_count = end.piece_corner;
    to->node_count = end.node;
    to->vertex_count = all->point_count + end.vertex;
    to->cell_count += all->tetrahedron_count + end.cell;
}

bool enf_yields_gather(enf_yield *yields, const enf_parts *parts, const enf_crew *crew,
                       enf_arrangement *arrangement, enf_complex *complex) {
    gathering all = {.yields = yields,
                     .parts = parts,
                     .tetrahedron_count = arrangement->tets.count,
                     .point_count = arrangement->geometry.point_count,
                     .points = arrangement->geometry.points,
                     .complex = complex};
    all.bases = enf_array_zeroed((size_t)parts->count + 1, sizeof *all.bases);
    if (!all.bases) return false;
    for (int32_t i = 0; i < parts->count; i++) {
        const enf_complex *one = &yields[i].complex;
        all.bases[i + 1] = base_after(all.bases[i], &yields[i]);
        complex->tetrahedra_cut += one->tetrahedra_cut;
        complex->cells_joined += one->cells_joined;
        complex->cell_count -= one->cells_joined;
        for (int k = 0; k < ENF_TIERS; k++) complex->predicates[k] += one->predicates[k];
    }
    base end = all.bases[parts->count];
    bool good = make_room(&all, &yields[0], end);
    if (good) {
        enf_crew unwatched = {.threads = crew->threads};
        complex->tetrahedron_count = all.tetrahedron_count;
        int32_t most = all.tetrahedron_count > all.point_count ? all.tetrahedron_count : all.point_count;
        enf_parallel_for(&unwatched, most / BLOCK + 1, place_block, &all);
        take_first(&all, end);
        enf_parallel_for(&unwatched, parts->count, place_part, &all);
        enf_yield_free(&yields[0]);
    }
    arrangement->cell_into = all.into;
    free(all.bases);
    return good;
}
