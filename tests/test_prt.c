// SPDX-License-Identifier: GPL-3.0-or-later
// The reader of portal files: every variant as others may write it, everything that is wrong with its line,
// and the levels of Quake.
#include "visibility/read_prt.h"
#include "visibility/winding.h"

#include <inttypes.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <glob.h>
#include <zlib.h>

#include "tests/read_fixture.h"
#include "tests/shared_data.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

#define SQUARE "(0 0 0 ) (0 8 0 ) (0 8 8 ) (0 0 8 ) \n"
#define PORTAL_1 "4 0 1 " SQUARE
#define PORTAL_2 "3 1 2 (8 0 0 ) (8 4.5 0 ) (8 0 8 ) \n"
#define PRT1 "PRT1\n3\n2\n" PORTAL_1 PORTAL_2
#define PRT2 "PRT2\n5\n3\n2\n" PORTAL_1 PORTAL_2 "0 -1\n1 3 4 -1\n2 -1\n"
#define PRT1_AM "PRT1-AM\n3\n2\n5\n" PORTAL_1 PORTAL_2 "0\n1\n2\n1\n1\n"

static enf_status parse(enf_portal_graph *graph, const char *text, enf_error *error) {
    enf_source source;
    assert_int_equal(enf_source_over(&source, "text", text, strlen(text), error), ENF_OK);
    enf_status status = enf_read_prt(graph, &source, error);
    enf_source_close(&source);
    return status;
}

static enf_portal_graph parse_good(const char *text) {
    enf_portal_graph graph;
    enf_error error = {0};
    if (parse(&graph, text, &error)) fail_msg("%.60s...: %s", text, error.text);
    return graph;
}

static void assert_corner(const enf_portal_graph *graph, int corner, double x, double y, double z) {
    const double *at = graph->corners[corner];
    if (at[0] != x || at[1] != y || at[2] != z)
        fail_msg("corner %d is (%g %g %g)", corner, at[0], at[1], at[2]);
}

/// The graph that all variants above hold.
static void assert_three_cells(const enf_portal_graph *graph) {
    static const int32_t cells[2][2] = {{0, 1}, {1, 2}}, offsets[] = {0, 4, 7};
    static const int32_t starts[] = {0, 1, 3, 4}, portals[] = {0, 1, 2, 3};
    assert_int_equal(graph->cell_count, 3);
    assert_int_equal(graph->opening_count, 2);
    assert_memory_equal(graph->opening_cell, cells, sizeof cells);
    assert_memory_equal(graph->opening_corner, offsets, sizeof offsets);
    assert_memory_equal(graph->cell_portal, starts, sizeof starts);
    assert_memory_equal(graph->cell_portals, portals, sizeof portals);
    assert_corner(graph, 1, 0, 8, 0);
    assert_corner(graph, 5, 8, 4.5, 0);
    assert_int_equal(enf_portal_from(graph, 3), 2);
    assert_int_equal(enf_portal_to(graph, 3), 1);
}

static void all_variants_give_the_same_cells(void **state) {
    (void)state;
    static const char *const variants[] = {PRT1, PRT2, PRT1_AM};
    static const int32_t leafs[] = {0, 1, 2, 1, 1};
    for (int i = 0; i < 3; i++) {
        enf_portal_graph graph = parse_good(variants[i]);
        assert_three_cells(&graph);
        assert_int_equal(graph.leaf_count, i ? 5 : 0);
        if (i == 0) assert_null(graph.leaf_cell);
        if (i) assert_memory_equal(graph.leaf_cell, leafs, sizeof leafs);
        enf_portal_graph_free(&graph);
    }
}

static void white_space_is_free(void **state) {
    (void)state;
    static const char *const texts[] = {
        "PRT1\r\n3\r\n2\r\n4 0 1 (0 0 0)(0 8 0)(0 8 8)(0 0 8)\r\n3 1 2 (8 0 0) (8 4.5 0) (8 0 8)\r\n",
        "PRT1 \t\n3 2 4 0 1 ( 0 0 0 ) ( 0 8 0 )\n\n( 0 8\n8 )\t(0\v0\f8)3 1 2(8 0 0)(8 4.5 0)(8 0 8)",
        "PRT1\r3\r2\r4 0 1 (0 0 0) (0 8 0) (0 8 8) (0 0 8)\r3 1 2 (8 0 0) (8 4.5 0) (8 0 8)\r",
        "PRT1\n\n\n3\n2\n4 0 1 (0 0 0)(0 8 0)(0 8 8)(0 0 8)\n3\n1\n2\n(8 0 0)(8 4.5 0)(8 0 8)\n\n \t\n",
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        enf_portal_graph graph = parse_good(texts[i]);
        assert_three_cells(&graph);
        enf_portal_graph_free(&graph);
    }
}

static void numbers_are_read_to_the_last_bit(void **state) {
    (void)state;
    enf_portal_graph graph =
        parse_good("PRT1\n2\n1\n3 0 1 (-0 2.842170943040401e-14 +1E2) "
                   "(104.00000000000003 -.5 1.e+1) (0.1 123456789.01234567890123456789 0)\n");
    assert_corner(&graph, 0, 0, 2.842170943040401e-14, 100);
    assert_corner(&graph, 1, 104.00000000000003, -0.5, 10);
    assert_corner(&graph, 2, 0.1, 123456789.01234567890123456789, 0);
    enf_portal_graph_free(&graph);
}

static void cells_may_be_without_portals(void **state) {
    (void)state;
    enf_portal_graph graph = parse_good("PRT1\n1\n0\n");
    assert_int_equal(graph.cell_count, 1);
    assert_int_equal(graph.opening_count, 0);
    assert_non_null(graph.opening_corner);
    assert_int_equal(graph.cell_portal[1], 0);
    enf_portal_graph_free(&graph);
    graph = parse_good("PRT1\n9\n1\n4 7 3 " SQUARE);
    assert_int_equal(graph.cell_portal[3], 0);
    assert_int_equal(graph.cell_portal[9], 2);
    enf_portal_graph_free(&graph);
}

static void repeated_corners_are_dropped(void **state) {
    (void)state;
    enf_portal_graph graph =
        parse_good("PRT1\n2\n1\n7 0 1 (0 0 0) (0 0 0) (0 8 0) (0 8 8) (0 8 8) (0 0 8) (-0 0 0)\n");
    assert_int_equal(graph.opening_corner[1], 4);
    assert_corner(&graph, 3, 0, 0, 8);
    enf_portal_graph_free(&graph);
}

static void rounded_windings_are_taken(void **state) {
    (void)state;
    // Six digits: out of the plane by 0.01, and a corner on the line of its neighbours that is off by as
    // much.
    enf_portal_graph graph =
        parse_good("PRT1\n2\n2\n4 0 1 (4096 0 0) (4096.01 800 0) (4096 800 80) (4096.01 0 80)\n"
                   "5 0 1 (0 0 1024) (800 0 1024) (799.99 40 1024) (800 80 1024) (0 80 1024)\n");
    assert_int_equal(graph.opening_count, 2);
    enf_portal_graph_free(&graph);
}

/// Header, then a portal on line 4.
#define WINDING(corners) "PRT1\n2\n1\n" corners "\n"

static const char *const wrong[][2] = {
    {"", "text:1: this is no portal file"},
    {"\n" PRT1, "text:1: this is no portal file"},
    {"PRT3\n1\n0\n", "text:1: this is no portal file"},
    {"PRT1-AMX\n1\n0\n1\n0\n", "text:1: this is no portal file"},
    {"PRT1 3\n2\n", "text:1: this is no portal file"},
    {"PRT1", "text:1: the file ends where the number of leafs should stand"},
    {"PRT1\n3\n", "text:3: the file ends where the number of portals should stand"},
    {"PRT2\n5\n3\n", "text:4: the file ends where the number of portals should stand"},
    {"PRT1-AM\n5\n3\n", "text:4: the file ends where the number of leafs should stand"},
    {"PRT1\nthree\n2\n", "text:2: the number of leafs should stand here"},
    {"PRT1\n3.5\n2\n", "text:2: the number of leafs should stand here"},
    {"PRT1\n0\n0\n", "text:2: 0 is no number of leafs"},
    {"PRT1\n-3\n0\n", "text:2: -3 is no number of leafs"},
    {"PRT1\n3\n-1\n", "text:3: -1 is no number of portals"},
    {"PRT2\n1\n0\n0\n0 -1\n", "text:3: 0 is no number of clusters"},
    {"PRT1\n99999999999999999999999\n0\n", "is no number of leafs"},
    {"PRT1\n1000000000\n0\n", "text:3: the header announces far more leafs than portals"},
    {"PRT1\n3\n1000000\n" PORTAL_1, "text:3: the header announces more portals than the file can hold"},
    {"PRT2\n1000000\n3\n1\n" PORTAL_1, "text:4: the header announces more leafs than the file can hold"},
    {"PRT1-AM\n3\n1\n2\n" PORTAL_1 "0 1\n", "text:4: the header announces more clusters than leafs"},
    {"PRT1\n3\n3\n" PORTAL_1 PORTAL_2,
     "text:6: the file ends where a portal's number of corners should stand"},
    {"PRT1\n3\n1\n" PORTAL_1 PORTAL_2, "text:5: something stands after the end"},
    {PRT1 "0 -1\n", "text:6: something stands after the end"},
    {PRT2 "\n\nx", "text:12: something stands after the end"},
    {PRT1_AM "1", "text:12: something stands after the end"},
    {WINDING("2 0 1 (0 0 0) (0 8 0)"), "text:4: a portal has 3 to 64 corners, not 2"},
    {WINDING("65 0 1 (0 0 0) (0 8 0)"), "text:4: a portal has 3 to 64 corners, not 65"},
    {WINDING("4 0 2 " SQUARE), "text:4: there is no leaf 2; they are numbered 0 to 1"},
    {WINDING("4 -1 1 " SQUARE), "text:4: there is no leaf -1"},
    {WINDING("4 1 1 " SQUARE), "text:4: this portal leads from a cell into itself"},
    {WINDING("4 0 x " SQUARE), "text:4: the number of a leaf should stand here"},
    {WINDING("3 0 1 (0 0 0) (0 8 0)"), "text:5: the file ends where the ( of a corner should stand"},
    {WINDING("3 0 1 (0 0 0) 0 8 0) (0 8 8)"), "text:4: the ( of a corner should stand here"},
    {WINDING("3 0 1 (0 0 0) (0 8) (0 8 8)"), "text:4: a coordinate should stand here"},
    {WINDING("3 0 1 (0 0 0) (0 8 0 1) (0 8 8)"), "text:4: the ) after three coordinates should stand here"},
    {WINDING("3 0 1 (0 0 0) (0 8 0)\n(0 8 a)"), "text:5: a coordinate should stand here"},
    {WINDING("3 0 1 (0 0 0) (0 8 0) (0 8 0x8)"), "text:4: a coordinate should stand here"},
    {WINDING("3 0 1 (0 0 0) (0 8 0) (0 8 8e)"), "text:4: a coordinate should stand here"},
    {WINDING("3 0 1 (0 0 0) (0 8 0) (0 8 nan)"), "text:4: a coordinate should stand here"},
    {WINDING("3 0 1 (0 0 0) (0 8 0) (0 8 -inf)"), "text:4: a coordinate should stand here"},
    {WINDING("3 0 1 (0 0 0) (0 8 0) (0 8 1e999)"), "text:4: this coordinate is beyond 1e100"},
    {WINDING("3 0 1 (0 0 0) (0 8 0) (0 8 -1e101)"), "text:4: this coordinate is beyond 1e100"},
    {WINDING("3 0 1 (1 2 3) (1 2 3) (1 2 3)"), "text:4: this portal has no area"},
    {WINDING("4 0 1 (1 2 3) (1 2 3) (4 5 6) (4 5 6)"), "text:4: this portal has no area"},
    {WINDING("3 0 1 (.1 .2 .3) (.2 .4 .6) (.3 .6 .9)"), "text:4: this portal has no area"},
    {WINDING("4 0 1 (0 0 0) (8 8 0) (8 0 0) (0 8 0)"), "text:4: this portal has no area"},
    {WINDING("4 0 1 (0 0 0) (0 8 0) (1 8 8) (0 0 8)"), "text:4: this portal is not flat"},
    {WINDING("4 0 1 (0 0 0) (0 8 0)\n(0 2 2) (0 0 8)"),
     "text:4: this portal is not convex, by more than 3e-05"},
    {WINDING("4 0 1 (0 0 0) (0 9 0) (0 7 0) (0 0 8)"), "text:4: this portal is not convex"},
    {WINDING("4 0 1 (0 0 0) (0 8 0) (0 7.99999 0) (0 0 8)"), "text:4: this portal is not convex"},
    {WINDING("5 0 1 (0 9 0) (-5 -7 0) (8 3 0) (-8 3 0) (5 -7 0)"), "text:4: this portal is not convex"},
    {WINDING("5 0 1 (0 0 1024) (800 0 1024) (799 40 1024) (800 80 1024) (0 80 1024)"), "at (799 40 1024)"},
    {"PRT2\n5\n3\n1\n" PORTAL_1 "0 -1\n1 3 -1\n2 -1\n", "text:8: leaf 4 is in no cluster"},
    {"PRT2\n5\n3\n1\n" PORTAL_1 "0 -1\n1 3 4 -1\n", "text:8: the file ends where a leaf of a cluster, or -1"},
    {"PRT2\n5\n3\n1\n" PORTAL_1 "0 -1\n1 3 4\n", "text:8: the file ends where a leaf of a cluster, or -1"},
    {"PRT2\n5\n3\n1\n" PORTAL_1 "0 -1\n1 3 0 -1\n2 4 -1\n", "text:7: leaf 0 is in cluster 0 already"},
    {"PRT2\n5\n3\n1\n" PORTAL_1 "0 -1\n1 3 5 -1\n2 -1\n",
     "text:7: there is no leaf 5; they are numbered 0 to 4"},
    {"PRT2\n5\n3\n1\n" PORTAL_1 "0 -1\n1 3 -2 -1\n2 -1\n", "text:7: there is no leaf -2"},
    {"PRT2\n5\n3\n1\n" PORTAL_1 "0 -1\n-1\n1 2 3 4 -1\n", "text:7: cluster 1 has no leafs"},
    {"PRT2\n5\n3\n1\n" PORTAL_1 "0 -1\n1 x -1\n", "text:7: a leaf of a cluster, or -1 should stand here"},
    {"PRT1-AM\n3\n1\n5\n" PORTAL_1 "0 1 2 1 3\n", "text:6: there is no cluster 3; they are numbered 0 to 2"},
    {"PRT1-AM\n3\n1\n5\n" PORTAL_1 "0 1 1 1\n1\n", "text:7: cluster 2 has no leafs"},
    {"PRT1-AM\n3\n1\n5\n" PORTAL_1 "0 1 2 1\n",
     "text:7: the file ends where the number of a cluster should stand"},
};

static void every_fault_is_told_with_its_line(void **state) {
    (void)state;
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        enf_portal_graph graph, none = {0};
        enf_error error = {0};
        enf_status status = parse(&graph, wrong[i][0], &error);
        if (status != ENF_BAD_INPUT || !strstr(error.text, wrong[i][1]))
            fail_msg("%s...: status %d, \"%s\" instead of \"%s\"", wrong[i][0], status, error.text,
                     wrong[i][1]);
        assert_memory_equal(&graph, &none, sizeof none);
    }
}

static void a_file_cut_anywhere_is_refused(void **state) {
    (void)state;
    static const char *const variants[] = {PRT1, PRT2, PRT1_AM};
    for (int i = 0; i < 3; i++)
        for (size_t size = 0; size + 2 < strlen(variants[i]); size++) { // without "\n" or " \n" it is whole
            char text[512];
            enf_portal_graph graph;
            enf_error error = {0};
            snprintf(text, sizeof text, "%.*s", (int)size, variants[i]);
            assert_int_equal(parse(&graph, text, &error), ENF_BAD_INPUT);
        }
}

static void scale_does_not_matter_to_windings(void **state) {
    (void)state;
    static const double scales[] = {1e-300, 1e-30, 1, 1e30, 1e100};
    for (size_t i = 0; i < sizeof scales / sizeof *scales; i++) {
        double s = scales[i], square[][3] = {{0, 0, 0}, {0, s, 0}, {0, s, s}, {0, 0, s}}, normal[3];
        int32_t corner;
        assert_int_equal(enf_winding_judge((const double(*)[3])square, 4, &corner), ENF_WINDING_FINE);
        assert_true(enf_winding_normal((const double(*)[3])square, 4, normal));
        assert_true(normal[0] == 1 && normal[1] == 0 && normal[2] == 0);
        square[2][1] = square[2][2] = s / 8;
        assert_int_equal(enf_winding_judge((const double(*)[3])square, 4, &corner), ENF_WINDING_NOT_CONVEX);
        assert_int_equal(corner, 2);
        square[2][0] = s / 8;
        assert_int_equal(enf_winding_judge((const double(*)[3])square, 4, &corner), ENF_WINDING_NOT_PLANAR);
    }
    double top[][3] = {{0, 0, 4096}, {0, 0, -1}}, unit[][3] = {{1, 0, 0}}, zero[][3] = {{0, 0, 0}};
    assert_float_equal(enf_winding_tolerance((const double(*)[3])top, 2), 3e-2, 1e-8);
    assert_float_equal(enf_winding_tolerance((const double(*)[3])unit, 1), 3e-5, 1e-11);
    assert_true(enf_winding_tolerance((const double(*)[3])zero, 1) == 0);
}

/// Cell 1 lies between two squares that face each other; the second is tilted into the first or not.
static void cells_that_are_not_convex_are_counted(void **state) {
    (void)state;
    enf_portal_graph graph =
        parse_good("PRT1\n3\n2\n4 0 1 " SQUARE "4 1 2 (9 0 0) (9 8 0) (9 8 8) (9 0 8)\n");
    enf_portal_graph_find_non_convex(&graph);
    assert_int_equal(graph.non_convex_cells, 0);
    assert_int_equal(graph.first_non_convex_cell, -1);
    enf_portal_graph_free(&graph);
    static const char *const bent[] = {
        "PRT1\n3\n2\n4 0 1 " SQUARE "4 1 2 (-1 0 0) (9 8 0) (9 8 8) (-1 0 8)\n", // one behind the other
        "PRT1\n3\n2\n4 1 0 " SQUARE
        "4 1 2 (9 0 0) (9 8 0) (9 8 8) (9 0 8)\n", // the first faces the wrong way
    };
    for (int i = 0; i < 2; i++) {
        graph = parse_good(bent[i]);
        enf_portal_graph_find_non_convex(&graph);
        assert_int_equal(graph.non_convex_cells, 1);
        assert_int_equal(graph.first_non_convex_cell, 1);
        assert_true(enf_portal_graph_is_convex(&graph, 0));
        enf_portal_graph_free(&graph);
    }
}

static void gzipped_files_are_read(void **state) {
    (void)state;
    char path[512];
    fixture_path(path, sizeof path, ".prt"); // by content, not by name
    gzFile packed = gzopen(path, "wb");
    assert_non_null(packed);
    gzputs(packed, PRT2);
    assert_int_equal(gzclose(packed), Z_OK);
    enf_portal_graph graph;
    enf_error error = {0};
    enf_status status = enf_portal_graph_read(&graph, path, &error);
    assert_int_equal(truncate(path, 40), 0);
    enf_portal_graph none;
    enf_status cut = enf_portal_graph_read(&none, path, &error);
    remove(path);
    assert_int_equal(status, ENF_OK);
    assert_three_cells(&graph);
    enf_portal_graph_free(&graph);
    assert_int_equal(cut, ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "the gzip data end early"));
    assert_int_equal(enf_portal_graph_read(&none, path, &error), ENF_NO_RESOURCES);
    assert_non_null(strstr(error.text, "cannot be opened"));
}

/// Reads a level and holds it against its header and what its folder's README says.
static void check_level(const char *path) {
    FILE *file = fopen(path, "r");
    int leafs, clusters, portals;
    assert_non_null(file);
    assert_int_equal(fscanf(file, "PRT2 %d %d %d", &leafs, &clusters, &portals), 3);
    fclose(file);
    enf_portal_graph graph;
    enf_error error = {0};
    if (enf_portal_graph_read(&graph, path, &error)) fail_msg("%s", error.text);
    assert_int_equal(graph.leaf_count, leafs);
    assert_int_equal(graph.cell_count, clusters);
    assert_int_equal(graph.opening_count, portals);
    for (int32_t i = 0; i < portals; i++) {
        int32_t count = graph.opening_corner[i + 1] - graph.opening_corner[i];
        assert_in_range(count, 3, 18);
    }
    enf_portal_graph_find_non_convex(&graph);
    bool is_e2m7 = strstr(path, "e2m7") != NULL;
    assert_int_equal(graph.non_convex_cells, is_e2m7 ? 1 : 0);
    assert_int_equal(graph.first_non_convex_cell, is_e2m7 ? 343 : -1);
    enf_portal_graph_free(&graph);
}

/// The level with its coordinates rounded to six digits, as old compilers do.
static void check_rounded_level(const char *path) {
    enf_portal_graph graph, rounded;
    enf_error error = {0};
    if (enf_portal_graph_read(&graph, path, &error)) fail_msg("%s", error.text);
    char *text = NULL;
    size_t size;
    FILE *file = open_memstream(&text, &size);
    assert_non_null(file);
    fprintf(file, "PRT1\n%d\n%d\n", (int)graph.cell_count, (int)graph.opening_count);
    for (int32_t i = 0; i < graph.opening_count; i++) {
        fprintf(file, "%d %d %d ", (int)(graph.opening_corner[i + 1] - graph.opening_corner[i]),
                (int)graph.opening_cell[i][0], (int)graph.opening_cell[i][1]);
        for (int32_t k = graph.opening_corner[i]; k < graph.opening_corner[i + 1]; k++)
            fprintf(file, "(%g %g %g ) ", graph.corners[k][0], graph.corners[k][1], graph.corners[k][2]);
        fputc('\n', file);
    }
    assert_int_equal(fclose(file), 0);
    if (parse(&rounded, text, &error)) fail_msg("%s, rounded: %s", path, error.text);
    assert_int_equal(rounded.opening_count, graph.opening_count);
    enf_portal_graph_free(&rounded);
    enf_portal_graph_free(&graph);
    free(text);
}

static void the_levels_of_quake_are_read(void **state) {
    (void)state;
    char pattern[1024];
    glob_t levels;
    snprintf(pattern, sizeof pattern, "%s/quake/prt/*.prt", shared_data());
    assert_int_equal(glob(pattern, 0, NULL, &levels), 0);
    for (size_t i = 0; i < levels.gl_pathc; i++) {
        check_level(levels.gl_pathv[i]);
        check_rounded_level(levels.gl_pathv[i]);
    }
    print_message("%zu levels\n", levels.gl_pathc);
    globfree(&levels);
}

static uint64_t next_random(uint64_t *seed) { // splitmix64
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

/// Bytes replaced, cut out and doubled; those of the format itself more often than others.
static void mutated_files_never_crash(void **state) {
    (void)state;
    static const char *const variants[] = {PRT1, PRT2, PRT1_AM};
    static const char likely[] = "0123456789-+.eE() \n\r\tPRTAM";
    uint64_t seed = 1;
    for (int n = 0; n < 30000; n++) {
        char text[512];
        size_t size = strlen(variants[n % 3]);
        memcpy(text, variants[n % 3], size + 1);
        for (int k = n % 5; k >= 0; k--) {
            size_t at = next_random(&seed) % size, other = next_random(&seed) % size;
            switch (next_random(&seed) % 4) {
            case 0:
                text[at] = (char)next_random(&seed);
                break;
            case 1:
                memmove(text + at, text + at + 1, size - at);
                size--;
                break;
            case 2:
                text[at] = text[other];
                break;
            default:
                text[at] = likely[next_random(&seed) % (sizeof likely - 1)];
            }
        }
        LLVMFuzzerTestOneInput((const uint8_t *)text, n % 7 ? size : next_random(&seed) % size);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_variants_give_the_same_cells),
        cmocka_unit_test(white_space_is_free),
        cmocka_unit_test(numbers_are_read_to_the_last_bit),
        cmocka_unit_test(cells_may_be_without_portals),
        cmocka_unit_test(repeated_corners_are_dropped),
        cmocka_unit_test(rounded_windings_are_taken),
        cmocka_unit_test(every_fault_is_told_with_its_line),
        cmocka_unit_test(a_file_cut_anywhere_is_refused),
        cmocka_unit_test(scale_does_not_matter_to_windings),
        cmocka_unit_test(cells_that_are_not_convex_are_counted),
        cmocka_unit_test(gzipped_files_are_read),
        cmocka_unit_test(the_levels_of_quake_are_read),
        cmocka_unit_test(mutated_files_never_crash),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
