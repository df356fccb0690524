// SPDX-License-Identifier: GPL-3.0-or-later
// Clean, one thing at a time: what becomes of single polygons, of groups, of points near each other.
#include "build/clean.h"
#include "build/weld.h"
#include "tests/clean_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

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

/// Cleans one polygon with exact options; returns how many polygons come of it, and the first reason if none.
static size_t clean_one(size_t count, const double (*at)[3], double area[3], enf_reject *reason) {
    enf_soup soup = {0};
    enf_mesh mesh = {0};
    fixture_add_polygon(&soup, count, at, "");
    enf_error error;
    enf_status status = enf_mesh_clean(&mesh, &soup, &fixture_exact_options, &error);
    size_t made = mesh.polygon_count;
    assert_int_equal(status, made ? ENF_OK : ENF_BAD_INPUT);
    if (made) {
        fixture_check_mesh(&mesh);
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
        size_t count = 3 + fixture_random(&seed) % 10;
        for (size_t i = 0; i < count; i++)
            for (int a = 0; a < 3; a++) at[i][a] = (double)(fixture_random(&seed) % (round % 2 ? 4 : 1000));
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
        size_t count = 4 + fixture_random(&seed) % 56;
        enf_soup soup = {0};
        enf_mesh mesh;
        for (size_t i = 0; i < count; i++) { // a star around the middle: simple
            double angle = 6.283185307179586 * (double)i / (double)count;
            double radius = 1000 + (double)(fixture_random(&seed) % 20000);
            at[i][0] = round % 3 == 0 ? 5 : nearbyint(radius * cos(angle));
            at[i][1] = nearbyint(radius * sin(angle));
            at[i][2] = round % 3 == 0 ? nearbyint(radius * cos(angle)) : at[i][0] * (round % 3 - 1) + 7;
        }
        ring_area(count, (const double(*)[3])at, wanted);
        fixture_add_polygon(&soup, count, (const double(*)[3])at, "");
        assert_int_equal(enf_mesh_clean(&mesh, &soup, &fixture_exact_options, NULL), ENF_OK);
        fixture_check_mesh(&mesh);
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
    static const double scales[] = {1e100, 1e-150, 1e-310, 5e-324, 1};
    for (int s = 0; s < 5; s++) {
        double k = scales[s];
        const double square[][3] = {{0, 0, 0}, {k, 0, 0}, {k, k, 0}, {0, k, 0}};
        enf_soup soup = {0};
        enf_mesh mesh;
        fixture_add_polygon(&soup, 4, square, "");
        assert_int_equal(enf_mesh_clean(&mesh, &soup, NULL, NULL), ENF_OK);
        assert_int_equal(mesh.polygon_count, 1);
        assert_int_equal(mesh.point_count, 4);
        double world[3];
        enf_frame_to_world(&mesh.frame, &mesh.points[0], world);
        assert_true((world[0] == 0 || world[0] == k) && world[2] == 0);
        fixture_check_mesh(&mesh);
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
    fixture_add_polygon(&soup, 3, line, "");
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
        double radius = jagged && i % 2 ? 1 + (double)(fixture_random(&enormous_seed) % 1000) / 2000 : 2;
        corners[i] = (int32_t)i;
        assert_true(enf_soup_add_point(&soup, radius * cos(angle), radius * sin(angle), 0));
    }
    assert_true(enf_soup_add_polygon(&soup, count, corners, NULL, NULL, -1, 0, 0, -1));
    free(corners);
    assert_int_equal(enf_mesh_clean(&mesh, &soup, &fixture_exact_options, NULL), wanted);
    if (wanted == ENF_OK) {
        fixture_check_mesh(&mesh);
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
        fixture_add_box(&soup, low_g, high_g, groups[g]);
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
    assert_int_equal(fixture_count_rejected(&soup, ENF_REJECT_EXCLUDED), 6);
    assert_int_equal(mesh.detail_count, 12);
    assert_int_equal(mesh.polygon_count, 12);
    assert_int_equal(mesh.point_count, 16);
    fixture_check_accounts(&soup, &mesh);
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
    fixture_add_polygon(&soup, 3, first, "");
    fixture_add_polygon(&soup, 3, second, "");
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
            for (int k = 0; k < 9; k++) at[k / 3][k % 3] = (double)(fixture_random(&seed) % 1000);
            fixture_add_polygon(&soup, 3, (const double(*)[3])at, "");
        }
        enf_mesh exact, welded;
        enf_clean_options options = {.weld = 20 + 10 * round};
        assert_int_equal(enf_mesh_clean(&exact, &soup, &fixture_exact_options, NULL), ENF_OK);
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
        double distance = 1 + (double)(fixture_random(&seed) % 400) / 2;
        for (int i = 0; i < COUNT; i++) {
            sites[i].id = i;
            for (int a = 0; a < 3; a++)
                sites[i].at[a] = (double)(fixture_random(&seed) % (round % 2 ? 1000 : 100)) - 500;
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
    fixture_add_polygon(&soup, 4, torn, "");
    enf_mesh mesh;
    enf_clean_options options = {.weld = 0, .plane_tolerance = 0.01};
    assert_int_equal(enf_mesh_clean(&mesh, &soup, &fixture_exact_options, NULL), ENF_OK);
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
    fixture_add_polygon(&soup, 3, front, "");
    fixture_add_polygon(&soup, 3, turned, "");
    fixture_add_polygon(&soup, 3, back, "");
    enf_mesh mesh;
    assert_int_equal(enf_mesh_clean(&mesh, &soup, NULL, NULL), ENF_OK);
    assert_int_equal(mesh.polygon_count, 2);
    assert_int_equal(mesh.two_sided, 2);
    assert_int_equal(mesh.polygon_copies[0] + mesh.polygon_copies[1], 3);
    assert_int_equal(mesh.polygon_copies[mesh.polygon_source[0] == 0 ? 0 : 1], 2);
    assert_int_equal(soup.rejected_count, 1);
    assert_int_equal(soup.rejected[0].reason, ENF_REJECT_DUPLICATE);
    assert_int_equal(soup.rejected[0].polygon, 1);
    fixture_check_accounts(&soup, &mesh);
    enf_mesh_free(&mesh);
    enf_soup_free(&soup);
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
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
