// SPDX-License-Identifier: GPL-3.0-or-later
// The checker passes worlds that the builder makes, and names the right invariant for every way of breaking
// one. Worlds are broken in their file's bytes, with the checksums made right again.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/hash.h"
#include "build/build.h"
#include "build/check.h"
#include "build/gen.h"
#include "build/write.h"
#include "check_breakers.h"
#include "format/read.h"

// ---- Worlds in memory ----

static void temporary_name(char path[64], const char *suffix) {
    snprintf(path, 64, "/tmp/enfilade-check-XXXXXX%s", suffix);
    int file = mkstemps(path, (int)strlen(suffix));
    assert_true(file >= 0);
    close(file);
}

static void read_bytes(const char *path, world *w) {
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    assert_int_equal(fseek(file, 0, SEEK_END), 0);
    long size = ftell(file);
    assert_true(size > 0);
    rewind(file);
    w->size = (size_t)size;
    w->bytes = malloc(w->size);
    assert_non_null(w->bytes);
    assert_int_equal(fread(w->bytes, 1, w->size, file), w->size);
    fclose(file);
}

/// A generated world, compiled and written.
static void make_world(world *w, const char *name, const char *setting, const enf_build_options *options,
                       const char *text) {
    char soup_path[64], world_path[64];
    enf_error error = {0};
    enf_build build = {0};
    temporary_name(soup_path, ".obj");
    temporary_name(world_path, ".enf");
    FILE *file = fopen(soup_path, "w");
    assert_non_null(file);
    assert_int_equal(enf_gen_write(name, &setting, setting ? 1 : 0, file, &error), ENF_OK);
    fclose(file);
    assert_int_equal(enf_soup_read(&build.soup, soup_path, &error), ENF_OK);
    enf_status status = enf_build_run(&build, options, &error);
    if (status != ENF_OK) fail_msg("%s", error.text);
    assert_int_equal(enf_build_write(&build, text, world_path, &error), ENF_OK);
    enf_build_free(&build);
    read_bytes(world_path, w);
    unlink(soup_path);
    unlink(world_path);
    if (enf_file_read(&w->view, w->bytes, w->size, false, &error) != ENF_OK) fail_msg("%s", error.text);
}

static void world_free(world *w) {
    free(w->bytes);
    memset(w, 0, sizeof *w);
}

static enf_build_options default_options(void) {
    return (enf_build_options){.clean = {.weld = -1, .plane_tolerance = -1}, .threads = 1};
}

static void copy_world(const world *from, world *to) {
    to->size = from->size;
    to->bytes = malloc(from->size);
    assert_non_null(to->bytes);
    memcpy(to->bytes, from->bytes, from->size);
    assert_int_equal(enf_file_read(&to->view, to->bytes, to->size, false, NULL), ENF_OK);
}

/// Makes all checksums right for the bytes as they are.
static void sign_world(world *w) {
    enf_file_header header;
    memcpy(&header, w->bytes, sizeof header);
    for (uint32_t s = 0; s < header.section_count; s++) {
        uint8_t *at = w->bytes + header.table_offset + (size_t)s * header.entry_size;
        enf_file_section section;
        memcpy(&section, at, sizeof section);
        section.checksum = enf_hash64(w->bytes + section.offset, section.size, 0);
        memcpy(at, &section, sizeof section);
    }
    header.table_checksum =
        enf_hash64(w->bytes + header.table_offset, (size_t)header.section_count * header.entry_size, 0);
    memcpy(w->bytes, &header, sizeof header);
    header.header_checksum = enf_hash64(w->bytes, offsetof(enf_file_header, header_checksum), 0);
    memcpy(w->bytes, &header, sizeof header);
}

// ---- Tests ----

/// The world that is broken: rooms with cut tetrahedra, several cells, portals and spawn points.
static world model;

static int make_model(void **unused) {
    (void)unused;
    enf_build_options options = default_options();
    make_world(&model, "four-rooms", NULL, &options, "{\"keep\": \"auto\"}");
    return 0;
}

static int free_model(void **unused) {
    (void)unused;
    world_free(&model);
    return 0;
}

static void assert_passes(const world *w) {
    enf_check_report report;
    enf_error error = {0};
    enf_status status = enf_world_check(&w->view, &report, &error);
    if (status != ENF_OK) fail_msg("%s", error.text);
    assert_int_equal(report.broken_count, 0);
    assert_string_equal(report.first, "");
    for (int i = 0; i < report.row_count; i++) {
        assert_true(report.rows[i].held);
        assert_false(report.rows[i].skipped);
    }
}

static void built_worlds_pass(void **unused) {
    (void)unused;
    static const char *const worlds[][2] = {{"four-rooms", NULL},
                                            {"four-rooms", "rotate=10,20,30"},
                                            {"four-rooms-distorted", NULL},
                                            {"four-rooms-tessellated", "noise=0.01"},
                                            {"furnished", "scale=-1,1,1"},
                                            {"cavern", "scale=0.001,3,1"},
                                            {"post", "translate=1000,2,1e6"}};
    for (size_t i = 0; i < sizeof worlds / sizeof *worlds; i++) {
        world w = {0};
        enf_build_options options = default_options();
        options.keep = (enf_keep)(i % 3); // auto, all, outside
        static const char *const texts[] = {"{\"keep\":\"auto\"}", "{\"keep\":\"all\"}",
                                            "{\"keep\":\"outside\"}"};
        make_world(&w, worlds[i][0], worlds[i][1], &options, texts[i % 3]);
        assert_passes(&w);
        world_free(&w);
    }
}

static void worlds_pass_however_far_they_are_decimated(void **unused) {
    (void)unused;
    for (int i = 0; i < 3; i++) {
        world w = {0};
        enf_build_options options = default_options();
        options.stop.rule = i == 0 ? ENF_STOP_CELLS : ENF_STOP_WEIGHT;
        options.stop.cells = 1;
        options.stop.weight = i == 1 ? 0 : 3;
        make_world(&w, "furnished", NULL, &options, NULL);
        assert_passes(&w);
        world_free(&w);
    }
}

/// Sets *named to the row that the checker names for the world broken in the `index`-th way, empty if it
/// names none or the reader refuses the world already. False if there are no more ways.
static bool broken_row(breaker *breaks, int index, bool sign, char named[64]) {
    world w = {0};
    enf_check_report report;
    copy_world(&model, &w);
    bool more = breaks(&w, index);
    if (sign) sign_world(&w);
    named[0] = 0;
    if (more && enf_file_read(&w.view, w.bytes, w.size, !sign, NULL) == ENF_OK) {
        enf_error error = {0};
        enf_status status = enf_world_check(&w.view, &report, &error);
        assert_int_equal(status, report.broken_count > 0 ? ENF_CHECK_FAILED : ENF_OK);
        assert_string_equal(error.text, report.first);
        char *end = strchr(report.first, ':');
        if (end) snprintf(named, 64, "%.*s", (int)(strchr(end + 1, ':') - report.first), report.first);
    }
    world_free(&w);
    return more;
}

static void every_broken_invariant_is_named(void **unused) {
    (void)unused;
    for (int k = 0; k < check_kind_count; k++) {
        char named[64], last[64] = "";
        bool found = false;
        for (int i = 0; !found && broken_row(check_kinds[k].breaks, i,
                                             strcmp(check_kinds[k].row, "file: checksums") != 0, named);
             i++) {
            found = strcmp(named, check_kinds[k].row) == 0;
            memcpy(last, named, sizeof last);
        }
        if (!found) fail_msg("kind %d: expected '%s' to break, found '%s'", k, check_kinds[k].row, last);
    }
}

static void every_invariant_has_a_way_to_break_it(void **unused) {
    (void)unused;
    enf_check_report report;
    assert_int_equal(enf_world_check(&model.view, &report, NULL), ENF_OK);
    assert_true(report.row_count < ENF_CHECK_ROWS_MAX);
    for (int i = 0; i < report.row_count; i++) {
        int k = 0;
        while (k < check_kind_count && strcmp(check_kinds[k].row, report.rows[i].name) != 0) k++;
        if (k == check_kind_count) fail_msg("nothing breaks '%s'", report.rows[i].name);
    }
}

static void a_world_without_its_exact_part_is_refused(void **unused) {
    (void)unused;
    enf_check_report report;
    enf_error error = {0};
    enf_file_view view = model.view;
    view.has_exact = false;
    assert_int_equal(enf_world_check(&view, &report, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "exact part"));
}

/// Any change of any number that the reader lets pass must not crash the checker.
static void random_damage_does_no_harm(void **unused) {
    (void)unused;
    uint64_t state = 7;
    const char *text = getenv("ENFILADE_TEST_SCALE");
    int count = (int)ceil(1500 * (text && atof(text) > 0 ? atof(text) : 1)), checked = 0;
    printf("seed %llu\n", (unsigned long long)state);
    for (int i = 0; i < count; i++) {
        world w = {0};
        copy_world(&model, &w);
        state = enf_hash_mix(state + (uint64_t)i);
        const enf_file_section *section = &w.view.sections[state % w.view.header->section_count];
        for (int k = 0; k < 3 && section->size >= 4; k++) {
            state = enf_hash_mix(state + 1);
            int32_t value;
            uint8_t *at = w.bytes + section->offset + state / 16 % (section->size / 4) * 4;
            memcpy(&value, at, sizeof value);
            value = state % 4 == 0   ? value + 1
                    : state % 4 == 1 ? value - 1
                    : state % 4 == 2 ? value ^ 1
                                     : (int32_t)(state >> 40);
            memcpy(at, &value, sizeof value);
        }
        sign_world(&w);
        if (enf_file_read(&w.view, w.bytes, w.size, false, NULL) == ENF_OK && w.view.has_exact) {
            enf_check_report report;
            enf_status status = enf_world_check(&w.view, &report, NULL);
            assert_true(status == ENF_OK || status == ENF_CHECK_FAILED);
            checked++;
        }
        world_free(&w);
    }
    assert_true(checked > count / 20);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(built_worlds_pass),
        cmocka_unit_test(worlds_pass_however_far_they_are_decimated),
        cmocka_unit_test(every_broken_invariant_is_named),
        cmocka_unit_test(every_invariant_has_a_way_to_break_it),
        cmocka_unit_test(a_world_without_its_exact_part_is_refused),
        cmocka_unit_test(random_damage_does_no_harm),
    };
    return cmocka_run_group_tests(tests, make_model, free_model);
}
