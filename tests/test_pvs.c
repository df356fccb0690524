// SPDX-License-Identifier: GPL-3.0-or-later
// Visible sets: the bits, the text and back, the references of Quake's levels; sight lines as text.
#include "visibility/pvs.h"
#include "visibility/sightings.h"
#include "visibility/witness.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>
#include <glob.h>

#include "tests/read_fixture.h"

static enf_pvs new_pvs(int32_t cells) {
    enf_pvs pvs;
    assert_int_equal(enf_pvs_new(&pvs, cells, NULL), ENF_OK);
    return pvs;
}

static enf_status read_text(enf_pvs *pvs, const char *text, int32_t cells, enf_error *error) {
    char path[512];
    fixture_path(path, sizeof path, ".pvs.txt");
    fixture_write(path, text, strlen(text));
    enf_status status = enf_pvs_read(pvs, path, cells, error);
    remove(path);
    return status;
}

static void bits_are_kept_and_counted(void **state) {
    (void)state;
    static const int32_t sizes[] = {0, 1, 63, 64, 65, 129};
    for (size_t n = 0; n < sizeof sizes / sizeof *sizes; n++) {
        int32_t cells = sizes[n];
        enf_pvs pvs = new_pvs(cells);
        assert_int_equal(enf_pvs_pairs(&pvs), cells);
        for (int32_t i = 0; i < cells; i++)
            for (int32_t j = i; j < cells; j += 7) enf_pvs_set(&pvs, i, j);
        int64_t pairs = 0;
        for (int32_t i = 0; i < cells; i++) {
            int32_t seen = 0;
            for (int32_t j = 0; j < cells; j++) {
                assert_int_equal(enf_pvs_get(&pvs, i, j), j >= i && (j - i) % 7 == 0);
                seen += enf_pvs_get(&pvs, i, j);
            }
            assert_int_equal(enf_pvs_seen(&pvs, i), seen);
            pairs += seen;
        }
        assert_int_equal(enf_pvs_pairs(&pvs), pairs);
        assert_true(enf_pvs_mean_seen(&pvs) == (cells ? (double)pairs / cells : 0));
        enf_pvs_free(&pvs);
    }
}

static void what_does_not_fit_into_memory_is_told(void **state) {
    (void)state;
    enf_pvs pvs;
    enf_error error = {0};
    assert_int_equal(enf_pvs_new(&pvs, INT32_MAX, &error), ENF_NO_RESOURCES);
    assert_non_null(strstr(error.text, "the visible sets of 2147483647 cells take"));
    assert_null(pvs.rows);
    enf_pvs_free(&pvs);
}

static void the_text_is_as_the_design_says_and_comes_back(void **state) {
    (void)state;
    enf_pvs pvs = new_pvs(66), back;
    enf_pvs_set(&pvs, 0, 65);
    enf_pvs_set(&pvs, 2, 0);
    enf_pvs_set(&pvs, 2, 64);
    char path[512];
    fixture_path(path, sizeof path, ".pvs.txt");
    assert_int_equal(enf_pvs_write(&pvs, path, NULL), ENF_OK);
    assert_int_equal(enf_pvs_read(&back, path, 66, NULL), ENF_OK);
    char text[64] = "";
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_true(fread(text, 1, 18, file) == 18);
    fclose(file);
    remove(path);
    assert_string_equal(text, "0 65\n1\n0 2 64\n3\n4\n");
    assert_memory_equal(pvs.rows, back.rows, 66 * pvs.row_words * sizeof *pvs.rows);
    enf_pvs_free(&pvs);
    enf_pvs_free(&back);
}

static void a_path_that_cannot_be_written_is_told(void **state) {
    (void)state;
    enf_pvs pvs = new_pvs(3);
    enf_error error = {0};
    assert_int_equal(enf_pvs_write(&pvs, "/nowhere/at/all", &error), ENF_NO_RESOURCES);
    assert_non_null(strstr(error.text, "/nowhere/at/all: can't be written"));
    if (access("/dev/full", W_OK) == 0)
        assert_int_equal(enf_pvs_write(&pvs, "/dev/full", NULL), ENF_NO_RESOURCES);
    enf_pvs_free(&pvs);
}

static void wrong_texts_are_refused_with_their_line(void **state) {
    (void)state;
    static const char *const wrong[][2] = {
        {"", "pvs.txt:1: the file ends before cell 0 of 3"},
        {"0\n0 1\n", "pvs.txt:3: the file ends before cell 2 of 3"},
        {"0\n1\n2\n0\n", "pvs.txt:4: there are more lines than the 3 cells"},
        {"0\n1\n2\n\n", "pvs.txt:4: there are more lines than the 3 cells"},
        {"0\n\n2\n", "pvs.txt:2: cell 1 does not see itself"},
        {"0\n0 2\n2\n", "pvs.txt:2: cell 1 does not see itself"},
        {"0\n1\n0 2 1\n", "pvs.txt:3: the numbers do not ascend"},
        {"0\n1\n1 1 2\n", "pvs.txt:3: the numbers do not ascend"},
        {"0\n1 3\n2\n", "pvs.txt:2: there is no cell 3; they are numbered 0 to 2"},
        {"-1 0\n1\n2\n", "pvs.txt:1: there is no cell -1"},
        {"0,1\n1\n2\n", "pvs.txt:1: the number of a cell should stand here"},
        {"0\n1\nx 2\n", "pvs.txt:3: the number of a cell should stand here"},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        enf_pvs pvs;
        enf_error error = {0};
        enf_status status = read_text(&pvs, wrong[i][0], 3, &error);
        if (status != ENF_BAD_INPUT || !strstr(error.text, wrong[i][1]))
            fail_msg("%s: status %d, \"%s\" instead of \"%s\"", wrong[i][0], status, error.text, wrong[i][1]);
        enf_pvs_free(&pvs);
    }
    enf_pvs pvs;
    assert_int_equal(read_text(&pvs, "0 \t2\r\n 1\r\n0 1 2", 3, NULL), ENF_OK);
    assert_int_equal(enf_pvs_pairs(&pvs), 6);
    enf_pvs_free(&pvs);
}

static void methods_have_names(void **state) {
    (void)state;
    for (int i = 0; i < ENF_METHOD_COUNT; i++) {
        enf_method method = ENF_METHOD_COUNT;
        assert_true(enf_method_find(enf_method_name((enf_method)i), &method));
        assert_int_equal(method, i);
    }
    enf_method method;
    assert_false(enf_method_find("none", &method));
    assert_true(enf_method_find("exact", &method) && method == ENF_METHOD_EXACT);
}

static void witnesses_are_sorted_and_written_to_the_last_bit(void **state) {
    (void)state;
    enf_line lines[] = {{{1, 2, 3}, {0.1, -1e-30, 5}}, {{0, 0, 0}, {1, 1, 1}}, {{4, 4, 4}, {5, 5, 5}}};
    int32_t cells[][2] = {{1, 12}, {1, 2}, {0, 40}};
    char *longer[] = {NULL, "1.0 2.00 3e-1 0.12345678901234567890 5 6", NULL};
    enf_visibility visibility = {
        .witnesses = lines, .long_witnesses = longer, .witness_cells = cells, .witness_count = 3};
    char *text = NULL;
    size_t size;
    FILE *out = open_memstream(&text, &size);
    assert_non_null(out);
    assert_int_equal(enf_witnesses_print(&visibility, out, NULL), ENF_OK);
    assert_int_equal(fclose(out), 0);
    assert_string_equal(text, "0 40 4 4 4 5 5 5\n1 2 1.0 2.00 3e-1 0.12345678901234567890 5 6\n"
                              "1 12 1 2 3 0.10000000000000001 -1.0000000000000001e-30 5\n");
    free(text);
}

static void sightings_are_turned_with_their_lines(void **state) {
    (void)state;
    enf_sightings sightings;
    const enf_line line = {{1, 2, 3}, {4, 5, 6}};
    assert_true(enf_sightings_new(&sightings, 4, true));
    const enf_sighting three = {3, 2}, two = {2, 1}, one = {1, 1};
    assert_true(enf_sightings_add(&sightings, 0, &three, &line));
    assert_true(enf_sightings_add_long(&sightings, 0, &two, NULL, "1 2 3 -4.5 5e-3 66"));
    assert_true(enf_sightings_add(&sightings, 0, &one, NULL));
    assert_true(enf_sightings_symmetrise(&sightings) && enf_sightings_symmetrise(&sightings));
    for (int32_t i = 1; i < 4; i++) {
        assert_int_equal(sightings.cells[i].count, 1);
        assert_int_equal(sightings.cells[i].sightings[0].cell, 0);
    }
    assert_string_equal(sightings.cells[2].long_lines[0], "-4.5 5e-3 66 1 2 3");
    assert_true(sightings.cells[3].lines[0].from[0] == 4 && sightings.cells[3].lines[0].to[2] == 3);
    assert_null(sightings.cells[1].long_lines[0]);
    enf_sightings_free(&sightings);
}

static void the_references_of_quake_are_read(void **state) {
    (void)state;
#ifdef ENFILADE_SHARED_DIR
    glob_t levels;
    if (glob(ENFILADE_SHARED_DIR "/quake/prt/*.prt", 0, NULL, &levels) == 0) {
        for (size_t i = 0; i < levels.gl_pathc; i++) {
            char path[4096];
            const char *level = levels.gl_pathv[i];
            snprintf(path, sizeof path, "%.*s.pvs.txt.gz", (int)strlen(level) - 4, level);
            enf_portal_graph graph;
            enf_pvs pvs;
            enf_error error = {0};
            if (enf_portal_graph_read(&graph, level, &error)) fail_msg("%s", error.text);
            if (enf_pvs_read(&pvs, path, graph.cell_count, &error)) fail_msg("%s", error.text);
            assert_true(enf_pvs_pairs(&pvs) > graph.cell_count);
            enf_pvs_free(&pvs);
            assert_int_equal(enf_pvs_read(&pvs, path, graph.cell_count - 1, &error), ENF_BAD_INPUT);
            enf_pvs_free(&pvs);
            enf_portal_graph_free(&graph);
        }
        globfree(&levels);
        return;
    }
#endif
    print_message("the shared portal files are absent: skipped\n");
    skip();
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bits_are_kept_and_counted),
        cmocka_unit_test(what_does_not_fit_into_memory_is_told),
        cmocka_unit_test(the_text_is_as_the_design_says_and_comes_back),
        cmocka_unit_test(a_path_that_cannot_be_written_is_told),
        cmocka_unit_test(wrong_texts_are_refused_with_their_line),
        cmocka_unit_test(methods_have_names),
        cmocka_unit_test(witnesses_are_sorted_and_written_to_the_last_bit),
        cmocka_unit_test(sightings_are_turned_with_their_lines),
        cmocka_unit_test(the_references_of_quake_are_read),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
