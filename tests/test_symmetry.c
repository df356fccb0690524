// SPDX-License-Identifier: GPL-3.0-or-later
// What stays in a matrix of bits that is made symmetric is what a look at each bit leaves.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "visibility/symmetry.h"

#include <string.h>

static uint64_t next(uint64_t *seed) {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 7;
    *seed ^= *seed << 17;
    return *seed;
}

/// A third to all of the bits, in some parts none.
static enf_bits make_bits(int32_t rows, uint64_t *seed) {
    enf_bits bits;
    const uint64_t most = 1 + next(seed) % 3;
    assert_true(enf_bits_new(&bits, rows, rows));
    for (int32_t i = 0; i < rows; i++)
        for (int32_t j = 0; j < rows; j++)
            if ((i / 50 + j / 70) % 3 > 0 && next(seed) % most == 0) enf_bit_set(enf_bits_row(&bits, i), j);
    return bits;
}

static void check(int32_t rows, int twin, uint64_t *seed) {
    enf_bits bits = make_bits(rows, seed), before;
    assert_true(enf_bits_new(&before, rows, rows));
    memcpy(before.words, bits.words, (size_t)rows * bits.row_words * sizeof *bits.words);
    if (twin)
        enf_symmetry_keep_twins(&bits);
    else
        enf_symmetry_keep(&bits);
    for (int32_t i = 0; i < rows; i++)
        for (int32_t j = 0; j < rows; j++)
            assert_int_equal(enf_bit_get(enf_bits_row(&bits, i), j),
                             enf_bit_get(enf_bits_row(&before, i), j) &&
                                 enf_bit_get(enf_bits_row(&before, j ^ twin), i ^ twin));
    enf_bits_free(&bits);
    enf_bits_free(&before);
}

static void pairs_stay_that_are_there_both_ways(void **state) {
    (void)state;
    uint64_t seed = 64;
    print_message("seed %llu\n", (unsigned long long)seed);
    static const int32_t sizes[] = {0, 1, 2, 63, 64, 65, 127, 128, 130, 200, 321};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++)
        for (int round = 0; round < 5; round++) {
            check(sizes[i], 0, &seed);
            check(sizes[i] / 2 * 2, 1, &seed);
        }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(pairs_stay_that_are_there_both_ways)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
