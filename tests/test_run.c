// SPDX-License-Identifier: GPL-3.0-or-later
// The runtime: point location against looking at every fine cell, and the predicate under it against another
// one.
#include "world_fixture.h"

#include "base/exact.h"
#include "base/narrow.h"
#include "enfilade/run.h"
#include "format/locate.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static uint64_t next_random(uint64_t *seed) { // splitmix64
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

typedef struct opened {
    fixture fixture;
    unsigned char *bytes;
    enf_world *world;
} opened;

static opened open_fixture(int side, const enf_frame *frame) {
    opened o;
    size_t size;
    fixture_make(&o.fixture, side, frame);
    o.bytes = fixture_save(&o.fixture, &size);
    assert_int_equal(enf_world_open_memory(&o.world, o.bytes, size, NULL, NULL), ENF_OK);
    return o;
}

static void close_fixture(opened *o) {
    enf_world_close(o->world);
    free(o->bytes);
    fixture_free(&o->fixture);
}

// --- The other way to locate: every tetrahedron, sides in whole numbers of 1/1024 grid steps
// ---------------------

#define FINE_GRID 1024

static int64_t side_in_integers(const double *p, const double *q, const double *r, const int64_t at[3]) {
    int64_t u[3], v[3], w[3];
    for (int a = 0; a < 3; a++) {
        int64_t origin = (int64_t)p[a] * FINE_GRID;
        u[a] = (int64_t)q[a] - (int64_t)p[a];
        v[a] = (int64_t)r[a] - (int64_t)p[a];
        w[a] = at[a] - origin;
    }
    return w[0] * (u[1] * v[2] - u[2] * v[1]) + w[1] * (u[2] * v[0] - u[0] * v[2]) +
           w[2] * (u[0] * v[1] - u[1] * v[0]);
}

static bool tetrahedron_touches(const enf_complex *c, int32_t tetrahedron, const int64_t at[3]) {
    const double *p[4];
    for (int k = 0; k < 4; k++) p[k] = c->points + 3 * c->tetrahedra[tetrahedron][k];
    return side_in_integers(p[0], p[1], p[2], at) >= 0 && side_in_integers(p[0], p[2], p[3], at) >= 0 &&
           side_in_integers(p[0], p[3], p[1], at) >= 0 && side_in_integers(p[1], p[3], p[2], at) >= 0;
}

/// The rule of run.h: of the fine cells that touch the point, those of cells first, then the lowest number.
static int32_t locate_by_looking_everywhere(const fixture *f, const int64_t at[3]) {
    const enf_complex *c = &f->build.complex;
    int32_t best = -1;
    for (int32_t fine = 0; fine < c->cell_count; fine++) {
        int32_t tetrahedron = fixture_tetrahedron_of(f, fine);
        if (!tetrahedron_touches(c, tetrahedron, at)) continue;
        if (tetrahedron == f->cut) {
            const int32_t *plane = c->planes[c->node_plane[0]];
            int64_t side = side_in_integers(c->points + 3 * plane[0], c->points + 3 * plane[1],
                                            c->points + 3 * plane[2], at);
            if (fine == c->cell_count - 1 ? side < 0 : side > 0) continue;
        }
        bool better = best < 0 || (f->build.cell_of[fine] >= 0 && f->build.cell_of[best] < 0);
        if (better) best = fine;
    }
    return best;
}

/// Without bricks and a hint there is nothing to walk from: the boxes must find the same.
static enf_place locate_by_boxes(const opened *o, const double world[3]) {
    enf_file_view file = *enf_world_file(o->world);
    file.start = NULL;
    return enf_view_locate(&file, world, -1);
}

static void check_point(const opened *o, const int64_t at[3], int32_t hint) {
    double grid[3], world[3];
    for (int a = 0; a < 3; a++) grid[a] = (double)at[a] / FINE_GRID;
    enf_frame_to_world(&o->fixture.build.mesh.frame, grid, world);
    int32_t expected = locate_by_looking_everywhere(&o->fixture, at);
    enf_place place = enf_world_locate(o->world, world, hint);
    if (place.fine_cell != expected)
        fail_msg("at %g %g %g (hint %d): fine cell %d, not %d", grid[0], grid[1], grid[2], hint,
                 place.fine_cell, expected);
    assert_int_equal(locate_by_boxes(o, world).fine_cell, expected);
    const enf_build *build = &o->fixture.build;
    assert_int_equal(place.cell, expected < 0 ? -1 : build->cell_of[expected]);
    assert_int_equal(place.tetrahedron < 0, expected < 0);
    assert_int_equal(place.region, expected < 0 ? -1 : build->regions.cell_region[expected]);
    assert_int_equal(place.kind, expected < 0 ? ENF_WORLD_OUTSIDE : (int)build->regions.kind[place.region]);
}

static const enf_frame frames[] = {
    {0.25, {0, 1, 2}, {1, 1, 1}, 1, false, {{0}}},
    {0x1p-40, {1, 2, 0}, {-1, 1, -1}, 1, false, {{0}}},
    {0x1p60, {2, 1, 0}, {1, 1, 1}, -1, false, {{0}}},
    {1, {0, 1, 2}, {1, -1, 1}, -1, false, {{0}}},
};

static void random_points_are_found_where_they_are(void **state) {
    (void)state;
    uint64_t seed = 5;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (size_t i = 0; i < sizeof frames / sizeof *frames; i++) {
        opened o = open_fixture(4, &frames[i]);
        for (int n = 0; n < 4000; n++) {
            int64_t at[3];
            // A coarse share of the points lies on faces, edges and corners; some lie outside.
            int64_t grain = n % 3 ? 1 : FINE_GRID / (1 + n % 4);
            for (int a = 0; a < 3; a++)
                at[a] = ((int64_t)(next_random(&seed) % (20 * FINE_GRID)) - 2 * FINE_GRID) / grain * grain;
            check_point(&o, at, -1);
            check_point(&o, at,
                        (int32_t)(next_random(&seed) % (uint64_t)o.fixture.build.complex.tetrahedron_count));
        }
        close_fixture(&o);
    }
}

/// Rounding may take a point across a wall that it lies on, so those are left out.
static void a_turned_world_is_asked_in_the_users_coordinates(void **state) {
    (void)state;
    const enf_frame frame = {0.5, {1, 2, 0}, {-1, 1, -1},
                             1,   true,      {{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}}};
    uint64_t seed = 6;
    print_message("seed %llu\n", (unsigned long long)seed);
    opened o = open_fixture(4, &frame);
    int tested = 0;
    for (int n = 0; n < 4000; n++) {
        int64_t at[3];
        for (int a = 0; a < 3; a++) at[a] = (int64_t)(next_random(&seed) % (20 * FINE_GRID)) - 2 * FINE_GRID;
        int32_t here = locate_by_looking_everywhere(&o.fixture, at);
        bool inside = true;
        for (int k = 0; k < 6 && inside; k++) {
            int64_t next[3] = {at[0], at[1], at[2]};
            next[k / 2] += k % 2 ? 1 : -1;
            inside = locate_by_looking_everywhere(&o.fixture, next) == here;
        }
        if (!inside) continue;
        tested++;
        check_point(&o, at, -1);
        check_point(&o, at, (int32_t)(next_random(&seed) % (uint64_t)o.fixture.build.complex.cell_count));
    }
    assert_true(tested > 3000);
    close_fixture(&o);
}

static void vertices_and_centres_are_found_where_they_are(void **state) {
    (void)state;
    opened o = open_fixture(4, NULL);
    const enf_complex *c = &o.fixture.build.complex;
    for (int32_t i = 0; i < c->point_count; i++) {
        int64_t at[3];
        for (int a = 0; a < 3; a++) at[a] = (int64_t)c->points[3 * i + a] * FINE_GRID;
        check_point(&o, at, -1);
        check_point(&o, at, i);
    }
    for (int32_t i = 0; i < c->facet_count; i++) { // near the middle: 1/3 is not a binary fraction
        int64_t at[3];
        for (int a = 0; a < 3; a++) {
            at[a] = 0;
            for (int k = 0; k < 3; k++)
                at[a] += (int64_t)c->points[3 * c->planes[i][k] + a] * (k == 0 ? 512 : 256);
        }
        check_point(&o, at, -1);
    }
    close_fixture(&o);
}

/// Centroids computed in floating point by a user lie next to their face, not on it. On the hull some lie
/// outside.
static void rounded_face_centres_are_never_outside(void **state) {
    (void)state;
    const enf_frame frame = {0x1p-60, {1, 0, 2}, {1, 1, -1}, 1, false, {{0}}};
    opened o = open_fixture(4, &frame);
    const enf_complex *c = &o.fixture.build.complex;
    for (int32_t i = 0; i < c->facet_count; i++) {
        double centre[3] = {0, 0, 0};
        for (int k = 0; k < 3; k++) {
            double world[3];
            enf_frame_to_world(&frame, c->points + 3 * c->planes[i][k], world);
            for (int a = 0; a < 3; a++) centre[a] += world[a] * (1.0 / 3.0);
        }
        enf_place place = enf_world_locate(o.world, centre, -1);
        assert_true(place.fine_cell >= 0);
        const int32_t *cell = c->facet_cell[i]; // as many as tetrahedra, and one more
        assert_int_equal(place.tetrahedron, fixture_tetrahedron_of(&o.fixture, place.fine_cell));
        assert_true(place.tetrahedron == cell[0] || place.tetrahedron == cell[1]);
    }
    close_fixture(&o);
}

static void just_outside_the_hull_is_inside_and_further_out_is_not(void **state) {
    (void)state;
    opened o = open_fixture(2, NULL);
    const enf_file_frame *frame = enf_world_file(o.world)->frame;
    double margin = frame->locate_rounding * frame->step;
    assert_true(margin > 0 && margin < 1e-14);
    double at[3] = {0.3, 0.6, -margin / 2};
    assert_int_equal(enf_world_locate(o.world, at, -1).cell, 0);
    assert_int_equal(locate_by_boxes(&o, at).cell, 0);
    at[2] = -margin * 4;
    assert_int_equal(enf_world_locate(o.world, at, -1).fine_cell, -1);
    assert_int_equal(locate_by_boxes(&o, at).fine_cell, -1);
    at[2] = 0;
    assert_int_equal(enf_world_locate(o.world, at, -1).cell, 0);
    close_fixture(&o);
}

static void a_point_on_a_wall_is_in_the_room(void **state) {
    (void)state;
    opened o = open_fixture(4, NULL);
    double at[3] = {2, 0.3, 0.7}; // the wall is at x = 2; beyond it is rock
    enf_place place = enf_world_locate(o.world, at, -1);
    assert_int_equal(place.cell, 0);
    assert_int_equal(place.kind, ENF_WORLD_AIR);
    at[0] = nextafter(2, 3);
    place = enf_world_locate(o.world, at, place.tetrahedron);
    assert_int_equal(place.cell, -1);
    assert_int_equal(place.kind, ENF_WORLD_ROCK);
    assert_string_equal(enf_world_kind_name(place.kind), "rock");
    close_fixture(&o);
}

static void what_is_not_a_number_is_outside(void **state) {
    (void)state;
    opened o = open_fixture(2, NULL);
    const double odd[] = {NAN, INFINITY, -INFINITY, 1e308, -1e308, 0x1p-1074};
    for (size_t i = 0; i < sizeof odd / sizeof *odd; i++) {
        double at[3] = {0.25, odd[i], 0.25};
        enf_place place = enf_world_locate(o.world, at, (int32_t)i);
        assert_int_equal(place.cell, i < 5 ? -1 : 0);
        assert_int_equal(place.kind, i < 5 ? ENF_WORLD_OUTSIDE : ENF_WORLD_AIR);
    }
    double at[3] = {0.25, 0.5, 0.25};
    assert_int_equal(enf_world_locate(o.world, at, INT32_MAX).cell, 0); // a hint that never was
    assert_int_equal(enf_world_locate(o.world, at, INT32_MIN).cell, 0);
    close_fixture(&o);
}

static void spawn_points_are_found_where_the_file_says(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof frames / sizeof *frames; i++) {
        opened o = open_fixture(2, &frames[i]);
        const enf_file_view *file = enf_world_file(o.world);
        assert_int_equal(file->spawn_count, 3);
        for (int32_t k = 0; k < file->spawn_count; k++) {
            enf_place place = enf_world_locate(o.world, file->spawns[k].position, -1);
            assert_int_equal(place.cell, file->spawns[k].cell);
        }
        close_fixture(&o);
    }
}

static void the_summary_counts(void **state) {
    (void)state;
    opened o = open_fixture(2, NULL);
    enf_world_info info;
    enf_world_get_info(o.world, &info);
    assert_int_equal(info.cells, 2);
    assert_int_equal(info.portals, 1);
    assert_int_equal(info.portal_polygons, 4);
    assert_int_equal(info.regions, 2);
    assert_int_equal(info.regions_kept, 1);
    assert_int_equal(info.regions_of_kind[ENF_WORLD_ROCK], 1);
    assert_int_equal(info.fine_cells, 49);
    assert_int_equal(info.fine_cells_active, 25);
    assert_int_equal(info.fine_cells_discarded, 24);
    assert_int_equal(info.spawns, 3);
    assert_int_equal(info.spawns_in_cells, 2);
    assert_int_equal(info.triangles, 10);
    assert_int_equal(info.detail_triangles, 2);
    assert_true(info.volume_kept == 4 && info.volume_of_kind[ENF_WORLD_ROCK] == 4);
    assert_true(info.box_min[0] == 0 && info.box_max[2] == 2);
    assert_true(info.has_exact && info.has_geometry && !info.leak);
    close_fixture(&o);
}

static void extreme_coordinates_do_not_overflow_the_predicate(void **state) {
    (void)state;
    const double m = 0x1p53;
    const double a[3] = {-m, -m, -m}, b[3] = {m, -m, -m}, c[3] = {-m, m, -m}, d[3] = {m, m, m},
                 e[3] = {m, m, -m};
    assert_int_equal(enf_points_orient(a, b, c, d), 1);
    assert_int_equal(enf_points_orient(a, c, b, d), -1);
    assert_int_equal(enf_points_orient(a, b, c, e), 0);
    const double f[3] = {m, m, -m + 1};
    assert_int_equal(enf_points_orient(a, b, c, f), 1);
}

static int64_t random_wide(uint64_t *seed) { // up to 2^54, of any magnitude
    int64_t value = (int64_t)(next_random(seed) >> 10 >> next_random(seed) % 54);
    return next_random(seed) % 2 ? -value : value;
}

/// Limbs of 32 bits tell the sign of determinants whose rows are known to depend on each other, or not.
static void narrow_determinants_are_exact(void **state) {
    (void)state;
    uint64_t seed = 99;
    for (int round = 0; round < 200000; round++) {
        int64_t m[3][3] = {{0}}, p = (int64_t)(next_random(&seed) % 3), s = (int64_t)(next_random(&seed) % 4);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k <= i; k++) m[i][k] = random_wide(&seed);
        int sign = 1;
        for (int i = 0; i < 3; i++) sign *= (m[i][i] > 0) - (m[i][i] < 0);
        assert_int_equal(enf_narrow_determinant(m[p], m[(p + 1) % 3], m[(p + 2) % 3]), sign);
        assert_int_equal(enf_narrow_determinant(m[(p + 1) % 3], m[p], m[(p + 2) % 3]), -sign);
        // The third row becomes a sum of others, and then one that is 1 off in one place.
        int64_t u[3], v[3], w[3];
        for (int k = 0; k < 3; k++) {
            u[k] = random_wide(&seed) / 4;
            v[k] = random_wide(&seed) / 8;
            w[k] = u[k] - s * v[k];
        }
        assert_int_equal(enf_narrow_determinant(u, v, w), 0);
        u[2] = 0, v[2] = 0; // det = w[2] * (u[0] v[1] - u[1] v[0])
        u[1] = 0;
        w[2] = p - 1;
        sign = (u[0] > 0) - (u[0] < 0);
        sign *= (v[1] > 0) - (v[1] < 0);
        assert_int_equal(enf_narrow_determinant(u, v, w), sign * (int)(p - 1));
#ifdef __SIZEOF_INT128__
        double a[3], b[3], c[3], d[3];
        int64_t rows[3][3];
        for (int k = 0; k < 3; k++) {
            a[k] = (double)(random_wide(&seed) / 2);
            b[k] = (double)(random_wide(&seed) / 2);
            c[k] = (double)(random_wide(&seed) / 2);
            d[k] = round % 2 ? (double)(random_wide(&seed) / 2) : b[k] + (k == 0);
            rows[0][k] = (int64_t)b[k] - (int64_t)a[k];
            rows[1][k] = (int64_t)c[k] - (int64_t)a[k];
            rows[2][k] = (int64_t)d[k] - (int64_t)a[k];
        }
        assert_int_equal(enf_narrow_determinant(rows[0], rows[1], rows[2]),
                         enf_points_orient_exactly(a, b, c, d));
#endif
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_points_are_found_where_they_are),
        cmocka_unit_test(a_turned_world_is_asked_in_the_users_coordinates),
        cmocka_unit_test(vertices_and_centres_are_found_where_they_are),
        cmocka_unit_test(rounded_face_centres_are_never_outside),
        cmocka_unit_test(just_outside_the_hull_is_inside_and_further_out_is_not),
        cmocka_unit_test(a_point_on_a_wall_is_in_the_room),
        cmocka_unit_test(what_is_not_a_number_is_outside),
        cmocka_unit_test(spawn_points_are_found_where_the_file_says),
        cmocka_unit_test(the_summary_counts),
        cmocka_unit_test(extreme_coordinates_do_not_overflow_the_predicate),
        cmocka_unit_test(narrow_determinants_are_exact),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
