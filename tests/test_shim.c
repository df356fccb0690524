// SPDX-License-Identifier: GPL-3.0-or-later
// Both tetrahedralizers against arithmetic of the test's own: 128-bit integers, which are exact for small
// coordinates.
#include "base/exact.h"
#include "build/delaunay.h"
#include "build/tet_order.h"
#include "oracle.h"
#include "shim/shim.h"

#include <fenv.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

__extension__ typedef __int128 wide;

typedef enf_status delaunay_function(const double *, size_t, enf_tetrahedra *, enf_error *);

typedef struct cloud {
    size_t count;
    double *points;
} cloud;

static const double two53 = 9007199254740992.0;

static uint64_t next_random(uint64_t *state) { // splitmix64
    uint64_t x = *state += 0x9e3779b97f4a7c15U;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
    return x ^ (x >> 31);
}

static cloud new_cloud(size_t count) {
    const cloud result = {count, malloc((count + 1) * 3 * sizeof(double))};
    assert_non_null(result.points);
    return result;
}

// How many cases: `usual`, times the environment variable ENFILADE_TEST_SCALE.
static long scaled(long usual) {
    const char *text = getenv("ENFILADE_TEST_SCALE");
    const double scale = text ? atof(text) : 1;
    return scale > 0 ? (long)ceil((double)usual * scale) : usual;
}

static cloud make_lattice(int side) {
    cloud result = new_cloud((size_t)side * (size_t)side * (size_t)side);
    double *point = result.points;
    for (int x = 0; x < side; ++x)
        for (int y = 0; y < side; ++y)
            for (int z = 0; z < side; ++z, point += 3) {
                point[0] = x;
                point[1] = y;
                point[2] = z;
            }
    return result;
}

static int compare_points(const void *a, const void *b) {
    const double *p = a, *q = b;
    for (int k = 0; k < 3; ++k)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

static void drop_equal_points(cloud *cloud) {
    qsort(cloud->points, cloud->count, 3 * sizeof(double), compare_points);
    size_t kept = 0;
    for (size_t i = 0; i < cloud->count; ++i)
        if (i == 0 || compare_points(cloud->points + 3 * i, cloud->points + 3 * (kept - 1)) != 0)
            memmove(cloud->points + 3 * kept++, cloud->points + 3 * i, 3 * sizeof(double));
    cloud->count = kept;
}

// Different points with whole coordinates in [-range, range].
static cloud make_random(size_t count, double range, uint64_t seed) {
    cloud result = new_cloud(count);
    for (size_t i = 0; i < 3 * count; ++i)
        result.points[i] = (double)(next_random(&seed) % (uint64_t)(2 * range + 1)) - range;
    drop_equal_points(&result);
    return result;
}

static wide determinant(wide m[3][3]) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

// Six times the volume of tetrahedron abcd; coordinates below 2^40.
static wide find_volume(const double *points, const int32_t corners[4]) {
    wide m[3][3];
    for (int i = 0; i < 3; ++i)
        for (int k = 0; k < 3; ++k)
            m[i][k] = (wide)points[3 * corners[i + 1] + k] - (wide)points[3 * corners[0] + k];
    return determinant(m);
}

static bool sphere_contains(const double *points, const int32_t corners[4], size_t point) {
    wide m[4][4];
    for (int i = 0; i < 4; ++i) {
        m[i][3] = 0;
        for (int k = 0; k < 3; ++k) {
            m[i][k] = (wide)points[3 * corners[i] + k] - (wide)points[3 * point + (size_t)k];
            m[i][3] += m[i][k] * m[i][k];
        }
    }
    wide sum = 0;
    for (int skip = 0; skip < 4; ++skip) { // along the last column
        wide minor[3][3];
        for (int i = 0, row = 0; i < 4; ++i)
            if (i != skip) memcpy(minor[row++], m[i], 3 * sizeof(wide));
        sum += (skip % 2 ? m[skip][3] : -m[skip][3]) * determinant(minor);
    }
    return sum < 0; // the corners are positively oriented
}

static enf_tetrahedra make(delaunay_function *delaunay, const cloud *cloud) {
    enf_tetrahedra result;
    enf_error error = {0};
    const enf_status status = delaunay(cloud->points, cloud->count, &result, &error);
    if (status != ENF_OK) fail_msg("%s", error.text);
    assert_true(enf_tetrahedra_sort(&result.corners, result.count, cloud->points, cloud->count));
    return result;
}

// Every tetrahedron positive and canonical; returns six times the volume.
static wide check_cells(const cloud *cloud, const enf_tetrahedra *cells) {
    wide volume = 0;
    for (size_t i = 0; i < cells->count; ++i) {
        const int32_t *c = cells->corners[i];
        for (int k = 0; k < 4; ++k) assert_in_range(c[k], 0, cloud->count - 1);
        assert_true(c[0] < c[1] && c[1] < c[2] && c[1] < c[3] && c[2] != c[3]);
        const wide part = find_volume(cloud->points, c);
        assert_true(part > 0);
        volume += part;
    }
    return volume;
}

static void check_empty_spheres(const cloud *cloud, const enf_tetrahedra *cells) {
    for (size_t i = 0; i < cells->count; ++i)
        for (size_t point = 0; point < cloud->count; ++point)
            assert_false(sphere_contains(cloud->points, cells->corners[i], point));
}

// Ours must be the very tetrahedra of CGAL.
static void check_ours(const cloud *cloud, const enf_tetrahedra *cells) {
    const enf_tetrahedra ours = make(enf_delaunay, cloud);
    assert_int_equal(ours.count, cells->count);
    assert_memory_equal(ours.corners, cells->corners, ours.count * sizeof *ours.corners);
    free(ours.corners);
}

static void check_both(cloud cloud, wide volume) {
    qsort(cloud.points, cloud.count, 3 * sizeof(double), compare_points);
    enf_tetrahedra cells = make(enf_shim_delaunay_cgal, &cloud);
    const wide found = check_cells(&cloud, &cells);
    check_ours(&cloud, &cells);
    if (cloud.count <= 300) check_empty_spheres(&cloud, &cells);
    if (volume > 0) assert_true(found == volume);
    free(cells.corners);
    if (enf_shim_has_tetgen()) {
        cells = make(enf_shim_delaunay_tetgen, &cloud);
        assert_true(check_cells(&cloud, &cells) == found);
        if (cloud.count <= 300) check_empty_spheres(&cloud, &cells);
        free(cells.corners);
    }
    free(cloud.points);
}

static void a_cube_is_tiled(void **state) {
    (void)state;
    check_both(make_lattice(2), 6);
}

static void one_tetrahedron_is_itself(void **state) {
    (void)state;
    cloud cloud = new_cloud(4);
    const double points[12] = {0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, 0};
    memcpy(cloud.points, points, sizeof points);
    const enf_tetrahedra cells = make(enf_shim_delaunay_cgal, &cloud);
    assert_int_equal(cells.count, 1);
    free(cells.corners);
    check_both(cloud, 1);
}

static void lattices_are_tiled(void **state) {
    (void)state;
    check_both(make_lattice(3), 6 * 8);
    check_both(make_lattice(6), 6 * 125);
    check_both(make_lattice(10), 6 * 729);
}

static void random_points_are_tiled(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        print_message("seed %d\n", (int)seed);
        check_both(make_random(60, seed % 2 ? 3 : 1000, seed), 0);
    }
    check_both(make_random(5000, 1 << 30, 99), 0);
}

// TetGen's own choice of a first tetrahedron fails on the second and third of these.
static void clusters_far_apart_are_tiled(void **state) {
    (void)state;
    for (int kind = 0; kind < 3; ++kind) {
        cloud cloud = make_random(300, 4, 7);
        for (size_t i = 0; i < cloud.count; ++i) {
            double *point = cloud.points + 3 * i;
            if (kind == 0) point[2] += 1 << 30;
            if (kind == 1 && i % 2)
                for (int k = 0; k < 3; ++k) point[k] += 1 << 30;
            if (kind == 2) point[0] *= 1 << 30;
        }
        check_both(cloud, 0);
    }
}

static void largest_coordinates_are_fine(void **state) {
    (void)state;
    cloud cloud = make_random(500, two53, 11);
    enf_tetrahedra cells = make(enf_shim_delaunay_cgal, &cloud);
    assert_true(cells.count > 1000);
    check_ours(&cloud, &cells);
    free(cells.corners);
    if (enf_shim_has_tetgen()) {
        cells = make(enf_shim_delaunay_tetgen, &cloud);
        assert_true(cells.count > 1000);
        free(cells.corners);
    }
    free(cloud.points);
}

static void check_refused(const cloud *cloud) {
    enf_tetrahedra cells;
    enf_error error = {0};
    assert_int_equal(enf_shim_delaunay_cgal(cloud->points, cloud->count, &cells, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "plane"));
    assert_null(cells.corners);
    qsort(cloud->points, cloud->count, 3 * sizeof(double), compare_points);
    assert_int_equal(enf_delaunay(cloud->points, cloud->count, &cells, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "plane"));
    assert_null(cells.corners);
    if (!enf_shim_has_tetgen()) return;
    assert_int_equal(enf_shim_delaunay_tetgen(cloud->points, cloud->count, &cells, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "plane"));
    assert_null(cells.corners);
}

static void flat_worlds_are_refused(void **state) {
    (void)state;
    for (size_t count = 0; count <= 3; ++count) {
        cloud few = make_lattice(2);
        few.count = count;
        check_refused(&few);
        free(few.points);
    }
    for (int kind = 0; kind < 3; ++kind) {
        cloud cloud = make_random(50, two53 / 4, 5);
        for (size_t i = 0; i < cloud.count; ++i) {
            double *point = cloud.points + 3 * i;
            if (kind == 0) point[2] = 0;
            if (kind == 1) point[2] = point[0] + point[1];
            if (kind == 2) point[1] = point[2] = point[0];
        }
        check_refused(&cloud);
        free(cloud.points);
    }
}

static void almost_flat_worlds_are_tiled_or_refused(void **state) {
    (void)state;
    cloud cloud = make_random(50, two53 / 4, 5);
    for (size_t i = 0; i < cloud.count; ++i)
        cloud.points[3 * i + 2] = cloud.points[3 * i] + cloud.points[3 * i + 1];
    cloud.points[2] += 1;
    enf_tetrahedra cells = make(enf_shim_delaunay_cgal, &cloud);
    assert_true(cells.count >= 47);
    qsort(cloud.points, cloud.count, 3 * sizeof(double), compare_points);
    free(cells.corners);
    cells = make(enf_shim_delaunay_cgal, &cloud);
    check_ours(&cloud, &cells);
    free(cells.corners);
    enf_error error = {0};
    const enf_status status = enf_shim_delaunay_tetgen(cloud.points, cloud.count, &cells, &error);
    assert_true(status == ENF_OK || strstr(error.text, "cgal") != NULL);
    free(cells.corners);
    free(cloud.points);
}

static void equal_points_are_refused(void **state) {
    (void)state;
    cloud cloud = make_lattice(3);
    memcpy(cloud.points + 3, cloud.points + 60, 3 * sizeof(double));
    enf_tetrahedra cells;
    enf_error error = {0};
    assert_int_equal(enf_shim_delaunay_cgal(cloud.points, cloud.count, &cells, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "equal"));
    assert_int_equal(enf_delaunay(cloud.points, cloud.count, &cells, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "equal"));
    if (enf_shim_has_tetgen())
        assert_int_not_equal(enf_shim_delaunay_tetgen(cloud.points, cloud.count, &cells, &error), ENF_OK);
    free(cloud.points);
}

// A fan: all tetrahedra have the same edge, so the holes are as large as the world, and the places, too.
static void large_holes_are_filled(void **state) {
    (void)state;
    const size_t count = (size_t)scaled(3000) + 100;
    for (int kind = 0; kind < 2; ++kind) {
        cloud cloud = new_cloud(count + 2);
        for (size_t i = 0; i < count; ++i) {
            const double angle = 6.283185307179586 * (double)i / (double)count;
            cloud.points[3 * i] = rint(ldexp(cos(angle), 40));
            cloud.points[3 * i + 1] = rint(ldexp(sin(angle), 40));
            cloud.points[3 * i + 2] = kind == 0 ? 0 : (double)(i % 7);
        }
        const double ends[6] = {0, 0, -ldexp(1, 39), 0, 0, ldexp(1, 39)};
        memcpy(cloud.points + 3 * count, ends, sizeof ends);
        qsort(cloud.points, cloud.count, 3 * sizeof(double), compare_points);
        enf_tetrahedra cells = make(enf_shim_delaunay_cgal, &cloud);
        assert_true(cells.count >= count);
        check_ours(&cloud, &cells);
        free(cells.corners);
        free(cloud.points);
    }
}

// Many small clouds on few places: nearly all of it is ties.
static void ties_are_broken_as_cgal_does(void **state) {
    (void)state;
    const long count = scaled(3000);
    for (long i = 0; i < count; ++i) {
        cloud cloud = make_random(8 + (size_t)i % 40, 1 + (double)(i % 4), (uint64_t)i);
        enf_tetrahedra cells;
        if (enf_shim_delaunay_cgal(cloud.points, cloud.count, &cells, NULL) == ENF_OK) {
            assert_true(enf_tetrahedra_sort(&cells.corners, cells.count, cloud.points, cloud.count));
            check_ours(&cloud, &cells);
        }
        free(cells.corners);
        free(cloud.points);
    }
}

// ------------------------------------------------------------------------------------------ predicates

enum { KINDS = 6 };

static double random_whole(uint64_t *state, double range) {
    return (double)(next_random(state) % (uint64_t)(2 * range + 1)) - range;
}

// A point of a sphere of radius `radius` about the origin, rounded.
static void random_on_sphere(uint64_t *state, double radius, double point[3]) {
    double length = 0;
    while (length == 0) {
        for (int k = 0; k < 3; ++k) point[k] = random_whole(state, 1000);
        length = sqrt(point[0] * point[0] + point[1] * point[1] + point[2] * point[2]);
    }
    for (int k = 0; k < 3; ++k) point[k] = fmax(-two53, fmin(two53, rint(point[k] / length * radius)));
}

// Five points, on or near one sphere or plane more often than not; at most 2^53.
static void make_case(long number, uint64_t *state, double points[5][3]) {
    const int kind = (int)(number % KINDS);
    const double size = ldexp(1, (int)(next_random(state) % 54)), shift = random_whole(state, two53 - size);
    for (int i = 0; i < 5; ++i) {
        double *point = points[i];
        for (int k = 0; k < 3; ++k) {
            if (kind == 0) point[k] = random_whole(state, size);                // any
            if (kind == 1) point[k] = floor(random_whole(state, 2) * size / 2); // a small lattice
            if (kind == 2) point[k] = next_random(state) % 2 ? size : -size;    // a cube
            if (kind == 3) point[k] = next_random(state) % 2 ? two53 : random_whole(state, 3) - two53 + 3;
        }
        if (kind >= 4) random_on_sphere(state, size, point);
        if (kind == 5 && size < two53) point[next_random(state) % 3] += 1 - (double)(next_random(state) % 3);
        if (kind == 0 && i == 4 && number % 4 == 0) // near a plane
            for (int k = 0; k < 3; ++k) point[k] = floor((points[0][k] + points[1][k] + points[2][k]) / 3);
        if (kind < 3 && number % 5 == 0) // far away
            for (int k = 0; k < 3; ++k) point[k] = fmax(-two53, fmin(two53, point[k] + (k ? shift : -shift)));
    }
}

static void predicates_agree_with_cgal(void **state) {
    (void)state;
    uint64_t random = 5;
    long zeros[2] = {0}, count = scaled(1000000) * KINDS;
    for (long i = 0; i < count; ++i) {
        double p[5][3];
        make_case(i, &random, p);
        const int side = enf_points_side_of_sphere(p[0], p[1], p[2], p[3], p[4]);
        if (side != oracle_side_of_sphere(p[0], p[1], p[2], p[3], p[4])) fail_msg("case %ld: sphere", i);
        zeros[0] += side == 0;
        if (i % 5) continue; // this oracle takes its time
        const int orientation = enf_points_orient(p[0], p[1], p[2], p[3]);
        if (orientation != oracle_orient(p[0], p[1], p[2], p[3])) fail_msg("case %ld: orientation", i);
        zeros[1] += orientation == 0;
    }
    assert_true(zeros[0] > count / 100 && zeros[1] > count / 500);
}

static int compare_corners(const void *a, const void *b) {
    const int32_t *p = a, *q = b;
    for (int k = 0; k < 4; ++k)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

static int compare_index(const void *a, const void *b) {
    return (*(const int32_t *)a > *(const int32_t *)b) * 2 - 1;
}

static void sort_as_sets(enf_tetrahedra *cells) {
    for (size_t i = 0; i < cells->count; ++i) qsort(cells->corners[i], 4, sizeof(int32_t), compare_index);
    qsort(cells->corners, cells->count, sizeof *cells->corners, compare_corners);
}

static void check_shuffled(cloud original, uint64_t seed) {
    enf_tetrahedra expected = make(enf_shim_delaunay_cgal, &original);
    sort_as_sets(&expected);
    int32_t *source = malloc(original.count * sizeof *source);
    cloud shuffled = new_cloud(original.count);
    for (size_t i = 0; i < original.count; ++i) source[i] = (int32_t)i;
    for (size_t i = original.count; i-- > 1;) {
        const size_t k = next_random(&seed) % (i + 1);
        const int32_t kept = source[i];
        source[i] = source[k];
        source[k] = kept;
    }
    for (size_t i = 0; i < original.count; ++i)
        memcpy(shuffled.points + 3 * i, original.points + 3 * source[i], 3 * sizeof(double));
    enf_tetrahedra found = make(enf_shim_delaunay_cgal, &shuffled);
    for (size_t i = 0; i < found.count; ++i)
        for (int k = 0; k < 4; ++k) found.corners[i][k] = source[found.corners[i][k]];
    sort_as_sets(&found);
    assert_int_equal(found.count, expected.count);
    assert_memory_equal(found.corners, expected.corners, found.count * sizeof *found.corners);
    free(found.corners);
    free(expected.corners);
    free(shuffled.points);
    free(source);
    free(original.points);
}

static void cgal_does_not_depend_on_the_order_of_points(void **state) {
    (void)state;
    for (uint64_t seed = 1; seed <= 5; ++seed) {
        print_message("seed %d\n", (int)seed);
        check_shuffled(make_lattice(6), seed);
        check_shuffled(make_random(400, 4, seed), seed);
        check_shuffled(make_random(400, two53, seed), seed);
    }
}

static void the_order_of_tetrahedra_depends_on_the_set_only(void **state) {
    (void)state;
    static const int even[12][4] = {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 0, 3, 2},
                                    {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 0, 1, 3}, {2, 1, 3, 0},
                                    {2, 3, 0, 1}, {3, 0, 2, 1}, {3, 1, 0, 2}, {3, 2, 1, 0}};
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        const double range = seed % 2 ? 6 : two53; // with few places, many tetrahedra share one
        cloud cloud = make_random(400, range, seed);
        const enf_tetrahedra expected = make(enf_shim_delaunay_cgal, &cloud);
        int32_t(*found)[4] = malloc(expected.count * sizeof *found);
        uint64_t random = seed;
        for (size_t i = 0; i < expected.count; ++i) { // at random among those before it, turned at random
            const size_t k = next_random(&random) % (i + 1);
            const int *turn = even[next_random(&random) % 12];
            memcpy(found[i], found[k], sizeof *found);
            for (int j = 0; j < 4; ++j) found[k][j] = expected.corners[i][turn[j]];
        }
        assert_true(enf_tetrahedra_sort(&found, expected.count, cloud.points, cloud.count));
        assert_memory_equal(found, expected.corners, expected.count * sizeof *found);
        free(found);
        free(expected.corners);
        free(cloud.points);
    }
}

static void same_points_give_the_same_array(void **state) {
    (void)state;
    delaunay_function *const functions[2] = {enf_shim_delaunay_cgal, enf_shim_delaunay_tetgen};
    for (int i = 0; i < (enf_shim_has_tetgen() ? 2 : 1); ++i) {
        cloud cloud = make_random(500, 20, 3);
        const enf_tetrahedra first = make(functions[i], &cloud), second = make(functions[i], &cloud);
        assert_int_equal(first.count, second.count);
        assert_memory_equal(first.corners, second.corners, first.count * sizeof *first.corners);
        free(first.corners);
        free(second.corners);
        free(cloud.points);
    }
}

static void rounding_mode_comes_back(void **state) {
    (void)state;
    const int modes[2] = {FE_TONEAREST, FE_UPWARD};
    for (int i = 0; i < 2; ++i) {
        cloud cloud = make_lattice(3), flat = make_lattice(3);
        flat.count = 9;
        enf_tetrahedra cells;
        fesetround(modes[i]);
        assert_int_equal(enf_shim_delaunay_cgal(cloud.points, cloud.count, &cells, NULL), ENF_OK);
        assert_int_equal(fegetround(), modes[i]);
        free(cells.corners);
        assert_int_equal(enf_shim_delaunay_cgal(flat.points, flat.count, &cells, NULL), ENF_BAD_INPUT);
        assert_int_equal(fegetround(), modes[i]);
        fesetround(FE_TONEAREST);
        free(cloud.points);
        free(flat.points);
    }
}

static void a_build_without_tetgen_says_so(void **state) {
    (void)state;
    if (enf_shim_has_tetgen()) skip();
    cloud cloud = make_lattice(2);
    enf_tetrahedra cells;
    enf_error error = {0};
    assert_int_equal(enf_shim_delaunay_tetgen(cloud.points, cloud.count, &cells, &error), ENF_BAD_USAGE);
    assert_non_null(strstr(error.text, "TetGen"));
    free(cloud.points);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(predicates_agree_with_cgal), // before others rely on them
        cmocka_unit_test(a_cube_is_tiled),
        cmocka_unit_test(one_tetrahedron_is_itself),
        cmocka_unit_test(lattices_are_tiled),
        cmocka_unit_test(random_points_are_tiled),
        cmocka_unit_test(clusters_far_apart_are_tiled),
        cmocka_unit_test(largest_coordinates_are_fine),
        cmocka_unit_test(flat_worlds_are_refused),
        cmocka_unit_test(almost_flat_worlds_are_tiled_or_refused),
        cmocka_unit_test(equal_points_are_refused),
        cmocka_unit_test(large_holes_are_filled),
        cmocka_unit_test(ties_are_broken_as_cgal_does),
        cmocka_unit_test(cgal_does_not_depend_on_the_order_of_points),
        cmocka_unit_test(the_order_of_tetrahedra_depends_on_the_set_only),
        cmocka_unit_test(same_points_give_the_same_array),
        cmocka_unit_test(rounding_mode_comes_back),
        cmocka_unit_test(a_build_without_tetgen_says_so),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
