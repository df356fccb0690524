// SPDX-License-Identifier: GPL-3.0-or-later
// Clean, whole worlds: every polygon is accounted for, and the result depends on the world only, not on how
// it was listed, scaled or turned.
#include "build/clean.h"
#include "tests/clean_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/// Boxes, triangles and broken polygons at small whole coordinates: a world full of coincidences.
static void add_random_world(enf_soup *soup, uint64_t *seed, int size) {
    for (int i = 0; i < size; i++) {
        double low[3], high[3];
        for (int a = 0; a < 3; a++) {
            low[a] = (double)(fixture_random(seed) % 8);
            high[a] = low[a] + 1 + (double)(fixture_random(seed) % 4) * (a + 1);
        }
        fixture_add_box(soup, low, high, "boxes");
        double at[8][3];
        size_t count = 1 + fixture_random(seed) % 8;
        for (size_t k = 0; k < count; k++)
            for (int a = 0; a < 3; a++)
                at[k][a] = (double)(fixture_random(seed) % 10) / (fixture_random(seed) % 4 ? 1 : 3);
        if (fixture_random(seed) % 9 == 0) at[0][1] = NAN;
        fixture_add_polygon(soup, count, (const double(*)[3])at, "chaos");
        if (fixture_random(seed) % 3 == 0) fixture_add_polygon(soup, count, (const double(*)[3])at, "again");
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
        size_t shift = rotate_seed ? fixture_random(rotate_seed) % count : 0;
        int32_t corners[64];
        for (size_t i = 0; i < count; i++) {
            int32_t point = from->corner_point[first + (int64_t)((i + shift) % count)];
            corners[i] = point_of ? point_of[point] : point;
        }
        assert_true(enf_soup_add_polygon(to, count, corners, NULL, NULL, -1, 0, enf_soup_group(to, ""), -1));
    }
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
    assert_memory_equal(a->polygon_copies, b->polygon_copies, a->polygon_count * sizeof *a->polygon_copies);
    assert_int_equal(a->two_sided, b->two_sided);
    assert_int_equal(a->triangulated, b->triangulated);
    assert_int_equal(a->welded, b->welded);
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
        fixture_check_mesh(&mesh);
        fixture_check_accounts(&soup, &mesh);
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
            size_t j = fixture_random(&seed) % (i + 1);
            order[i] = order[j];
            order[j] = i;
        }
        for (size_t i = 0; i < soup.point_count; i++) {
            size_t j = fixture_random(&seed) % (i + 1);
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
                              (int)(fixture_random(&seed) % 200) - 100);
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
    fixture_add_polygon(&soup, 3, points, "");
    fixture_add_polygon(&soup, 3, points + 3, "");
    fixture_add_polygon(&soup, 3, second, "");
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
    fixture_add_polygon(&soup, 4, side, "");
    fixture_add_polygon(&soup, 4, wall, "");
    fixture_add_polygon(&soup, 3, half, "");
    for (int transform = 0; transform < 48; transform++)
        check_transformed(&soup, orders[transform / 8], transform % 8, 3);
    enf_soup_free(&soup);
}

static void spawn_points_follow_into_the_grid(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_mesh mesh;
    const double low[3] = {-8, 2, 3}, high[3] = {4, 9, 20};
    fixture_add_box(&soup, low, high, "");
    assert_true(enf_soup_add_spawn(&soup, 1.1, 2.2, 3.3));
    assert_int_equal(enf_mesh_clean(&mesh, &soup, NULL, NULL), ENF_OK);
    double world[3];
    enf_frame_to_world(&mesh.frame, mesh.spawns, world);
    assert_true(world[0] == 1.1 && world[1] == 2.2 && world[2] == 3.3);
    enf_mesh_free(&mesh);
    enf_soup_free(&soup);
}

static void zeros_come_back_without_a_sign(void **state) {
    (void)state;
    enf_frame frame = {.step = 0.5, .axis = {2, 0, 1}, .sign = {-1, 1, -1}, .handedness = -1};
    for (int turned = 0; turned < 2; turned++) {
        frame.is_turned = turned;
        for (int a = 0; a < 3 && turned; a++) frame.turn[a][(a + 1) % 3] = -1;
        for (int signs = 0; signs < 8; signs++) {
            double at[3];
            for (int a = 0; a < 3; a++) at[a] = signs >> a & 1 ? -0.0 : 0.0;
            enf_frame_to_world(&frame, at, at);
            for (int a = 0; a < 3; a++) assert_false(signbit(at[a]));
        }
    }
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
        fixture_check_mesh(&mesh);
        fixture_check_accounts(&soup, &mesh);
        assert_true(mesh.displacement_max < 1e-6);
        assert_true(mesh.spawn_count > 0);
        assert_int_equal(fixture_count_rejected(&soup, ENF_REJECT_SYNTAX) +
                             fixture_count_rejected(&soup, ENF_REJECT_INDEX_RANGE),
                         0);
        print_message(
            "%s: %zu points %zu polygons -> %zu points %zu polygons, %zu triangulated, %zu duplicates\n",
            levels[i], soup.point_count, soup.polygon_count, mesh.point_count, mesh.polygon_count,
            mesh.triangulated, fixture_count_rejected(&soup, ENF_REJECT_DUPLICATE));
        enf_mesh_free(&mesh);
        enf_soup_free(&soup);
    }
    if (!found) skip();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_polygon_is_kept_or_listed_or_detail),
        cmocka_unit_test(the_order_of_the_input_does_not_matter),
        cmocka_unit_test(right_angles_mirrors_and_powers_of_two_give_the_same_grid),
        cmocka_unit_test(worlds_with_symmetric_marginals_get_a_canonical_frame_too),
        cmocka_unit_test(symmetric_points_with_unsymmetric_polygons_get_a_canonical_frame_too),
        cmocka_unit_test(spawn_points_follow_into_the_grid),
        cmocka_unit_test(zeros_come_back_without_a_sign),
        cmocka_unit_test(quake_levels_come_through),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
