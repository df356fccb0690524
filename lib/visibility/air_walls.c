// SPDX-License-Identifier: GPL-3.0-or-later
#include "visibility/air_walls.h"

#include "base/array.h"
#include "base/parallel.h"
#include "format/frame.h"
#include "visibility/flat_hull.h"
#include "visibility/window.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COVER_SEALED = -2 };

/// For what rounding takes off a radius, as a part of the size of coordinates.
static const double rounding = 0x1p-48;

/// A sphere around the mean of the corners.
static void find_sphere(enf_wall *wall, const double (*corners)[3], int32_t count) {
    double square = 0, size = 0;
    for (int axis = 0; axis < 3; axis++) {
        double sum = 0;
        for (int32_t i = 0; i < count; i++) sum += corners[i][axis];
        wall->middle[axis] = sum / count;
        size += fabs(wall->middle[axis]);
    }
    for (int32_t i = 0; i < count; i++) {
        double way[3];
        for (int axis = 0; axis < 3; axis++) way[axis] = corners[i][axis] - wall->middle[axis];
        square = fmax(square, enf_dot(way, way));
    }
    wall->radius = sqrt(square) + rounding * (size + sqrt(square));
}

bool enf_walls_add(enf_walls *walls, const enf_wall *like, const double (*corners)[3], int32_t count) {
    if (!enf_array_reserve(walls->walls, walls->wall_capacity, walls->count + 1) ||
        !enf_array_reserve(walls->corners, walls->corner_capacity, walls->corner_count + count))
        return false;
    enf_wall *wall = &walls->walls[walls->count++];
    *wall = *like;
    wall->first = walls->corner_count;
    wall->count = count;
    memcpy(walls->corners + wall->first, corners, (size_t)count * sizeof *corners);
    find_sphere(wall, corners, count);
    walls->corner_count += count;
    return true;
}

/// A plane on a grid: its normal, which points up the first axis that it can, and its offset.
typedef struct grid_plane {
    int64_t at[4];
} grid_plane;

static const double grid_steps = 0x1p20; ///< from 0 to 1, and to the size of the world

static grid_plane find_grid_plane(const enf_wall *wall, double size) {
    grid_plane plane;
    for (int axis = 0; axis < 3; axis++) plane.at[axis] = llround(wall->normal[axis] * grid_steps);
    plane.at[3] = size > 0 ? llround(wall->offset / size * grid_steps) : 0;
    int first = 0;
    while (first < 2 && plane.at[first] == 0) first++;
    if (plane.at[first] < 0)
        for (int k = 0; k < 4; k++) plane.at[k] = -plane.at[k];
    return plane;
}

static int compare_planes(const void *a, const void *b) {
    return memcmp(a, b, sizeof(grid_plane)); // any order will do
}

int32_t enf_walls_count_planes(const enf_walls *walls, double size) {
    grid_plane *planes = enf_array_new((size_t)walls->count, sizeof *planes);
    int32_t count = 0;
    if (!planes) return -1;
    for (int32_t i = 0; i < walls->count; i++) planes[i] = find_grid_plane(&walls->walls[i], size);
    qsort(planes, (size_t)walls->count, sizeof *planes, compare_planes);
    for (int32_t i = 0; i < walls->count; i++)
        count += i == 0 || compare_planes(&planes[i - 1], &planes[i]) != 0;
    free(planes);
    return count;
}

void enf_walls_free(enf_walls *walls) {
    free(walls->walls);
    free(walls->corners);
    *walls = (enf_walls){0};
}

/// The pieces of closed facets that kept cells touch, sorted by occluder.
typedef struct closed {
    int32_t *first;  ///< mesh_polygon_count + 1 offsets into pieces
    int32_t *pieces; ///< then the sealed ones
    int32_t sealed;  ///< how many of those
} closed;

/// Of the occluders, however many threads there are.
enum { SHARES = 64 };

/// The walls of some occluders.
typedef struct share {
    enf_walls walls;
    double (*corners)[3]; ///< scratch
    size_t capacity;
    bool good;
} share;

/// How many of the two fine cells at a piece are kept.
static int count_kept(const enf_file_view *view, int32_t piece) {
    const int32_t *fine = view->facet_fine[view->piece_facet[piece]];
    return (fine[0] >= 0 && view->fine_cell[fine[0]] >= 0) + (fine[1] >= 0 && view->fine_cell[fine[1]] >= 0);
}

static bool sort_pieces(closed *closed, const enf_file_view *view) {
    int32_t polygons = view->mesh_polygon_count;
    closed->first = enf_array_zeroed((size_t)polygons + 2, sizeof *closed->first);
    closed->pieces = enf_array_new((size_t)view->piece_count, sizeof *closed->pieces);
    if (!closed->first || !closed->pieces) return false;
    int32_t *next = closed->first + 1; // one ahead while counting: it becomes the offsets themselves
    for (int32_t p = 0; p < view->piece_count; p++)
        if (view->piece_cover[p] >= 0 && count_kept(view, p) > 0)
            next[view->cover_polygon[view->piece_cover[p]] + 1]++;
    for (int32_t i = 0; i < polygons; i++) next[i + 1] += next[i];
    int32_t sealed = next[polygons];
    for (int32_t p = 0; p < view->piece_count; p++) {
        if (count_kept(view, p) == 0) continue;
        if (view->piece_cover[p] >= 0) closed->pieces[next[view->cover_polygon[view->piece_cover[p]]]++] = p;
        if (view->piece_cover[p] == COVER_SEALED) closed->pieces[sealed + closed->sealed++] = p;
    }
    return true;
}

/// Appends the corners of a piece, or of its facet if it has none of its own.
static bool take_corners(share *share, const enf_file_view *view, int32_t piece, int32_t *count) {
    const int32_t *offset = &view->piece_offset[piece];
    const enf_file_corner *corners = view->piece_corners;
    if (offset[0] == offset[1]) {
        offset = &view->facet_offset[view->piece_facet[piece]];
        corners = view->facet_corners;
    }
    if (!enf_array_reserve(share->corners, share->capacity, *count + offset[1] - offset[0])) return false;
    for (int64_t i = offset[0]; i < offset[1]; i++)
        enf_view_to_world(view, view->vertex_position[corners[i].vertex], share->corners[(*count)++]);
    return true;
}

/// The plane through three points of the grid; false if rounding leaves none.
static bool find_plane(const enf_file_view *view, const int32_t points[3], enf_wall *wall) {
    double at[3][3], normal[3];
    for (int i = 0; i < 3; i++) enf_view_to_world(view, view->points[points[i]], at[i]);
    for (int a = 0; a < 3; a++) {
        int u = (a + 1) % 3, v = (a + 2) % 3;
        normal[a] =
            (at[1][u] - at[0][u]) * (at[2][v] - at[0][v]) - (at[1][v] - at[0][v]) * (at[2][u] - at[0][u]);
    }
    double length = sqrt(enf_dot(normal, normal));
    if (!(length > 0)) return false;
    for (int a = 0; a < 3; a++) wall->normal[a] = normal[a] / length;
    wall->offset = enf_dot(wall->normal, at[0]);
    return true;
}

/// Adds the hull of the pieces of one occluder, or of one sealed piece.
static bool add_wall(share *share, const closed *closed, const enf_file_view *view, const int32_t points[3],
                     int32_t begin, int32_t end) {
    enf_wall wall = {0};
    int32_t count = 0;
    for (int32_t i = begin; i < end; i++) {
        if (!take_corners(share, view, closed->pieces[i], &count)) return false;
        wall.has_air_behind = wall.has_air_behind || count_kept(view, closed->pieces[i]) == 2;
    }
    if (count == 0 || !find_plane(view, points, &wall)) return true;
    if (!enf_array_reserve(share->corners, share->capacity, 3 * count + 1)) return false;
    int32_t made = enf_flat_hull(share->corners, count, wall.normal, share->corners + count);
    return made < 3 ||
           enf_walls_add(&share->walls, &wall, (const double(*)[3])(share->corners + count), made);
}

typedef struct making {
    const closed *closed;
    const enf_file_view *view;
    share shares[SHARES];
} making;

/// Occluders, then sealed pieces; as many of both in each share.
static void make_share(void *user, int32_t number, int thread) {
    making *making = user;
    const closed *closed = making->closed;
    const enf_file_view *view = making->view;
    const int64_t polygons = view->mesh_polygon_count, all = polygons + closed->sealed;
    share *share = &making->shares[number];
    (void)thread;
    share->good = true;
    for (int64_t i = all * number / SHARES; share->good && i < all * (number + 1) / SHARES; i++) {
        if (i < polygons) {
            share->good = add_wall(share, closed, view, view->mesh_polygon_plane[i], closed->first[i],
                                   closed->first[i + 1]);
            continue;
        }
        const int32_t at = (int32_t)(closed->first[polygons] + i - polygons);
        const int32_t plane = view->facet_plane[view->piece_facet[closed->pieces[at]]];
        share->good = add_wall(share, closed, view, view->planes[plane], at, at + 1);
    }
}

/// Appends walls. False without memory.
static bool append(enf_walls *walls, const enf_walls *more) {
    const int32_t first = walls->corner_count;
    if (more->count == 0) return true;
    if (!enf_array_reserve(walls->walls, walls->wall_capacity, walls->count + more->count) ||
        !enf_array_reserve(walls->corners, walls->corner_capacity, first + more->corner_count))
        return false;
    memcpy(walls->corners + first, more->corners, (size_t)more->corner_count * sizeof *more->corners);
    for (int32_t i = 0; i < more->count; i++) {
        walls->walls[walls->count] = more->walls[i];
        walls->walls[walls->count++].first += first;
    }
    walls->corner_count += more->corner_count;
    return true;
}

enf_status enf_air_walls_make(enf_walls *walls, const enf_file_view *view, int threads, enf_error *error) {
    closed closed = {0};
    *walls = (enf_walls){0};
    bool good = sort_pieces(&closed, view);
    making making = {.closed = &closed, .view = view};
    if (good) enf_parallel_for(&(enf_crew){.threads = threads}, SHARES, make_share, &making);
    for (int i = 0; i < SHARES; i++) {
        good = good && making.shares[i].good && append(walls, &making.shares[i].walls);
        enf_walls_free(&making.shares[i].walls);
        free(making.shares[i].corners);
    }
    free(closed.first);
    free(closed.pieces);
    return good ? ENF_OK : enf_fail_memory(error, "the walls");
}
