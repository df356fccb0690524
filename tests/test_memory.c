// SPDX-License-Identifier: GPL-3.0-or-later
// Memory is foreseen: sizes are read strictly, and what will not fit is refused before the work.
#include "pipeline_fixture.h"

#include "base/memory.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cmocka.h>

static void sizes_are_read_strictly(void **state) {
    (void)state;
    static const struct {
        const char *text;
        uint64_t bytes;
    } good[] = {{"1", 1},
                {"512M", UINT64_C(512) << 20},
                {"16G", UINT64_C(16) << 30},
                {"7K", 7168},
                {"2T", UINT64_C(2) << 40},
                {"18446744073709551615", UINT64_MAX},
                {"16777215T", UINT64_C(16777215) << 40}};
    static const char *const bad[] = {"",      "0",   "0G",   "G",    "-1",        "+1",       " 1",
                                      "1 ",    "1 G", "1.5G", "16GB", "16g",       "1e9",      "0x10",
                                      "16G16", "1GG", "inf",  "1P",   "16777216T", "99999999T"};
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        uint64_t bytes = 0;
        assert_true(enf_memory_parse(good[i].text, &bytes));
        assert_true(bytes == good[i].bytes);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        uint64_t bytes = 77;
        if (enf_memory_parse(bad[i], &bytes))
            fail_msg("'%s' was read as %llu", bad[i], (unsigned long long)bytes);
        assert_true(bytes == 77);
    }
    uint64_t bytes;
    assert_false(enf_memory_parse("18446744073709551616", &bytes));
}

static void more_of_anything_needs_no_less(void **state) {
    (void)state;
    enf_memory_counts counts = {.points = 1000, .polygons = 2000, .corners = 6000};
    uint64_t least = enf_memory_estimate(&counts);
    counts.points = 100000;
    assert_true(enf_memory_estimate(&counts) > 10 * least);
    counts.tetrahedra = 600000;
    uint64_t uncut = enf_memory_estimate(&counts);
    counts.tetrahedra = 1200000;
    assert_true(enf_memory_estimate(&counts) > uncut);
    counts.missing = 600000;
    counts.tetrahedra = 600000;
    assert_true(enf_memory_estimate(&counts) > uncut);
}

static void what_does_not_fit_is_refused_in_words(void **state) {
    (void)state;
    enf_memory_counts counts = {.points = 5000000, .polygons = 10000000, .corners = 30000000};
    enf_error error = {0};
    uint64_t needed = enf_memory_estimate(&counts);
    assert_int_equal(enf_memory_admit(&counts, enf_memory_allow(needed), &error), ENF_OK);
    assert_int_equal(enf_memory_admit(&counts, enf_memory_allow(needed - 1), &error), ENF_NO_RESOURCES);
    const char *const words[] = {"10000000 polygons", "GiB", "--memory allows", "--exclude", "--detail"};
    for (size_t i = 0; i < sizeof words / sizeof *words; i++)
        if (!strstr(error.text, words[i])) fail_msg("no '%s' in: %s", words[i], error.text);
}

static void what_cannot_be_numbered_is_refused_in_words(void **state) {
    (void)state;
    const enf_memory_counts beyond[] = {
        {.points = UINT64_C(1) << 26, .polygons = 10, .corners = 30},
        {.points = 100, .polygons = UINT64_C(1) << 31, .corners = 30},
        {.points = 100, .polygons = 100, .corners = UINT64_C(1) << 31},
        {.points = 100, .polygons = 100, .corners = 300, .tetrahedra = UINT64_C(1) << 29},
        {.soup_points = UINT64_C(1) << 32, .points = 100, .polygons = 100, .corners = 300},
    };
    for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++) {
        enf_error error = {0};
        assert_int_equal(enf_memory_admit(&beyond[i], enf_memory_allow(UINT64_MAX), &error),
                         ENF_NO_RESOURCES);
        assert_non_null(strstr(error.text, "more than this build can number"));
    }
}

static void the_limit_is_that_of_the_address_space_if_it_is_lower(void **state) {
    (void)state;
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    print_message("skipped: sanitizers take more address space than there is memory\n");
    skip();
#endif
    const char *limiter = NULL;
    uint64_t before = enf_memory_limit(&limiter);
    assert_non_null(limiter);
    struct rlimit old, low = {.rlim_cur = (rlim_t)1 << 29};
    assert_int_equal(getrlimit(RLIMIT_AS, &old), 0);
    low.rlim_max = old.rlim_max;
    if (before < low.rlim_cur || setrlimit(RLIMIT_AS, &low) != 0) {
        print_message("skipped: there is a lower limit already\n");
        skip();
    }
    uint64_t limit = enf_memory_limit(&limiter);
    assert_int_equal(setrlimit(RLIMIT_AS, &old), 0);
    assert_true(limit == low.rlim_cur);
    assert_non_null(strstr(limiter, "ulimit"));
}

static void a_build_is_refused_before_there_are_tetrahedra(void **state) {
    (void)state;
    enf_build build;
    memset(&build, 0, sizeof build);
    pipeline_read_model(&build.soup, "office");
    enf_build_options options = pipeline_options();
    options.memory = 1000000;
    enf_error error = {0};
    assert_int_equal(enf_build_run(&build, &options, &error), ENF_NO_RESOURCES);
    assert_non_null(strstr(error.text, "of memory"));
    assert_string_equal(build.stages[build.stage_count - 1].name, "tetrahedralize");
    assert_int_equal(build.counts.tetrahedra, 0);
    assert_true(build.peak_bytes_predicted > options.memory);
    enf_build_free(&build);
}

static void estimates_go_by_what_is_there(void **state) {
    (void)state;
    enf_build build;
    memset(&build, 0, sizeof build);
    pipeline_read_model(&build.soup, "office");
    enf_build_options options = pipeline_options();
    enf_error error = {0};
    assert_int_equal(enf_build_run(&build, &options, &error), ENF_OK);
    assert_int_equal(build.counts.points, build.mesh.point_count);
    assert_int_equal(build.counts.polygons, build.mesh.polygon_count);
    assert_int_equal(build.counts.tetrahedra, build.complex.tetrahedron_count);
    assert_true(build.peak_bytes_predicted == enf_memory_estimate(&build.counts));
    for (int i = 0; i < ENF_STAGE_COUNT; i++) {
        assert_true(build.stages[i].peak_bytes > 0);
        assert_true(i == 0 || build.stages[i].peak_bytes >= build.stages[i - 1].peak_bytes);
    }
    enf_build_free(&build);
}

/// Four points; one tetrahedron between them, whose faces are polygons, and a triangle that is no face.
static void triangles_that_are_no_faces_are_counted(void **state) {
    (void)state;
    int32_t(*made)[4] = malloc(sizeof *made);
    assert_non_null(made);
    for (int k = 0; k < 4; k++) made[0][k] = k;
    enf_tet_mesh tets;
    enf_error error = {0};
    assert_int_equal(enf_tet_mesh_pair(&tets, made, 1, 4, &error), ENF_OK);
    int32_t corners[] = {0, 1, 2, 3, 1, 0, 0, 1, 4};
    int64_t offsets[] = {0, 3, 6, 9};
    enf_mesh mesh = {.polygon_count = 2, .polygon_corner = offsets, .corners = corners};
    enf_memory_counts counts = {0};
    enf_memory_count_tetrahedra(&counts, &mesh, &tets);
    assert_int_equal(counts.tetrahedra, 1);
    assert_int_equal(counts.missing, 0);
    mesh.polygon_count = 3;
    enf_memory_count_tetrahedra(&counts, &mesh, &tets);
    assert_int_equal(counts.missing, 1);
    enf_tet_mesh_free(&tets);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sizes_are_read_strictly),
        cmocka_unit_test(more_of_anything_needs_no_less),
        cmocka_unit_test(what_does_not_fit_is_refused_in_words),
        cmocka_unit_test(what_cannot_be_numbered_is_refused_in_words),
        cmocka_unit_test(the_limit_is_that_of_the_address_space_if_it_is_lower),
        cmocka_unit_test(a_build_is_refused_before_there_are_tetrahedra),
        cmocka_unit_test(estimates_go_by_what_is_there),
        cmocka_unit_test(triangles_that_are_no_faces_are_counted),
    };
    return cmocka_run_group_tests_name("memory", tests, NULL, NULL);
}
