// SPDX-License-Identifier: GPL-3.0-or-later
// Both removals are reductions of a cyclic word (equal neighbours merge, a step forth and back cancels), so
// their result is the same, up to rotation, wherever they begin. Smallest rotation: Shiloach, "Fast
// canonization of circular strings", 1981.
#include "build/ring.h"

#include "base/exact.h"
#include "build/planar.h"

#include <string.h>

/// True if b can go from between a and c.
static bool is_idle(int32_t a, int32_t b, int32_t c, const double *points) {
    if (a == c) return true;
    return points &&
           enf_planar_collinear(&points[3 * (size_t)a], &points[3 * (size_t)b], &points[3 * (size_t)c]);
}

static size_t reduce(int32_t *ring, size_t count, const double *points) {
    size_t low = 0, high = 0; // what is kept: ring[low .. high)
    for (size_t i = 0; i < count; i++) {
        int32_t corner = ring[i];
        while (high >= 2 && is_idle(ring[high - 2], ring[high - 1], corner, points)) high--;
        if (high == 0 || ring[high - 1] != corner) ring[high++] = corner;
    }
    while (high - low >= 2) { // where the ends meet
        if (ring[low] == ring[high - 1])
            high--;
        else if (high - low >= 3 && is_idle(ring[high - 2], ring[high - 1], ring[low], points))
            high--;
        else if (high - low >= 3 && is_idle(ring[high - 1], ring[low], ring[low + 1], points))
            low++;
        else
            break;
    }
    memmove(ring, ring + low, (high - low) * sizeof *ring);
    return high - low;
}

size_t enf_ring_remove_repeats(int32_t *ring, size_t count) {
    return reduce(ring, count, NULL);
}

size_t enf_ring_remove_collinear(int32_t *ring, size_t count, const double *points) {
    return reduce(ring, count, points);
}

static void reverse(int32_t *ring, size_t count) {
    for (size_t i = 0; i + 1 < count - i; i++) {
        int32_t swap = ring[i];
        ring[i] = ring[count - 1 - i];
        ring[count - 1 - i] = swap;
    }
}

void enf_ring_rotate(int32_t *ring, size_t count) {
    size_t a = 0, b = 1, same = 0;
    while (a < count && b < count && same < count) {
        int32_t left = ring[(a + same) % count], right = ring[(b + same) % count];
        if (left == right) {
            same++;
            continue;
        }
        if (left > right)
            a += same + 1;
        else
            b += same + 1;
        if (a == b) b++;
        same = 0;
    }
    size_t first = a < b ? a : b;
    if (first == 0 || first >= count) return;
    reverse(ring, first); // rotation by three reversals
    reverse(ring + first, count - first);
    reverse(ring, count);
}

void enf_ring_projection(const int32_t *ring, size_t count, const double *points, int *u, int *v, int *sign) {
    const double *origin = &points[3 * (size_t)ring[0]];
    enf_int128 normal[3] = {0}; // exact: a term has 110 bits, count at most 17 more
    for (size_t i = 1; i + 1 < count; i++) {
        const double *p = &points[3 * (size_t)ring[i]], *q = &points[3 * (size_t)ring[i + 1]];
        int64_t a[3], b[3];
        for (int k = 0; k < 3; k++) {
            a[k] = (int64_t)p[k] - (int64_t)origin[k];
            b[k] = (int64_t)q[k] - (int64_t)origin[k];
        }
        for (int k = 0; k < 3; k++) {
            int next = (k + 1) % 3, last = (k + 2) % 3;
            normal[k] += (enf_int128)a[next] * b[last] - (enf_int128)a[last] * b[next];
        }
    }
    int axis = 0;
    enf_int128 largest = -1;
    for (int k = 0; k < 3; k++) {
        enf_int128 size = normal[k] < 0 ? -normal[k] : normal[k];
        if (size > largest) largest = size, axis = k;
    }
    *u = (axis + 1) % 3;
    *v = (axis + 2) % 3;
    *sign = normal[axis] < 0 ? -1 : 1;
}

static bool is_planar(const int32_t *ring, size_t count, const double *points) {
    const double *a = &points[3 * (size_t)ring[0]], *b = &points[3 * (size_t)ring[1]],
                 *c = &points[3 * (size_t)ring[2]];
    for (size_t i = 3; i < count; i++)
        if (enf_points_orient(a, b, c, &points[3 * (size_t)ring[i]]) != 0) return false;
    return true;
}

/// -1 or +1: which way, lexicographically in (u, v), the edge from corner i goes.
static int edge_direction(const int32_t *ring, size_t count, const double *points, size_t i, int u, int v) {
    const double *p = &points[3 * (size_t)ring[i]], *q = &points[3 * (size_t)ring[(i + 1) % count]];
    if (p[u] != q[u]) return p[u] < q[u] ? 1 : -1;
    return p[v] < q[v] ? 1 : -1;
}

bool enf_ring_is_convex(const int32_t *ring, size_t count, const double *points) {
    if (!is_planar(ring, count, points)) return false;
    if (count == 3) return true;
    const double *first = &points[3 * (size_t)ring[0]], *second = &points[3 * (size_t)ring[1]],
                 *third = &points[3 * (size_t)ring[2]];
    int u = 0, v = 1, side = 0; // any projection that shows the first corner's turn shows the whole plane
    for (int k = 0; k < 3 && side == 0; k++) {
        u = k, v = (k + 1) % 3;
        side = enf_planar_turn(first, second, third, u, v);
    }
    size_t changes = 0;
    for (size_t i = 0; i < count; i++) {
        const double *a = &points[3 * (size_t)ring[i]], *b = &points[3 * (size_t)ring[(i + 1) % count]],
                     *c = &points[3 * (size_t)ring[(i + 2) % count]];
        if (enf_planar_turn(a, b, c, u, v) != side) return false;
        changes += edge_direction(ring, count, points, i, u, v) !=
                   edge_direction(ring, count, points, (i + 1) % count, u, v);
    }
    return changes == 2;
}

/// Squared length of the cross product of (b - a) and (c - a).
static double spread(const double *points, int32_t a, int32_t b, int32_t c) {
    const double *p = &points[3 * (size_t)a], *q = &points[3 * (size_t)b], *r = &points[3 * (size_t)c];
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        int u = (k + 1) % 3, v = (k + 2) % 3;
        double component = (q[u] - p[u]) * (r[v] - p[v]) - (q[v] - p[v]) * (r[u] - p[u]);
        sum += component * component;
    }
    return sum;
}

static double distance_squared(const double *points, int32_t a, int32_t b) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double difference = points[3 * (size_t)b + k] - points[3 * (size_t)a + k];
        sum += difference * difference;
    }
    return sum;
}

/// Many corners: the first, the one farthest from it, and the one farthest from the line through these two.
static void plane_of_many(const int32_t *ring, size_t count, const double *points, int32_t plane[3]) {
    size_t far = 1, third = 0;
    for (size_t i = 2; i < count; i++)
        if (distance_squared(points, ring[0], ring[i]) > distance_squared(points, ring[0], ring[far]))
            far = i;
    double best = -1;
    for (size_t i = 1; i < count; i++) {
        double size = i == far ? -1 : spread(points, ring[0], ring[far], ring[i]);
        if (size > best) best = size, third = i;
    }
    plane[0] = ring[0];
    plane[1] = ring[far < third ? far : third];
    plane[2] = ring[far < third ? third : far];
}

void enf_ring_plane(const int32_t *ring, size_t count, const double *points, int32_t plane[3]) {
    enum { FEW = 12 };
    if (count > FEW) {
        plane_of_many(ring, count, points, plane);
        return;
    }
    double best = -1;
    for (size_t i = 0; i < count; i++)
        for (size_t j = i + 1; j < count; j++)
            for (size_t k = j + 1; k < count; k++) {
                double size = spread(points, ring[i], ring[j], ring[k]);
                if (size <= best) continue;
                best = size;
                plane[0] = ring[i], plane[1] = ring[j], plane[2] = ring[k];
            }
}
