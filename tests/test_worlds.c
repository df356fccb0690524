// SPDX-License-Identifier: GPL-3.0-or-later
// The whole way by the program: gen, compile, info, check, locate, export; and the same bytes every time.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "process.h"

static const char *const worlds[] = {
    "four-rooms",
    "four-rooms-tessellated",
    "four-rooms-distorted",
    "cavern",
    "furnished",
    "office floors=2 rooms=2",
    "post",
};

enum { WORLD_COUNT = sizeof worlds / sizeof *worlds };

static int enter(void **state) {
    (void)state;
    return enter_test_folder() ? 0 : -1;
}

static int leave(void **state) {
    (void)state;
    leave_test_folder();
    return 0;
}

/// Runs a line that must succeed; its standard output is the caller's to free.
static char *run(const char *input, const char *format, ...) __attribute__((format(printf, 2, 3)));

static char *run(const char *input, const char *format, ...) {
    char line[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(line, sizeof line, format, arguments);
    va_end(arguments);
    process ran = run_enfilade(input, line);
    if (ran.status != 0) print_error("`%s`: status %d; it said: %s\n", line, ran.status, ran.err);
    assert_int_equal(ran.status, 0);
    free(ran.err);
    return ran.out;
}

static void do_run(const char *line) {
    free(run(NULL, "%s", line));
}

/// The number after the first "key": of a JSON text.
static double number_of(const char *json, const char *key) {
    char quoted[64];
    snprintf(quoted, sizeof quoted, "\"%s\": ", key);
    const char *at = strstr(json, quoted);
    if (!at) print_error("no key %s\n", key);
    assert_non_null(at);
    return strtod(at + strlen(quoted), NULL);
}

static char *read_text(const char *path) {
    size_t size;
    char *text = read_file(path, &size);
    assert_non_null(text);
    return text;
}

/// The "# spawn x y z" lines of an OBJ file as input for locate; returns how many.
static int spawns_of(const char *path, char *points, size_t size) {
    char *text = read_text(path);
    int count = 0;
    points[0] = 0;
    for (char *at = strstr(text, "# spawn "); at; at = strstr(at + 1, "# spawn "), count++) {
        double x, y, z;
        assert_int_equal(sscanf(at, "# spawn %lf %lf %lf", &x, &y, &z), 3);
        size_t used = strlen(points);
        snprintf(points + used, size - used, "%.17g %.17g %.17g\n", x, y, z);
    }
    free(text);
    return count;
}

static void expect_same_file(const char *a, const char *b) {
    size_t size_a, size_b;
    char *bytes_a = read_file(a, &size_a), *bytes_b = read_file(b, &size_b);
    assert_non_null(bytes_a);
    assert_non_null(bytes_b);
    assert_int_equal(size_a, size_b);
    assert_memory_equal(bytes_a, bytes_b, size_a);
    free(bytes_a);
    free(bytes_b);
}

static void every_world_goes_all_the_way(void **state) {
    (void)state;
    for (int i = 0; i < WORLD_COUNT; i++) {
        char points[4096];
        free(run(NULL, "gen %s -o way.obj", worlds[i]));
        do_run("compile way.obj -o way.enf --stop cells=12 --report way.json");
        char *report = read_text("way.json"), *info = run(NULL, "info way.enf --json");
        static const char *const same[] = {"vertices",          "tetrahedra",
                                           "cells_split",       "fine_cells",
                                           "regions_kept",      "fine_cells_discarded",
                                           "fine_cells_active", "portals_initial",
                                           "collapses",         "cells",
                                           "portals",           "portal_polygons"};
        for (size_t k = 0; k < sizeof same / sizeof *same; k++)
            assert_true(number_of(report, same[k]) == number_of(info, same[k]));
        assert_true(number_of(info, "spawns") > 0);
        assert_true(number_of(info, "spawns") == number_of(info, "spawns_in_cells"));
        assert_true(number_of(info, "cells") >= 1);
        assert_non_null(strstr(report, "\"leak\": false"));
        free(run(NULL, "check way.enf"));
        int count = spawns_of("way.obj", points, sizeof points), lines = 0;
        char *cells = run(points, "locate way.enf --kind");
        for (char *at = cells; *at; at = strchr(at, '\n') + 1, lines++) {
            assert_true(atoi(at) >= 0 && atoi(at) < number_of(info, "cells"));
            assert_non_null(strstr(at, " air\n"));
        }
        assert_int_equal(lines, count);
        do_run("export way.enf -o way.svg");
        do_run("export way.enf -o way.dot");
        do_run("export way.enf -o way-graph.json");
        do_run("export way.enf -o way-cells.obj");
        free(cells);
        free(report);
        free(info);
    }
}

static void the_report_has_every_key(void **state) {
    (void)state;
    static const char *const keys[] = {
        "\"input\": {",
        "\"vertices\": ",
        "\"polygons\": ",
        "\"rejected\": [",
        "\"tetrahedra\": ",
        "\"cells_split\"",
        "\"fine_cells\"",
        "\"regions\": ",
        "\"fine_cells_discarded\"",
        "\"fine_cells_active\"",
        "\"portals_initial\"",
        "\"collapses\"",
        "\"cells\": ",
        "\"portals\": ",
        "\"portal_polygons\": ",
        "\"pvs\": {",
        "\"method\": \"none\"",
        "\"pairs\": 0",
        "\"leak\": false",
        "\"stages\": [",
        "\"seconds\": ",
        "\"peak_bytes\": ",
        "\"resident_bytes\": ",
        "\"peak_bytes_least\": ",
        "\"peak_bytes_predicted\": ",
        "\"threads\": 1",
        "\"options\": {",
        "\"ran\": true",
        "\"why\": ",
        "\"reason\": \"duplicate\"",
        "\"count\": 1",
        "\"file\": \"keys.obj\"",
        "\"reason\": \"index-range\"",
    };
    char *world = run(NULL, "gen four-rooms -o -");
    char *text = malloc(strlen(world) + 256);
    assert_non_null(text);
    char *first = strstr(world, "\nf ");
    assert_non_null(first);
    int length = (int)strcspn(first + 1, "\n");
    sprintf(text, "%s%.*s\nf 1 2 99999\n", world, length, first + 1);
    write_text("keys.obj", text);
    do_run("compile keys.obj -o keys.enf --pvs none --report keys.json --threads 1");
    char *report = read_text("keys.json");
    for (size_t i = 0; i < sizeof keys / sizeof *keys; i++) {
        if (!strstr(report, keys[i])) print_error("the report lacks %s\n", keys[i]);
        assert_non_null(strstr(report, keys[i]));
    }
    free(report);
    free(text);
    free(world);
}

static void threads_and_repetition_change_no_byte(void **state) {
    (void)state;
    for (int i = 0; i < WORLD_COUNT; i++) {
        free(run(NULL, "gen %s -o same.obj", worlds[i]));
        do_run("compile same.obj -o one.enf --threads 1");
        do_run("compile same.obj -o two.enf --threads 2");
        do_run("compile same.obj -o five.enf --threads 5 --report five.json -v");
        expect_same_file("one.enf", "two.enf");
        expect_same_file("one.enf", "five.enf");
    }
}

static uint64_t next_random(uint64_t *seed) { // splitmix64
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

/// Writes an OBJ of vertices and triangles again with both in another order.
static void shuffle(const char *from, const char *to, uint64_t seed) {
    enum { MOST = 20000 };
    static char vertices[MOST][96], others[64][96];
    static int faces[MOST][3], place[MOST];
    int vertex_count = 0, face_count = 0, other_count = 0;
    char line[256];
    FILE *in = fopen(from, "r"), *out = fopen(to, "w");
    assert_non_null(in);
    assert_non_null(out);
    while (fgets(line, sizeof line, in)) {
        if (line[0] == 'v')
            snprintf(vertices[vertex_count++], 96, "%.95s", line);
        else if (line[0] == 'f')
            assert_int_equal(sscanf(line, "f %d %d %d", &faces[face_count][0], &faces[face_count][1],
                                    &faces[face_count][2]),
                             3),
                face_count++;
        else if (strncmp(line, "# spawn", 7) == 0)
            snprintf(others[other_count++], 96, "%.95s", line);
        assert_true(vertex_count < MOST && face_count < MOST && other_count < 64);
    }
    int order[MOST];
    for (int i = 0; i < vertex_count; i++) {
        int k = (int)(next_random(&seed) % (uint64_t)(i + 1));
        order[i] = order[k];
        order[k] = i;
    }
    for (int i = 0; i < other_count; i++) fputs(others[i], out);
    for (int i = 0; i < vertex_count; i++) {
        fputs(vertices[order[i]], out);
        place[order[i]] = i + 1;
    }
    for (int i = 0; i < face_count; i++) {
        int k = (int)(next_random(&seed) % (uint64_t)(i + 1));
        order[i] = order[k];
        order[k] = i;
    }
    for (int i = 0; i < face_count; i++) {
        const int *face = faces[order[i]];
        int turn = (int)(next_random(&seed) % 3);
        fprintf(out, "f %d %d %d\n", place[face[turn] - 1], place[face[(turn + 1) % 3] - 1],
                place[face[(turn + 2) % 3] - 1]);
    }
    fclose(in);
    assert_int_equal(fclose(out), 0);
}

static void the_order_of_the_input_changes_nothing_in_the_graph(void **state) {
    (void)state;
    for (int i = 0; i < WORLD_COUNT; i++) {
        uint64_t seed = 1234 + (uint64_t)i;
        print_message("%s, seed %llu\n", worlds[i], (unsigned long long)seed);
        free(run(NULL, "gen %s -o straight.obj", worlds[i]));
        shuffle("straight.obj", "shuffled.obj", seed);
        do_run("compile straight.obj -o straight.enf --stop cells=12");
        do_run("compile shuffled.obj -o shuffled.enf --stop cells=12");
        do_run("export straight.enf -o straight.json");
        do_run("export shuffled.enf -o shuffled.json");
        expect_same_file("straight.json", "shuffled.json");
    }
}

static void an_input_may_come_in_pieces_or_from_a_pipe(void **state) {
    (void)state;
    char *world = run(NULL, "gen post -o -");
    do_run("gen post -o piece.obj");
    do_run("compile piece.obj -o piece.enf");
    free(run(world, "compile - -o piped.enf"));
    expect_same_file("piece.enf", "piped.enf");
    process ran = run_enfilade(world, "compile - -o -");
    assert_int_equal(ran.status, 0);
    size_t size;
    char *bytes = read_file("piece.enf", &size);
    assert_int_equal(ran.out_size, size);
    assert_memory_equal(ran.out, bytes, size);
    free(bytes);
    process_free(&ran);
    do_run("gen post translate=100,0,0 -o far.obj");
    do_run("compile piece.obj far.obj -o both.enf");
    char *one = run(NULL, "info piece.enf --json"), *both = run(NULL, "info both.enf --json");
    assert_true(number_of(both, "spawns_in_cells") == 2 * number_of(one, "spawns_in_cells"));
    assert_true(number_of(both, "regions_kept") == 2 * number_of(one, "regions_kept"));
    free(one);
    free(both);
    free(world);
}

static void a_leak_is_a_warning_with_a_path(void **state) {
    (void)state;
    // A box without a lid, fronts inward.
    write_text("open.obj", "# spawn 1 1 1\n"
                           "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 0 0 2\nv 2 0 2\nv 2 2 2\nv 0 2 2\n"
                           "f 1 2 3 4\nf 1 5 6 2\nf 2 6 7 3\nf 3 7 8 4\nf 4 8 5 1\n");
    process ran = run_enfilade(NULL, "compile open.obj -o open.enf --report open.json --leak open.pts");
    assert_int_equal(ran.status, 0);
    assert_non_null(strstr(ran.err, "leak"));
    assert_non_null(strstr(ran.err, "open.pts"));
    char *report = read_text("open.json"), *path = read_text("open.pts");
    assert_non_null(strstr(report, "\"leak\": true"));
    double at[3];
    assert_int_equal(sscanf(path, "%lf %lf %lf", &at[0], &at[1], &at[2]), 3);
    assert_true(at[0] == 1 && at[1] == 1 && at[2] == 1);
    free(path);
    process_free(&ran);
    do_run("compile open.obj -o open.enf --leak way-out.obj -q");
    path = read_text("way-out.obj");
    assert_true(strncmp(path, "v 1 1 1\n", 8) == 0);
    assert_non_null(strstr(path, "\nl 1 2"));
    free(path);
    free(report);
    do_run("gen post -o tight.obj");
    do_run("compile tight.obj -o tight.enf --leak tight.pts");
    assert_false(file_exists("tight.pts"));
}

static void quiet_says_nothing_and_verbose_says_what_was_done(void **state) {
    (void)state;
    do_run("gen post -o talk.obj");
    process ran = run_enfilade(NULL, "compile talk.obj -o talk.enf -q");
    assert_int_equal(ran.status, 0);
    assert_string_equal(ran.err, "");
    assert_string_equal(ran.out, "");
    process_free(&ran);
    ran = run_enfilade(NULL, "compile talk.obj -o talk.enf -v --pvs none");
    static const char *const stages[] = {"clean",    "tetrahedralize", "split",      "connect", "colour",
                                         "decimate", "portals",        "visibility", "write"};
    for (size_t i = 0; i < sizeof stages / sizeof *stages; i++) assert_non_null(strstr(ran.err, stages[i]));
    assert_non_null(strstr(ran.err, "skipped"));
    process_free(&ran);
    ran = run_enfilade(NULL, "compile talk.obj -o talk.enf -q --progress always");
    assert_non_null(strstr(ran.err, "split"));
    process_free(&ran);
}

/// By default worlds of some size have a visible set, and larger ones say that they have none.
static void visible_sets_are_found_by_default_where_they_are_cheap(void **state) {
    (void)state;
    do_run("gen four-rooms -o small.obj");
    do_run("compile small.obj -o small.enf --report small.json");
    do_run("compile small.obj -o bare.enf --pvs none --report none.json");
    char *report = read_text("small.json"), *none = read_text("none.json");
    assert_non_null(strstr(report, "\"method\": \"hourglass\""));
    assert_non_null(strstr(none, "\"method\": \"none\""));
    free(report);
    free(none);
    do_run("gen caverns -o large.obj");
    process ran = run_enfilade(NULL, "compile large.obj -o large.enf -v --report large.json");
    assert_int_equal(ran.status, 0);
    assert_non_null(strstr(ran.err, "skipped: it would take long"));
    process_free(&ran);
    report = read_text("large.json");
    assert_non_null(strstr(report, "\"method\": \"none\""));
    free(report);
}

static void spawn_points_may_be_given_and_groups_left_out(void **state) {
    (void)state;
    do_run("gen four-rooms -o given.obj");
    do_run("compile given.obj -o given.enf --spawn 4.4,3.65,1 --spawn 4.4,3.65,1.25");
    char *plain = run(NULL, "info given.enf --json");
    assert_true(number_of(plain, "spawns") == 6);
    assert_non_null(strstr(plain, "[4.4, 3.65, 1.25]"));
    free(plain);
    do_run("compile given.obj -o far.enf --spawn 1e300,0,-1e300"); // far outside is no error
    plain = run(NULL, "info far.enf --json");
    assert_true(number_of(plain, "spawns") == 5);
    assert_true(number_of(plain, "spawns_in_cells") == 4);
    free(plain);
    process ran = run_enfilade(NULL, "compile given.obj -o none.enf --exclude *");
    assert_int_equal(ran.status, 3);
    assert_non_null(strstr(ran.err, "given.obj"));
    assert_false(file_exists("none.enf"));
    process_free(&ran);
}

static void vertices_that_no_polygon_can_use_do_no_harm(void **state) {
    (void)state;
    char *world = run(NULL, "gen four-rooms -o -");
    char *text = malloc(strlen(world) + 256);
    assert_non_null(text);
    sprintf(text,
            "%svn nan 1e308 -inf\nvt inf nan\nv 1e308 0 0\nv nan 0 0\nv 0 -inf 1e999\nf 1 2 -1\nf -1 -2 "
            "-3\nf 1 2 -3\n",
            world);
    write_text("wild.obj", text);
    do_run("compile wild.obj -o wild.enf --report wild.json");
    char *report = read_text("wild.json"), *info = run(NULL, "info wild.enf --json");
    assert_true(number_of(info, "rejected") == 3);
    assert_true(number_of(info, "spawns_in_cells") == 4);
    free(run(NULL, "check wild.enf"));
    do_run("export wild.enf -o wild-cells.obj");
    free(info);
    free(report);
    free(text);
    free(world);
}

static void worlds_may_be_tiny_or_immense(void **state) {
    (void)state;
    static const char *const scales[] = {"1e-12", "1e-6", "1024", "1e12"};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        free(run(NULL, "gen four-rooms scale=%s -o scaled.obj", scales[i]));
        do_run("compile scaled.obj -o scaled.enf");
        free(run(NULL, "check scaled.enf"));
        do_run("export scaled.enf -o scaled.svg");
    }
    for (int power = -300; power <= 100; power += 100) {
        char text[512];
        snprintf(text, sizeof text,
                 "v 0 0 0\nv 1e%d 0 0\nv 0 1e%d 0\nv 0 0 1e%d\nf 1 2 3\nf 1 4 2\nf 1 3 4\nf 2 4 3\n", power,
                 power, power);
        write_text("simplex.obj", text);
        do_run("compile simplex.obj -o simplex.enf");
        free(run(NULL, "check simplex.enf"));
        do_run("export simplex.enf -o simplex.svg");
        do_run("export simplex.enf -o simplex.json");
    }
}

/// The figures of the thesis (4.3): sizes about as there, and a stop at which every room is a cell of its own
/// and no more cells are left than rooms (24 for the distorted rooms, which keep spikes).
static void the_worlds_of_the_thesis_fall_into_their_rooms(void **state) {
    (void)state;
    static const struct {
        const char *name;
        int tetrahedra_min, tetrahedra_max, rooms, cells_max;
        double split_min, split_max; ///< percent
    } rows[] = {
        {"four-rooms ", 140, 180, 4, 4, 8, 14},
        {"four-rooms-tessellated ", 480, 560, 4, 4, 0, 2},
        {"four-rooms-distorted ", 270, 330, 4, 24, 33, 41},
        {"cavern ", 1050, 1210, 6, 6, 0, 2},
    };
    char *table = run(NULL, "bench thesis");
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        char line[64];
        snprintf(line, sizeof line, "\n%s", rows[i].name);
        const char *at = strstr(table, line);
        assert_non_null(at);
        int tetrahedra, cut, fine, gone, active, rooms, cells[2];
        double split;
        char mark[2];
        assert_int_equal(sscanf(at + strlen(line), "%d %d %lf %% %d %d %d %d %d%c %*f %*f %d%c", &tetrahedra,
                                &cut, &split, &fine, &gone, &active, &rooms, &cells[0], &mark[0], &cells[1],
                                &mark[1]),
                         11);
        assert_in_range(tetrahedra, rows[i].tetrahedra_min, rows[i].tetrahedra_max);
        assert_true(split >= rows[i].split_min && split <= rows[i].split_max);
        assert_int_equal(rooms, rows[i].rooms);
        assert_int_equal(gone + active, fine);
        assert_true(cells[0] <= rows[i].cells_max || cells[1] <= rows[i].cells_max);
        assert_true(cells[0] >= rooms && cells[1] >= rooms);
    }
    free(table);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_world_goes_all_the_way),
        cmocka_unit_test(the_report_has_every_key),
        cmocka_unit_test(threads_and_repetition_change_no_byte),
        cmocka_unit_test(the_order_of_the_input_changes_nothing_in_the_graph),
        cmocka_unit_test(an_input_may_come_in_pieces_or_from_a_pipe),
        cmocka_unit_test(a_leak_is_a_warning_with_a_path),
        cmocka_unit_test(quiet_says_nothing_and_verbose_says_what_was_done),
        cmocka_unit_test(visible_sets_are_found_by_default_where_they_are_cheap),
        cmocka_unit_test(vertices_that_no_polygon_can_use_do_no_harm),
        cmocka_unit_test(worlds_may_be_tiny_or_immense),
        cmocka_unit_test(the_worlds_of_the_thesis_fall_into_their_rooms),
        cmocka_unit_test(spawn_points_may_be_given_and_groups_left_out),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
