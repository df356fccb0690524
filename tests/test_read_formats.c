// SPDX-License-Identifier: GPL-3.0-or-later
// Reading PLY, OFF and STL, and damaged files of any format.
#include "build/soup.h"
#include "tests/read_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

// ---- PLY

#define PLY_HEADER(FORMAT, COUNT)                                                                      \
    "ply\nformat " FORMAT " 1.0\ncomment made by hand\nelement vertex 4\nproperty double x\nproperty " \
    "double y\nproperty double z\nproperty uchar red\nelement face " COUNT                             \
    "\nproperty list uchar int vertex_indices\nelement extra 1\nproperty short what\nend_header\n"

static void check_square(const attempt *made) {
    if (made->status != ENF_OK) fail_msg("%s", made->error.text);
    assert_int_equal(made->soup.polygon_count, 2);
    assert_int_equal(made->soup.polygon_corner[1], 4);
    assert_true(fixture_corner(&made->soup, 0, 0)[0] == 0.1); // not 0.1f
    assert_true(fixture_corner(&made->soup, 0, 2)[1] == 1);
    assert_int_equal(made->soup.corner_point[made->soup.polygon_corner[1] + 2], -1);
    assert_int_equal(made->soup.rejected_count, 0);
}

static void ply_text_is_read_in_double_precision_with_polygons(void **state) {
    (void)state;
    attempt made = fixture_read_text(
        ".ply",
        PLY_HEADER("ascii", "2") "0.1 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n4 0 1 2 3\n3 0 1 4\n7\n");
    check_square(&made);
    assert_int_equal(made.soup.polygon_line[0], 18);
    enf_soup_free(&made.soup);
    made = fixture_read_text(
        ".ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\nproperty float s\nproperty float t\n"
        "element face 2\nproperty list uint int vertex_index\nend_header\n"
        "0 0 0 0 0 1 .5 .25\n1 0 0 0 0 1 0 0\n1 1 nan 0 0 1 0 0\n3 0 1 2\n3 0 1 x\n");
    assert_int_equal(made.status, ENF_OK);
    assert_int_equal(made.soup.normal_count, 3);
    assert_true(made.soup.texcoords[1] == 0.25);
    assert_int_equal(made.soup.corner_normal[2], 2);
    assert_true(isnan(made.soup.points[8]));
    assert_int_equal(made.soup.polygon_count, 1);
    assert_int_equal(made.soup.rejected_count, 1);
    assert_int_equal(made.soup.rejected[0].line, 19);
    enf_soup_free(&made.soup);
}

/// Appends the low `size` bytes of `bits` in the wanted order.
static void put(unsigned char *out, size_t *at, uint64_t bits, int size, bool big) {
    for (int k = 0; k < size; k++) out[(*at)++] = (unsigned char)(bits >> 8 * (big ? size - 1 - k : k));
}

static size_t make_binary_ply(unsigned char *out, bool big) {
    static const double points[] = {0.1, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const char *header = big ? PLY_HEADER("binary_big_endian", "2") : PLY_HEADER("binary_little_endian", "2");
    size_t size = strlen(header);
    memcpy(out, header, size);
    for (int i = 0; i < 12; i++) {
        uint64_t bits;
        memcpy(&bits, &points[i], 8);
        put(out, &size, bits, 8, big);
        if (i % 3 == 2) put(out, &size, 255, 1, big);
    }
    static const unsigned faces[2][5] = {{4, 0, 1, 2, 3}, {3, 0, 1, 4}};
    for (int f = 0; f < 2; f++) {
        put(out, &size, faces[f][0], 1, big);
        for (unsigned k = 1; k <= faces[f][0]; k++) put(out, &size, faces[f][k], 4, big);
    }
    put(out, &size, 7, 2, big);
    return size;
}

static void ply_binary_is_read_in_both_byte_orders(void **state) {
    (void)state;
    for (int big = 0; big < 2; big++) {
        unsigned char bytes[1000];
        size_t size = make_binary_ply(bytes, big);
        attempt made = fixture_read_bytes(".ply", bytes, size);
        check_square(&made);
        enf_soup_free(&made.soup);
        for (size_t cut = 1; cut < size; cut++) { // every truncation is noticed
            made = fixture_read_bytes(".ply", bytes, cut);
            assert_int_equal(made.status, ENF_BAD_INPUT);
            enf_soup_free(&made.soup);
        }
    }
}

static void ply_headers_that_lie_are_bad_input(void **state) {
    (void)state;
    fixture_expect_failure(".ply", "plyx\n", ENF_BAD_INPUT, ".ply:1:");
    fixture_expect_failure(
        ".ply", "ply\nformat ascii 1.0\nelement vertex 9999999999999\nproperty float x\nend_header\n1\n",
        ENF_BAD_INPUT, "announces");
    fixture_expect_failure(".ply",
                           "ply\nformat ascii 1.0\nelement face 99999999999999999999999\nend_header\n",
                           ENF_BAD_INPUT, "without properties");
    fixture_expect_failure(".ply",
                           "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint double "
                           "vertex_index\nend_header\n\xff\xff\xff\xff",
                           ENF_BAD_INPUT, "truncated");
    fixture_expect_failure(".ply", "ply\nformat weird 1.0\nend_header\n", ENF_BAD_INPUT, ".ply:2:");
    fixture_expect_failure(".ply", "ply\nformat ascii 1.0\nelement vertex -1\nend_header\n", ENF_BAD_INPUT,
                           ".ply:3:");
    fixture_expect_failure(".ply", "ply\nformat ascii 1.0\nproperty float x\nend_header\n", ENF_BAD_INPUT,
                           ".ply:3:");
    fixture_expect_failure(".ply",
                           "ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\nend_header\n",
                           ENF_BAD_INPUT, ".ply:4:");
    fixture_expect_failure(".ply", "ply\nelement vertex 1\n", ENF_BAD_INPUT, "does not end");
}

// ---- OFF

static void off_is_read_with_prefixes_and_comments(void **state) {
    (void)state;
    attempt made = fixture_read_text(
        ".off",
        "# a square\nOFF 4 2 0\n0.1 0 0\n1 0 0 # right\n\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n3 0 1 4\n");
    check_square(&made);
    assert_int_equal(made.soup.polygon_line[0], 8);
    enf_soup_free(&made.soup);
    made = fixture_read_text(".off", "COFF\n3 1 3\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n1 1 0 1 0 0 1\n3 0 1 2\n");
    assert_int_equal(made.status, ENF_OK);
    assert_true(fixture_corner(&made.soup, 0, 2)[1] == 1);
    enf_soup_free(&made.soup);
    made = fixture_read_text(
        ".off", "STNOFF\n3 2 3\n0 0 0 0 0 1 .5 .25\n1 0 0 0 0 1 0 0\n1 1 0 0 0 1\n3 0 1 2\n3 0 1\n");
    assert_int_equal(made.status, ENF_OK);
    assert_int_equal(made.soup.normal_count, 3);
    assert_true(made.soup.texcoords[0] == 0.5 && made.soup.texcoords[1] == 0.25 && made.soup.normals[2] == 1);
    assert_int_equal(made.soup.polygon_count, 1);
    assert_int_equal(made.soup.rejected_count,
                     2); // a vertex without texture coordinates, a face that ends early
    assert_true(isnan(made.soup.points[6]));
    enf_soup_free(&made.soup);
}

static void off_files_that_lie_are_bad_input(void **state) {
    (void)state;
    fixture_expect_failure(".off", "hello\n", ENF_BAD_INPUT, ".off:1:");
    fixture_expect_failure(".off", "OFF\n2000000000 2000000000 0\n1 2 3\n", ENF_BAD_INPUT, "announces");
    fixture_expect_failure(".off", "OFF\n-3 1 0\n", ENF_BAD_INPUT, ".off:2:");
    fixture_expect_failure(".off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", ENF_BAD_INPUT, "truncated");
    fixture_expect_failure(".off", "OFF BINARY\n", ENF_BAD_INPUT, "binary");
    fixture_expect_failure(".off", "4OFF\n1 1 1\n", ENF_BAD_INPUT, "4OFF");
}

// ---- STL

static void stl_text_is_read_in_double_precision(void **state) {
    (void)state;
    attempt made = fixture_read_text(
        ".stl",
        "solid my room\nfacet normal 0 0 nonsense\nouter loop\nVERTEX 0.1 0 0\nvertex 1 0 0\nvertex 1 1 0\n"
        "endloop\nendfacet\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 0 0 0 vertex 1 1 1 endloop "
        "endfacet\n"
        "what\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0 x 0\nvertex 1 1 "
        "1\nendloop\nendfacet\nendsolid my room\n");
    const enf_soup *soup = &made.soup;
    assert_int_equal(made.status, ENF_OK);
    assert_int_equal(soup->polygon_count, 3);
    assert_true(soup->points[0] == 0.1);
    assert_string_equal(soup->groups[soup->polygon_group[0]], "my room");
    assert_int_equal(soup->polygon_line[1], 9);
    assert_true(soup->rejected_count >= 2);
    assert_int_equal(soup->rejected[0].line, 10);
    assert_int_equal(soup->rejected[1].line, 14);
    assert_true(isnan(fixture_corner(soup, 2, 1)[0]));
    enf_soup_free(&made.soup);
    fixture_expect_failure(".stl", "solid cut\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", ENF_BAD_INPUT,
                           "truncated");
    fixture_expect_failure(".stl", "hello\n", ENF_BAD_INPUT, ".stl:1:");
}

static size_t make_binary_stl(unsigned char *out, uint32_t announced) {
    static const float corners[2][9] = {{0.5f, 0, 0, 1, 0, 0, 1, 1, 0}, {0, 0, 0, 0, 1, 0, 1, 1, NAN}};
    size_t size = 80;
    memset(out, 0, 80);
    memcpy(out, "solid, it says, but it is binary", 32);
    put(out, &size, announced, 4, false);
    for (int t = 0; t < 2; t++) {
        for (int k = 0; k < 3; k++) put(out, &size, 0, 4, false);
        for (int k = 0; k < 9; k++) {
            uint32_t bits;
            memcpy(&bits, &corners[t][k], 4);
            put(out, &size, bits, 4, false);
        }
        put(out, &size, 0, 2, false);
    }
    return size;
}

static void stl_binary_is_read_and_cut_ones_are_noticed(void **state) {
    (void)state;
    unsigned char bytes[400];
    size_t size = make_binary_stl(bytes, 2);
    attempt made = fixture_read_bytes(".stl", bytes, size);
    assert_int_equal(made.status, ENF_OK);
    assert_int_equal(made.soup.polygon_count, 2);
    assert_int_equal(made.soup.polygon_line[1], 2);
    assert_true(fixture_corner(&made.soup, 0, 0)[0] == 0.5 && isnan(fixture_corner(&made.soup, 1, 2)[2]));
    enf_soup_free(&made.soup);
    for (size_t cut = 1; cut < size; cut++) {
        made = fixture_read_bytes(".stl", bytes, cut);
        assert_int_equal(made.status, ENF_BAD_INPUT);
        enf_soup_free(&made.soup);
    }
    size = make_binary_stl(bytes, UINT32_MAX);
    made = fixture_read_bytes(".stl", bytes, size);
    assert_int_equal(made.status, ENF_BAD_INPUT);
    enf_soup_free(&made.soup);
}

// ---- anything

static uint64_t next_random(uint64_t *seed) {
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static void garbage_and_damaged_files_never_crash(void **state) {
    (void)state;
    uint64_t seed = 20261122;
    print_message("seed %llu\n", (unsigned long long)seed);
    static const char *const suffixes[] = {".obj", ".ply", ".off", ".stl"};
    static const char obj[] =
        "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 0\nvn 0 0 1\no a\ng b\nusemtl c\nf 1/1/1 2 -1//1\n# spawn 1 2 3\n";
    static const char off[] = "COFF 3 1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n1 1 0 1 1 1 1\n3 0 1 2\n";
    static const char stl[] = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 "
                              "1 0\nendloop\nendfacet\nendsolid\n";
    for (int round = 0; round < 2000; round++) {
        unsigned char bytes[1000];
        int format = round & 3;
        size_t size = 0;
        if (round % 5 == 0) {
            size = next_random(&seed) % sizeof bytes;
            for (size_t i = 0; i < size; i++) bytes[i] = (unsigned char)next_random(&seed);
        } else if (format == 1) {
            size = make_binary_ply(bytes, round & 4);
        } else if (format == 3 && round & 4) {
            size = make_binary_stl(bytes, 2);
        } else {
            const char *text = format == 0 ? obj : format == 2 ? off : stl;
            size = strlen(text);
            memcpy(bytes, text, size);
        }
        for (uint64_t hits = next_random(&seed) % 6; hits > 0 && size > 0; hits--)
            bytes[next_random(&seed) % size] = (unsigned char)next_random(&seed);
        attempt made = fixture_read_bytes(suffixes[format], bytes, size);
        if (made.status != ENF_OK) assert_true(made.status == ENF_BAD_INPUT && made.error.text[0]);
        for (size_t c = 0; c < made.soup.corner_count && made.status == ENF_OK; c++)
            assert_true(made.soup.corner_point[c] < (int64_t)made.soup.point_count);
        enf_soup_free(&made.soup);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ply_text_is_read_in_double_precision_with_polygons),
        cmocka_unit_test(ply_binary_is_read_in_both_byte_orders),
        cmocka_unit_test(ply_headers_that_lie_are_bad_input),
        cmocka_unit_test(off_is_read_with_prefixes_and_comments),
        cmocka_unit_test(off_files_that_lie_are_bad_input),
        cmocka_unit_test(stl_text_is_read_in_double_precision),
        cmocka_unit_test(stl_binary_is_read_and_cut_ones_are_noticed),
        cmocka_unit_test(garbage_and_damaged_files_never_crash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
