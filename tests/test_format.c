// SPDX-License-Identifier: GPL-3.0-or-later
// The file: what is written comes back, and nothing that is wrong with a file gets past the opener.
#include "run_worlds.h"
#include "world_fixture.h"

#include "base/hash.h"
#include "enfilade/run.h"
#include "format/pvs_row.h"
#include "format/read.h"
#include "format/sections.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static uint64_t next_random(uint64_t *seed) { // splitmix64
    uint64_t z = *seed += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

static enf_status open_copy(const unsigned char *bytes, size_t size, enf_error *error) {
    unsigned char *copy = malloc(size ? size : 1);
    assert_non_null(copy);
    memcpy(copy, bytes, size);
    enf_world *world;
    enf_status status = enf_world_open_memory(&world, copy, size, NULL, error);
    assert_true((status == ENF_OK) == (world != NULL));
    enf_world_close(world);
    free(copy);
    return status;
}

static enf_file_section *section_of(unsigned char *file, const char *tag) {
    enf_file_header *header = (void *)file;
    enf_file_section *sections = (void *)(file + header->table_offset);
    for (uint32_t i = 0; i < header->section_count; i++) {
        if (strncmp(sections[i].tag, tag, 8) == 0) return &sections[i];
    }
    fail_msg("no section %s", tag);
    return NULL;
}

static void every_array_comes_back_as_it_was(void **state) {
    fixture_saved *s = *state;
    enf_build_image image;
    enf_file_view view;
    enf_error error = {0};
    assert_int_equal(enf_build_image_make(&image, &s->fixture.build, "{}", &error), ENF_OK);
    assert_int_equal(enf_file_read(&view, s->bytes, s->size, false, &error), ENF_OK);
    int compared = 0;
    for (int i = 0; i < enf_section_spec_count; i++) {
        const enf_section_spec *spec = &enf_section_specs[i];
        if (strcmp(spec->tag, "STRINGS") == 0 || strcmp(spec->tag, "PROVEN") == 0 ||
            strcmp(spec->tag, "LEAK") == 0 || strcmp(spec->tag, "TURN") == 0 || spec->part == ENF_PART_PVS)
            continue;
        int64_t count = enf_view_count(&view, spec->dimension);
        if (strcmp(spec->tag, "GROUP") && strcmp(spec->tag, "MATERIAL"))
            assert_memory_equal(enf_view_array(&view, spec), enf_view_array(&image.view, spec),
                                (size_t)(count + spec->extra) * spec->element_size);
        assert_int_equal(count, enf_view_count(&image.view, spec->dimension));
        compared++;
    }
    assert_true(compared > 50);
    assert_true(view.has_exact && view.has_geometry);
    assert_int_equal(view.point_count, 27);
    assert_int_equal(view.tetrahedron_count, 48);
    assert_int_equal(view.fine_count, 49);
    assert_int_equal(view.box_count, 11); // six leaves
    enf_build_image_free(&image);
}

static void names_and_options_come_back(void **state) {
    fixture_saved *s = *state;
    enf_world *world;
    assert_int_equal(enf_world_open_memory(&world, s->bytes, s->size, NULL, NULL), ENF_OK);
    enf_world_info info;
    enf_world_get_info(world, &info);
    assert_string_equal(info.options, "{\"stop\":\"auto\"}");
    assert_string_equal(enf_world_string(world, enf_world_file(world)->material_names[0]), "stone");
    assert_string_equal(enf_world_string(world, enf_world_file(world)->group_names[0]), "");
    assert_string_equal(enf_world_string(world, UINT32_MAX), "");
    enf_world_close(world);
}

static void the_same_world_gives_the_same_bytes(void **state) {
    fixture_saved *s = *state;
    size_t size;
    fixture again;
    fixture_make(&again, 2, NULL);
    again.build.seconds = 12.5; // times and memory are not in the file
    again.build.peak_bytes = 77;
    unsigned char *bytes = fixture_save(&again, &size);
    assert_int_equal(size, s->size);
    assert_memory_equal(bytes, s->bytes, size);
    free(bytes);
    fixture_free(&again);
}

static void sections_are_aligned_and_padding_is_zero(void **state) {
    fixture_saved *s = *state;
    const enf_file_header *header = (const void *)s->bytes;
    const enf_file_section *sections = (const void *)(s->bytes + header->table_offset);
    uint64_t end = header->table_offset + header->section_count * sizeof *sections;
    for (uint32_t i = 0; i < header->section_count; i++) {
        assert_int_equal(sections[i].offset % ENF_FILE_ALIGNMENT, 0);
        for (; end < sections[i].offset; end++) assert_int_equal(s->bytes[end], 0);
        end = sections[i].offset + sections[i].size;
    }
    assert_int_equal(end, s->size);
}

static void neighbours_share_the_face_between_them(void **state) {
    fixture_saved *s = *state;
    enf_file_view view;
    assert_int_equal(enf_file_read(&view, s->bytes, s->size, false, NULL), ENF_OK);
    int hull = 0;
    for (int32_t i = 0; i < view.tetrahedron_count; i++) {
        for (int k = 0; k < 4; k++) {
            int32_t next = view.tetrahedron_next[i][k];
            if (next < 0) {
                hull++;
                continue;
            }
            for (int c = 0; c < 4; c++) {
                bool shared = false;
                for (int n = 0; n < 4; n++)
                    shared = shared || view.tetrahedra[next][n] == view.tetrahedra[i][c];
                assert_true(shared == (c != k));
            }
        }
    }
    assert_int_equal(hull, 6 * 4 * 2);
}

static void a_turn_is_kept_must_be_known_and_be_a_rotation(void **state) {
    (void)state;
    const enf_frame frame = {1, {0, 1, 2}, {1, 1, 1}, 1, true, {{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}}};
    fixture f;
    size_t size;
    fixture_make(&f, 2, &frame);
    unsigned char *bytes = fixture_save(&f, &size);
    enf_file_view view;
    assert_int_equal(enf_file_read(&view, bytes, size, false, NULL), ENF_OK);
    assert_non_null(view.turn);
    assert_memory_equal(view.turn->rows, frame.turn, sizeof frame.turn);
    for (uint32_t i = 0; i < view.header->section_count; i++)
        assert_int_equal(view.sections[i].flags, strcmp(view.sections[i].tag, "TURN") == 0);
    static const double wrong[] = {0.6000001, NAN, INFINITY, -0.6};
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        enf_error error = {0};
        memcpy(bytes + section_of(bytes, "TURN")->offset, &wrong[i], sizeof wrong[i]);
        fixture_fix_checksums(bytes);
        assert_int_equal(open_copy(bytes, size, &error), ENF_BAD_INPUT);
        assert_non_null(strstr(error.text, "TURN"));
    }
    free(bytes);
    fixture_free(&f);
}

static void rows_come_back_from_their_code(void **state) {
    (void)state;
    uint8_t row[700], coded[2 * sizeof row], back[sizeof row];
    uint32_t random = 1;
    for (int32_t cells = 1; cells < 8 * (int32_t)sizeof row; cells += cells / 3 + 1) {
        size_t bytes = enf_pvs_row_bytes(cells);
        for (int density = 0; density < 4; density++) {
            for (size_t i = 0; i < bytes; i++) {
                random = random * 1664525 + 1013904223;
                row[i] = random >> 24 >> density * 2 && density < 3 ? (uint8_t)(random >> 16) : 0;
            }
            row[bytes - 1] &= (uint8_t)(cells % 8 ? (1 << cells % 8) - 1 : 255);
            size_t size = enf_pvs_row_encode(row, bytes, coded);
            assert_true(size <= 2 * bytes);
            assert_true(enf_pvs_row_decode(coded, size, back, cells));
            assert_memory_equal(row, back, bytes);
            assert_true(enf_pvs_row_decode(coded, size, NULL, cells));
            assert_false(enf_pvs_row_decode(coded, size - 1, NULL, cells));
            assert_false(enf_pvs_row_decode(coded, size, NULL, cells + 8));
        }
    }
}

static void a_visible_set_is_kept_and_looked_at(void **state) {
    fixture_saved *s = *state;
    enf_build_image image;
    enf_error error = {0};
    assert_int_equal(enf_build_image_make(&image, &s->fixture.build, "{}", &error), ENF_OK);
    assert_int_equal(image.view.cell_count, 2);
    const enf_file_pvs pvs = {.method = ENF_FILE_PVS_EXACT, .pairs = 4};
    static const struct {
        int64_t offsets[3];
        uint8_t rows[4];
        uint32_t method;
        enf_status status;
    } cases[] = {
        {{0, 1, 2}, {3, 3}, ENF_FILE_PVS_EXACT, ENF_OK},
        {{0, 2, 3}, {0, 1, 2}, ENF_FILE_PVS_REACH, ENF_OK},
        {{0, 1, 2}, {3, 7}, ENF_FILE_PVS_EXACT, ENF_BAD_INPUT},       // a third cell
        {{0, 1, 2}, {3, 0}, ENF_FILE_PVS_EXACT, ENF_BAD_INPUT},       // a zero without its number
        {{0, 2, 4}, {0, 2, 0, 1}, ENF_FILE_PVS_EXACT, ENF_BAD_INPUT}, // two zeros
        {{0, 2, 4}, {0, 0, 0, 1}, ENF_FILE_PVS_EXACT, ENF_BAD_INPUT}, // no zeros
        {{0, 2, 2}, {3, 3}, ENF_FILE_PVS_EXACT, ENF_BAD_INPUT},       // too long, and too short
        {{0, 2, 1}, {3, 3}, ENF_FILE_PVS_EXACT, ENF_BAD_INPUT},
        {{0, 1, 2}, {3, 3}, ENF_FILE_PVS_METHODS, ENF_BAD_INPUT},
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        enf_file_pvs head = pvs;
        head.method = cases[i].method;
        image.view.pvs = &head;
        image.view.pvs_offset = cases[i].offsets;
        image.view.pvs_rows = cases[i].rows;
        image.view.pvs_byte_count = cases[i].offsets[2];
        if (enf_view_check(&image.view, &error) != cases[i].status) fail_msg("case %zu: %s", i, error.text);
    }
    enf_build_image_free(&image);
}

static void portals_face_the_cell_they_lead_from(void **state) {
    (void)state;
    const enf_frame frames[] = {
        {0.25, {0, 1, 2}, {1, 1, 1}, 1, false, {{0}}},
        {2, {1, 2, 0}, {-1, 1, -1}, 1, false, {{0}}},
        {1, {0, 1, 2}, {1, -1, 1}, -1, false, {{0}}},
        {1, {1, 0, 2}, {1, 1, 1}, -1, false, {{0}}},
        {1, {1, 2, 0}, {1, 1, -1}, -1, true, {{0.6, 0.8, 0}, {-0.8, 0.6, 0}, {0, 0, 1}}}};
    for (size_t i = 0; i < sizeof frames / sizeof *frames; i++) {
        fixture f;
        enf_build_image image;
        fixture_make(&f, 4, &frames[i]);
        assert_int_equal(enf_build_image_make(&image, &f.build, NULL, NULL), ENF_OK);
        const enf_file_view *view = &image.view;
        assert_int_equal(view->portal_count, 2);
        for (int32_t p = 0; p < 2; p++) {
            const enf_file_portal *portal = &view->portals[p];
            assert_int_equal(portal->from, p);
            const enf_file_cell *from = &view->cells[portal->from];
            double middle[3];
            for (int a = 0; a < 3; a++) middle[a] = (from->box_min[a] + from->box_max[a]) / 2;
            assert_int_equal(portal->polygon_count, 16);
            for (int32_t k = 0; k < portal->polygon_count; k++) {
                const enf_file_portal_polygon *polygon = &view->portal_polygons[portal->polygon_first + k];
                const double(*v)[3] = view->portal_vertices + polygon->vertex_first;
                double side = polygon->plane[3], turn = 0;
                for (int a = 0; a < 3; a++) {
                    int b = (a + 1) % 3, c = (a + 2) % 3;
                    side += polygon->plane[a] * middle[a];
                    turn += polygon->plane[a] * ((v[1][b] - v[0][b]) * (v[2][c] - v[0][c]) -
                                                 (v[1][c] - v[0][c]) * (v[2][b] - v[0][b]));
                }
                assert_true(side > 0);
                assert_true(turn > 0); // counter-clockwise seen from where the plane is positive
                assert_true(turn / 2 > 0.999 * polygon->area && turn / 2 < 1.001 * polygon->area);
            }
        }
        enf_build_image_free(&image);
        fixture_free(&f);
    }
}

static void triangles_keep_the_inputs_corners_and_cells_list_what_they_see(void **state) {
    fixture_saved *s = *state;
    enf_file_view view;
    assert_int_equal(enf_file_read(&view, s->bytes, s->size, false, NULL), ENF_OK);
    assert_int_equal(view.triangle_count, 8 + 2); // the wall, the detail
    for (int32_t i = 0; i < 8; i++) {
        assert_int_equal(view.triangles[i].mesh_polygon, i);
        assert_int_equal(view.triangles[i].cell, -1);
        const enf_soup *soup = &s->fixture.build.soup;
        for (int k = 0; k < 3; k++)
            assert_int_equal(view.triangles[i].point[k], soup->corner_point[soup->polygon_corner[i] + k]);
    }
    assert_int_equal(view.triangles[8].mesh_polygon, -1);
    assert_int_equal(view.triangles[8].cell, 0);
    for (int32_t c = 0; c < view.cell_count; c++) {
        int detail = 0;
        for (int64_t k = 0; k < view.cells[c].triangle_count; k++) {
            int32_t triangle = view.cell_triangles[view.cells[c].triangle_first + k];
            if (k) assert_true(triangle > view.cell_triangles[view.cells[c].triangle_first + k - 1]);
            detail += triangle >= 8;
        }
        assert_int_equal(detail, 2); // it reaches to the portal, so both cells hold it
    }
    double volume = view.cells[0].volume + view.cells[1].volume;
    assert_true(volume > 3.999 && volume < 4.001); // half of (2 * 4 steps * 1/4)^3
}

/// Bytes of padding between sections mean nothing; any other change must be noticed.
static void every_changed_byte_is_noticed(void **state) {
    fixture_saved *s = *state;
    enf_file_view view;
    assert_int_equal(enf_file_read(&view, s->bytes, s->size, false, NULL), ENF_OK);
    unsigned char *copy = malloc(s->size), *covered = calloc(s->size, 1);
    assert_non_null(copy);
    assert_non_null(covered);
    uint64_t table_end = view.header->table_offset + view.header->section_count * sizeof *view.sections;
    memset(covered, 1, table_end);
    for (uint32_t i = 0; i < view.header->section_count; i++)
        memset(covered + view.sections[i].offset, 1, view.sections[i].size);
    memcpy(copy, s->bytes, s->size);
    for (size_t i = 0; i < s->size; i++) {
        copy[i] ^= (unsigned char)(1u << i % 8);
        enf_world *world;
        enf_error error = {0};
        enf_status status = enf_world_open_memory(&world, copy, s->size, NULL, &error);
        // A newer minor version would open; its checksum tells that it is damage.
        assert_int_equal(status, covered[i] ? ENF_BAD_INPUT : ENF_OK);
        if (status) assert_true(error.text[0] != 0);
        enf_world_close(world);
        copy[i] = s->bytes[i];
    }
    free(copy);
    free(covered);
}

static void every_truncation_is_refused(void **state) {
    fixture_saved *s = *state;
    enf_error error;
    for (size_t size = 0; size < s->size; size += size < 4096 ? 1 : 37)
        assert_int_equal(open_copy(s->bytes, size, &error), ENF_BAD_INPUT);
    assert_int_equal(open_copy(s->bytes, s->size, &error), ENF_OK);
}

static void truncation_says_so(void **state) {
    fixture_saved *s = *state;
    enf_error error;
    assert_int_equal(open_copy(s->bytes, s->size - 1, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "incomplete"));
    assert_int_equal(open_copy((const unsigned char *)"v 0 0 0\n", 8, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "not a world file"));
}

static void newer_minor_versions_open_and_newer_major_ones_do_not(void **state) {
    fixture_saved *s = *state;
    enf_file_header *header = (void *)s->bytes;
    enf_error error;
    header->minor = 9;
    fixture_fix_checksums(s->bytes);
    assert_int_equal(open_copy(s->bytes, s->size, &error), ENF_OK);
    header->major = ENF_FILE_MAJOR + 1;
    fixture_fix_checksums(s->bytes);
    assert_int_equal(open_copy(s->bytes, s->size, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "newer program"));
    header->major = ENF_FILE_MAJOR;
    header->minor = ENF_FILE_MINOR;
    fixture_fix_checksums(s->bytes);
}

static void unknown_sections_are_skipped_unless_they_must_be_known(void **state) {
    fixture_saved *s = *state;
    enf_error error;
    unsigned char *copy = malloc(s->size);
    assert_non_null(copy);
    memcpy(copy, s->bytes, s->size);
    // Renaming one geometry section breaks the part; renaming all of them drops it.
    memcpy(section_of(copy, "RNORMAL")->tag, "FUTURE\0", 8);
    fixture_fix_checksums(copy);
    assert_int_equal(open_copy(copy, s->size, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, "RNORMAL is missing"));
    for (int i = 0; i < enf_section_spec_count; i++) {
        const enf_section_spec *spec = &enf_section_specs[i];
        if (spec->part != ENF_PART_GEOMETRY || strcmp(spec->tag, "RNORMAL") == 0) continue;
        enf_file_section *section = section_of(copy, spec->tag);
        section->tag[0] = (char)('a' + i % 26);
    }
    fixture_fix_checksums(copy);
    assert_int_equal(open_copy(copy, s->size, &error), ENF_OK);
    section_of(copy, "FUTURE")->flags = ENF_FILE_MUST_KNOW;
    fixture_fix_checksums(copy);
    assert_int_equal(open_copy(copy, s->size, &error), ENF_BAD_INPUT);
    free(copy);
}

static void hostile_table_entries_are_refused(void **state) {
    fixture_saved *s = *state;
    const uint64_t values[] = {1,
                               8,
                               15,
                               0x7fffffff,
                               UINT64_C(0x80000000),
                               UINT64_C(1) << 60,
                               UINT64_C(1) << 61,
                               UINT64_MAX - 15,
                               UINT64_MAX};
    unsigned char *copy = malloc(s->size);
    assert_non_null(copy);
    memcpy(copy, s->bytes, s->size);
    enf_file_header *header = (void *)copy;
    enf_file_section *sections = (void *)(copy + header->table_offset);
    for (uint32_t i = 0; i < header->section_count; i++) {
        enf_file_section good = sections[i];
        uint64_t *const fields[] = {&sections[i].offset, &sections[i].size, &sections[i].count};
        for (int field = 0; field < 3; field++) {
            for (size_t v = 0; v < sizeof values / sizeof *values; v++) {
                if (*fields[field] == values[v]) continue;
                *fields[field] = values[v];
                enf_file_view view;
                uint64_t table_checksum = header->table_checksum, header_checksum = header->header_checksum;
                header->table_checksum = enf_hash64(sections, header->section_count * sizeof *sections, 0);
                header->header_checksum = enf_hash64(header, offsetof(enf_file_header, header_checksum), 0);
                assert_int_equal(enf_file_read(&view, copy, s->size, true, NULL), ENF_BAD_INPUT);
                header->table_checksum = table_checksum;
                header->header_checksum = header_checksum;
                LLVMFuzzerTestOneInput(copy, s->size); // repairs the table's checksum
                sections[i] = good;
            }
        }
        // Size and count that agree with each other but not with the rest of the world.
        sections[i].count += 1;
        sections[i].size += sections[i].element_size;
        LLVMFuzzerTestOneInput(copy, s->size);
        sections[i].offset = 0;
        LLVMFuzzerTestOneInput(copy, s->size);
        sections[i] = good;
    }
    free(copy);
}

/// Opens with a table whose checksums are right, whatever it says. Section checksums are left alone.
static enf_status read_with_table(unsigned char *file, size_t size) {
    enf_file_header *header = (void *)file;
    const enf_file_section *sections = (void *)(file + header->table_offset);
    header->table_checksum = enf_hash64(sections, header->section_count * sizeof *sections, 0);
    header->header_checksum = enf_hash64(header, offsetof(enf_file_header, header_checksum), 0);
    enf_file_view view;
    return enf_file_read(&view, file, size, true, NULL);
}

static void sections_that_overlap_or_stick_out_are_refused(void **state) {
    fixture_saved *s = *state;
    unsigned char *copy = malloc(s->size);
    assert_non_null(copy);
    memcpy(copy, s->bytes, s->size);
    enf_file_section *last = section_of(copy, "PORTSIDE");
    last->offset += 16; // one alignment step beyond the end of the file
    assert_int_equal(read_with_table(copy, s->size), ENF_BAD_INPUT);
    last->offset -= 16;
    assert_int_equal(read_with_table(copy, s->size), ENF_OK);
    last->offset = section_of(copy, "PORTPLAN")->offset; // the bytes of another section
    assert_int_equal(read_with_table(copy, s->size), ENF_BAD_INPUT);
    free(copy);
}

/// Random words of random sections become numbers that hurt, with correct checksums. The world opens or not;
/// if it does, everything in it can be used.
static void hostile_numbers_never_crash(void **state) {
    fixture_saved *s = *state;
    uint64_t seed = 20261122;
    print_message("seed %llu\n", (unsigned long long)seed);
    unsigned char *copy = malloc(s->size);
    assert_non_null(copy);
    memcpy(copy, s->bytes, s->size);
    const enf_file_header *header = (const void *)copy;
    const enf_file_section *sections = (const void *)(copy + header->table_offset);
    int refused = 0, opened = 0;
    for (uint32_t i = 0; i < header->section_count; i++) {
        for (int round = 0; round < 60 && sections[i].size >= 4; round++) {
            const uint32_t nasty[] = {0,
                                      1,
                                      UINT32_MAX,
                                      UINT32_MAX - 1,
                                      0x7fffffff,
                                      0x80000000,
                                      0x7ff00000,
                                      0x7ff80001,
                                      0xfff00000,
                                      0x7fc00000,
                                      (uint32_t)next_random(&seed),
                                      27,
                                      48,
                                      49};
            size_t word = next_random(&seed) % (sections[i].size / 4);
            unsigned char *at = copy + sections[i].offset + 4 * word;
            memcpy(at, &nasty[next_random(&seed) % (sizeof nasty / sizeof *nasty)], 4);
            LLVMFuzzerTestOneInput(copy, s->size); // the second opening skips the section's checksum
            enf_file_view view;
            if (enf_file_read(&view, copy, s->size, true, NULL))
                refused++;
            else
                opened++;
            memcpy(at, s->bytes + (at - copy), 4);
        }
    }
    assert_true(refused > 500); // the checks behind the checksums do work
    assert_true(opened > 100);
    free(copy);
}

/// Damaged bytes and short files, past the checksums: errors, or worlds that answer, whole and lazily. One in
/// `step` bytes (all of them with ENFILADE_TEST_SCALE=40).
static void expect_answers(unsigned char *bytes, size_t size, size_t step, size_t first) {
    enf_file_header *header = (void *)bytes;
    for (size_t i = first; i < size; i += step) {
        bytes[i] ^= (unsigned char)(1u << (i / step + i) % 8);
        LLVMFuzzerTestOneInput(bytes, size);
        bytes[i] ^= (unsigned char)(1u << (i / step + i) % 8);
    }
    uint64_t whole = header->file_size;
    for (size_t i = first; i < size; i += step) LLVMFuzzerTestOneInput(bytes, i);
    assert_int_equal(header->file_size, whole);
    assert_int_equal(open_copy(bytes, size, NULL), ENF_OK);
}

static void damaged_bytes_give_errors_or_answers(void **state) {
    fixture_saved *s = *state;
    const char *text = getenv("ENFILADE_TEST_SCALE");
    double scale = text && atof(text) > 0 ? atof(text) : 1;
    size_t step = scale >= 40 ? 1 : (size_t)(40 / scale);
    size_t first = (size_t)getpid() % step;
    print_message("byte %zu, then every %zuth\n", first, step);
    expect_answers(s->bytes, s->size, step, first);
    run_world grid = run_world_grid(2, false, 3); // with a visible set
    expect_answers(grid.bytes, grid.size, step, first);
    run_world_free(&grid);
}

static void expect_refusal(fixture_saved *s, const char *tag, size_t offset, int32_t value) {
    unsigned char *copy = malloc(s->size);
    assert_non_null(copy);
    memcpy(copy, s->bytes, s->size);
    memcpy(copy + section_of(copy, tag)->offset + offset, &value, sizeof value);
    fixture_fix_checksums(copy);
    enf_error error;
    assert_int_equal(open_copy(copy, s->size, &error), ENF_BAD_INPUT);
    if (!strstr(error.text, tag)) fail_msg("%s: %s", tag, error.text);
    free(copy);
}

static void each_kind_of_bad_index_is_named(void **state) {
    fixture_saved *s = *state;
    expect_refusal(s, "TET", 0, 27);
    expect_refusal(s, "TET", 0, -1);
    expect_refusal(s, "TETNEXT", 4, -2);
    expect_refusal(s, "TETROOT", 4, -51);      // no such fine cell
    expect_refusal(s, "NODCHILD", 0, 0);       // a node that is its own child, and a tree's root
    expect_refusal(s, "BOX", 24, 0);           // a walk that would not go on
    expect_refusal(s, "BOX", 0, 0x7fc00000);   // NaN
    expect_refusal(s, "POINT", 4, 0x7ff80000); // NaN
    expect_refusal(s, "PLANE", 8, -4);
    expect_refusal(s, "FACTOFF", 4, 1 << 20);
    expect_refusal(s, "FACTOFF", 0, 1);
    expect_refusal(s, "FACTCORN", 0, 27);
    expect_refusal(s, "FACTFINE", 0, 49); // no such fine cell
    expect_refusal(s, "FACTFINE", 4, -2);
    expect_refusal(s, "FINEFACT", 4, -1);
    expect_refusal(s, "FINELIST", 0, -1);
    expect_refusal(s, "FINELIST", 4, 1 << 20);
    expect_refusal(s, "PIECFACT", 0, -1); // a piece has a facet
    expect_refusal(s, "PIECFACT", 0, 1 << 20);
    expect_refusal(s, "COVERSID", 0, 2);
    expect_refusal(s, "PORTAL", 0, 1); // its twin no longer leads back
    expect_refusal(s, "PORTPOLY", 44, 2);
    expect_refusal(s, "PORTPOLY", 44, 6); // shares corners with another polygon
    expect_refusal(s, "CELL", 64, (int32_t)section_of(s->bytes, "CELLTRI")->count); // shares triangles
    expect_refusal(s, "CELL", 76, 2);
    expect_refusal(s, "CELLPORT", 0, 2);
    expect_refusal(s, "CELL", 68, 1); // portal 1 leads out of another cell
    expect_refusal(s, "REGION", 28, 3);
    expect_refusal(s, "TRIANGLE", 0, 1 << 20);
    expect_refusal(s, "MATERIAL", 0, 1000); // beyond the strings
}

static void tetrahedra_may_share_a_tree(void **state) {
    fixture_saved *s = *state;
    unsigned char *copy = malloc(s->size);
    assert_non_null(copy);
    memcpy(copy, s->bytes, s->size);
    memset(copy + section_of(copy, "TETROOT")->offset + 4, 0, 4); // the second one's root: node 0
    fixture_fix_checksums(copy);
    enf_error error;
    assert_int_equal(open_copy(copy, s->size, &error), ENF_OK);
    free(copy);
}

static void unreadable_paths_are_told_from_bad_files(void **state) {
    (void)state;
    enf_world *world;
    enf_error error;
    assert_int_equal(enf_world_open_path(&world, "no-such-file.enf", NULL, &error), ENF_NO_RESOURCES);
    assert_non_null(strstr(error.text, "no-such-file.enf"));
    assert_int_equal(enf_world_open_path(&world, ".", NULL, &error), ENF_NO_RESOURCES);
    assert_int_equal(enf_world_open_path(&world, "/dev/null", NULL, &error), ENF_NO_RESOURCES);
    char path[] = "empty-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0);
    close(file);
    assert_int_equal(enf_world_open_path(&world, path, NULL, &error), ENF_BAD_INPUT);
    assert_non_null(strstr(error.text, path));
    assert_null(world);
    remove(path);
}

static void misaligned_memory_is_refused(void **state) {
    fixture_saved *s = *state;
    unsigned char *copy = malloc(s->size + 1);
    assert_non_null(copy);
    memcpy(copy + 1, s->bytes, s->size);
    enf_world *world;
    assert_int_equal(enf_world_open_memory(&world, copy + 1, s->size, NULL, NULL), ENF_BAD_USAGE);
    free(copy);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_array_comes_back_as_it_was),
        cmocka_unit_test(names_and_options_come_back),
        cmocka_unit_test(the_same_world_gives_the_same_bytes),
        cmocka_unit_test(sections_are_aligned_and_padding_is_zero),
        cmocka_unit_test(neighbours_share_the_face_between_them),
        cmocka_unit_test(a_turn_is_kept_must_be_known_and_be_a_rotation),
        cmocka_unit_test(rows_come_back_from_their_code),
        cmocka_unit_test(a_visible_set_is_kept_and_looked_at),
        cmocka_unit_test(portals_face_the_cell_they_lead_from),
        cmocka_unit_test(triangles_keep_the_inputs_corners_and_cells_list_what_they_see),
        cmocka_unit_test(every_changed_byte_is_noticed),
        cmocka_unit_test(every_truncation_is_refused),
        cmocka_unit_test(truncation_says_so),
        cmocka_unit_test(newer_minor_versions_open_and_newer_major_ones_do_not),
        cmocka_unit_test(unknown_sections_are_skipped_unless_they_must_be_known),
        cmocka_unit_test(hostile_table_entries_are_refused),
        cmocka_unit_test(sections_that_overlap_or_stick_out_are_refused),
        cmocka_unit_test(hostile_numbers_never_crash),
        cmocka_unit_test(damaged_bytes_give_errors_or_answers),
        cmocka_unit_test(each_kind_of_bad_index_is_named),
        cmocka_unit_test(tetrahedra_may_share_a_tree),
        cmocka_unit_test(unreadable_paths_are_told_from_bad_files),
        cmocka_unit_test(misaligned_memory_is_refused),
    };
    return cmocka_run_group_tests(tests, fixture_set_up, fixture_tear_down);
}
