// SPDX-License-Identifier: GPL-3.0-or-later
// Clean: what comes out is planar, convex and in canonical order whatever goes in, and every input polygon is
// accounted for.
#include "base/exact.h"
#include "build/clean.h"
#include "build/weld.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint64_t next_random(uint64_t *seed) {
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static const enf_clean_options exact_options = {.weld = 0, .plane_tolerance = 0};

// ---- making soups

/// Adds a polygon with points of its own.
static void add_polygon(enf_soup *soup, size_t count, const double (*at)[3], const char *group) {
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
static void add_box(enf_soup *soup, const double low[3], const double high[3], const char *group) {
    static const int faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                    {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (int f = 0; f < 6; f++) {
        double at[4][3];
        for (int k = 0; k < 4; k++)
            for (int a = 0; a < 3; a++) at[k][a] = faces[f][k] >> a & 1 ? high[a] : low[a];
        add_polygon(soup, 4, (const double(*)[3])at, group);
    }
}

/// Boxes, triangles and broken polygons at small whole coordinates: a world full of coincidences.
static void add_random_world(enf_soup *soup, uint64_t *seed, int size) {
    for (int i = 0; i < size; i++) {
        double low[3], high[3];
        for (int a = 0; a < 3; a++) {
            low[a] = (double)(next_random(seed) % 8);
            high[a] = low[a] + 1 + (double)(next_random(seed) % 4) * (a + 1);
        }
        add_box(soup, low, high, "boxes");
        double at[8][3];
        size_t count = 1 + next_random(seed) % 8;
        for (size_t k = 0; k < count; k++)
            for (int a = 0; a < 3; a++)
                at[k][a] = (double)(next_random(seed) % 10) / (next_random(seed) % 4 ? 1 : 3);
        if (next_random(seed) % 9 == 0) at[0][1] = NAN;
        add_polygon(soup, count, (const double(*)[3])at, "chaos");
        if (next_random(seed) % 3 == 0) add_polygon(soup, count, (const double(*)[3])at, "again");
    }
}

static void copy_soup(enf_soup *to, const enf_soup *from, const size_t *polygon_order,
                      const int32_t *point_of, const double *points, uint64_t *rotate_seed) {
    for (size_t p = 0; p < from->point_count; p++)
        assert_true(enf_soup_add_point(to, points[3 * p], points[3 * p + 1], points[3 * p + 2]));
    for (size_t k = 0; k < from->polygon_count; k++) {
        size_t polygon = polygon_order ? polygon_order[k] : k;
        int64_t first = from->polygon_corner[polygon];
        size_t count = (size_t)(from->polygon_corner[polygon + 1] - first);
        size_t shift = rotate_seed ? next_random(rotate_seed) % count : 0;
        int32_t corners[64];
        for (size_t i = 0; i < count; i++) {
            int32_t point = from->corner_point[first + (int64_t)((i + shift) % count)];
            corners[i] = point_of ? point_of[point] : point;
        }
        assert_true(enf_soup_add_polygon(to, count, corners, NULL, NULL, -1, 0, enf_soup_group(to, ""), -1));
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

static void check_mesh(const enf_mesh *mesh) {
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

static void check_accounts(const enf_soup *soup, const enf_mesh *mesh) {
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

static void check_same(const enf_mesh *a, const enf_mesh *b) {
    assert_int_equal(a->point_count, b->point_count);
    assert_memory_equal(a->points, b->points, a->point_count * 3 * sizeof *a->points);
    assert_int_equal(a->polygon_count, b->polygon_count);
    assert_memory_equal(a->polygon_corner, b->polygon_corner,
                        (a->polygon_count + 1) * sizeof *a->polygon_corner);
    size_t corners = (size_t)a->polygon_corner[a->polygon_count];
    assert_memory_equal(a->corners, b->corners, corners * sizeof *a->corners);
    assert_memory_equal(a->polygon_plane, b->polygon_plane, a->polygon_count * sizeof *a->polygon_plane);
    assert_int_equal(a->two_sided, b->two_sided);
    assert_int_equal(a->triangulated, b->triangulated);
    assert_int_equal(a->welded, b->welded);
}

/// Twice the sum of the polygons' area vectors, in world units.
static void area_vector(const enf_mesh *mesh, double sum[3]) {
    sum[0] = sum[1] = sum[2] = 0;
    for (size_t p = 0; p < mesh->polygon_count; p++) {
        const int32_t *ring = &mesh->corners[mesh->polygon_corner[p]];
        double first[3];
        enf_frame_to_world(&mesh->frame, &mesh->points[3 * ring[0]], first);
        for (int64_t i = 1; i + 1 < mesh->polygon_corner[p + 1] - mesh->polygon_corner[p]; i++) {
            double b[3], c[3];
            enf_frame_to_world(&mesh->frame, &mesh->points[3 * ring[i]], b);
            enf_frame_to_world(&mesh->frame, &mesh->points[3 * ring[i + 1]], c);
            for (int a = 0; a < 3; a++) {
                int u = (a + 1) % 3, v = (a + 2) % 3;
                sum[a] += (b[u] - first[u]) * (c[v] - first[v]) - (b[v] - first[v]) * (c[u] - first[u]);
            }
        }
    }
}

static size_t count_rejected(const enf_soup *soup, enf_reject reason) {
    size_t count = 0;
    for (size_t i = 0; i < soup->rejected_count; i++) count += soup->rejected[i].reason == reason;
    return count;
}

/// Cleans one polygon with exact options; returns how many polygons come of it, and the first reason if none.
static size_t clean_one(size_t count, const double (*at)[3], double area[3], enf_reject *reason) {
    enf_soup soup = {0};
    enf_mesh mesh = {0};
    add_polygon(&soup, count, at, "");
    enf_error error;
    enf_status status = enf_mesh_clean(&mesh, &soup, &exact_options, &error);
    size_t made = mesh.polygon_count;
    assert_int_equal(status, made ? ENF_OK : ENF_BAD_INPUT);
    if (made) {
        check_mesh(&mesh);
        area_vector(&mesh, area);
        // A mirrored frame has turned the polygons over so that they are right on the grid; turn them back.
        for (int a = 0; a < 3; a++) area[a] *= mesh.frame.handedness;
    } else {
        *reason = soup.rejected[0].reason;
    }
    enf_mesh_free(&mesh);
    enf_soup_free(&soup);
    return made;
}

// ---- single polygons

static void convex_planar_polygons_stay_whole(void **state) {
    (void)state;
    const double pentagon[][3] = {{0, 0, 1}, {2, 0, 1}, {3, 2, 1}, {1, 3, 1}, {-1, 2, 1}};
    double area[3];
    enf_reject reason;
    assert_int_equal(clean_one(5, pentagon, area, &reason), 1);
    assert_true(area[2] == 16 && area[0] == 0 && area[1] == 0);
}

static void fronts_stay_fronts(void **state) {
    (void)state;
    const double square[][3] = {{0, 0, 5}, {0, 1, 5}, {3, 1, 5}, {3, 0, 5}};
    double area[3];
    enf_reject reason;
    assert_int_equal(clean_one(4, square, area, &reason), 1);
    assert_true(area[2] == -6);
}

static void concave_polygons_become_triangles_of_the_same_area(void **state) {
    (void)state;
    const double corner[][3] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {3, 4, 0}, {3, 1, 0}, {0, 1, 0}};
    double area[3];
    enf_reject reason;
    assert_int_equal(clean_one(6, corner, area, &reason), 4);
    assert_true(area[2] == 2 * 7);
    const double bridged[][3] = {{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}, {0, 0, 0},
                                 {2, 2, 0}, {2, 4, 0}, {4, 4, 0}, {4, 2, 0}, {2, 2, 0}};
    assert_int_equal(clean_one(10, bridged, area, &reason), 8);
    assert_true(area[2] == 2 * 32);
}

static void nonplanar_polygons_become_triangles(void **state) {
    (void)state;
    const double bent[][3] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 1}, {0, 4, 0}};
    double area[3];
    enf_reject reason;
    assert_int_equal(clean_one(4, bent, area, &reason), 2);
    assert_true(area[2] == 32);
}

static void crossed_polygons_end_and_leave_something(void **state) {
    (void)state;
    const double bow[][3] = {{0, 0, 0}, {4, 4, 0}, {4, 0, 0}, {0, 4, 0}};
    const double star[][3] = {{0, 3, 0}, {-2, -3, 0}, {3, 1, 0}, {-3, 1, 0}, {2, -3, 0}};
    double area[3];
    enf_reject reason;
    assert_true(clean_one(4, bow, area, &reason) > 0);
    assert_true(clean_one(5, star, area, &reason) > 0);
}

/// The area vector of a ring of corners, doubled.
static void ring_area(size_t count, const double (*at)[3], double sum[3]) {
    for (int a = 0; a < 3; a++) {
        int u = (a + 1) % 3, v = (a + 2) % 3;
        sum[a] = 0;
        for (size_t i = 0; i < count; i++) {
            const double *p = at[i], *q = at[(i + 1) % count];
            sum[a] += p[u] * q[v] - p[v] * q[u];
        }
    }
}

static void triangles_of_any_ring_add_up_to_its_area(void **state) {
    (void)state;
    uint64_t seed = 5;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 3000; round++) {
        double at[12][3], made[3], wanted[3];
        size_t count = 3 + next_random(&seed) % 10;
        for (size_t i = 0; i < count; i++)
            for (int a = 0; a < 3; a++) at[i][a] = (double)(next_random(&seed) % (round % 2 ? 4 : 1000));
        if (round % 3 == 0)
            for (size_t i = 0; i < count; i++) at[i][2] = 3;
        ring_area(count, (const double(*)[3])at, wanted);
        enf_reject reason;
        if (clean_one(count, (const double(*)[3])at, made, &reason) == 0) continue;
        // On the small grid a ring may go around the same triangle twice, and then one of the two is a
        // duplicate.
        for (int a = 0; a < 3 && round % 2 == 0; a++) assert_true(made[a] == wanted[a]);
    }
}

static void triangles_of_simple_rings_cover_them_once(void **state) {
    (void)state;
    uint64_t seed = 6;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 500; round++) {
        double at[60][3], area[3] = {0}, wanted[3];
        size_t count = 4 + next_random(&seed) % 56;
        enf_soup soup = {0};
        enf_mesh mesh;
        for (size_t i = 0; i < count; i++) { // a star around the middle: simple
            double angle = 6.283185307179586 * (double)i / (double)count;
            double radius = 1000 + (double)(next_random(&seed) % 20000);
            at[i][0] = round % 3 == 0 ? 5 : nearbyint(radius * cos(angle));
            at[i][1] = nearbyint(radius * sin(angle));
            at[i][2] = round % 3 == 0 ? nearbyint(radius * cos(angle)) : at[i][0] * (round % 3 - 1) + 7;
        }
        ring_area(count, (const double(*)[3])at, wanted);
        add_polygon(&soup, count, (const double(*)[3])at, "");
        assert_int_equal(enf_mesh_clean(&mesh, &soup, &exact_options, NULL), ENF_OK);
        check_mesh(&mesh);
        for (size_t p = 0; p < mesh.polygon_count; p++) { // of one plane, so equal signs mean no overlap
            double one[3] = {0}, triangle[3][3];
            for (int k = 0; k < 3; k++)
                enf_frame_to_world(&mesh.frame, &mesh.points[3 * mesh.corners[mesh.polygon_corner[p] + k]],
                                   triangle[k]);
            ring_area(3, (const double(*)[3])triangle, one);
            for (int a = 0; a < 3; a++) {
                assert_true(one[a] * mesh.frame.handedness * wanted[a] >= 0);
                area[a] += one[a] * mesh.frame.handedness;
            }
        }
        for (int a = 0; a < 3 && mesh.polygon_count > 1; a++) assert_true(area[a] == wanted[a]);
        enf_mesh_free(&mesh);
        enf_soup_free(&soup);
    }
}

static void corners_without_purpose_go(void **state) {
    (void)state;
    const double repeated[][3] = {{0, 0, 0}, {0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {5, 9, 2},
                                  {4, 4, 0}, {2, 4, 0}, {0, 4, 0}, {0, 0, 0}};
    double area[3];
    enf_reject reason;
    assert_int_equal(clean_one(9, repeated, area, &reason), 1);
    assert_true(area[2] == 32);
}

static void polygons_without_area_are_rejected_with_the_reason(void **state) {
    (void)state;
    double area[3];
    enf_reject reason = ENF_REJECT_COUNT;
    const double line[][3] = {{0, 0, 0}, {1, 2, 3}, {3, 6, 9}, {2, 4, 6}};
    assert_int_equal(clean_one(4, line, area, &reason), 0);
    assert_int_equal(reason, ENF_REJECT_NO_AREA);
    const double needle[][3] = {{0, 0, 0}, {1, 2, 3}, {0, 0, 0}, {3, 3, 3}};
    assert_int_equal(clean_one(4, needle, area, &reason), 0);
    assert_int_equal(reason, ENF_REJECT_TOO_FEW_CORNERS);
    const double infinite[][3] = {{0, 0, 0}, {1, 2, INFINITY}, {0, 0, 1}};
    assert_int_equal(clean_one(3, infinite, area, &reason), 0);
    assert_int_equal(reason, ENF_REJECT_NOT_FINITE);
    const double huge[][3] = {{0, 0, 0}, {1, 2, 1e308}, {0, 0, 1}};
    assert_int_equal(clean_one(3, huge, area, &reason), 0);
    assert_int_equal(reason, ENF_REJECT_TOO_LARGE);
    const double almost[][3] = {{0, 0, 0}, {0x1p52, 0x1p52, 0}, {0x1p52 - 1, 0x1p52 - 2, 0}};
    assert_int_equal(clean_one(3, almost, area, &reason), 1);
}

static void extreme_scales_survive(void **state) {
    (void)state;
    static const double scales[] = {1e150, 1e-150, 1e-310, 5e-324, 1};
    for (int s = 0; s < 5; s++) {
        double k = scales[s];
        const double square[][3] = {{0, 0, 0}, {k, 0, 0}, {k, k, 0}, {0, k, 0}};
        enf_soup soup = {0};
        enf_mesh mesh;
        add_polygon(&soup, 4, square, "");
        assert_int_equal(enf_mesh_clean(&mesh, &soup, NULL, NULL), ENF_OK);
        assert_int_equal(mesh.polygon_count, 1);
        assert_int_equal(mesh.point_count, 4);
        double world[3];
        enf_frame_to_world(&mesh.frame, &mesh.points[0], world);
        assert_true((world[0] == 0 || world[0] == k) && world[2] == 0);
        check_mesh(&mesh);
        enf_mesh_free(&mesh);
        enf_soup_free(&soup);
    }
}

static void worlds_in_one_point_or_empty_fail_with_words(void **state) {
    (void)state;
    const double nothing[][3] = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
    double area[3];
    enf_reject reason;
    assert_int_equal(clean_one(3, nothing, area, &reason), 0);
    assert_int_equal(reason, ENF_REJECT_TOO_FEW_CORNERS);
    enf_soup soup = {0};
    enf_mesh mesh;
    enf_error error;
    assert_int_equal(enf_mesh_clean(&mesh, &soup, NULL, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "no polygons"));
    enf_soup_free(&soup);
}

static void a_failure_names_the_first_rejected_polygon(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_mesh mesh;
    enf_error error;
    const double line[][3] = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    add_polygon(&soup, 3, line, "");
    soup.files = malloc(sizeof *soup.files);
    assert_non_null(soup.files);
    soup.files[soup.file_count++] = strdup("cellar.obj");
    soup.polygon_file[0] = 0;
    soup.polygon_line[0] = 77;
    assert_int_equal(enf_mesh_clean(&mesh, &soup, NULL, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "cellar.obj:77:"));
    assert_non_null(strstr(error.text, "no-area"));
    enf_soup_free(&soup);
}

static uint64_t enormous_seed = 7;

/// Cleans a polygon of `count` corners on a circle of radius `radius`, jagged if asked for.
static void clean_enormous(size_t count, bool jagged, enf_status wanted) {
    enf_soup soup = {0};
    enf_mesh mesh;
    int32_t *corners = malloc(count * sizeof *corners);
    assert_non_null(corners);
    for (size_t i = 0; i < count; i++) {
        double angle = 6.283185307179586 * (double)i / (double)count;
        double radius = jagged && i % 2 ? 1 + (double)(next_random(&enormous_seed) % 1000) / 2000 : 2;
        corners[i] = (int32_t)i;
        assert_true(enf_soup_add_point(&soup, radius * cos(angle), radius * sin(angle), 0));
    }
    assert_true(enf_soup_add_polygon(&soup, count, corners, NULL, NULL, -1, 0, 0, -1));
    free(corners);
    assert_int_equal(enf_mesh_clean(&mesh, &soup, &exact_options, NULL), wanted);
    if (wanted == ENF_OK) {
        check_mesh(&mesh);
        assert_int_equal(mesh.polygon_count, jagged ? count - 2 : 1);
    } else {
        assert_int_equal(soup.rejected[0].reason, ENF_REJECT_TOO_COMPLEX);
    }
    enf_mesh_free(&mesh);
    enf_soup_free(&soup);
}

static void polygons_of_many_corners_end_in_time(void **state) {
    (void)state;
    clean_enormous(1000, false, ENF_OK);
    clean_enormous(4000, true, ENF_OK);
    clean_enormous(300000, true, ENF_BAD_INPUT);
}

// ---- groups

static void globs_match_object_group_or_both(void **state) {
    (void)state;
    enf_soup soup = {0};
    const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    static const char *const groups[] = {"world/solid", "world/clip", "door_1/solid", "lamp", ""};
    for (int g = 0; g < 5; g++) {
        double low_g[3] = {low[0] + 3 * g, low[1], low[2]}, high_g[3] = {high[0] + 3 * g, high[1], high[2]};
        add_box(&soup, low_g, high_g, groups[g]);
    }
    const char *const exclude[] = {"clip"}, *const detail[] = {"door_*", "l?mp"};
    enf_clean_options options = {.weld = -1,
                                 .plane_tolerance = -1,
                                 .exclude = exclude,
                                 .exclude_count = 1,
                                 .detail = detail,
                                 .detail_count = 2};
    enf_mesh mesh;
    assert_int_equal(enf_mesh_clean(&mesh, &soup, &options, NULL), ENF_OK);
    assert_int_equal(count_rejected(&soup, ENF_REJECT_EXCLUDED), 6);
    assert_int_equal(mesh.detail_count, 12);
    assert_int_equal(mesh.polygon_count, 12);
    assert_int_equal(mesh.point_count, 16);
    check_accounts(&soup, &mesh);
    enf_mesh_free(&mesh);
    const char *const all[] = {"world/*", "*"};
    options = (enf_clean_options){.weld = -1, .plane_tolerance = -1, .detail = all, .detail_count = 2};
    enf_error error;
    assert_int_equal(enf_mesh_clean(&mesh, &soup, &options, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "--detail"));
    enf_soup_free(&soup);
}

// ---- welding and planes

static void points_weld_within_the_distance_and_no_further(void **state) {
    (void)state;
    enf_soup soup = {0};
    const double first[][3] = {{0, 0, 0}, {8, 0, 0}, {0, 8, 0}},
                 second[][3] = {{0, 0, 0.125}, {0, 8, -0.125}, {-8, 0, 0.25}};
    add_polygon(&soup, 3, first, "");
    add_polygon(&soup, 3, second, "");
    enf_mesh mesh;
    enf_clean_options options = {.weld = 0.125};
    assert_int_equal(enf_mesh_clean(&mesh, &soup, &options, NULL), ENF_OK);
    assert_int_equal(mesh.point_count, 4);
    assert_int_equal(mesh.welded, 2);
    assert_true(mesh.displacement_max == 0.125);
    enf_mesh_free(&mesh);
    options.weld = 0.1249;
    assert_int_equal(enf_mesh_clean(&mesh, &soup, &options, NULL), ENF_OK);
    assert_int_equal(mesh.point_count, 6);
    assert_true(mesh.displacement_max == 0);
    enf_mesh_free(&mesh);
    options.weld = 1e300; // everything becomes one point
    assert_int_equal(enf_mesh_clean(&mesh, &soup, &options, NULL), ENF_BAD_INPUT);
    options.weld = NAN;
    assert_int_equal(enf_mesh_clean(&mesh, &soup, &options, NULL), ENF_BAD_USAGE);
    enf_soup_free(&soup);
}

static void welding_agrees_with_the_plain_definition(void **state) {
    (void)state;
    uint64_t seed = 99;
    for (int round = 0; round < 20; round++) {
        enf_soup soup = {0};
        for (int t = 0; t < 100; t++) {
            double at[3][3];
            for (int k = 0; k < 9; k++) at[k / 3][k % 3] = (double)(next_random(&seed) % 1000);
            add_polygon(&soup, 3, (const double(*)[3])at, "");
        }
        enf_mesh exact, welded;
        enf_clean_options options = {.weld = 20 + 10 * round};
        assert_int_equal(enf_mesh_clean(&exact, &soup, &exact_options, NULL), ENF_OK);
        enf_status status = enf_mesh_clean(&welded, &soup, &options, NULL);
        double distance = options.weld / exact.frame.step;
        size_t kept = 0; // of the sorted points, those that no kept one is near to
        double *points = malloc(exact.point_count * 3 * sizeof *points);
        assert_non_null(points);
        for (size_t p = 0; p < exact.point_count; p++) {
            bool joins = false;
            for (size_t q = 0; q < kept && !joins; q++) {
                double sum = 0;
                for (int a = 0; a < 3; a++) sum += pow(exact.points[3 * p + a] - points[3 * q + a], 2);
                joins = sum <= distance * distance;
            }
            if (!joins) memcpy(&points[3 * kept++], &exact.points[3 * p], 3 * sizeof *points);
        }
        if (status == ENF_OK) {
            assert_true(welded.displacement_max <= options.weld);
            assert_true(welded.point_count <= kept);
            assert_int_equal(exact.point_count - welded.welded, kept);
            for (size_t p = 0; p < welded.point_count; p++) {
                bool known = false;
                for (size_t q = 0; q < kept && !known; q++)
                    known = memcmp(&welded.points[3 * p], &points[3 * q], 3 * sizeof *points) == 0;
                assert_true(known);
            }
        }
        free(points);
        enf_mesh_free(&exact);
        enf_mesh_free(&welded);
        enf_soup_free(&soup);
    }
}

static void each_site_joins_the_first_representative_in_reach(void **state) {
    (void)state;
    enum { COUNT = 600 };
    uint64_t seed = 17;
    for (int round = 0; round < 40; round++) {
        enf_site sites[COUNT];
        int32_t joined_to[COUNT];
        double distance = 1 + (double)(next_random(&seed) % 400) / 2;
        for (int i = 0; i < COUNT; i++) {
            sites[i].id = i;
            for (int a = 0; a < 3; a++)
                sites[i].at[a] = (double)(next_random(&seed) % (round % 2 ? 1000 : 100)) - 500;
        }
        enf_sites_sort(sites, COUNT);
        int32_t group_of[COUNT];
        size_t count = enf_sites_unite(sites, COUNT, group_of);
        assert_int_equal(enf_sites_weld(sites, count, distance, joined_to, NULL), ENF_OK);
        for (size_t i = 0; i < count; i++) {
            size_t first = i;
            for (size_t j = 0; j < i && first == i; j++) {
                double sum = 0;
                for (int a = 0; a < 3; a++) sum += pow(sites[i].at[a] - sites[j].at[a], 2);
                if (joined_to[j] == (int32_t)j && sum <= distance * distance) first = j;
            }
            assert_int_equal(joined_to[i], first);
        }
    }
}

static void the_plane_tolerance_recovers_axis_parallel_planes(void **state) {
    (void)state;
    enf_soup soup = {0};
    const double torn[][3] = {{0, 0, 1.001}, {5, 0.001, 0.999}, {5.0005, 5, 1}, {0.0005, 5, 1.0005}};
    add_polygon(&soup, 4, torn, "");
    enf_mesh mesh;
    enf_clean_options options = {.weld = 0, .plane_tolerance = 0.01};
    assert_int_equal(enf_mesh_clean(&mesh, &soup, &exact_options, NULL), ENF_OK);
    assert_int_equal(mesh.polygon_count, 2);
    enf_mesh_free(&mesh);
    assert_int_equal(enf_mesh_clean(&mesh, &soup, &options, NULL), ENF_OK);
    assert_int_equal(mesh.polygon_count, 1);
    assert_true(mesh.displacement_max > 0 && mesh.displacement_max <= 0.01 * 1.7320508075688774);
    assert_true(mesh.plane_tolerance == 0.01);
    enf_mesh_free(&mesh);
    enf_soup_free(&soup);
}

static void duplicates_go_and_twins_stay(void **state) {
    (void)state;
    enf_soup soup = {0};
    const double front[][3] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}},
                 turned[][3] = {{1, 0, 0}, {0, 2, 0}, {0, 0, 0}},
                 back[][3] = {{0, 0, 0}, {0, 2, 0}, {1, 0, 0}};
    add_polygon(&soup, 3, front, "");
    add_polygon(&soup, 3, turned, "");
    add_polygon(&soup, 3, back, "");
    enf_mesh mesh;
    assert_int_equal(enf_mesh_clean(&mesh, &soup, NULL, NULL), ENF_OK);
    assert_int_equal(mesh.polygon_count, 2);
    assert_int_equal(mesh.two_sided, 2);
    assert_int_equal(soup.rejected_count, 1);
    assert_int_equal(soup.rejected[0].reason, ENF_REJECT_DUPLICATE);
    assert_int_equal(soup.rejected[0].polygon, 1);
    check_accounts(&soup, &mesh);
    enf_mesh_free(&mesh);
    enf_soup_free(&soup);
}

// ---- invariance

static void every_polygon_is_kept_or_listed_or_detail(void **state) {
    (void)state;
    uint64_t seed = 4711;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 200; round++) {
        enf_soup soup = {0};
        enf_mesh mesh;
        add_random_world(&soup, &seed, 10);
        enf_clean_options options = {.weld = round % 3 ? 0 : 0.5, .plane_tolerance = round % 4 ? 0 : 0.4};
        assert_int_equal(enf_mesh_clean(&mesh, &soup, &options, NULL), ENF_OK);
        check_mesh(&mesh);
        check_accounts(&soup, &mesh);
        enf_mesh_free(&mesh);
        enf_soup_free(&soup);
    }
}

static void the_order_of_the_input_does_not_matter(void **state) {
    (void)state;
    uint64_t seed = 12345;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 100; round++) {
        enf_soup soup = {0}, shuffled = {0};
        enf_mesh mesh, other;
        add_random_world(&soup, &seed, 8);
        size_t *order = malloc(soup.polygon_count * sizeof *order);
        int32_t *point_of = malloc(soup.point_count * sizeof *point_of);
        double *points = malloc(soup.point_count * 3 * sizeof *points);
        assert_true(order && point_of && points);
        for (size_t i = 0; i < soup.polygon_count; i++) {
            size_t j = next_random(&seed) % (i + 1);
            order[i] = order[j];
            order[j] = i;
        }
        for (size_t i = 0; i < soup.point_count; i++) {
            size_t j = next_random(&seed) % (i + 1);
            point_of[i] = point_of[j];
            point_of[j] = (int32_t)i;
        }
        for (size_t i = 0; i < soup.point_count; i++)
            memcpy(&points[3 * (size_t)point_of[i]], &soup.points[3 * i], 3 * sizeof *points);
        copy_soup(&shuffled, &soup, order, point_of, points, &seed);
        enf_clean_options options = {.weld = round % 3 ? 0 : 0.5, .plane_tolerance = round % 4 ? 0 : 0.4};
        assert_int_equal(enf_mesh_clean(&mesh, &soup, &options, NULL), ENF_OK);
        assert_int_equal(enf_mesh_clean(&other, &shuffled, &options, NULL), ENF_OK);
        check_same(&mesh, &other);
        enf_mesh_free(&mesh);
        enf_mesh_free(&other);
        enf_soup_free(&soup);
        enf_soup_free(&shuffled);
        free(order);
        free(point_of);
        free(points);
    }
}

static void reverse_polygons(enf_soup *soup) {
    for (size_t p = 0; p < soup->polygon_count; p++)
        for (int64_t i = soup->polygon_corner[p], j = soup->polygon_corner[p + 1] - 1; i < j; i++, j--) {
            int32_t swap = soup->corner_point[i];
            soup->corner_point[i] = soup->corner_point[j];
            soup->corner_point[j] = swap;
        }
}

/// The world with axes permuted, mirrored and scaled by a power of two, compared in grid coordinates.
static void check_transformed(const enf_soup *soup, const int axis[3], int mirror, int exponent) {
    enf_soup turned = {0};
    enf_mesh mesh, other;
    double *points = malloc(soup->point_count * 3 * sizeof *points);
    assert_non_null(points);
    for (size_t p = 0; p < soup->point_count; p++)
        for (int a = 0; a < 3; a++)
            points[3 * p + a] = ldexp(
                mirror >> a & 1 ? -soup->points[3 * p + axis[a]] : soup->points[3 * p + axis[a]], exponent);
    copy_soup(&turned, soup, NULL, NULL, points, NULL);
    bool even = (axis[1] - axis[0] + 3) % 3 == 1;
    if (even != (__builtin_popcount((unsigned)mirror) % 2 == 0))
        reverse_polygons(&turned); // fronts stay fronts
    enf_soup original = {0};
    copy_soup(&original, soup, NULL, NULL, soup->points, NULL);
    assert_int_equal(enf_mesh_clean(&mesh, &original, NULL, NULL), ENF_OK);
    assert_int_equal(enf_mesh_clean(&other, &turned, NULL, NULL), ENF_OK);
    assert_int_equal(mesh.point_count, other.point_count);
    assert_memory_equal(mesh.points, other.points, mesh.point_count * 3 * sizeof *mesh.points);
    assert_true(other.frame.step == ldexp(mesh.frame.step, exponent));
    check_same(&mesh, &other);
    enf_mesh_free(&mesh);
    enf_mesh_free(&other);
    enf_soup_free(&turned);
    enf_soup_free(&original);
    free(points);
}

static void right_angles_mirrors_and_powers_of_two_give_the_same_grid(void **state) {
    (void)state;
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    uint64_t seed = 31337;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int round = 0; round < 4; round++) {
        enf_soup soup = {0};
        add_random_world(&soup, &seed, round == 0 ? 1 : 12);
        for (int transform = 0; transform < 48; transform++)
            check_transformed(&soup, orders[transform / 8], transform % 8,
                              (int)(next_random(&seed) % 200) - 100);
        enf_soup_free(&soup);
    }
}

static void worlds_with_symmetric_marginals_get_a_canonical_frame_too(void **state) {
    (void)state;
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    // Both axes have the values -3 to 3 once each, so no moment of one axis tells them or their ends apart.
    const double points[][3] = {{-3, -2, 7}, {-2, 1, 7}, {-1, -3, 7}, {1, 3, 7}, {2, -1, 7}, {3, 2, 7}};
    enf_soup soup = {0};
    const double second[][3] = {{-3, -2, 7}, {1, 3, 7}, {-2, 1, 7}};
    add_polygon(&soup, 3, points, "");
    add_polygon(&soup, 3, points + 3, "");
    add_polygon(&soup, 3, second, "");
    for (int transform = 0; transform < 48; transform++) {
        enf_soup turned = {0};
        enf_mesh mesh, other;
        double at[3 * 9];
        for (int p = 0; p < 9; p++)
            for (int a = 0; a < 3; a++)
                at[3 * p + a] = (transform >> a & 1 ? -1 : 1) * soup.points[3 * p + orders[transform / 8][a]];
        copy_soup(&turned, &soup, NULL, NULL, at, NULL);
        assert_int_equal(enf_mesh_clean(&mesh, &soup, NULL, NULL), ENF_OK);
        assert_int_equal(enf_mesh_clean(&other, &turned, NULL, NULL), ENF_OK);
        assert_memory_equal(mesh.points, other.points, mesh.point_count * 3 * sizeof *mesh.points);
        enf_mesh_free(&mesh);
        enf_mesh_free(&other);
        enf_soup_free(&turned);
    }
    enf_soup_free(&soup);
}

static void symmetric_points_with_unsymmetric_polygons_get_a_canonical_frame_too(void **state) {
    (void)state;
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    // Three sides of a cube around the origin, one of them a triangle only.
    const double side[][3] = {{-1, -1, -1}, {-1, 1, -1}, {1, 1, -1}, {1, -1, -1}},
                 wall[][3] = {{-1, -1, -1}, {-1, -1, 1}, {-1, 1, 1}, {-1, 1, -1}},
                 half[][3] = {{1, 1, 1}, {1, -1, 1}, {-1, 1, 1}};
    enf_soup soup = {0};
    add_polygon(&soup, 4, side, "");
    add_polygon(&soup, 4, wall, "");
    add_polygon(&soup, 3, half, "");
    for (int transform = 0; transform < 48; transform++)
        check_transformed(&soup, orders[transform / 8], transform % 8, 3);
    enf_soup_free(&soup);
}

static void spawn_points_follow_into_the_grid(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_mesh mesh;
    const double low[3] = {-8, 2, 3}, high[3] = {4, 9, 20};
    add_box(&soup, low, high, "");
    assert_true(enf_soup_add_spawn(&soup, 1.1, 2.2, 3.3));
    assert_int_equal(enf_mesh_clean(&mesh, &soup, NULL, NULL), ENF_OK);
    double world[3];
    enf_frame_to_world(&mesh.frame, mesh.spawns, world);
    assert_true(world[0] == 1.1 && world[1] == 2.2 && world[2] == 3.3);
    enf_mesh_free(&mesh);
    enf_soup_free(&soup);
}

// ---- real worlds

static void quake_levels_come_through(void **state) {
    (void)state;
    const char *folder = getenv("ENFILADE_SHARED");
#ifdef ENFILADE_SHARED_DIR
    if (!folder) folder = ENFILADE_SHARED_DIR;
#endif
    if (!folder) {
        print_message("no shared data; set ENFILADE_SHARED\n");
        skip();
    }
    static const char *const levels[] = {"dm1",  "dm2",  "dm4",  "dm5",  "e1m3", "e1m4", "e1m5",
                                         "e1m6", "e1m8", "e2m2", "e2m4", "e2m5", "e2m7", "e3m1",
                                         "e3m3", "e3m5", "e3m6", "e3m7", "e4m1", "e4m2", "e4m4",
                                         "e4m5", "e4m6", "e4m8", "end"};
    int found = 0;
    for (size_t i = 0; i < sizeof levels / sizeof *levels; i++) {
        char path[600];
        snprintf(path, sizeof path, "%s/quake/obj/%s.obj.gz", folder, levels[i]);
        FILE *file = fopen(path, "rb");
        if (!file) snprintf(path, sizeof path, "%s/data/quake/obj/%s.obj.gz", folder, levels[i]);
        if (file) fclose(file);
        enf_soup soup = {0};
        enf_mesh mesh;
        enf_error error = {0};
        enf_status status = enf_soup_read(&soup, path, &error);
        if (status == ENF_NO_RESOURCES) continue;
        found++;
        const char *const exclude[] = {"*_liquid", "*_clip"};
        enf_clean_options options = {
            .weld = -1, .plane_tolerance = -1, .exclude = exclude, .exclude_count = 2};
        if (status == ENF_OK) status = enf_mesh_clean(&mesh, &soup, &options, &error);
        if (status != ENF_OK) fail_msg("%s", error.text);
        check_mesh(&mesh);
        check_accounts(&soup, &mesh);
        assert_true(mesh.displacement_max < 1e-6);
        assert_true(mesh.spawn_count > 0);
        assert_int_equal(
            count_rejected(&soup, ENF_REJECT_SYNTAX) + count_rejected(&soup, ENF_REJECT_INDEX_RANGE), 0);
        print_message(
            "%s: %zu points %zu polygons -> %zu points %zu polygons, %zu triangulated, %zu duplicates\n",
            levels[i], soup.point_count, soup.polygon_count, mesh.point_count, mesh.polygon_count,
            mesh.triangulated, count_rejected(&soup, ENF_REJECT_DUPLICATE));
        enf_mesh_free(&mesh);
        enf_soup_free(&soup);
    }
    if (!found) skip();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(convex_planar_polygons_stay_whole),
        cmocka_unit_test(fronts_stay_fronts),
        cmocka_unit_test(concave_polygons_become_triangles_of_the_same_area),
        cmocka_unit_test(nonplanar_polygons_become_triangles),
        cmocka_unit_test(crossed_polygons_end_and_leave_something),
        cmocka_unit_test(triangles_of_any_ring_add_up_to_its_area),
        cmocka_unit_test(triangles_of_simple_rings_cover_them_once),
        cmocka_unit_test(corners_without_purpose_go),
        cmocka_unit_test(polygons_without_area_are_rejected_with_the_reason),
        cmocka_unit_test(extreme_scales_survive),
        cmocka_unit_test(worlds_in_one_point_or_empty_fail_with_words),
        cmocka_unit_test(a_failure_names_the_first_rejected_polygon),
        cmocka_unit_test(polygons_of_many_corners_end_in_time),
        cmocka_unit_test(globs_match_object_group_or_both),
        cmocka_unit_test(points_weld_within_the_distance_and_no_further),
        cmocka_unit_test(welding_agrees_with_the_plain_definition),
        cmocka_unit_test(each_site_joins_the_first_representative_in_reach),
        cmocka_unit_test(the_plane_tolerance_recovers_axis_parallel_planes),
        cmocka_unit_test(duplicates_go_and_twins_stay),
        cmocka_unit_test(every_polygon_is_kept_or_listed_or_detail),
        cmocka_unit_test(the_order_of_the_input_does_not_matter),
        cmocka_unit_test(right_angles_mirrors_and_powers_of_two_give_the_same_grid),
        cmocka_unit_test(worlds_with_symmetric_marginals_get_a_canonical_frame_too),
        cmocka_unit_test(symmetric_points_with_unsymmetric_polygons_get_a_canonical_frame_too),
        cmocka_unit_test(spawn_points_follow_into_the_grid),
        cmocka_unit_test(quake_levels_come_through),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
