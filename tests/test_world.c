// SPDX-License-Identifier: GPL-3.0-or-later
// Worlds from the real pipeline through the file: the same bytes for any number of threads, points found
// where the exact complex has them, and mutated files never crash the runtime.
#include "world_fixture.h"

#include "base/exact.h"
#include "build/gen.h"
#include "enfilade/run.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static uint64_t next_random(uint64_t *seed) { // splitmix64
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static void compile(enf_build *build, const char *name, const char *const *settings, size_t setting_count,
                    int threads) {
    char path[] = "world-XXXXXX.obj";
    int file = mkstemps(path, 4);
    assert_true(file >= 0);
    FILE *out = fdopen(file, "w");
    enf_error error = {0};
    assert_int_equal(enf_gen_write(name, settings, setting_count, out, &error), ENF_OK);
    fclose(out);
    memset(build, 0, sizeof *build);
    enf_build_options options = {.clean = {.weld = -1, .plane_tolerance = -1}, .threads = threads};
    enf_status status = enf_soup_read(&build->soup, path, &error);
    if (!status) status = enf_build_run(build, &options, &error);
    remove(path);
    if (status) fail_msg("%s: %s", name, error.text);
}

static unsigned char *save(const enf_build *build, size_t *size) {
    char path[] = "world-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    enf_error error = {0};
    enf_status status = enf_build_write(build, "{}", path, &error);
    unsigned char *bytes = status ? NULL : fixture_read_file(path, size);
    remove(path);
    if (status) fail_msg("%s", error.text);
    return bytes;
}

static const double *point_of(const enf_complex *c, int32_t point) {
    return c->points + 3 * (size_t)point;
}

static int side_of_plane(const enf_complex *c, int32_t plane, const double at[3]) {
    const int32_t *through = c->planes[plane];
    if (through[2] >= 0)
        return enf_points_orient(point_of(c, through[0]), point_of(c, through[1]), point_of(c, through[2]),
                                 at);
    double third[3];
    memcpy(third, point_of(c, through[0]), sizeof third);
    third[-1 - through[2]] += 1;
    return enf_points_orient(point_of(c, through[0]), point_of(c, through[1]), third, at);
}

static void better_of(const enf_build *build, int32_t fine, int32_t *best) {
    bool in_cell = build->cell_of[fine] >= 0, best_in_cell = *best >= 0 && build->cell_of[*best] >= 0;
    if (*best < 0 || in_cell > best_in_cell || (in_cell == best_in_cell && fine < *best)) *best = fine;
}

/// All fine cells under a node that touch the point (recursion is as deep as the tree of one tetrahedron).
static void look_below(const enf_build *build, int32_t node, const double at[3], int32_t *best) {
    if (node < 0) {
        better_of(build, -1 - node, best);
        return;
    }
    int side = side_of_plane(&build->complex, build->complex.node_plane[node], at);
    if (side <= 0) look_below(build, build->complex.node_child[node][0], at, best);
    if (side >= 0) look_below(build, build->complex.node_child[node][1], at, best);
}

/// The rule of run.h by looking at every tetrahedron; `at` is a grid point.
static int32_t locate_by_looking_everywhere(const enf_build *build, const double at[3]) {
    const enf_complex *c = &build->complex;
    int32_t best = -1;
    for (int32_t t = 0; t < c->tetrahedron_count; t++) {
        const double *p[4];
        for (int k = 0; k < 4; k++) p[k] = point_of(c, c->tetrahedra[t][k]);
        if (enf_points_orient(p[0], p[1], p[2], at) >= 0 && enf_points_orient(p[0], p[2], p[3], at) >= 0 &&
            enf_points_orient(p[0], p[3], p[1], at) >= 0 && enf_points_orient(p[1], p[3], p[2], at) >= 0)
            look_below(build, c->tetrahedron_root[t], at, &best);
    }
    return best;
}

static void check_point(const enf_build *build, const enf_world *world, const double grid[3], int32_t hint) {
    double at[3], user[3];
    for (int a = 0; a < 3; a++) {
        at[a] = nearbyint(grid[a]);
        if (fabs(at[a]) >= 0x1p53) return;
    }
    enf_frame_to_world(&build->mesh.frame, at, user);
    int32_t expected = locate_by_looking_everywhere(build, at);
    enf_place place = enf_world_locate(world, user, hint);
    if (expected < 0) return; // outside, or next to the hull, where the runtime is generous
    if (place.fine_cell != expected)
        fail_msg("at %.17g %.17g %.17g: fine cell %d, not %d", user[0], user[1], user[2], place.fine_cell,
                 expected);
    assert_int_equal(place.cell, build->cell_of[expected]);
    assert_int_equal(place.kind, (int)build->regions.kind[build->regions.cell_region[expected]]);
}

static void check_points(const enf_build *build, const enf_world *world) {
    uint64_t seed = 3;
    const enf_complex *c = &build->complex;
    int32_t stride = 1 + c->vertex_count / 400;
    for (int32_t i = 0; i < c->vertex_count; i += stride)
        check_point(build, world, c->vertex_position[i], i % c->tetrahedron_count);
    double largest = 0;
    for (int32_t i = 0; i < c->point_count; i++) {
        for (int a = 0; a < 3; a++) largest = fmax(largest, fabs(c->points[3 * i + a]));
    }
    for (int n = 0; n < 600; n++) {
        double grid[3];
        for (int a = 0; a < 3; a++) grid[a] = ((double)(next_random(&seed) >> 11) * 0x1p-52 - 1) * largest;
        check_point(build, world, grid,
                    n % 2 ? -1 : (int32_t)(next_random(&seed) % (uint64_t)c->tetrahedron_count));
    }
    stride = 1 + c->facet_count / 400;
    for (int32_t i = 0; i < c->facet_count;
         i += stride) { // the middle of a diagonal: on or next to the facet
        int64_t first = c->facets.offset[i], count = c->facets.offset[i + 1] - first;
        double grid[3];
        for (int a = 0; a < 3; a++)
            grid[a] = (c->vertex_position[c->facets.corners[first].vertex][a] +
                       c->vertex_position[c->facets.corners[first + count / 2].vertex][a]) /
                      2;
        check_point(build, world, grid, -1);
    }
    const enf_file_view *file = enf_world_file(world);
    for (int32_t i = 0; i < file->cell_count; i++) {
        const int32_t *list = file->cell_triangles + file->cells[i].triangle_first;
        for (int32_t k = 1; k < file->cells[i].triangle_count; k++) assert_true(list[k - 1] < list[k]);
    }
    for (int32_t i = 0; i < file->spawn_count; i++)
        assert_int_equal(enf_world_locate(world, file->spawns[i].position, -1).cell, file->spawns[i].cell);
}

static const char *const turned[] = {"rotate=11,23,37", "noise=0.01"};
static const char *const mirrored[] = {"scale=-1,1,1"};

static void points_are_found_where_the_exact_complex_has_them(void **state) {
    (void)state;
    const char *name;
    for (size_t i = 0; (name = enf_gen_list(i, NULL)); i++) {
        for (int variant = 0; variant < 3; variant++) {
            enf_build build;
            if (variant == 0) compile(&build, name, NULL, 0, 1);
            if (variant == 1) compile(&build, name, turned, 2, 1);
            if (variant == 2) compile(&build, name, mirrored, 1, 1);
            size_t size;
            unsigned char *bytes = save(&build, &size);
            enf_world *world;
            enf_error error = {0};
            if (enf_world_open_memory(&world, bytes, size, NULL, &error))
                fail_msg("%s: %s", name, error.text);
            check_points(&build, world);
            enf_world_close(world);
            free(bytes);
            enf_build_free(&build);
        }
    }
}

static void threads_do_not_show_in_the_file(void **state) {
    (void)state;
    unsigned char *bytes[2];
    size_t size[2];
    for (int k = 0; k < 2; k++) {
        enf_build build;
        compile(&build, "office", turned, 2, 1 + 2 * k);
        bytes[k] = save(&build, &size[k]);
        enf_build_free(&build);
    }
    assert_int_equal(size[0], size[1]);
    assert_memory_equal(bytes[0], bytes[1], size[0]);
    free(bytes[0]);
    free(bytes[1]);
}

static void mutated_worlds_never_crash(void **state) {
    (void)state;
    uint64_t seed = 99;
    print_message("seed %llu\n", (unsigned long long)seed);
    enf_build build;
    size_t size;
    compile(&build, enf_gen_list(0, NULL), NULL, 0, 1);
    unsigned char *bytes = save(&build, &size), *copy = malloc(size);
    enf_build_free(&build);
    assert_non_null(copy);
    for (int n = 0; n < 300; n++) {
        memcpy(copy, bytes, size);
        int changes = 1 + n % 4;
        for (int k = 0; k < changes; k++) {
            size_t span = n % 5 ? size : 64 + 60 * 48; // the header and the table more often
            size_t at = next_random(&seed) % (span < size ? span : size);
            copy[at] = (unsigned char)next_random(&seed);
        }
        LLVMFuzzerTestOneInput(copy, n % 7 ? size : next_random(&seed) % size);
    }
    free(bytes);
    free(copy);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(points_are_found_where_the_exact_complex_has_them),
        cmocka_unit_test(threads_do_not_show_in_the_file),
        cmocka_unit_test(mutated_worlds_never_crash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
