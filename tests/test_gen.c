// SPDX-License-Identifier: GPL-3.0-or-later
// The built-in test worlds: the same bytes each time, closed, facing the air, and moved as their settings
// say.
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "build/gen.h"

typedef struct text {
    char *bytes;
    size_t size;
} text;

typedef struct world {
    double (*points)[3], (*spawns)[3];
    int (*triangles)[3];
    bool *furniture; ///< by triangle: in a group of closed solids that stand in the air
    size_t point_count, spawn_count, triangle_count;
} world;

enum { SETTINGS_MAX = 8 };

static const struct {
    const char *name;
    size_t spawns, points, triangles;
    bool has_no_model; ///< in models/: too large for that
} expected[] = {
    {"four-rooms", 4, 64, 128, false},           {"four-rooms-tessellated", 4, 200, 400, false},
    {"four-rooms-distorted", 4, 64, 128, false}, {"cavern", 6, 402, 808, false},
    {"caverns", 12, 5154, 10324, true},          {"furnished", 2, 243, 422, false},
    {"office", 12, 1218, 2436, false},           {"post", 4, 40, 80, false},
};

enum { WORLD_COUNT = sizeof expected / sizeof *expected };

static enf_status try_print(const char *name, const char *const *settings, size_t count, text *out,
                            enf_error *error) {
    FILE *file = open_memstream(&out->bytes, &out->size);
    assert_non_null(file);
    enf_status status = enf_gen_write(name, settings, count, file, error);
    fclose(file);
    return status;
}

// `settings`: separated by blanks; may be null.
static text print(const char *name, const char *settings) {
    char copy[256];
    const char *list[SETTINGS_MAX];
    size_t count = 0;
    snprintf(copy, sizeof copy, "%s", settings ? settings : "");
    for (char *token = strtok(copy, " "); token; token = strtok(NULL, " ")) list[count++] = token;
    text out = {0};
    enf_error error = {0};
    enf_status status = try_print(name, list, count, &out, &error);
    if (status != ENF_OK) fail_msg("%s %s: %s", name, settings ? settings : "", error.text);
    return out;
}

static size_t count_lines(const char *bytes, const char *prefix) {
    size_t count = 0, length = strlen(prefix);
    for (const char *line = bytes; line; line = strchr(line, '\n'), line = line ? line + 1 : NULL)
        count += strncmp(line, prefix, length) == 0;
    return count;
}

static bool is_furniture(const char *group) {
    return strncmp(group, "table", 5) == 0 || strncmp(group, "chair", 5) == 0 ||
           strncmp(group, "stairs-", 7) == 0;
}

static world read_world(text text) {
    world w = {0};
    w.points = calloc(count_lines(text.bytes, "v ") + 1, sizeof *w.points);
    w.spawns = calloc(count_lines(text.bytes, "# spawn ") + 1, sizeof *w.spawns);
    w.triangles = calloc(count_lines(text.bytes, "f ") + 1, sizeof *w.triangles);
    w.furniture = calloc(count_lines(text.bytes, "f ") + 1, sizeof *w.furniture);
    assert_true(w.points && w.spawns && w.triangles && w.furniture);
    bool furniture = false;
    for (const char *line = text.bytes; *line; line = strchr(line, '\n') + 1) {
        double *p = w.points[w.point_count], *s = w.spawns[w.spawn_count];
        int *t = w.triangles[w.triangle_count];
        if (strncmp(line, "g ", 2) == 0) furniture = is_furniture(line + 2);
        if (sscanf(line, "v %lf %lf %lf", &p[0], &p[1], &p[2]) == 3) w.point_count++;
        if (sscanf(line, "# spawn %lf %lf %lf room-", &s[0], &s[1], &s[2]) == 3) w.spawn_count++;
        if (sscanf(line, "f %d %d %d", &t[0], &t[1], &t[2]) == 3) {
            for (int k = 0; k < 3; k++) t[k]--;
            w.furniture[w.triangle_count++] = furniture;
        }
    }
    return w;
}

static world make(const char *name, const char *settings) {
    text text = print(name, settings);
    world w = read_world(text);
    free(text.bytes);
    return w;
}

static void free_world(world *w) {
    free(w->points);
    free(w->spawns);
    free(w->triangles);
    free(w->furniture);
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void triangle_normal(const world *w, size_t t, double normal[3]) {
    double edge[2][3];
    for (int e = 0; e < 2; e++)
        for (int k = 0; k < 3; k++)
            edge[e][k] = w->points[w->triangles[t][e + 1]][k] - w->points[w->triangles[t][0]][k];
    cross(edge[0], edge[1], normal);
}

// How often the fronts of the triangles turn around a point: -1 in a shell that faces inward (van Oosterom
// and Strackee 1983).
static double winding(const world *w, const double at[3]) {
    double sum = 0;
    for (size_t t = 0; t < w->triangle_count; t++) {
        double v[3][3], length[3], normal[3];
        for (int i = 0; i < 3; i++) {
            for (int k = 0; k < 3; k++) v[i][k] = w->points[w->triangles[t][i]][k] - at[k];
            length[i] = sqrt(dot(v[i], v[i]));
        }
        cross(v[1], v[2], normal);
        sum += 2 * atan2(dot(v[0], normal), length[0] * length[1] * length[2] + dot(v[0], v[1]) * length[2] +
                                                dot(v[1], v[2]) * length[0] + dot(v[2], v[0]) * length[1]);
    }
    return sum / (4 * acos(-1.0));
}

static int compare_edges(const void *a, const void *b) {
    return memcmp(a, b, 2 * sizeof(int)); // any total order will do
}

// Every directed edge has as many partners in the other direction.
static bool is_closed(const world *w) {
    size_t count = 3 * w->triangle_count;
    int(*forth)[2] = calloc(count, sizeof *forth), (*back)[2] = calloc(count, sizeof *back);
    assert_true(forth && back);
    for (size_t i = 0; i < count; i++) {
        forth[i][0] = back[i][1] = w->triangles[i / 3][i % 3];
        forth[i][1] = back[i][0] = w->triangles[i / 3][(i + 1) % 3];
    }
    qsort(forth, count, sizeof *forth, compare_edges);
    qsort(back, count, sizeof *back, compare_edges);
    bool closed = memcmp(forth, back, count * sizeof *forth) == 0;
    free(forth);
    free(back);
    return closed;
}

static int find(int *parent, int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

// Connected parts of the surface, furniture left out.
static size_t shell_parts(const world *w) {
    int *parent = calloc(w->point_count, sizeof *parent);
    bool *used = calloc(w->point_count, sizeof *used);
    size_t parts = 0;
    assert_true(parent && used);
    for (size_t i = 0; i < w->point_count; i++) parent[i] = (int)i;
    for (size_t t = 0; t < w->triangle_count; t++) {
        if (w->furniture[t]) continue;
        for (int k = 0; k < 3; k++) {
            used[w->triangles[t][k]] = true;
            parent[find(parent, w->triangles[t][k])] = find(parent, w->triangles[t][0]);
        }
    }
    for (size_t i = 0; i < w->point_count; i++) parts += used[i] && parent[i] == (int)i;
    free(parent);
    free(used);
    return parts;
}

static void lists_every_world_with_a_description(void **state) {
    (void)state;
    for (size_t i = 0; i < WORLD_COUNT; i++) {
        const char *description = NULL;
        assert_string_equal(enf_gen_list(i, &description), expected[i].name);
        assert_true(description && *description && !strchr(description, '\n'));
    }
    assert_null(enf_gen_list(WORLD_COUNT, NULL));
}

static void writes_the_same_bytes_twice(void **state) {
    (void)state;
    static const char *const settings[] = {NULL, "noise=0.01 seed=7 rotate=7,8,9 scale=1.5 translate=1,2,3"};
    for (size_t i = 0; i < 2 * WORLD_COUNT; i++) {
        text a = print(expected[i / 2].name, settings[i % 2]),
             b = print(expected[i / 2].name, settings[i % 2]);
        assert_int_equal(a.size, b.size);
        assert_memory_equal(a.bytes, b.bytes, a.size);
        free(a.bytes);
        free(b.bytes);
    }
}

static void has_the_size_it_is_known_for(void **state) {
    (void)state;
    for (size_t i = 0; i < WORLD_COUNT; i++) {
        world w = make(expected[i].name, NULL);
        assert_int_equal(w.spawn_count, expected[i].spawns);
        assert_int_equal(w.point_count, expected[i].points);
        assert_int_equal(w.triangle_count, expected[i].triangles);
        free_world(&w);
    }
}

static int compare_points(const void *a, const void *b) {
    const double *p = a, *q = b;
    for (int k = 0; k < 3; k++)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

static void uses_each_of_its_different_points(void **state) {
    (void)state;
    for (size_t i = 0; i < WORLD_COUNT; i++) {
        world w = make(expected[i].name, NULL);
        bool *used = calloc(w.point_count, sizeof *used);
        for (size_t t = 0; t < w.triangle_count; t++) {
            double normal[3];
            for (int k = 0; k < 3; k++) {
                assert_in_range(w.triangles[t][k], 0, w.point_count - 1);
                used[w.triangles[t][k]] = true;
            }
            triangle_normal(&w, t, normal);
            assert_true(dot(normal, normal) > 0);
        }
        for (size_t p = 0; p < w.point_count; p++) assert_true(used[p]);
        qsort(w.points, w.point_count, sizeof *w.points, compare_points);
        for (size_t p = 1; p < w.point_count; p++)
            assert_int_not_equal(compare_points(w.points[p - 1], w.points[p]), 0);
        free(used);
        free_world(&w);
    }
}

static void is_closed_and_one_shell_whatever_moves_it(void **state) {
    (void)state;
    static const char *const settings[] = {NULL, "noise=0.01", "rotate=30,40,50 noise=0.02 seed=3",
                                           "scale=1,-2,1"};
    for (size_t i = 0; i < 4 * WORLD_COUNT; i++) {
        world w = make(expected[i / 4].name, settings[i % 4]);
        assert_true(is_closed(&w));
        assert_int_equal(shell_parts(&w), 1);
        free_world(&w);
    }
}

static void spawns_in_the_air_before_the_fronts(void **state) {
    (void)state;
    static const char *const settings[] = {NULL, "rotate=7,8,9 scale=2,1,0.5 translate=-5,6,7 noise=0.01",
                                           "scale=-1,1,1", "scale=-1"};
    for (size_t i = 0; i < 4 * WORLD_COUNT; i++) {
        world w = make(expected[i / 4].name, settings[i % 4]);
        for (size_t s = 0; s < w.spawn_count; s++) assert_true(fabs(winding(&w, w.spawns[s]) + 1) < 1e-6);
        free_world(&w);
    }
}

static void cavern_has_no_axis_aligned_face(void **state) {
    (void)state;
    world w = make("cavern", NULL);
    for (size_t t = 0; t < w.triangle_count; t++) {
        double normal[3];
        triangle_normal(&w, t, normal);
        for (int k = 0; k < 3; k++) assert_true(fabs(normal[k]) < 0.999 * sqrt(dot(normal, normal)));
    }
    free_world(&w);
}

static void office_grows_with_its_settings(void **state) {
    (void)state;
    static const struct {
        const char *settings;
        size_t rooms;
    } cases[] = {{"floors=1 rooms=1", 1}, {"floors=3 rooms=7", 21}, {"floors=2 rooms=30", 60}};
    for (size_t i = 0; i < 3; i++) {
        world w = make("office", cases[i].settings);
        assert_int_equal(w.spawn_count, cases[i].rooms);
        assert_true(is_closed(&w));
        assert_int_equal(shell_parts(&w), 1);
        for (size_t s = 0; s < w.spawn_count; s++) assert_true(fabs(winding(&w, w.spawns[s]) + 1) < 1e-6);
        free_world(&w);
    }
    world coarse = make("office", "floors=1 rooms=4"), fine = make("office", "floors=1 rooms=4 detail=3");
    assert_int_equal(fine.triangle_count, 9 * coarse.triangle_count);
    assert_true(is_closed(&fine));
    free_world(&coarse);
    free_world(&fine);
}

// Closed, with all rooms in one piece of air, and no face along an axis.
static void expect_caverns(const world *w, size_t rooms) {
    assert_int_equal(w->spawn_count, rooms);
    assert_true(is_closed(w));
    assert_int_equal(shell_parts(w), 1);
    for (size_t s = 0; s < w->spawn_count; s++) assert_true(fabs(winding(w, w->spawns[s]) + 1) < 1e-6);
    for (size_t t = 0; t < w->triangle_count; t++) {
        double normal[3];
        triangle_normal(w, t, normal);
        for (int k = 0; k < 3; k++) assert_true(normal[k] != 0);
    }
}

static void caverns_grow_with_their_settings(void **state) {
    (void)state;
    static const struct {
        const char *settings;
        size_t rooms;
    } cases[] = {{"floors=1 rooms=1", 1},
                 {"floors=1 rooms=3", 3},
                 {"floors=3 rooms=7", 21},
                 {"floors=2 rooms=12 seed=5", 24},
                 {"floors=1 rooms=2 detail=4", 2}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        world w = make("caverns", cases[i].settings);
        expect_caverns(&w, cases[i].rooms);
        free_world(&w);
    }
    world coarse = make("caverns", "floors=1 rooms=4"), fine = make("caverns", "floors=1 rooms=4 detail=3");
    assert_in_range(fine.triangle_count, 8 * coarse.triangle_count, 10 * coarse.triangle_count);
    free_world(&coarse);
    free_world(&fine);
}

// Of a triangle and an edge that have no corner in common: do they meet? Far from rounding, with numbers as
// short as these.
static bool edge_meets(const world *w, size_t t, int from, int to) {
    const int *corners = w->triangles[t];
    double volume[5], e[3][3];
    const int fourth[5][4] = {{corners[0], corners[1], corners[2], from},
                              {corners[0], corners[1], corners[2], to},
                              {from, to, corners[0], corners[1]},
                              {from, to, corners[1], corners[2]},
                              {from, to, corners[2], corners[0]}};
    for (int i = 0; i < 5; i++) {
        double normal[3];
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) e[j][k] = w->points[fourth[i][j + 1]][k] - w->points[fourth[i][0]][k];
        cross(e[0], e[1], normal);
        volume[i] = dot(normal, e[2]);
    }
    return (volume[0] > 0) != (volume[1] > 0) && (volume[2] > 0) == (volume[3] > 0) &&
           (volume[3] > 0) == (volume[4] > 0);
}

static bool boxes_meet(const world *w, const int *a, const int *b) {
    for (int k = 0; k < 3; k++) {
        double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (int i = 0; i < 3; i++) {
            low[0] = fmin(low[0], w->points[a[i]][k]), high[0] = fmax(high[0], w->points[a[i]][k]);
            low[1] = fmin(low[1], w->points[b[i]][k]), high[1] = fmax(high[1], w->points[b[i]][k]);
        }
        if (low[0] > high[1] || low[1] > high[0]) return false;
    }
    return true;
}

static void no_triangle_of_the_caverns_crosses_another(void **state) {
    (void)state;
    world w = make("caverns", "floors=1 rooms=2");
    for (size_t t = 0; t < w.triangle_count; t++)
        for (size_t u = 0; u < w.triangle_count; u++) {
            if (!boxes_meet(&w, w.triangles[t], w.triangles[u])) continue;
            for (int k = 0; k < 3; k++) {
                int from = w.triangles[u][k], to = w.triangles[u][(k + 1) % 3];
                bool shared = false;
                for (int i = 0; i < 3; i++)
                    shared = shared || w.triangles[t][i] == from || w.triangles[t][i] == to;
                assert_true(shared || !edge_meets(&w, t, from, to));
            }
        }
    free_world(&w);
}

static void scale_and_translate_act_on_points_and_spawns(void **state) {
    (void)state;
    world plain = make("four-rooms", NULL), moved = make("four-rooms", "translate=1,-2,4 scale=2,4,0.5");
    static const double scale[3] = {2, 4, 0.5}, shift[3] = {1, -2, 4};
    assert_int_equal(plain.point_count, moved.point_count);
    for (size_t i = 0; i < plain.point_count; i++)
        for (int k = 0; k < 3; k++)
            assert_true(moved.points[i][k] == plain.points[i][k] * scale[k] + shift[k]);
    for (size_t i = 0; i < plain.spawn_count; i++)
        for (int k = 0; k < 3; k++)
            assert_true(moved.spawns[i][k] == plain.spawns[i][k] * scale[k] + shift[k]);
    assert_memory_equal(plain.triangles, moved.triangles, plain.triangle_count * sizeof *plain.triangles);
    free_world(&plain);
    free_world(&moved);
}

static void rotate_turns_about_x_then_y_then_z(void **state) {
    (void)state;
    world plain = make("furnished", NULL), turned = make("furnished", "rotate=90,90,0");
    for (size_t i = 0; i < plain.point_count; i++) { // (x, y, z) -> (x, -z, y) -> (y, -z, -x)
        const double *p = plain.points[i], *q = turned.points[i];
        assert_true(q[0] == p[1] && q[1] == -p[2] && q[2] == -p[0]);
    }
    free_world(&turned);
    turned = make("furnished", "rotate=0,0,30");
    for (size_t i = 0; i < plain.point_count; i++) {
        const double *p = plain.points[i], *q = turned.points[i];
        assert_true(fabs(q[0] - (p[0] * sqrt(0.75) - p[1] * 0.5)) < 1e-14);
        assert_true(fabs(q[1] - (p[0] * 0.5 + p[1] * sqrt(0.75))) < 1e-14 && q[2] == p[2]);
    }
    free_world(&turned);
    free_world(&plain);
}

static void noise_moves_each_point_no_further_than_told(void **state) {
    (void)state;
    world plain = make("cavern", NULL), noisy = make("cavern", "noise=0.25"),
          other = make("cavern", "noise=0.25 seed=2");
    double farthest = 0;
    size_t differing = 0;
    for (size_t i = 0; i < plain.point_count; i++) {
        double d[3];
        for (int k = 0; k < 3; k++) d[k] = noisy.points[i][k] - plain.points[i][k];
        farthest = fmax(farthest, sqrt(dot(d, d)));
        differing += compare_points(noisy.points[i], other.points[i]) != 0;
    }
    assert_true(farthest <= 0.25 * (1 + 1e-12) && farthest > 0.2);
    assert_int_equal(differing, plain.point_count);
    assert_memory_equal(plain.spawns, noisy.spawns, plain.spawn_count * sizeof *plain.spawns);
    assert_memory_equal(plain.triangles, noisy.triangles, plain.triangle_count * sizeof *plain.triangles);
    free_world(&plain);
    free_world(&noisy);
    free_world(&other);
}

static void numbers_have_no_needless_digits(void **state) {
    (void)state;
    text text = print("furnished", "rotate=7,8,9 translate=0.1,1e-9,1e9");
    for (const char *line = text.bytes; *line; line = strchr(line, '\n') + 1) {
        if (strncmp(line, "v ", 2) != 0) continue;
        char numbers[3][64];
        assert_int_equal(sscanf(line, "v %63s %63s %63s", numbers[0], numbers[1], numbers[2]), 3);
        for (int k = 0; k < 3; k++) {
            char shortest[64];
            int digits = 0;
            do snprintf(shortest, sizeof shortest, "%.*g", ++digits, strtod(numbers[k], NULL));
            while (strtod(shortest, NULL) != strtod(numbers[k], NULL));
            assert_true(strspn(numbers[k], "+-.e0123456789") == strlen(numbers[k]));
            size_t significant = 0;
            for (const char *c = numbers[k] + strspn(numbers[k], "-0."); *c && *c != 'e'; c++)
                significant += *c != '.';
            assert_true(significant <= (size_t)digits || !strchr(numbers[k], '.'));
        }
    }
    free(text.bytes);
}

static void refuses_what_it_does_not_know(void **state) {
    (void)state;
    static const char *const cases[][2] = {
        {"no-such-world", NULL},
        {"", NULL},
        {"cavern", "colour=red"},
        {"cavern", "scale"},
        {"cavern", ""},
        {"cavern", "=1"},
        {"cavern", "scale="},
        {"cavern", "scale=0"},
        {"cavern", "scale=1,2"},
        {"cavern", "scale=1,0,1"},
        {"cavern", "scale=nan"},
        {"cavern", "scale=inf"},
        {"cavern", "scale=1e300"},
        {"cavern", "scale=1,1,1,1"},
        {"cavern", "scale=2x"},
        {"cavern", "scale=2,"},
        {"cavern", "rotate=1"},
        {"cavern", "rotate=1,2"},
        {"cavern", "rotate=a,b,c"},
        {"cavern", "translate=1,2"},
        {"cavern", "translate= 1,2,3"},
        {"cavern", "noise=-1"},
        {"cavern", "noise=1,1,1"},
        {"cavern", "seed=-1"},
        {"cavern", "seed=1.5"},
        {"cavern", "seed=99999999999999999999"},
        {"cavern", "floors=2"},
        {"office", "floors=0"},
        {"office", "floors=-1"},
        {"office", "floors=2.5"},
        {"office", "rooms="},
        {"office", "rooms=99999999999999999999"},
        {"office", "detail=101"},
        {"cavern", "Scale=2"},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        text text = {0};
        enf_error error = {0};
        if (try_print(cases[i][0], &cases[i][1], cases[i][1] ? 1 : 0, &text, &error) != ENF_BAD_USAGE)
            fail_msg("%s %s was accepted", cases[i][0], cases[i][1]);
        assert_int_equal(error.status, ENF_BAD_USAGE);
        assert_true(*error.text);
        assert_int_equal(text.size, 0);
        free(text.bytes);
    }
}

static void refuses_a_setting_given_twice_and_a_size_beyond_reason(void **state) {
    (void)state;
    static const char *const twice[] = {"scale=2", "noise=0", "scale=2"};
    static const char *const huge[] = {"floors=1000", "rooms=100000", "detail=100"};
    text text = {0};
    assert_int_equal(try_print("post", twice, 3, &text, NULL), ENF_BAD_USAGE);
    free(text.bytes);
    static const char *const sized[] = {"office", "caverns"};
    for (int i = 0; i < 2; i++) {
        assert_int_equal(try_print(sized[i], huge, 3, &text, NULL), ENF_BAD_USAGE);
        free(text.bytes);
    }
}

static void names_what_is_allowed(void **state) {
    (void)state;
    text text = {0};
    enf_error error = {0};
    try_print("no-such-world", NULL, 0, &text, &error);
    for (size_t i = 0; i < WORLD_COUNT; i++) assert_non_null(strstr(error.text, expected[i].name));
    free(text.bytes);
    static const char *const bad[] = {"wings=3"};
    try_print("office", bad, 1, &text, &error);
    assert_non_null(strstr(error.text, "floors="));
    assert_non_null(strstr(error.text, "rotate="));
    free(text.bytes);
}

static void reports_a_full_disk(void **state) {
    (void)state;
    FILE *full = fopen("/dev/full", "w");
    if (!full) skip();
    enf_error error = {0};
    assert_int_equal(enf_gen_write("cavern", NULL, 0, full, &error), ENF_NO_RESOURCES);
    assert_true(*error.text);
    fclose(full);
}

static void models_are_what_it_prints(void **state) {
    (void)state;
#ifdef ENFILADE_MODELS_DIR
    for (size_t i = 0; i < WORLD_COUNT; i++) {
        if (expected[i].has_no_model) continue;
        char path[1024];
        snprintf(path, sizeof path, "%s/%s.obj", ENFILADE_MODELS_DIR, expected[i].name);
        FILE *file = fopen(path, "rb");
        if (!file) fail_msg("%s is missing", path);
        text text = print(expected[i].name, NULL);
        char *bytes = calloc(text.size + 1, 1);
        assert_non_null(bytes);
        assert_int_equal(fread(bytes, 1, text.size + 1, file), text.size);
        assert_memory_equal(bytes, text.bytes, text.size);
        fclose(file);
        free(bytes);
        free(text.bytes);
    }
#else
    skip();
#endif
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_every_world_with_a_description),
        cmocka_unit_test(writes_the_same_bytes_twice),
        cmocka_unit_test(has_the_size_it_is_known_for),
        cmocka_unit_test(uses_each_of_its_different_points),
        cmocka_unit_test(is_closed_and_one_shell_whatever_moves_it),
        cmocka_unit_test(spawns_in_the_air_before_the_fronts),
        cmocka_unit_test(cavern_has_no_axis_aligned_face),
        cmocka_unit_test(office_grows_with_its_settings),
        cmocka_unit_test(caverns_grow_with_their_settings),
        cmocka_unit_test(no_triangle_of_the_caverns_crosses_another),
        cmocka_unit_test(scale_and_translate_act_on_points_and_spawns),
        cmocka_unit_test(rotate_turns_about_x_then_y_then_z),
        cmocka_unit_test(noise_moves_each_point_no_further_than_told),
        cmocka_unit_test(numbers_have_no_needless_digits),
        cmocka_unit_test(refuses_what_it_does_not_know),
        cmocka_unit_test(refuses_a_setting_given_twice_and_a_size_beyond_reason),
        cmocka_unit_test(names_what_is_allowed),
        cmocka_unit_test(reports_a_full_disk),
        cmocka_unit_test(models_are_what_it_prints),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
