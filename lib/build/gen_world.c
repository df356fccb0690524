// SPDX-License-Identifier: GPL-3.0-or-later
// The container behind the test worlds: points shared by exact coordinates, triangles, boxes, tubes,
// polygons. Polygons are cut by clipping ears (Meisters 1975), the best shaped ear first.
#include "build/gen_world.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "base/array.h"

enum { POLYGON_CORNERS_MAX = 64 };

void enf_gen_world_free(enf_gen_world *world) {
    free(world->points);
    free(world->slots);
    free(world->triangles);
    free(world->triangle_group);
    free(world->groups);
    free(world->spawns);
    *world = (enf_gen_world){0};
}

static uint64_t mix(uint64_t z) {
    z = (z ^ (z >> 30)) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ (z >> 27)) * UINT64_C(0x94d049bb133111eb);
    return z ^ (z >> 31);
}

uint64_t enf_gen_random(uint64_t *state) {
    return mix(*state += UINT64_C(0x9e3779b97f4a7c15));
}

double enf_gen_random_unit(uint64_t *state) {
    return (double)(enf_gen_random(state) >> 11) * 0x1p-52 - 1.0;
}

static size_t point_slot(const enf_gen_world *world, const double point[3]) {
    uint64_t hash = 0;
    for (int a = 0; a < 3; a++) {
        uint64_t bits;
        memcpy(&bits, &point[a], sizeof bits);
        hash = mix(hash + bits + UINT64_C(0x9e3779b97f4a7c15));
    }
    size_t slot = (size_t)hash & (world->slot_count - 1);
    while (world->slots[slot] >= 0 &&
           memcmp(world->points[world->slots[slot]], point, sizeof(double[3])) != 0)
        slot = (slot + 1) & (world->slot_count - 1);
    return slot;
}

static bool grow_slots(enf_gen_world *world) {
    if (world->slot_count > 2 * world->point_count) return true;
    size_t count = world->slot_count ? 2 * world->slot_count : 1024;
    int32_t *slots = enf_array_new(count, sizeof *slots);
    if (!slots) return false;
    free(world->slots);
    world->slots = slots;
    world->slot_count = count;
    memset(slots, 0xff, count * sizeof *slots);
    for (size_t i = 0; i < world->point_count; i++) slots[point_slot(world, world->points[i])] = (int32_t)i;
    return true;
}

int32_t enf_gen_point(enf_gen_world *world, double x, double y, double z) {
    const double point[3] = {x + 0.0, y + 0.0, z + 0.0}; // no negative zeros
    if (world->failed || world->point_count >= INT32_MAX || !grow_slots(world) ||
        !enf_array_reserve(world->points, world->point_capacity, world->point_count + 1)) {
        world->failed = true;
        return 0;
    }
    size_t slot = point_slot(world, point);
    if (world->slots[slot] < 0) {
        world->slots[slot] = (int32_t)world->point_count;
        memcpy(world->points[world->point_count++], point, sizeof point);
    }
    return world->slots[slot];
}

int32_t enf_gen_group(enf_gen_world *world, const char *format, ...) {
    if (world->failed || world->group_count >= INT32_MAX ||
        !enf_array_reserve(world->groups, world->group_capacity, world->group_count + 1)) {
        world->failed = true;
        return 0;
    }
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(world->groups[world->group_count], sizeof *world->groups, format, arguments);
    va_end(arguments);
    return (int32_t)world->group_count++;
}

void enf_gen_spawn(enf_gen_world *world, double x, double y, double z) {
    if (world->failed || !enf_array_reserve(world->spawns, world->spawn_capacity, world->spawn_count + 1)) {
        world->failed = true;
        return;
    }
    double *spawn = world->spawns[world->spawn_count++];
    spawn[0] = x, spawn[1] = y, spawn[2] = z;
}

void enf_gen_triangle_in(enf_gen_world *world, int32_t group, int32_t a, int32_t b, int32_t c) {
    size_t wanted = world->triangle_count + 1;
    if (world->failed || wanted >= INT32_MAX ||
        !enf_array_reserve(world->triangles, world->triangle_capacity, wanted) ||
        !enf_array_reserve(world->triangle_group, world->triangle_group_capacity, wanted)) {
        world->failed = true;
        return;
    }
    int32_t *corners = world->triangles[world->triangle_count];
    corners[0] = a, corners[1] = b, corners[2] = c;
    world->triangle_group[world->triangle_count++] = group;
}

void enf_gen_triangle(enf_gen_world *world, int32_t a, int32_t b, int32_t c) {
    enf_gen_triangle_in(world, (int32_t)world->group_count - 1, a, b, c);
}

void enf_gen_quad(enf_gen_world *world, int32_t a, int32_t b, int32_t c, int32_t d) {
    enf_gen_triangle(world, a, b, c);
    enf_gen_triangle(world, a, c, d);
}

void enf_gen_tube(enf_gen_world *world, const int32_t *a, const int32_t *b, size_t count) {
    for (size_t i = 0; i < count; i++) {
        size_t next = (i + 1) % count;
        enf_gen_quad(world, a[i], b[i], b[next], a[next]);
    }
}

void enf_gen_box(enf_gen_world *world, const double low[3], const double high[3]) {
    int32_t corners[8];
    for (int i = 0; i < 8; i++)
        corners[i] = enf_gen_point(world, i & 1 ? high[0] : low[0], i & 2 ? high[1] : low[1],
                                   i & 4 ? high[2] : low[2]);
    static const int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (int f = 0; f < 6; f++)
        enf_gen_quad(world, corners[faces[f][0]], corners[faces[f][1]], corners[faces[f][2]],
                     corners[faces[f][3]]);
}

// Twice the area of a triangle in the plane, positive if counter-clockwise.
static double turn(const double a[2], const double b[2], const double c[2]) {
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static double length_squared(const double a[2], const double b[2]) {
    return (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]);
}

// How well shaped the ear at corner `i` is (area over the sum of squared sides), or 0 if it is none: flat,
// turning the wrong way, or touched by another corner.
static double ear_quality(double (*flat)[2], const int *ring, int count, int i) {
    const double *a = flat[ring[(i + count - 1) % count]], *b = flat[ring[i]],
                 *c = flat[ring[(i + 1) % count]];
    double area = turn(a, b, c);
    if (!(area > 0)) return 0;
    for (int j = 0; j < count; j++) {
        const double *p = flat[ring[j]];
        if (p == a || p == b || p == c) continue;
        if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0) return 0;
    }
    return area / (length_squared(a, b) + length_squared(b, c) + length_squared(c, a));
}

void enf_gen_polygon(enf_gen_world *world, int axis, int facing, const int32_t *corners, size_t count) {
    double flat[POLYGON_CORNERS_MAX][2];
    int ring[POLYGON_CORNERS_MAX];
    if (world->failed || count > POLYGON_CORNERS_MAX) {
        world->failed = true;
        return;
    }
    for (size_t i = 0; i < count; i++) {
        const double *point = world->points[corners[i]];
        flat[i][0] = point[(axis + 1) % 3] * facing;
        flat[i][1] = point[(axis + 2) % 3];
        ring[i] = (int)i;
    }
    for (int left = (int)count; left >= 3; left--) {
        int best = -1;
        double best_quality = 0;
        for (int i = 0; i < left; i++) {
            double quality = ear_quality(flat, ring, left, i);
            if (quality > best_quality) best_quality = quality, best = i;
        }
        if (best < 0) { // not a simple polygon: a mistake in a world
            world->failed = true;
            return;
        }
        enf_gen_triangle(world, corners[ring[(best + left - 1) % left]], corners[ring[best]],
                         corners[ring[(best + 1) % left]]);
        memmove(ring + best, ring + best + 1, (size_t)(left - 1 - best) * sizeof *ring);
    }
}
