// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/clean_fixture.h"

#include "base/exact.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

uint64_t fixture_random(uint64_t *seed) {
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

const enf_clean_options fixture_exact_options = {.weld = 0, .plane_tolerance = 0};

// ---- making soups

/// Adds a polygon with points of its own.
void fixture_add_polygon(enf_soup *soup, size_t count, const double (*at)[3], const char *group) {
    int32_t corners[64];
    assert_true(count <= 64);
    for (size_t i = 0; i < count; i++) {
        corners[i] = (int32_t)soup->point_count;
        assert_true(enf_soup_add_point(soup, at[i][0], at[i][1], at[i][2]));
    }
    int32_t number = enf_soup_group(soup, group);
    assert_true(number >= 0);
    assert_true(enf_soup_add_polygon(soup, count, corners, NULL, NULL, -1, 0, number, -1));
}

/// A closed box that faces outwards.
void fixture_add_box(enf_soup *soup, const double low[3], const double high[3], const char *group) {
    static const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (int f = 0; f < 6; f++) {
        double at[4][3];
        for (int k = 0; k < 4; k++)
            for (int a = 0; a < 3; a++) at[k][a] = faces[f][k] >> a & 1 ? high[a] : low[a];
        fixture_add_polygon(soup, 4, (const double(*)[3])at, group);
    }
}

// ---- judging meshes

/// Sign of (b - a) x (c - a) along an axis, exactly; coordinates are whole numbers up to 2^53.
static int turn_along(const double *a, const double *b, const double *c, int axis) {
    __extension__ typedef __int128 wide;
    int u = (axis + 1) % 3, v = (axis + 2) % 3;
    wide left = ((wide)b[u] - (wide)a[u]) * ((wide)c[v] - (wide)a[v]);
    wide right = ((wide)b[v] - (wide)a[v]) * ((wide)c[u] - (wide)a[u]);
    return (left > right) - (left < right);
}

/// Every corner lies strictly on the inner side of every edge that it is not an end of.
static bool is_strictly_convex(const double *points, const int32_t *ring, int count, const int32_t plane[3]) {
    int axis = 0, side = 0;
    for (int k = 0; k < 3 && side == 0; k++) {
        axis = k;
        side = turn_along(&points[3 * plane[0]], &points[3 * plane[1]], &points[3 * plane[2]], axis);
    }
    if (side == 0) return false;
    for (int i = 0; i < count && count < 100; i++)
        for (int k = 0; k < count; k++) {
            int j = (i + 1) % count;
            if (k == i || k == j) continue;
            if (turn_along(&points[3 * ring[i]], &points[3 * ring[j]], &points[3 * ring[k]], axis) != side)
                return false;
        }
    return true;
}

void fixture_check_mesh(const enf_mesh *mesh) {
    for (size_t p = 1; p < mesh->point_count; p++) {
        const double *a = &mesh->points[3 * p - 3], *b = a + 3;
        assert_true(a[0] < b[0] || (a[0] == b[0] && (a[1] < b[1] || (a[1] == b[1] && a[2] < b[2]))));
    }
    for (size_t i = 0; i < 3 * mesh->point_count; i++)
        assert_true(mesh->points[i] == nearbyint(mesh->points[i]) && fabs(mesh->points[i]) <= 0x1p53);
    for (size_t p = 0; p < mesh->polygon_count; p++) {
        const int32_t *ring = &mesh->corners[mesh->polygon_corner[p]];
        int count = (int)(mesh->polygon_corner[p + 1] - mesh->polygon_corner[p]);
        assert_true(count >= 3);
        const int32_t *plane = mesh->polygon_plane[p];
        const double *a = &mesh->points[3 * plane[0]], *b = &mesh->points[3 * plane[1]],
                     *c = &mesh->points[3 * plane[2]];
        for (int k = 1; k < count; k++) assert_true(ring[k] > ring[0]);
        assert_true(is_strictly_convex(mesh->points, ring, count, plane));
        for (int k = 0; k < count; k++)
            assert_int_equal(enf_points_orient(a, b, c, &mesh->points[3 * ring[k]]), 0);
    }
}

void fixture_check_accounts(const enf_soup *soup, const enf_mesh *mesh) {
    int *times = calloc(soup->polygon_count + 1, sizeof *times);
    assert_non_null(times);
    for (size_t p = 0; p < mesh->polygon_count; p++) times[mesh->polygon_source[p]] = 1;
    for (size_t d = 0; d < mesh->detail_count; d++) times[mesh->details[d]]++;
    for (size_t r = 0; r < soup->rejected_count; r++)
        if (soup->rejected[r].polygon >= 0) times[soup->rejected[r].polygon]++;
    for (size_t p = 0; p < soup->polygon_count; p++)
        if (times[p] != 1) fail_msg("soup polygon %zu is accounted for %d times", p, times[p]);
    free(times);
}

size_t fixture_count_rejected(const enf_soup *soup, enf_reject reason) {
    size_t count = 0;
    for (size_t i = 0; i < soup->rejected_count; i++) count += soup->rejected[i].reason == reason;
    return count;
}
