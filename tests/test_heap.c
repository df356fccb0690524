// SPDX-License-Identifier: GPL-3.0-or-later
// The indexed heap against a plain array that is searched from end to end, and the pair table against a
// matrix.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "build/heap.h"
#include "build/pair_table.h"

enum { ITEMS = 200 };

static uint64_t next_random(uint64_t *state) {
    uint64_t z = *state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static void an_empty_heap_has_no_top(void **state) {
    (void)state;
    enf_heap heap;
    assert_true(enf_heap_create(&heap, 0));
    assert_int_equal(enf_heap_top(&heap), -1);
    enf_heap_free(&heap);
    assert_true(enf_heap_create(&heap, 3));
    assert_int_equal(enf_heap_top(&heap), -1);
    enf_heap_remove(&heap, 2);
    assert_int_equal(heap.count, 0);
    enf_heap_free(&heap);
}

static void ties_are_broken_by_first_then_second(void **state) {
    (void)state;
    enf_heap heap;
    assert_true(enf_heap_create(&heap, 4));
    enf_heap_set(&heap, 0, (enf_heap_key){1, 2, 3});
    enf_heap_set(&heap, 1, (enf_heap_key){1, 1, 9});
    enf_heap_set(&heap, 2, (enf_heap_key){1, 1, 4});
    enf_heap_set(&heap, 3, (enf_heap_key){0.5, 9, 9});
    const int32_t expected[] = {3, 2, 1, 0};
    for (int i = 0; i < 4; ++i) {
        assert_int_equal(enf_heap_top(&heap), expected[i]);
        enf_heap_remove(&heap, expected[i]);
        assert_false(enf_heap_has(&heap, expected[i]));
    }
    enf_heap_free(&heap);
}

static int32_t smallest_of(const enf_heap_key *keys, const bool *in) {
    int32_t best = -1;
    for (int32_t i = 0; i < ITEMS; ++i)
        if (in[i] && (best < 0 || enf_heap_key_less(keys[i], keys[best]))) best = i;
    return best;
}

static void the_top_is_the_smallest_after_any_change(void **state) {
    (void)state;
    uint64_t seed = 20261122;
    print_message("seed %llu\n", (unsigned long long)seed);
    enf_heap heap;
    assert_true(enf_heap_create(&heap, ITEMS));
    enf_heap_key keys[ITEMS];
    bool in[ITEMS] = {false};
    for (int round = 0; round < 20000; ++round) {
        int32_t item = (int32_t)(next_random(&seed) % ITEMS);
        if (next_random(&seed) % 4 == 0) {
            enf_heap_remove(&heap, item);
            in[item] = false;
        } else {
            // Few different weights, so that ties are common; the item as second makes the order total.
            keys[item] =
                (enf_heap_key){(double)(next_random(&seed) % 40), (int32_t)(next_random(&seed) % 5), item};
            enf_heap_set(&heap, item, keys[item]);
            in[item] = true;
        }
        assert_int_equal(enf_heap_top(&heap), smallest_of(keys, in));
        assert_int_equal(enf_heap_has(&heap, item), in[item]);
    }
    enf_heap_free(&heap);
}

enum { NUMBERS = 40, FAR = 5000, PAIRS = 20000 }; ///< numbers that are FAR from each other share no page

/// Puts pairs of the first numbers in and takes them out again, at random; `step` lies between two numbers.
static void check_pair_table(int32_t step, bool expect) {
    uint64_t seed = 7;
    print_message("seed %llu, step %d\n", (unsigned long long)seed, step);
    int32_t expected[NUMBERS][NUMBERS];
    for (int a = 0; a < NUMBERS; ++a)
        for (int b = 0; b < NUMBERS; ++b) expected[a][b] = -1;
    enf_pair_table table;
    assert_true(enf_pair_table_create(&table, NUMBERS * step));
    for (int a = 0; a < NUMBERS && expect; ++a)
        for (int b = 0; b < a; ++b) enf_pair_table_expect(&table, a * step, b * step);
    for (int round = 0; round < PAIRS; ++round) {
        int32_t a = (int32_t)(next_random(&seed) % NUMBERS), b = (int32_t)(next_random(&seed) % NUMBERS);
        if (a == b) continue;
        assert_int_equal(enf_pair_table_find(&table, a * step, b * step), expected[a][b]);
        if (next_random(&seed) % 2) {
            assert_true(enf_pair_table_put(&table, a * step, b * step, round));
            expected[a][b] = expected[b][a] = round;
        } else {
            enf_pair_table_remove(&table, b * step, a * step);
            expected[a][b] = expected[b][a] = -1;
        }
    }
    enf_pair_table_free(&table);
}

static void the_pair_table_remembers_what_was_put_in(void **state) {
    (void)state;
    check_pair_table(1, false); // all on one page, which grows
    check_pair_table(1, true);
    check_pair_table(1000, false);
    check_pair_table(FAR, true); // each on its own
}

static void the_pair_table_takes_a_number_that_is_in_all_pairs(void **state) {
    (void)state;
    enf_pair_table table;
    assert_true(enf_pair_table_create(&table, PAIRS));
    for (int32_t other = 0; other < PAIRS - 1; ++other)
        assert_true(enf_pair_table_put(&table, PAIRS - 1, other, other));
    for (int32_t other = 0; other < PAIRS - 1; other += 2) enf_pair_table_remove(&table, other, PAIRS - 1);
    for (int32_t other = 0; other < PAIRS - 1; ++other)
        assert_int_equal(enf_pair_table_find(&table, other, PAIRS - 1), other % 2 ? other : -1);
    enf_pair_table_free(&table);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_empty_heap_has_no_top),
        cmocka_unit_test(ties_are_broken_by_first_then_second),
        cmocka_unit_test(the_top_is_the_smallest_after_any_change),
        cmocka_unit_test(the_pair_table_remembers_what_was_put_in),
        cmocka_unit_test(the_pair_table_takes_a_number_that_is_in_all_pairs),
    };
    return cmocka_run_group_tests_name("heap", tests, NULL, NULL);
}
