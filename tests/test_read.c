// SPDX-License-Identifier: GPL-3.0-or-later
// Reading OBJ, gzip, and what is no readable file: what the file says arrives in the soup, what is wrong is
// told.
#include "base/hash.h"
#include "build/soup.h"
#include "tests/read_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include <cmocka.h>

static size_t count_rejected(const enf_soup *soup, enf_reject reason) {
    size_t count = 0;
    for (size_t i = 0; i < soup->rejected_count; i++) count += soup->rejected[i].reason == reason;
    return count;
}

// ---- OBJ

static void obj_polygons_arrive_with_everything_they_carry(void **state) {
    (void)state;
    attempt made = fixture_read_text(".obj", "# spawn 1 2 3 info_player_start\n"
                                             "mtllib x.mtl\n"
                                             "v 0 0 0\nv 1 0 0 1.0\nv 1 1 0 0.5 0.5 0.5\nv 0 1 0.25\n"
                                             "vt 0 0\nvt 1 0 0\nvt 1\nvn 0 0 1\n"
                                             "f 1 2 3\n"
                                             "o hall\ng walls left\nusemtl stone wall\ns off\n"
                                             "f 1/1/1 2/2/1 3/3/1 4//1\n"
                                             "f -4/-3 -3 -2//-1\n");
    const enf_soup *soup = &made.soup;
    assert_int_equal(made.status, ENF_OK);
    assert_int_equal(soup->point_count, 4);
    assert_int_equal(soup->polygon_count, 3);
    assert_int_equal(soup->polygon_corner[2] - soup->polygon_corner[1], 4);
    assert_string_equal(soup->groups[soup->polygon_group[0]], "");
    assert_int_equal(soup->polygon_material[0], -1);
    assert_string_equal(soup->groups[soup->polygon_group[1]], "hall/walls left");
    assert_string_equal(soup->materials[soup->polygon_material[1]], "stone wall");
    assert_int_equal(soup->polygon_line[1], 16);
    assert_int_equal(soup->corner_normal[soup->polygon_corner[1] + 3], 0);
    assert_int_equal(soup->corner_texcoord[soup->polygon_corner[1] + 3], -1);
    assert_int_equal(soup->corner_texcoord[soup->polygon_corner[1] + 2], 2);
    assert_int_equal(soup->corner_point[soup->polygon_corner[2]], 0);
    assert_int_equal(soup->corner_texcoord[soup->polygon_corner[2]], 0);
    assert_int_equal(soup->corner_normal[soup->polygon_corner[2] + 2], 0);
    assert_true(soup->points[11] == 0.25);
    assert_true(soup->texcoords[4] == 1 && soup->texcoords[5] == 0);
    assert_int_equal(soup->spawn_count, 1);
    assert_true(soup->spawns[2] == 3);
    assert_int_equal(soup->rejected_count, 0);
    enf_soup_free(&made.soup);
}

static void obj_numbers_are_rounded_correctly(void **state) {
    (void)state;
    static const char *const numbers[] = {"0.1",
                                          "-1234.5678e-3",
                                          "9007199254740993",
                                          "1e22",
                                          "1e23",
                                          "0x1.8p1",
                                          "5e-324",
                                          "1.7976931348623157e308",
                                          ".5",
                                          "3.",
                                          "0.30000000000000004",
                                          "1e-23",
                                          "7e-30",
                                          "3e23",
                                          "179769313486231580793e289",
                                          "+7",
                                          "123456789012345678901234567890"};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
        char text[200];
        snprintf(text, sizeof text, "v %s 0 0\nf 1 1 1\n", numbers[i]);
        attempt made = fixture_read_text(".obj", text);
        assert_int_equal(made.status, ENF_OK);
        if (made.soup.points[0] != strtod(numbers[i], NULL)) fail_msg("%s was misread", numbers[i]);
        enf_soup_free(&made.soup);
    }
}

static void obj_lines_may_be_joined_and_end_in_any_way(void **state) {
    (void)state;
    attempt made = fixture_read_text(
        ".obj", "\xef\xbb\xbfv 0 0 0\r\nv 1 0 \\\r\n 0\r\nv 1 1 0\rf 1 2 \\\n\\\n3 # a comment\nf 1 \\\n2 3");
    assert_int_equal(made.status, ENF_OK);
    assert_int_equal(made.soup.point_count, 3);
    assert_int_equal(made.soup.polygon_count, 2);
    assert_int_equal(made.soup.polygon_line[0], 5);
    assert_int_equal(made.soup.polygon_line[1], 8);
    assert_int_equal(made.soup.rejected_count, 0);
    enf_soup_free(&made.soup);
}

static void obj_faces_may_come_before_their_vertices(void **state) {
    (void)state;
    attempt made = fixture_read_text(".obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 1 1 0\n");
    assert_int_equal(made.status, ENF_OK);
    assert_true(fixture_corner(&made.soup, 0, 2)[1] == 1);
    enf_soup_free(&made.soup);
}

static void obj_indices_out_of_range_become_missing_corners(void **state) {
    (void)state;
    attempt made =
        fixture_read_text(".obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 2 4\nf 0 1 2\nf -4 1 2\n"
                                  "f 1 2 99999999999999999999\nf 1/7 2 3\n");
    const enf_soup *soup = &made.soup;
    assert_int_equal(made.status, ENF_OK);
    assert_int_equal(soup->polygon_count, 6);
    assert_int_equal(soup->corner_point[soup->polygon_corner[1] + 2], -1);
    assert_int_equal(soup->corner_point[soup->polygon_corner[2]], -1);
    assert_int_equal(soup->corner_point[soup->polygon_corner[3]], -1);
    assert_int_equal(soup->corner_point[soup->polygon_corner[4] + 2], -1);
    assert_int_equal(soup->corner_texcoord[soup->polygon_corner[5]], -1);
    assert_int_equal(soup->rejected_count, 1); // the texture coordinate that is not there
    assert_int_equal(soup->rejected[0].line, 9);
    enf_soup_free(&made.soup);
}

static void obj_lines_that_make_no_sense_are_listed_with_their_number(void **state) {
    (void)state;
    attempt made = fixture_read_text(
        ".obj",
        "v 0 0 0\nv 1 0\nv 1 1 0\nf 1 two 3\nwhat is this\nf\nf 1 2 3\nf 1/2/3x 2 3\n# spawn inf 0 0\n");
    const enf_soup *soup = &made.soup;
    assert_int_equal(made.status, ENF_OK);
    assert_int_equal(soup->point_count, 3); // the bad vertex keeps its number
    assert_true(isnan(soup->points[3]));
    assert_int_equal(soup->polygon_count, 1);
    static const int lines[] = {2, 4, 5, 6, 8, 9};
    assert_int_equal(soup->rejected_count, 6);
    assert_int_equal(count_rejected(soup, ENF_REJECT_SYNTAX), 6);
    for (int i = 0; i < 6; i++) assert_int_equal(soup->rejected[i].line, lines[i]);
    enf_soup_free(&made.soup);
}

static void a_second_file_has_its_own_numbering(void **state) {
    (void)state;
    char path[512];
    fixture_path(path, sizeof path, ".obj");
    static const char text[] = "v 5 0 0\nv 6 0 0\nv 6 1 0\nf 1 2 3\nf -3 -2 -1\nf 1 2 4\nf -4 -2 -1\n";
    fixture_write(path, text, sizeof text - 1);
    enf_soup soup = {0};
    assert_int_equal(enf_soup_read(&soup, path, NULL), ENF_OK);
    uint64_t once = soup.content_hash;
    assert_int_equal(enf_soup_read(&soup, path, NULL), ENF_OK);
    remove(path);
    assert_int_equal(soup.file_count, 2);
    assert_int_equal(soup.polygon_count, 8);
    assert_int_equal(soup.polygon_file[4], 1);
    assert_int_equal(soup.corner_point[soup.polygon_corner[4]], 3);
    assert_int_equal(soup.corner_point[soup.polygon_corner[5]], 3);
    assert_int_equal(soup.corner_point[soup.polygon_corner[6] + 2], -1);
    assert_int_equal(soup.corner_point[soup.polygon_corner[2] + 2], -1); // not the second file's first vertex
    assert_int_equal(soup.corner_point[soup.polygon_corner[7]], -1);
    assert_true(once != 0 && soup.content_hash != once);
    enf_soup_free(&soup);
}

static void files_without_polygons_are_bad_input(void **state) {
    (void)state;
    static const char *const suffixes[] = {".obj", ".ply", ".off", ".stl"};
    for (int i = 0; i < 4; i++) fixture_expect_failure(suffixes[i], "", ENF_BAD_INPUT, "no polygons");
    fixture_expect_failure(".obj", "# only words\nv 1 2 3\n", ENF_BAD_INPUT, "no polygons");
    fixture_expect_failure(".obj", "v 1 2 3\nf a b c\n", ENF_BAD_INPUT, ".obj:2:");
    fixture_expect_failure(".off", "OFF\n0 0 0\n", ENF_BAD_INPUT, "no polygons");
    fixture_expect_failure(".stl", "solid empty\nendsolid empty\n", ENF_BAD_INPUT, "no polygons");
    fixture_expect_failure(".ply", "ply\nformat ascii 1.0\nend_header\n", ENF_BAD_INPUT, "no polygons");
    fixture_expect_failure(".xyz", "v 1 2 3\n", ENF_BAD_INPUT, "unknown kind of file");
}

static void files_that_cannot_be_opened_are_no_resources(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_error error;
    assert_int_equal(enf_soup_read(&soup, "/nowhere/at/all.obj", &error), ENF_NO_RESOURCES);
    assert_non_null(strstr(error.text, "/nowhere/at/all.obj"));
    char path[512];
    fixture_path(path, sizeof path, ".obj");
    fixture_write(path, "", 0);
    if (geteuid() != 0) { // root may read anything
        char command[600];
        snprintf(command, sizeof command, "chmod 000 '%s'", path);
        assert_int_equal(system(command), 0);
        assert_int_equal(enf_soup_read(&soup, path, &error), ENF_NO_RESOURCES);
    }
    remove(path);
    char command[600];
    snprintf(command, sizeof command, "mkdir '%s'", path);
    assert_int_equal(system(command), 0);
    assert_int_equal(enf_soup_read(&soup, path, &error), ENF_NO_RESOURCES);
    assert_non_null(strstr(error.text, "directory"));
    rmdir(path);
    enf_soup_free(&soup);
}

static void a_line_of_a_million_corners_is_read(void **state) {
    (void)state;
    size_t corners = 1000000, size = 0;
    char *text = malloc(24 + corners * 2);
    assert_non_null(text);
    size += (size_t)sprintf(text, "v 0 0 0\nf");
    for (size_t i = 0; i < corners; i++) text[size++] = ' ', text[size++] = '1';
    attempt made = fixture_read_bytes(".obj", text, size);
    assert_int_equal(made.status, ENF_OK);
    assert_int_equal(made.soup.corner_count, corners);
    enf_soup_free(&made.soup);
    free(text);
}

// ---- gzip

static size_t gzip(const void *bytes, size_t size, unsigned char *out, size_t room) {
    z_stream stream = {0};
    assert_int_equal(deflateInit2(&stream, 9, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
    stream.next_in = (unsigned char *)(uintptr_t)bytes;
    stream.avail_in = (uInt)size;
    stream.next_out = out;
    stream.avail_out = (uInt)room;
    assert_int_equal(deflate(&stream, Z_FINISH), Z_STREAM_END);
    deflateEnd(&stream);
    return room - stream.avail_out;
}

static void gzip_is_transparent_and_told_by_its_first_bytes(void **state) {
    (void)state;
    static const char first[] = "v 0 0 0\nv 1 0 0\nv 0 1", second[] = " 0\nf 1 2 3\n";
    unsigned char packed[1000];
    size_t size = gzip(first, sizeof first - 1, packed, sizeof packed);
    size += gzip(second, sizeof second - 1, packed + size, sizeof packed - size); // members join
    attempt plain = fixture_read_text(".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    static const char *const suffixes[] = {".obj.gz", ".obj", ".OBJ.GZ"};
    for (int i = 0; i < 3; i++) {
        attempt made = fixture_read_bytes(suffixes[i], packed, size);
        assert_int_equal(made.status, ENF_OK);
        assert_int_equal(made.soup.polygon_count, 1);
        assert_true(made.soup.content_hash == plain.soup.content_hash);
        enf_soup_free(&made.soup);
    }
    enf_soup_free(&plain.soup);
}

static void gzip_cut_short_or_damaged_is_bad_input(void **state) {
    (void)state;
    static const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nv 4 5 6\nv 7 8 9\n";
    unsigned char packed[1000];
    size_t size = gzip(text, sizeof text - 1, packed, sizeof packed);
    for (size_t cut = 2; cut < size; cut++) {
        attempt made = fixture_read_bytes(".obj.gz", packed, cut);
        assert_int_equal(made.status, ENF_BAD_INPUT);
        assert_non_null(strstr(made.error.text, "gzip"));
        enf_soup_free(&made.soup);
    }
    packed[size - 6] ^= 1; // the checksum
    attempt made = fixture_read_bytes(".obj.gz", packed, size);
    assert_int_equal(made.status, ENF_BAD_INPUT);
    enf_soup_free(&made.soup);
}

// ---- the hash of the input

static void the_content_hash_is_fixed_and_sees_every_byte(void **state) {
    (void)state;
    unsigned char bytes[64] = {0};
    uint64_t seen[1 + 64 + 64];
    size_t count = 0;
    for (size_t size = 0; size <= 64; size++) seen[count++] = enf_hash64(bytes, size, 0);
    for (int i = 0; i < 64; i++) {
        bytes[i] = 1;
        seen[count++] = enf_hash64(bytes, 64, 0);
        bytes[i] = 0;
    }
    for (size_t i = 0; i < count; i++)
        for (size_t j = 0; j < i; j++) assert_true(seen[i] != seen[j]);
    assert_true(enf_hash64("enfilade", 8, 1) == UINT64_C(0xf3d8de3aca09b216));
    assert_true(enf_hash64("enfilade", 8, 1) != enf_hash64("enfilade", 8, 2));
}

static void obj_with_zero_bytes_is_bad_input(void **state) {
    (void)state;
    attempt made = fixture_read_bytes(".obj", "v 0 0 0\nv 1\0 0 0\n", 18);
    assert_int_equal(made.status, ENF_BAD_INPUT);
    assert_non_null(strstr(made.error.text, ".obj:2:"));
    enf_soup_free(&made.soup);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(obj_polygons_arrive_with_everything_they_carry),
        cmocka_unit_test(obj_numbers_are_rounded_correctly),
        cmocka_unit_test(obj_lines_may_be_joined_and_end_in_any_way),
        cmocka_unit_test(obj_faces_may_come_before_their_vertices),
        cmocka_unit_test(obj_indices_out_of_range_become_missing_corners),
        cmocka_unit_test(obj_lines_that_make_no_sense_are_listed_with_their_number),
        cmocka_unit_test(obj_with_zero_bytes_is_bad_input),
        cmocka_unit_test(a_second_file_has_its_own_numbering),
        cmocka_unit_test(files_without_polygons_are_bad_input),
        cmocka_unit_test(files_that_cannot_be_opened_are_no_resources),
        cmocka_unit_test(a_line_of_a_million_corners_is_read),
        cmocka_unit_test(gzip_is_transparent_and_told_by_its_first_bytes),
        cmocka_unit_test(gzip_cut_short_or_damaged_is_bad_input),
        cmocka_unit_test(the_content_hash_is_fixed_and_sees_every_byte),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
