// SPDX-License-Identifier: GPL-3.0-or-later
// Clipping convex polygons held as planes: every new vertex is named by three planes, so cutting never loses
// a bit however often it is repeated (Bernstein and Fussell 2009).
#include "build/loop.h"

#include "base/array.h"

#include <assert.h>
#include <stdlib.h>
#include <string.h>

void enf_pool_free(enf_pool *pool) {
    free(pool->geometry.crossings);
    free(pool->corners);
    free(pool->signs);
    memset(pool, 0, sizeof *pool);
}

static void add_corner(enf_pool *pool, enf_loop *loop, int32_t vertex, int32_t edge_plane) {
    if (vertex < 0 || !enf_array_reserve(pool->corners, pool->corner_capacity, pool->corner_count + 1)) {
        pool->failed = true;
        return;
    }
    pool->corners[pool->corner_count++] = (enf_corner){vertex, edge_plane};
    loop->count++;
}

static enf_loop start_loop(const enf_pool *pool, int32_t plane) {
    return (enf_loop){plane, (int32_t)pool->corner_count, 0};
}

enf_loop enf_pool_loop(enf_pool *pool, int32_t plane, const enf_corner *corners, int32_t count) {
    enf_loop loop = start_loop(pool, plane);
    for (int32_t i = 0; i < count; i++) add_corner(pool, &loop, corners[i].vertex, corners[i].edge_plane);
    return loop;
}

enf_loop enf_facet_loop(const enf_subdivision *space, int32_t facet, enf_pool *pool) {
    enf_loop loop = start_loop(pool, enf_subdivision_plane(space, facet));
    int32_t first = space->facets[facet].first, h = first;
    do {
        const enf_half *half = &space->halves[h], *next = &space->halves[half->next];
        if (next->edge_plane != half->edge_plane) add_corner(pool, &loop, next->vertex, next->edge_plane);
        h = half->next;
    } while (h != first);
    return loop;
}

enf_loop enf_pool_reversed(enf_pool *pool, enf_loop loop) {
    enf_loop reversed = start_loop(pool, loop.plane);
    for (int32_t i = loop.count - 1; i >= 0; i--) {
        int32_t before = i > 0 ? i - 1 : loop.count - 1;
        int32_t vertex = pool->corners[loop.first + i].vertex;
        add_corner(pool, &reversed, vertex, pool->corners[loop.first + before].edge_plane);
    }
    return reversed;
}

enf_position enf_pool_classify(enf_pool *pool, enf_loop loop, int32_t plane) {
    if (!enf_array_reserve(pool->signs, pool->sign_capacity, (size_t)loop.count)) {
        pool->failed = true;
        return ENF_POSITION_ON;
    }
    bool behind = false, front = false;
    for (int32_t i = 0; i < loop.count; i++) {
        int sign = enf_geometry_side(&pool->geometry, pool->corners[loop.first + i].vertex, plane);
        pool->signs[i] = (int8_t)sign;
        behind |= sign < 0;
        front |= sign > 0;
    }
    if (behind && front) return ENF_POSITION_ACROSS;
    return behind ? ENF_POSITION_BEHIND : front ? ENF_POSITION_FRONT : ENF_POSITION_ON;
}

/// The part of the loop whose corners have sign `side` or 0. New vertices come from `crossing`, one for each
/// of the two edges that cross, in the order met; they are made on the first pass.
static enf_loop part(enf_pool *pool, enf_loop loop, int32_t plane, int side, const int32_t crossing[2]) {
    enf_loop out = start_loop(pool, loop.plane);
    int met = 0;
    for (int32_t i = 0; i < loop.count; i++) {
        int32_t next = i + 1 < loop.count ? i + 1 : 0;
        enf_corner here = pool->corners[loop.first + i];
        int sign = pool->signs[i] * side, sign_next = pool->signs[next] * side;
        if (sign > 0 || (sign == 0 && sign_next > 0)) {
            add_corner(pool, &out, here.vertex, here.edge_plane);
        } else if (sign == 0) {
            int before = pool->signs[i > 0 ? i - 1 : loop.count - 1] * side;
            if (before > 0) add_corner(pool, &out, here.vertex, plane);
        }
        if (sign * sign_next < 0) {
            add_corner(pool, &out, crossing[met], sign > 0 ? plane : here.edge_plane);
            met++;
        }
    }
    return out;
}

void enf_pool_cut(enf_pool *pool, enf_loop loop, int32_t plane, enf_loop *behind, enf_loop *front) {
    int32_t crossing[2] = {-1, -1};
    int met = 0;
    for (int32_t i = 0; i < loop.count && met < 2; i++) {
        int32_t next = i + 1 < loop.count ? i + 1 : 0;
        if (pool->signs[i] * pool->signs[next] >= 0) continue;
        enf_corner here = pool->corners[loop.first + i];
        crossing[met++] = enf_geometry_cross(&pool->geometry, loop.plane, here.edge_plane, plane);
    }
    if (behind) *behind = part(pool, loop, plane, -1, crossing);
    if (front) *front = part(pool, loop, plane, +1, crossing);
}

bool enf_pool_keep(enf_pool *pool, enf_loop *loop, int32_t plane, int side) {
    switch (enf_pool_classify(pool, *loop, plane)) {
    case ENF_POSITION_ON:
        return false;
    case ENF_POSITION_BEHIND:
        return side < 0;
    case ENF_POSITION_FRONT:
        return side > 0;
    case ENF_POSITION_ACROSS:
        break;
    }
    enf_loop kept;
    enf_pool_cut(pool, *loop, plane, side < 0 ? &kept : NULL, side > 0 ? &kept : NULL);
    *loop = kept;
    return !pool->failed;
}

int enf_pool_edge_side(enf_pool *pool, enf_loop loop, int32_t i) {
    int32_t plane = pool->corners[loop.first + i].edge_plane;
    for (int32_t k = 2; k < loop.count; k++) { // strictly convex: the first one decides
        int32_t vertex = pool->corners[loop.first + (i + k) % loop.count].vertex;
        int sign = enf_geometry_side(&pool->geometry, vertex, plane);
        if (sign != 0) return sign;
    }
    return 0;
}

void enf_loop_area(const enf_corner *corners, int64_t count, const double (*positions)[3], double area[3]) {
    const double *origin = positions[corners[0].vertex];
    area[0] = area[1] = area[2] = 0;
    for (int64_t i = 1; i + 1 < count; i++) {
        const double *p = positions[corners[i].vertex], *q = positions[corners[i + 1].vertex];
        double u[3], v[3];
        for (int k = 0; k < 3; k++) {
            u[k] = p[k] - origin[k];
            v[k] = q[k] - origin[k];
        }
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3, m = (k + 2) % 3;
            area[k] += (u[l] * v[m] - u[m] * v[l]) / 2;
        }
    }
}

bool enf_loops_append(enf_loops *loops, const enf_corner *corners, int32_t count) {
    if (loops->corner_count + (size_t)count > INT32_MAX ||
        !enf_array_reserve(loops->offset, loops->offset_capacity, (size_t)loops->count + 2) ||
        !enf_array_reserve(loops->corners, loops->corner_capacity, loops->corner_count + (size_t)count)) {
        return false;
    }
    loops->offset[0] = 0;
    if (count > 0) memcpy(loops->corners + loops->corner_count, corners, (size_t)count * sizeof *corners);
    loops->corner_count += (size_t)count;
    loops->offset[++loops->count] = (int32_t)loops->corner_count;
    return true;
}

void enf_loops_free(enf_loops *loops) {
    free(loops->offset);
    free(loops->corners);
    memset(loops, 0, sizeof *loops);
}
