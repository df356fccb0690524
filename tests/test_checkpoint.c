// SPDX-License-Identifier: GPL-3.0-or-later
// Results as bytes and back, and the file that keeps them: whatever happens to it, what it gives is what was
// put in.
#include "visibility/checkpoint.h"

#include "base/hash.h"
#include "visibility/coding.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "maze_fixture.h"
#include "process.h"

enum { RECORDS = 5, HEADER = 64 };

typedef struct fixture {
    enf_portal_graph graph, other;
    enf_checkpoint_about about;
} fixture;

static fixture all;

static int enter(void **state) {
    (void)state;
    if (!enter_test_folder()) return -1;
    maze_read(&all.graph, 4, 1);
    maze_read(&all.other, 4, 2);
    all.about = (enf_checkpoint_about){&all.graph, 4, false};
    return 0;
}

static int leave(void **state) {
    (void)state;
    enf_portal_graph_free(&all.graph);
    enf_portal_graph_free(&all.other);
    leave_test_folder();
    return 0;
}

static enf_reader reader_of(const enf_bytes *bytes) {
    return (enf_reader){bytes->data, bytes->data + bytes->count, false};
}

// ---------------------------------------------------------------------------------------------- bytes

static void numbers_come_back(void **state) {
    (void)state;
    static const uint64_t numbers[] = {0, 1, 127, 128, 16383, 16384, UINT32_MAX, INT64_MAX, UINT64_MAX};
    static const double reals[] = {0.0, -0.0, 1e-310, 0.1, -1e100};
    enf_bytes bytes = {0};
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) enf_put_number(&bytes, numbers[i]);
    for (size_t i = 0; i < sizeof reals / sizeof *reals; i++) enf_put_real(&bytes, reals[i]);
    enf_put_word(&bytes, 0x01020304, 4);
    enf_reader reader = reader_of(&bytes);
    for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++)
        assert_true(enf_take_number(&reader, UINT64_MAX) == numbers[i]);
    for (size_t i = 0; i < sizeof reals / sizeof *reals; i++) {
        double real = enf_take_real(&reader);
        assert_memory_equal(&real, &reals[i], sizeof real);
    }
    assert_int_equal(reader.at[0], 4);
    assert_true(enf_take_word(&reader, 4) == 0x01020304);
    assert_false(reader.failed);
    assert_true(enf_reader_left(&reader) == 0);
    enf_bytes_free(&bytes);
}

static void what_does_not_fit_is_a_failure(void **state) {
    (void)state;
    static const struct {
        const char *bytes;
        size_t size;
        uint64_t most;
    } wrong[] = {
        {"", 0, 9},         {"\x80", 1, UINT64_MAX},
        {"\x0a", 1, 9},     {"\xff\xff\xff\xff\xff\xff\xff\xff\xff\x02", 10, UINT64_MAX},
        {"\x80\x01", 2, 9}, {"\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\x01", 11, UINT64_MAX},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        const uint8_t *data = (const uint8_t *)wrong[i].bytes;
        enf_reader reader = {data, data + wrong[i].size, false};
        assert_true(enf_take_number(&reader, wrong[i].most) == 0);
        assert_true(reader.failed);
        assert_true(enf_take_word(&reader, 1) == 0);
    }
    static const uint8_t infinite[] = {0, 0, 0, 0, 0, 0, 0xf0, 0x7f};
    enf_reader reader = {infinite, infinite + 8, false};
    assert_true(enf_take_real(&reader) == 0 && reader.failed);
}

/// Rows of a given length with every pattern of the bits around its words' borders.
static void rows_come_back(void **state) {
    (void)state;
    for (int32_t columns = 1; columns <= 130; columns += 43) {
        for (uint64_t seed = 0; seed < 200; seed++) {
            enf_bits bits;
            enf_bytes bytes = {0};
            assert_true(enf_bits_new(&bits, 2, columns));
            uint64_t *row = enf_bits_row(&bits, 0), *back = enf_bits_row(&bits, 1), random = seed;
            for (int32_t i = 0; i < columns; i++) {
                random = enf_hash_mix(random + seed);
                if (random % (1 + seed % 7) == 0) enf_bit_set(row, i);
            }
            enf_put_row(&bytes, row, bits.row_words);
            enf_reader reader = reader_of(&bytes);
            enf_take_row(&reader, back, columns);
            assert_false(reader.failed);
            assert_true(enf_reader_left(&reader) == 0);
            assert_memory_equal(row, back, bits.row_words * sizeof *row);
            enf_bytes_free(&bytes);
            enf_bits_free(&bits);
        }
    }
}

static void fill_sightings(enf_sightings *sightings) {
    assert_true(enf_sightings_new(sightings, 70, true));
    for (int32_t cell = 1; cell < 70; cell += 3) {
        const enf_sighting sighting = {cell, cell + 1000};
        const enf_line line = {{0.1, 2, 3}, {4, 5, -cell}};
        const char *long_line = cell % 4 == 0 ? "1.5 -2 3e-1 4.00000000000000000001 5 6" : NULL;
        assert_true(enf_sightings_add_long(sightings, 0, &sighting, cell % 2 ? &line : NULL, long_line));
    }
}

static void sightings_come_back(void **state) {
    (void)state;
    enf_sightings sightings, back;
    enf_bytes bytes = {0};
    fill_sightings(&sightings);
    enf_put_sightings(&bytes, &sightings, 0, 0);
    assert_true(enf_sightings_new(&back, 70, true));
    enf_reader reader = reader_of(&bytes);
    assert_true(enf_take_sightings(&reader, &back, 0));
    assert_false(reader.failed);
    const enf_cell_sightings *a = &sightings.cells[0], *b = &back.cells[0];
    assert_int_equal(a->count, b->count);
    assert_memory_equal(a->sightings, b->sightings, (size_t)a->count * sizeof *a->sightings);
    assert_memory_equal(a->lines, b->lines, (size_t)a->count * sizeof *a->lines);
    int32_t longer = 0;
    for (int32_t k = 0; k < a->count; k++) {
        assert_int_equal(a->long_lines[k] != NULL, b->long_lines[k] != NULL);
        if (a->long_lines[k]) assert_string_equal(a->long_lines[k], b->long_lines[k]);
        longer += a->long_lines[k] != NULL;
    }
    assert_true(longer > 0 && longer < a->count);
    reader = reader_of(&bytes); // all of them are there already
    assert_true(enf_take_sightings(&reader, &back, 0));
    assert_true(reader.failed);
    enf_sightings_free(&sightings);
    enf_sightings_free(&back);
    enf_bytes_free(&bytes);
}

/// Every byte replaced by others: what comes back is refused, or at least about cells that exist.
static void damaged_sightings_do_no_harm(void **state) {
    (void)state;
    enf_sightings sightings;
    enf_bytes bytes = {0};
    fill_sightings(&sightings);
    enf_put_sightings(&bytes, &sightings, 0, 0);
    enf_put_row(&bytes, enf_bits_row(&sightings.seen, 0), sightings.seen.row_words);
    for (size_t i = 0; i < bytes.count; i++) {
        for (int change = 1; change < 256; change += 9) {
            enf_sightings back;
            enf_bits bits;
            assert_true(enf_sightings_new(&back, 70, true) && enf_bits_new(&bits, 1, 70));
            bytes.data[i] ^= (uint8_t)change;
            enf_reader reader = reader_of(&bytes);
            assert_true(enf_take_sightings(&reader, &back, 0));
            enf_take_row(&reader, bits.words, 70);
            for (int32_t k = 0; k < back.cells[0].count; k++)
                assert_in_range(back.cells[0].sightings[k].cell, 1, 69);
            assert_true(enf_sightings_symmetrise(&back)); // turns long lines
            assert_true(enf_bits_count(bits.words, bits.row_words) <= 70);
            assert_int_equal(enf_bit_next(bits.words, bits.row_words, 70), -1);
            bytes.data[i] ^= (uint8_t)change;
            enf_bits_free(&bits);
            enf_sightings_free(&back);
        }
    }
    enf_bytes_free(&bytes);
    enf_sightings_free(&sightings);
}

// ---------------------------------------------------------------------------------------------- file

static enf_checkpoint *expect_open(const char *path) {
    enf_checkpoint *checkpoint;
    enf_error error = {0};
    if (enf_checkpoint_open(&checkpoint, path, &all.about, &error) != ENF_OK) fail_msg("%s", error.text);
    return checkpoint;
}

static void expect_refusal(const char *path, const enf_checkpoint_about *about, enf_status expected,
                           const char *words) {
    size_t size, size_after;
    char *before = read_file(path, &size);
    enf_checkpoint *checkpoint;
    enf_error error = {0};
    enf_status status = enf_checkpoint_open(&checkpoint, path, about, &error);
    if (status != expected || !strstr(error.text, words))
        fail_msg("status %d, \"%s\" instead of %d, \"%s\"", status, error.text, expected, words);
    assert_null(checkpoint);
    char *after = read_file(path, &size_after);
    assert_true(size == size_after);
    if (before) assert_memory_equal(before, after, size);
    free(before);
    free(after);
}

static enf_record record_of(int i) {
    static const char results[] = "job\njob\nabcdefghijklmnopqrstuvwxyz";
    return (enf_record){1 + i % 2, i, (uint64_t)i << 40, (const uint8_t *)results, (size_t)(i * 5)};
}

static void add_records(enf_checkpoint *checkpoint, int from, int to) {
    for (int i = from; i < to; i++) {
        const enf_record record = record_of(i);
        assert_int_equal(enf_checkpoint_add(checkpoint, &record, NULL), ENF_OK);
    }
}

/// How many of the records are there; each must be as it was put.
static int count_records(const char *path) {
    enf_checkpoint *checkpoint = expect_open(path);
    size_t count;
    const enf_record *records = enf_checkpoint_records(checkpoint, &count);
    for (size_t i = 0; i < count; i++) {
        const enf_record expected = record_of(records[i].cell);
        assert_true(i == 0 || records[i].cell > records[i - 1].cell);
        assert_int_equal(records[i].stage, expected.stage);
        assert_true(records[i].key == expected.key && records[i].size == expected.size);
        assert_memory_equal(records[i].result, expected.result, expected.size);
    }
    enf_checkpoint_close(checkpoint);
    return (int)count;
}

static char *make_file(const char *path, size_t *size) {
    unlink(path);
    enf_checkpoint *checkpoint = expect_open(path);
    add_records(checkpoint, 0, RECORDS);
    enf_checkpoint_close(checkpoint);
    return read_file(path, size);
}

static void records_come_back_and_more_can_be_added(void **state) {
    (void)state;
    write_text("a.ck", ""); // nothing to lose
    enf_checkpoint *checkpoint = expect_open("a.ck");
    add_records(checkpoint, 0, 2);
    enf_checkpoint_close(checkpoint);
    assert_int_equal(count_records("a.ck"), 2);
    checkpoint = expect_open("a.ck");
    add_records(checkpoint, 2, RECORDS);
    enf_checkpoint_close(checkpoint);
    assert_int_equal(count_records("a.ck"), RECORDS);
}

/// Cut at every length: whole records stay, what is left of another goes, and the file can be gone on with.
static void a_torn_tail_is_cut_off(void **state) {
    (void)state;
    size_t size;
    char *bytes = make_file("whole.ck", &size);
    int last = 0;
    for (size_t cut = HEADER; cut < size; cut++) {
        write_file("torn.ck", bytes, cut);
        int count = count_records("torn.ck");
        assert_in_range(count, last, last + 1);
        last = count;
        enf_checkpoint *checkpoint = expect_open("torn.ck");
        add_records(checkpoint, count, RECORDS);
        enf_checkpoint_close(checkpoint);
        size_t size_now;
        char *now = read_file("torn.ck", &size_now);
        assert_true(size_now == size);
        assert_memory_equal(now, bytes, size);
        free(now);
    }
    assert_int_equal(last, RECORDS - 1);
    free(bytes);
}

static void a_damaged_record_is_passed_over(void **state) {
    (void)state;
    size_t size;
    char *bytes = make_file("whole.ck", &size);
    for (size_t i = HEADER; i < size; i++) {
        for (int bit = 0; bit < 8; bit++) {
            bytes[i] = (char)(bytes[i] ^ 1 << bit);
            write_file("bad.ck", bytes, size);
            bytes[i] = (char)(bytes[i] ^ 1 << bit);
            assert_int_equal(count_records("bad.ck"), RECORDS - 1);
        }
    }
    free(bytes);
}

static void a_damaged_header_is_refused(void **state) {
    (void)state;
    size_t size;
    char *bytes = make_file("whole.ck", &size);
    for (size_t i = 0; i < HEADER; i++) {
        bytes[i] ^= 4;
        write_file("bad.ck", bytes, size);
        bytes[i] ^= 4;
        expect_refusal("bad.ck", &all.about, ENF_BAD_INPUT, i < 8 ? "no checkpoint" : "header is damaged");
    }
    for (size_t cut = 1; cut < HEADER; cut++) {
        write_file("bad.ck", bytes, cut);
        expect_refusal("bad.ck", &all.about, ENF_BAD_INPUT, "no checkpoint");
    }
    bytes[8] = ENF_CHECKPOINT_FORMAT + 1; // a version to come
    uint64_t hash = enf_hash64(bytes, 56, 0);
    for (int i = 0; i < 8; i++) bytes[56 + i] = (char)(hash >> 8 * i);
    write_file("bad.ck", bytes, size);
    expect_refusal("bad.ck", &all.about, ENF_BAD_INPUT, "another version");
    free(bytes);
}

static void what_is_of_something_else_is_refused(void **state) {
    (void)state;
    size_t size;
    enf_checkpoint_about other = all.about;
    free(make_file("whole.ck", &size));
    other.graph = &all.other;
    expect_refusal("whole.ck", &other, ENF_BAD_INPUT, "of another input");
    other = all.about;
    other.method = 3;
    expect_refusal("whole.ck", &other, ENF_BAD_INPUT, "another --method");
    other = all.about;
    other.keeps_lines = true;
    expect_refusal("whole.ck", &other, ENF_BAD_INPUT, "--witness");
    write_text("text.ck", "0 1 2\n0 1 2\n");
    expect_refusal("text.ck", &all.about, ENF_BAD_INPUT, "no checkpoint; it is left as it is");
    expect_refusal(".", &all.about, ENF_NO_RESOURCES, "must be a file");
    expect_refusal("/dev/null", &all.about, ENF_NO_RESOURCES, "must be a file");
    expect_refusal("nowhere/a.ck", &all.about, ENF_NO_RESOURCES, "can't be written");
}

static void two_runs_do_not_share_a_file(void **state) {
    (void)state;
    size_t size;
    free(make_file("whole.ck", &size));
    enf_checkpoint *checkpoint = expect_open("whole.ck");
    expect_refusal("whole.ck", &all.about, ENF_NO_RESOURCES, "another run writes this checkpoint");
    enf_checkpoint_close(checkpoint);
    assert_int_equal(count_records("whole.ck"), RECORDS);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(numbers_come_back),
        cmocka_unit_test(what_does_not_fit_is_a_failure),
        cmocka_unit_test(rows_come_back),
        cmocka_unit_test(sightings_come_back),
        cmocka_unit_test(damaged_sightings_do_no_harm),
        cmocka_unit_test(records_come_back_and_more_can_be_added),
        cmocka_unit_test(a_torn_tail_is_cut_off),
        cmocka_unit_test(a_damaged_record_is_passed_over),
        cmocka_unit_test(a_damaged_header_is_refused),
        cmocka_unit_test(what_is_of_something_else_is_refused),
        cmocka_unit_test(two_runs_do_not_share_a_file),
    };
    return cmocka_run_group_tests(tests, enter, leave);
}
