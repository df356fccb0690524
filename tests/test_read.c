// SPDX-License-Identifier: GPL-3.0-or-later
// Reading: what the formats say arrives in the soup; what is wrong with a file is told, and never a crash.
#include "build/soup.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <zlib.h>

#include <cmocka.h>

/// A soup read from bytes that were written to a temporary file.
typedef struct attempt {
    enf_soup soup;
    enf_error error;
    enf_status status;
} attempt;

static void make_path(char *path, size_t size, const char *suffix) {
    const char *folder = getenv("TMPDIR");
    snprintf(path, size, "%s/enfilade-test-%ld%s", folder ? folder : P_tmpdir, (long)getpid(), suffix);
}

static void write_file(const char *path, const void *bytes, size_t size) {
    FILE *file = fopen(path, "wb");
    assert_non_null(file);
    assert_int_equal(fwrite(bytes, 1, size, file), size);
    assert_int_equal(fclose(file), 0);
}

static attempt read_bytes(const char *suffix, const void *bytes, size_t size) {
    char path[512];
    make_path(path, sizeof path, suffix);
    write_file(path, bytes, size);
    attempt made = {0};
    made.status = enf_soup_read(&made.soup, path, &made.error);
    remove(path);
    return made;
}

static attempt read_text(const char *suffix, const char *text) {
    return read_bytes(suffix, text, strlen(text));
}

/// Reads text that must be turned down with `status` and words that contain `words`.
static void expect_failure(const char *suffix, const char *text, enf_status status, const char *words) {
    attempt made = read_text(suffix, text);
    assert_int_equal(made.status, status);
    assert_int_equal(made.error.status, status);
    if (!strstr(made.error.text, words)) fail_msg("\"%s\" does not say \"%s\"", made.error.text, words);
    enf_soup_free(&made.soup);
}

static size_t count_rejected(const enf_soup *soup, enf_reject reason) {
    size_t count = 0;
    for (size_t i = 0; i < soup->rejected_count; i++) count += soup->rejected[i].reason == reason;
    return count;
}

static const double *corner_at(const enf_soup *soup, size_t polygon, int corner) {
    return &soup->points[3 * (size_t)soup->corner_point[soup->polygon_corner[polygon] + corner]];
}

// ---- OBJ

static void obj_polygons_arrive_with_everything_they_carry(void **state) {
    (void)state;
    attempt made = read_text(".obj", "# spawn 1 2 3 info_player_start\n"
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
        attempt made = read_text(".obj", text);
        assert_int_equal(made.status, ENF_OK);
        if (made.soup.points[0] != strtod(numbers[i], NULL)) fail_msg("%s was misread", numbers[i]);
        enf_soup_free(&made.soup);
    }
}

static void obj_lines_may_be_joined_and_end_in_any_way(void **state) {
    (void)state;
    attempt made = read_text(
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
    attempt made = read_text(".obj", "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 1 1 0\n");
    assert_int_equal(made.status, ENF_OK);
    assert_true(corner_at(&made.soup, 0, 2)[1] == 1);
    enf_soup_free(&made.soup);
}

static void obj_indices_out_of_range_become_missing_corners(void **state) {
    (void)state;
    attempt made = read_text(".obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 2 4\nf 0 1 2\nf -4 1 2\n"
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
    attempt made = read_text(
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
    make_path(path, sizeof path, ".obj");
    static const char text[] = "v 5 0 0\nv 6 0 0\nv 6 1 0\nf 1 2 3\nf -3 -2 -1\nf 1 2 4\nf -4 -2 -1\n";
    write_file(path, text, sizeof text - 1);
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
    for (int i = 0; i < 4; i++) expect_failure(suffixes[i], "", ENF_BAD_INPUT, "no polygons");
    expect_failure(".obj", "# only words\nv 1 2 3\n", ENF_BAD_INPUT, "no polygons");
    expect_failure(".obj", "v 1 2 3\nf a b c\n", ENF_BAD_INPUT, ".obj:2:");
    expect_failure(".off", "OFF\n0 0 0\n", ENF_BAD_INPUT, "no polygons");
    expect_failure(".stl", "solid empty\nendsolid empty\n", ENF_BAD_INPUT, "no polygons");
    expect_failure(".ply", "ply\nformat ascii 1.0\nend_header\n", ENF_BAD_INPUT, "no polygons");
    expect_failure(".xyz", "v 1 2 3\n", ENF_BAD_INPUT, "unknown kind of file");
}

static void files_that_cannot_be_opened_are_no_resources(void **state) {
    (void)state;
    enf_soup soup = {0};
    enf_error error;
    assert_int_equal(enf_soup_read(&soup, "/nowhere/at/all.obj", &error), ENF_NO_RESOURCES);
    assert_non_null(strstr(error.text, "/nowhere/at/all.obj"));
    char path[512];
    make_path(path, sizeof path, ".obj");
    write_file(path, "", 0);
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
    attempt made = read_bytes(".obj", text, size);
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
    attempt plain = read_text(".obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    static const char *const suffixes[] = {".obj.gz", ".obj", ".OBJ.GZ"};
    for (int i = 0; i < 3; i++) {
        attempt made = read_bytes(suffixes[i], packed, size);
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
        attempt made = read_bytes(".obj.gz", packed, cut);
        assert_int_equal(made.status, ENF_BAD_INPUT);
        assert_non_null(strstr(made.error.text, "gzip"));
        enf_soup_free(&made.soup);
    }
    packed[size - 6] ^= 1; // the checksum
    attempt made = read_bytes(".obj.gz", packed, size);
    assert_int_equal(made.status, ENF_BAD_INPUT);
    enf_soup_free(&made.soup);
}

// ---- PLY

#define PLY_HEADER(FORMAT, COUNT)                                                                      \
    "ply\nformat " FORMAT " 1.0\ncomment made by hand\nelement vertex 4\nproperty double x\nproperty " \
    "double y\nproperty double z\nproperty uchar red\nelement face " COUNT                             \
    "\nproperty list uchar int vertex_indices\nelement extra 1\nproperty short what\nend_header\n"

static void check_square(const attempt *made) {
    if (made->status != ENF_OK) fail_msg("%s", made->error.text);
    assert_int_equal(made->soup.polygon_count, 2);
    assert_int_equal(made->soup.polygon_corner[1], 4);
    assert_true(corner_at(&made->soup, 0, 0)[0] == 0.1); // not 0.1f
    assert_true(corner_at(&made->soup, 0, 2)[1] == 1);
    assert_int_equal(made->soup.corner_point[made->soup.polygon_corner[1] + 2], -1);
    assert_int_equal(made->soup.rejected_count, 0);
}

static void ply_text_is_read_in_double_precision_with_polygons(void **state) {
    (void)state;
    attempt made = read_text(
        ".ply",
        PLY_HEADER("ascii", "2") "0.1 0 0 255\n1 0 0 255\n1 1 0 255\n0 1 0 255\n4 0 1 2 3\n3 0 1 4\n7\n");
    check_square(&made);
    assert_int_equal(made.soup.polygon_line[0], 18);
    enf_soup_free(&made.soup);
    made = read_text(
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
        attempt made = read_bytes(".ply", bytes, size);
        check_square(&made);
        enf_soup_free(&made.soup);
        for (size_t cut = 1; cut < size; cut++) { // every truncation is noticed
            made = read_bytes(".ply", bytes, cut);
            assert_int_equal(made.status, ENF_BAD_INPUT);
            enf_soup_free(&made.soup);
        }
    }
}

static void ply_headers_that_lie_are_bad_input(void **state) {
    (void)state;
    expect_failure(".ply", "plyx\n", ENF_BAD_INPUT, ".ply:1:");
    expect_failure(".ply",
                   "ply\nformat ascii 1.0\nelement vertex 9999999999999\nproperty float x\nend_header\n1\n",
                   ENF_BAD_INPUT, "announces");
    expect_failure(".ply", "ply\nformat ascii 1.0\nelement face 99999999999999999999999\nend_header\n",
                   ENF_BAD_INPUT, "without properties");
    expect_failure(".ply",
                   "ply\nformat binary_little_endian 1.0\nelement face 1\nproperty list uint double "
                   "vertex_index\nend_header\n\xff\xff\xff\xff",
                   ENF_BAD_INPUT, "truncated");
    expect_failure(".ply", "ply\nformat weird 1.0\nend_header\n", ENF_BAD_INPUT, ".ply:2:");
    expect_failure(".ply", "ply\nformat ascii 1.0\nelement vertex -1\nend_header\n", ENF_BAD_INPUT,
                   ".ply:3:");
    expect_failure(".ply", "ply\nformat ascii 1.0\nproperty float x\nend_header\n", ENF_BAD_INPUT, ".ply:3:");
    expect_failure(".ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty list float int x\nend_header\n",
                   ENF_BAD_INPUT, ".ply:4:");
    expect_failure(".ply", "ply\nelement vertex 1\n", ENF_BAD_INPUT, "does not end");
}

// ---- OFF

static void off_is_read_with_prefixes_and_comments(void **state) {
    (void)state;
    attempt made = read_text(
        ".off",
        "# a square\nOFF 4 2 0\n0.1 0 0\n1 0 0 # right\n\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n3 0 1 4\n");
    check_square(&made);
    assert_int_equal(made.soup.polygon_line[0], 8);
    enf_soup_free(&made.soup);
    made = read_text(".off", "COFF\n3 1 3\n0 0 0 1 0 0 1\n1 0 0 1 0 0 1\n1 1 0 1 0 0 1\n3 0 1 2\n");
    assert_int_equal(made.status, ENF_OK);
    assert_true(corner_at(&made.soup, 0, 2)[1] == 1);
    enf_soup_free(&made.soup);
    made = read_text(".off",
                     "STNOFF\n3 2 3\n0 0 0 0 0 1 .5 .25\n1 0 0 0 0 1 0 0\n1 1 0 0 0 1\n3 0 1 2\n3 0 1\n");
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
    expect_failure(".off", "hello\n", ENF_BAD_INPUT, ".off:1:");
    expect_failure(".off", "OFF\n2000000000 2000000000 0\n1 2 3\n", ENF_BAD_INPUT, "announces");
    expect_failure(".off", "OFF\n-3 1 0\n", ENF_BAD_INPUT, ".off:2:");
    expect_failure(".off", "OFF\n3 1 0\n0 0 0\n1 0 0\n", ENF_BAD_INPUT, "truncated");
    expect_failure(".off", "OFF BINARY\n", ENF_BAD_INPUT, "binary");
    expect_failure(".off", "4OFF\n1 1 1\n", ENF_BAD_INPUT, "4OFF");
}

// ---- STL

static void stl_text_is_read_in_double_precision(void **state) {
    (void)state;
    attempt made = read_text(
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
    assert_true(isnan(corner_at(soup, 2, 1)[0]));
    enf_soup_free(&made.soup);
    expect_failure(".stl", "solid cut\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", ENF_BAD_INPUT,
                   "truncated");
    expect_failure(".stl", "hello\n", ENF_BAD_INPUT, ".stl:1:");
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
    attempt made = read_bytes(".stl", bytes, size);
    assert_int_equal(made.status, ENF_OK);
    assert_int_equal(made.soup.polygon_count, 2);
    assert_int_equal(made.soup.polygon_line[1], 2);
    assert_true(corner_at(&made.soup, 0, 0)[0] == 0.5 && isnan(corner_at(&made.soup, 1, 2)[2]));
    enf_soup_free(&made.soup);
    for (size_t cut = 1; cut < size; cut++) {
        made = read_bytes(".stl", bytes, cut);
        assert_int_equal(made.status, ENF_BAD_INPUT);
        enf_soup_free(&made.soup);
    }
    size = make_binary_stl(bytes, UINT32_MAX);
    made = read_bytes(".stl", bytes, size);
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
        attempt made = read_bytes(suffixes[format], bytes, size);
        if (made.status != ENF_OK) assert_true(made.status == ENF_BAD_INPUT && made.error.text[0]);
        for (size_t c = 0; c < made.soup.corner_count && made.status == ENF_OK; c++)
            assert_true(made.soup.corner_point[c] < (int64_t)made.soup.point_count);
        enf_soup_free(&made.soup);
    }
}

static void obj_with_zero_bytes_is_bad_input(void **state) {
    (void)state;
    attempt made = read_bytes(".obj", "v 0 0 0\nv 1\0 0 0\n", 18);
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
