// SPDX-License-Identifier: GPL-3.0-or-later
// The program as its users meet it: what it refuses, with which status and words, and that it leaves nothing
// behind when it does.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <zlib.h>

#include "process.h"

#define BOX_POINTS "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\n"
/// A tetrahedron whose fronts face its inside.
#define BOX BOX_POINTS "f 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n"
#define PLY_HEAD \
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
#define PLY_FACE "element face 1\nproperty list uchar int vertex_indices\nend_header\n"

/// An input that can't be compiled.
typedef struct bad_input {
    const char *file, *content;
    size_t size; ///< 0: the content is text
    int status;
    const char *words; ///< the message holds them, besides the file's name
} bad_input;

static const bad_input bad_inputs[] = {
    {"empty.obj", "", 0, 3, "empty.obj: no polygons"},
    {"comments.obj", "# nothing\n\n", 0, 3, "comments.obj: no polygons"},
    {"vertices.obj", BOX_POINTS, 0, 3, "vertices.obj: no polygons"},
    {"no-vertices.obj", "f 1 2 3\n", 0, 3, "no-vertices.obj:1: "},
    {"flat.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n", 0, 3, "one plane"},
    {"tilted.obj", "v 0 0 0\nv 1 0 1\nv 1 1 2\nv 0 1 1\nv 2 2 4\nf 1 2 3\nf 1 3 4\nf 2 5 3\n", 0, 3,
     "one plane"},
    {"one-triangle.obj", "v 0 0 0\nv 1 0 0\nv 1 1 3\nf 1 2 3\n", 0, 3, "one plane"},
    {"index-high.obj", BOX_POINTS "f 1 2 9\n", 0, 3, "index-high.obj:5: "},
    {"index-zero.obj", BOX_POINTS "f 0 1 2\n", 0, 3, "index-zero.obj:5: "},
    {"index-negative.obj", BOX_POINTS "f -1 -2 -9\n", 0, 3, "index-negative.obj:5: "},
    {"index-overflow.obj", BOX_POINTS "f 1 2 99999999999999999999\n", 0, 3, "index-overflow.obj:5: "},
    {"index-words.obj", BOX_POINTS "f a b c\n", 0, 3, "index-words.obj:5: "},
    {"huge.obj", "v 1e308 0 0\nv 0 1e308 0\nv 0 0 1e308\nv -1e308 0 0\nf 1 2 3\nf 1 2 4\n", 0, 3,
     "huge.obj:5: "},
    {"beyond.obj", "v 1e999 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", 0, 3, "beyond.obj:4: "},
    {"beyond-volume.obj", "v 1e101 0 0\nv 0 1e101 0\nv 0 0 1e101\nf 1 2 3\n", 0, 3, "beyond-volume.obj:4: "},
    {"nan.obj", "v nan 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", 0, 3, "nan.obj:4: "},
    {"inf.obj", "v 0 -inf 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\n", 0, 3, "inf.obj:4: "},
    {"words.obj", "v a b c\nv 1 2 3\nf 1 2 1\n", 0, 3, "words.obj:3: "},
    {"short-vertices.obj", "v 1 2\nv 1 2\nf 1 2 1\n", 0, 3, "short-vertices.obj:3: "},
    {"two-corners.obj", BOX_POINTS "f 1 2\n", 0, 3, "two-corners.obj:5: "},
    {"no-area.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n", 0, 3, "no-area.obj:4: "},
    {"one-point.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", 0, 3, "one-point.obj:4: "},
    {"binary.obj",
     "\x7f"
     "ELF\0\1\2\3\0\0\0\0\xff\xfe\xfd",
     15, 3, "binary.obj:1: "},
    {"garbage.obj", "\x89\xfe\xfd\xfc \x80\x81\x82\n\xff\xff\n", 0, 3, "garbage.obj:1: "},
    {"magic.ply", "plx\n", 0, 3, "magic.ply:1: "},
    {"format.ply", "ply\nformat weird 1.0\nend_header\n", 0, 3, "format.ply:2: "},
    {"negative.ply", "ply\nformat ascii 1.0\nelement vertex -3\nend_header\n", 0, 3, "negative.ply:3: "},
    {"endless.ply", PLY_HEAD, 0, 3, "endless.ply:7: "},
    {"truncated.ply", PLY_HEAD PLY_FACE "0 0 0\n1 0 0\n", 0, 3, "truncated.ply:12: "},
    {"faceless.ply", PLY_HEAD "end_header\n0 0 0\n1 0 0\n0 1 0\n", 0, 3, "faceless.ply: no polygons"},
    {"index.ply", PLY_HEAD PLY_FACE "0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n", 0, 3, "index.ply:13: "},
    {"bomb.ply",
     "ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\n"
     "property float z\nend_header\n",
     0, 3, "bomb.ply:"},
    {"magic.off", "OFX\n", 0, 3, "magic.off:1: "},
    {"truncated.off", "OFF\n4 4 6\n0 0 0\n1 0 0\n", 0, 3, "truncated.off:5: "},
    {"index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 1\n3 0 1 7\n", 0, 3, "index.off:6: "},
    {"negative.off", "OFF\n-1 4 0\n", 0, 3, "negative.off:2: "},
    {"bomb.off", "OFF\n99999999999 4 0\n", 0, 3, "bomb.off:2: "},
    {"empty.off", "OFF\n0 0 0\n", 0, 3, "empty.off: no polygons"},
    {"truncated.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", 0, 3, "truncated.stl:5: "},
    {"garbage.stl", "solid x\nhello world\n", 0, 3, "garbage.stl:2: "},
    {"short.stl", "xyz", 0, 3, "short.stl:1: "},
    {"scene.doc", BOX, 0, 3, "scene.doc: unknown kind of file"},
    {"damaged.obj.gz", "\x1f\x8b\x08\0\0\0\0\0\0\3\xff\xff\xff\xff\xff\xff\xff\xff", 18, 3,
     "damaged.obj.gz: "},
};

enum { BAD_INPUT_COUNT = sizeof bad_inputs / sizeof *bad_inputs };

static int enter(void **state) {
    (void)state;
    return enter_test_folder() ? 0 : -1;
}

static int leave(void **state) {
    (void)state;
    leave_test_folder();
    return 0;
}

/// Runs a line that must fail: status, a message with these words, no out.enf.
static void expect_failure(const char *line, int status, const char *words) {
    unlink("out.enf");
    process ran = run_enfilade(NULL, line);
    if (ran.status != status || !strstr(ran.err, words))
        print_error("`%s`: status %d, expected %d with '%s'; it said: %s\n", line, ran.status, status, words,
                    ran.err);
    assert_int_equal(ran.status, status);
    assert_non_null(strstr(ran.err, words));
    assert_false(file_exists("out.enf"));
    process_free(&ran);
}

static void expect_success(const char *line) {
    process ran = run_enfilade(NULL, line);
    if (ran.status != 0) print_error("`%s`: status %d; it said: %s\n", line, ran.status, ran.err);
    assert_int_equal(ran.status, 0);
    process_free(&ran);
}

static void every_bad_input_is_refused_with_file_line_and_reason(void **state) {
    (void)state;
    for (int i = 0; i < BAD_INPUT_COUNT; i++) {
        const bad_input *bad = &bad_inputs[i];
        char line[256];
        write_file(bad->file, bad->content, bad->size ? bad->size : strlen(bad->content));
        snprintf(line, sizeof line, "compile %s -o out.enf", bad->file);
        expect_failure(line, bad->status, bad->words);
        unlink(bad->file);
    }
}

static void a_gzip_file_that_ends_early_is_refused(void **state) {
    (void)state;
    gzFile packed = gzopen("whole.obj.gz", "wb");
    assert_non_null(packed);
    for (int i = 0; i < 1000; i++) gzprintf(packed, "v %d %d %d\n", i, i * i % 97, i * 7 % 31);
    gzprintf(packed, BOX);
    gzclose(packed);
    size_t size;
    char *bytes = read_file("whole.obj.gz", &size);
    for (size_t cut = 2; cut < size; cut += size / 7) {
        write_file("cut.obj.gz", bytes, cut);
        expect_failure("compile cut.obj.gz -o out.enf", 3, "cut.obj.gz: ");
    }
    free(bytes);
}

static void a_polygon_of_ten_million_corners_is_left_out(void **state) {
    (void)state;
    FILE *file = fopen("wide.obj", "wb");
    assert_non_null(file);
    fputs(BOX_POINTS "f", file);
    static char many[40000];
    for (int i = 0; i < 10000; i++) memcpy(many + 4 * i, i % 3 ? " 2 3" : " 1 4", 4);
    for (int i = 0; i < 500; i++) fwrite(many, 1, sizeof many, file);
    fputs("\n", file);
    assert_int_equal(fclose(file), 0);
    expect_failure("compile wide.obj -o out.enf", 3, "wide.obj:5: ");
    unlink("wide.obj");
}

static void a_world_that_will_not_fit_is_refused(void **state) {
    (void)state;
    write_file("box.obj", BOX, strlen(BOX));
    expect_failure("compile box.obj -o out.enf --memory 1M", 4, "--memory allows 1 MiB");
    expect_success("compile box.obj -o out.enf -q --memory 4G");
    unlink("out.enf");
}

static void paths_that_cannot_be_read_are_told(void **state) {
    (void)state;
    assert_int_equal(mkdir("folder.obj", 0700), 0);
    expect_failure("compile folder.obj -o out.enf", 4, "folder.obj: is a directory");
    expect_failure("compile missing.obj -o out.enf", 4, "missing.obj: cannot be opened");
    expect_failure("info missing.enf", 4, "missing.enf");
    expect_failure("check missing.enf", 4, "missing.enf");
    expect_failure("locate missing.enf", 4, "missing.enf");
    expect_failure("export missing.enf -o out.svg", 4, "missing.enf");
    write_text("closed.obj", BOX);
    assert_int_equal(chmod("closed.obj", 0), 0);
    if (geteuid() == 0)
        print_message("running as root, who can read everything: one case skipped\n");
    else
        expect_failure("compile closed.obj -o out.enf", 4, "closed.obj: cannot be opened");
    process ran = run_enfilade("", "compile - -o out.enf");
    assert_int_equal(ran.status, 3);
    assert_non_null(strstr(ran.err, "standard input: no polygons"));
    process_free(&ran);
}

static void outputs_that_cannot_be_written_are_told_and_leave_nothing(void **state) {
    (void)state;
    write_text("box.obj", BOX);
    expect_success("compile box.obj -o good.enf");
    expect_failure("compile box.obj -o nowhere/out.enf", 4, "nowhere/out.enf: can't be written");
    expect_failure("compile box.obj -o out.enf --report nowhere/out.json", 4,
                   "nowhere/out.json: can't be written");
    expect_failure("compile box.obj -o out.enf --leak nowhere/out.pts", 4,
                   "nowhere/out.pts: can't be written");
    expect_failure("compile box.obj -o /dev/full", 4, "/dev/full: can't be written: No space left");
    expect_failure("compile box.obj -o .", 4, "can't be written: Is a directory");
    expect_failure("gen four-rooms -o /dev/full", 4, "No space left");
    expect_failure("gen four-rooms -o nowhere/out.obj", 4, "nowhere/out.obj: can't be written");
    expect_failure("export good.enf -o nowhere/out.svg", 4, "nowhere/out.svg: can't be written");
    expect_failure("export good.enf -o /dev/full --format json", 4, "No space left");
}

static void bad_options_are_refused_with_the_usage_line(void **state) {
    (void)state;
    static const char *const lines[][2] = {
        {"", "usage: enfilade COMMAND"},
        {"frobnicate", "there is no command 'frobnicate'"},
        {"render x.enf", "not built yet"},
        {"compile", "an input file is missing\nusage: enfilade compile"},
        {"compile box.obj", "-o WORLD.enf is missing\nusage: enfilade compile"},
        {"compile box.obj -o", "--output needs a value"},
        {"compile box.obj -o --report", "--output needs a value"},
        {"compile box.obj -o out.enf --frobnicate", "unknown option '--frobnicate'\nusage: enfilade compile"},
        {"compile box.obj -o out.enf -x", "unknown option '-x'"},
        {"compile box.obj -o out.enf -o b.enf", "given twice"},
        {"compile box.obj -o out.enf --verbose=1", "takes no value"},
        {"compile box.obj -o out.enf -v -q", "contradict"},
        {"compile box.obj -o out.enf --tetrahedralizer qhull", "choose one of own, cgal, tetgen"},
        {"compile box.obj -o out.enf --heuristic best", "choose one of aspect"},
        {"compile box.obj -o out.enf --stop never", "unknown stop rule 'never'"},
        {"compile box.obj -o out.enf --stop cells=0", "cells"},
        {"compile box.obj -o out.enf --stop cells=1.5", "cells"},
        {"compile box.obj -o out.enf --stop weight=-1", "weight"},
        {"compile box.obj -o out.enf --stop weight=nan", "weight"},
        {"compile box.obj -o out.enf --keep some", "choose one of auto, all, outside, spawn"},
        {"compile box.obj -o out.enf --spawn 1,2", "is no point"},
        {"compile box.obj -o out.enf --spawn 1,2,3,4", "is no point"},
        {"compile box.obj -o out.enf --spawn 1,2,nan", "is no point"},
        {"compile box.obj -o out.enf --spawn 1,2,1e999", "is no point"},
        {"compile box.obj -o out.enf --pvs perfect", "--pvs"},
        {"compile box.obj -o out.enf --pvs all", "choose one of auto, none"},
        {"compile box.obj -o out.enf --weld -1", "is no number"},
        {"compile box.obj -o out.enf --weld 1m", "is no number"},
        {"compile box.obj -o out.enf --weld 0x1", "is no number"},
        {"compile box.obj -o out.enf --weld inf", "is no number"},
        {"compile box.obj -o out.enf --plane-tolerance x", "is no number"},
        {"compile box.obj -o out.enf --threads 0", "whole number from 1"},
        {"compile box.obj -o out.enf --threads 2.5", "whole number from 1"},
        {"compile box.obj -o out.enf --threads 99999999999999999999", "whole number from 1"},
        {"compile box.obj -o out.enf --memory 0", "is no size"},
        {"compile box.obj -o out.enf --memory 16GB", "is no size"},
        {"compile box.obj -o out.enf --memory 1.5G", "is no size"},
        {"compile box.obj -o out.enf --memory", "--memory needs a value"},
        {"compile box.obj -o out.enf --progress sometimes", "choose one of auto, always, never"},
        {"compile box.obj -o box.obj", "would be written over"},
        {"compile box.obj -o ./box.obj", "would be written over"},
        {"compile box.obj -o out.enf --report out.enf", "would be written over"},
        {"info", "the world file is missing\nusage: enfilade info"},
        {"info a.enf b.enf", "one word too many"},
        {"info a.enf --xml", "unknown option '--xml'"},
        {"check", "the world file is missing"},
        {"locate", "the world file is missing"},
        {"sight", "the world file is missing"},
        {"bench run sight", "a world file is missing"},
        {"export good.enf", "-o OUT is missing"},
        {"export good.enf -o out.png", "does not tell the form"},
        {"export good.enf -o out", "does not tell the form"},
        {"export good.enf -o out.glb", "not built yet"},
        {"export good.enf -o out.prt", "not built yet"},
        {"export good.enf -o out.svg --up w", "choose one of x, y, z"},
        {"gen", "the name of a world is missing"},
        {"gen four-rooms", "-o OUT.obj is missing"},
        {"gen castle -o out.obj", "there is no world 'castle'"},
        {"gen four-rooms walls=3 -o out.obj", "'walls=3' is not a setting"},
        {"gen four-rooms scale=0 -o out.obj", "'scale=0'"},
        {"gen four-rooms noise=1 noise=2 -o out.obj", "given twice"},
        {"bench", "the name of a table is missing"},
        {"bench marks", "there is no table 'marks'"},
        {"bench cells", "the folder is missing"},
        {"bench cells . --runs 0", "--runs: '0'"},
        {"bench stability --family nobles", "there is no 'nobles'"},
        {"bench stability --first -1", "'-1' is no whole number"},
        {"bench growth --worlds jungle", "no world is left"},
        {"bench growth --largest 9999", "no world is left"},
        {"bench growth --runs 0", "--runs: '0'"},
        {"bench soups --soup gazpacho", "there is no soup 'gazpacho'"},
    };
    write_text("box.obj", BOX);
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) expect_failure(lines[i][0], 2, lines[i][1]);
    assert_false(file_exists("out.obj"));
    size_t size;
    char *box = read_file("box.obj", &size);
    assert_string_equal(box, BOX);
    free(box);
}

static void help_and_version_are_data(void **state) {
    (void)state;
    static const char *const lines[][2] = {
        {"--help", "usage: enfilade COMMAND"},
        {"--version", "enfilade 0."},
        {"compile --help", "--tetrahedralizer"},
        {"info --help", "--json"},
        {"check --help", "usage: enfilade check"},
        {"locate --help", "--kind"},
        {"sight --help", "x y z  x y z"},
        {"bench run --help", "locate"},
        {"export --help", "--up"},
        {"gen --help", "rotate="},
        {"gen list", "four-rooms-distorted"},
        {"bench --help", "thesis"},
        {"bench stability --help", "--seeds"},
        {"bench growth --help", "--largest"},
        {"bench soups --help", "--limit"},
        {"bench stability --seeds 2 --family rotations", "\nrotations,2,0,0,0,0,0,"},
        {"bench soups --soup cubes-1000-1e-12 --memory 0", "check holds"},
    };
    for (size_t i = 0; i < sizeof lines / sizeof *lines; i++) {
        process ran = run_enfilade(NULL, lines[i][0]);
        assert_int_equal(ran.status, 0);
        assert_non_null(strstr(ran.out, lines[i][1]));
        assert_string_equal(ran.err, "");
        process_free(&ran);
    }
}

/// Both tables end with a row about all levels; a level is named by a glob. What is rejected is so each time.
static void benches_over_a_folder_print_a_row_per_level(void **state) {
    (void)state;
    write_text("rock.obj",
               BOX_POINTS "f 1 2 2\n# spawn 3 3 3\n# brush 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    process ran = run_enfilade(NULL, "bench cells . --levels r?ck --runs 2");
    assert_int_equal(ran.status, 0);
    assert_non_null(strstr(ran.out, "level,triangles,tetrahedra,fine_cells,"));
    assert_non_null(strstr(ran.out, "\nrock.obj,5,1,1,1.000,"));
    assert_non_null(strstr(ran.out, "\nmedian (peak: largest),5,1,1,1.000,"));
    process_free(&ran);
    ran = run_enfilade(NULL, "bench solid . --levels rock --points 1000");
    assert_int_equal(ran.status, 0);
    int points, solid, spawns, wrong;
    const char *row = strstr(ran.out, "\nall,");
    assert_non_null(row);
    assert_int_equal(sscanf(row, "\nall,%d,%d,%d,%d,", &points, &solid, &spawns, &wrong), 4);
    assert_int_equal(points, 1000);
    assert_in_range(solid, 100, 240); // a sixth
    assert_int_equal(spawns, 1);
    assert_int_equal(wrong, 0);
    process_free(&ran);
    expect_failure("bench cells . --levels nothing", 3, "holds no levels that match");
}

/// A row for each world; what one size can't tell is said, and a bar that is missed is no failure.
static void growth_prints_a_row_per_world_and_a_verdict(void **state) {
    (void)state;
    process ran = run_enfilade(NULL, "bench growth --largest 10000 --runs 2 --seconds 0");
    assert_int_equal(ran.status, 0);
    assert_string_equal(ran.err, "");
    assert_non_null(strstr(ran.out, "world,polygons,tetrahedra,fine_cells,cells,read_s,"));
    assert_non_null(strstr(ran.out, "\noffice floors=1 rooms=7 detail=3,12096,"));
    assert_non_null(strstr(ran.out, "\ncaverns floors=1 rooms=3 detail=2,9440,"));
    assert_non_null(strstr(ran.out, "\noffice: one size alone has no exponent\n"));
    assert_non_null(strstr(ran.out, "\ncaverns: splitting the largest is "));
    process_free(&ran);
    ran = run_enfilade(NULL, "bench growth --largest 30000 --worlds office --runs 1 --threads 1 --seconds 0");
    assert_int_equal(ran.status, 0);
    assert_non_null(strstr(ran.out, "\noffice: time grows like polygons to the power of "));
    assert_non_null(strstr(ran.out, "(2 sizes, processor time of one thread; rounds: 1, from "));
    process_free(&ran);
}

static void damaged_world_files_are_refused(void **state) {
    (void)state;
    static const char *const commands[] = {"info bad.enf", "check bad.enf", "locate bad.enf", "sight bad.enf",
                                           "export bad.enf -o bad.svg"};
    write_text("box.obj", BOX);
    expect_success("compile box.obj -o whole.enf");
    size_t size;
    char *bytes = read_file("whole.enf", &size);
    assert_non_null(bytes);
    for (int damage = 0; damage < 5; damage++) {
        char *copy = malloc(size);
        size_t length = size;
        assert_non_null(copy);
        memcpy(copy, bytes, size);
        if (damage == 0) length = 0;
        if (damage == 1) length = 40;
        if (damage == 2) length = size - 1;
        if (damage == 3) copy[size / 2] ^= 1;
        if (damage == 4) copy[8] = 99; // the major version
        write_file("bad.enf", copy, length);
        for (size_t i = 0; i < sizeof commands / sizeof *commands; i++)
            expect_failure(commands[i], 3, "bad.enf");
        assert_false(file_exists("bad.svg"));
        free(copy);
    }
    free(bytes);
    write_text("bad.enf", BOX);
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) expect_failure(commands[i], 3, "bad.enf");
}

static void locate_answers_line_by_line_until_one_is_malformed(void **state) {
    (void)state;
    static const char *const wrong[] = {"1 2",     "1 2 3 4", "a b c", "nan 0 0",
                                        "0 inf 0", "1,2,3",   "",      "1 2 1e999"};
    write_text("box.obj", BOX);
    expect_success("compile box.obj -o box.enf");
    process ran = run_enfilade(" 0.5\t0.5 0.5 \r\n9 9 9\n1e-1 1 +1", "locate box.enf --kind");
    assert_int_equal(ran.status, 0);
    assert_string_equal(ran.out, "0 air\n-1 outside\n0 air\n");
    process_free(&ran);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char input[64];
        snprintf(input, sizeof input, "9 9 9\n%s\n1 1 1\n", wrong[i]);
        ran = run_enfilade(input, "locate box.enf");
        assert_int_equal(ran.status, 3);
        assert_string_equal(ran.out, "-1\n");
        assert_non_null(strstr(ran.err, "stdin:2: "));
        process_free(&ran);
    }
}

/// In a box, everything sees everything; nothing outside sees anything.
static void sight_answers_line_by_line_until_one_is_malformed(void **state) {
    (void)state;
    static const char *const wrong[] = {"1 2 3 4 5", "1 2 3 4 5 6 7", "0 0 0 0 0 nan", "", "0 0 0 1 1 a"};
    write_text("box.obj", BOX);
    expect_success("compile box.obj -o box.enf");
    process ran = run_enfilade(" 0.5\t0.5 0.5  0.1 0.2 .9\r\n9 9 9 .5 .5 .5\n.5 .5 .5 .5 .5 9\n0 0 0 1 1 1",
                               "sight box.enf");
    assert_int_equal(ran.status, 0);
    assert_string_equal(ran.out, "1\n0\n0\n1\n");
    process_free(&ran);
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        char input[64];
        snprintf(input, sizeof input, "9 9 9 9 9 9\n%s\n1 1 1 1 1 1\n", wrong[i]);
        ran = run_enfilade(input, "sight box.enf");
        assert_int_equal(ran.status, 3);
        assert_string_equal(ran.out, "0\n");
        assert_non_null(strstr(ran.err, "stdin:2: "));
        process_free(&ran);
    }
}

/// Kills compilations after growing delays. What has the output's name is always a whole world.
static void a_killed_compile_leaves_the_old_file_or_the_new_one(void **state) {
    (void)state;
    expect_success("gen four-rooms-tessellated -o killed.obj");
    write_text("box.obj", BOX);
    int finished = 0;
    for (int i = 0; i < 40 && finished < 3; i++) {
        expect_success("compile box.obj -o killed.enf -q");
        pid_t child = start_enfilade("compile killed.obj -o killed.enf -q");
        assert_true(child > 0);
        struct timespec delay = {.tv_nsec = (long)i * i * 300000};
        nanosleep(&delay, NULL);
        kill(child, SIGKILL);
        int outcome;
        assert_int_equal(waitpid(child, &outcome, 0), child);
        finished += WIFEXITED(outcome);
        expect_success("info killed.enf");
    }
}

static void an_interrupted_compile_says_so_and_writes_nothing(void **state) {
    (void)state;
    expect_success("gen four-rooms-tessellated -o stopped.obj");
    for (int i = 0; i < 10; i++) {
        unlink("stopped.enf");
        pid_t child = start_enfilade("compile stopped.obj -o stopped.enf -q");
        struct timespec delay = {.tv_nsec = (long)(i + 1) * 2000000};
        nanosleep(&delay, NULL);
        kill(child, SIGINT);
        int outcome;
        assert_int_equal(waitpid(child, &outcome, 0), child);
        // Too early and the signal finds the program not yet ready: then it dies of it.
        bool done = WIFEXITED(outcome) && WEXITSTATUS(outcome) == 0;
        assert_true(done || WIFSIGNALED(outcome) || WEXITSTATUS(outcome) == 4);
        assert_true(done == file_exists("stopped.enf"));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_bad_input_is_refused_with_file_line_and_reason),
        cmocka_unit_test(a_gzip_file_that_ends_early_is_refused),
        cmocka_unit_test(a_polygon_of_ten_million_corners_is_left_out),
        cmocka_unit_test(a_world_that_will_not_fit_is_refused),
        cmocka_unit_test(paths_that_cannot_be_read_are_told),
        cmocka_unit_test(outputs_that_cannot_be_written_are_told_and_leave_nothing),
        cmocka_unit_test(bad_options_are_refused_with_the_usage_line),
        cmocka_unit_test(help_and_version_are_data),
        cmocka_unit_test(benches_over_a_folder_print_a_row_per_level),
        cmocka_unit_test(growth_prints_a_row_per_world_and_a_verdict),
        cmocka_unit_test(damaged_world_files_are_refused),
        cmocka_unit_test(locate_answers_line_by_line_until_one_is_malformed),
        cmocka_unit_test(sight_answers_line_by_line_until_one_is_malformed),
        cmocka_unit_test(a_killed_compile_leaves_the_old_file_or_the_new_one),
        cmocka_unit_test(an_interrupted_compile_says_so_and_writes_nothing),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
