// SPDX-License-Identifier: GPL-3.0-or-later
// The 512-bit whole numbers against GMP, with operands of all sizes, long runs of ones and zeros, and sums
// that cancel.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <gmp.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "base/wide.h"

static const uint64_t seed = 20261122;

static uint64_t next_random(uint64_t *state) {
    uint64_t z = *state += UINT64_C(0x9e3779b97f4a7c15);
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

/// How many cases: `usual`, times the environment variable ENFILADE_TEST_SCALE.
static long scaled(long usual) {
    const char *text = getenv("ENFILADE_TEST_SCALE");
    double scale = text ? atof(text) : 1;
    return scale > 0 ? (long)ceil((double)usual * scale) : usual;
}

/// Up to `most` limbs, with limbs of all zeros and all ones more often than chance would have it.
static enf_wide random_wide(uint64_t *state, int most) {
    enf_wide number = {0};
    number.size = (int)(next_random(state) % (uint64_t)(most + 1));
    for (int i = 0; i < number.size; i++) {
        uint64_t kind = next_random(state) % 8;
        number.limb[i] = kind == 0   ? 0
                         : kind == 1 ? UINT64_MAX
                         : kind == 2 ? UINT64_C(1) << next_random(state) % 64
                                     : next_random(state);
    }
    while (number.size > 0 && number.limb[number.size - 1] == 0) number.size--;
    number.sign = number.size == 0 ? 0 : next_random(state) % 2 ? 1 : -1;
    return number;
}

static void to_gmp(mpz_t out, const enf_wide *number) {
    mpz_import(out, (size_t)number->size, -1, sizeof(uint64_t), 0, 0, number->limb);
    if (number->sign < 0) mpz_neg(out, out);
}

static void assert_same(const enf_wide *number, const mpz_t expected) {
    assert_int_equal(number->sign, mpz_sgn(expected));
    assert_true(number->size == 0 || number->limb[number->size - 1] != 0);
    assert_int_equal(number->size == 0, number->sign == 0);
    mpz_t value;
    mpz_init(value);
    to_gmp(value, number);
    assert_int_equal(mpz_cmp(value, expected), 0);
    mpz_clear(value);
}

typedef struct numbers {
    mpz_t a, b, c, expected;
} numbers;

static void numbers_init(numbers *n) {
    mpz_inits(n->a, n->b, n->c, n->expected, NULL);
}

static void numbers_clear(numbers *n) {
    mpz_clears(n->a, n->b, n->c, n->expected, NULL);
}

static void setting_keeps_every_128_bit_number(void **unused) {
    (void)unused;
    uint64_t state = seed;
    numbers n;
    numbers_init(&n);
    for (long i = 0; i < scaled(100000); i++) {
        uint64_t low = next_random(&state), high = next_random(&state);
        if (i % 3 == 0) high = low >> 63 ? UINT64_MAX : 0;
        if (i == 1) low = 0, high = UINT64_C(1) << 63; // the smallest of all, which has no positive twin
        if (i == 2) low = high = 0;
        enf_int128 value = (enf_int128)((enf_uint128)high << 64 | low);
        mpz_set_si(n.expected, (long)(int64_t)high);
        mpz_mul_2exp(n.expected, n.expected, 64);
        mpz_set_ui(n.a, low);
        mpz_add(n.expected, n.expected, n.a);
        enf_wide number;
        enf_wide_set(&number, value);
        assert_same(&number, n.expected);
    }
    numbers_clear(&n);
}

static void set_signed(mpz_t out, enf_int128 value) {
    enf_wide number;
    enf_wide_set(&number, value);
    to_gmp(out, &number);
}

static void parts_that_overlap_add_up(void **unused) {
    (void)unused;
    uint64_t state = seed + 7;
    numbers n;
    numbers_init(&n);
    for (long i = 0; i < scaled(100000); i++) {
        enf_int128 part[2];
        for (int k = 0; k < 2; k++) {
            enf_uint128 bits = (enf_uint128)next_random(&state) << 64 | next_random(&state);
            part[k] = (enf_int128)bits >> (next_random(&state) % 126 + 2 * (k == 0));
        }
        if (i % 4 == 0) part[1] = -((part[0] >> 63) * ((enf_int128)1 << 64)); // they nearly cancel
        if (i % 8 == 0) part[0] >>= 63;                                       // or do
        enf_wide number;
        enf_wide_set_parts(&number, part[0], part[1]);
        set_signed(n.a, part[0]);
        set_signed(n.b, part[1]);
        mpz_mul_2exp(n.expected, n.a, 64);
        mpz_add(n.expected, n.expected, n.b);
        assert_same(&number, n.expected);
    }
    numbers_clear(&n);
}

static void sums_and_differences_are_exact_also_in_place(void **unused) {
    (void)unused;
    uint64_t state = seed + 1;
    numbers n;
    numbers_init(&n);
    for (long i = 0; i < scaled(1000000); i++) {
        enf_wide a = random_wide(&state, 7), b = random_wide(&state, 7), sum, difference;
        if (i % 5 == 0) { // nearly equal: long borrows
            b = a;
            if (b.size > 0 && i % 2 && (b.size > 1 || b.limb[0] != 1)) b.limb[0] ^= 1;
            if (b.size == 1 && b.limb[0] == 0) b = a;
        }
        to_gmp(n.a, &a);
        to_gmp(n.b, &b);
        enf_wide_add(&sum, &a, &b);
        mpz_add(n.expected, n.a, n.b);
        assert_same(&sum, n.expected);
        enf_wide_subtract(&difference, &a, &b);
        mpz_sub(n.expected, n.a, n.b);
        assert_same(&difference, n.expected);
        enf_wide in_place = a;
        enf_wide_subtract(&in_place, &in_place, &b);
        assert_same(&in_place, n.expected);
        in_place = b;
        enf_wide_subtract(&in_place, &a, &in_place);
        assert_same(&in_place, n.expected);
        enf_wide_subtract(&in_place, &in_place, &in_place);
        assert_int_equal(in_place.sign, 0);
        assert_int_equal(in_place.size, 0);
    }
    numbers_clear(&n);
}

static void products_are_exact_up_to_512_bits(void **unused) {
    (void)unused;
    uint64_t state = seed + 2;
    numbers n;
    numbers_init(&n);
    for (long i = 0; i < scaled(1000000); i++) {
        enf_wide a = random_wide(&state, 7), b = random_wide(&state, 7 - a.size), c = random_wide(&state, 7),
                 result;
        to_gmp(n.a, &a);
        to_gmp(n.b, &b);
        to_gmp(n.c, &c);
        enf_wide_multiply(&result, &a, &b);
        mpz_mul(n.expected, n.a, n.b);
        assert_same(&result, n.expected);
        result = c;
        enf_wide_add_product(&result, &a, &b);
        mpz_set(n.expected, n.c);
        mpz_addmul(n.expected, n.a, n.b);
        assert_same(&result, n.expected);
        enf_wide_subtract_product(&result, &a, &b);
        assert_same(&result, n.c);
        enf_wide_subtract_product(&result, &a, &b);
        mpz_set(n.expected, n.c);
        mpz_submul(n.expected, n.a, n.b);
        assert_same(&result, n.expected);
    }
    enf_wide full = {1, 4, {UINT64_MAX, UINT64_MAX, UINT64_MAX, UINT64_MAX}}, square;
    enf_wide_multiply(&square, &full, &full); // all 512 bits in use
    to_gmp(n.a, &full);
    mpz_mul(n.expected, n.a, n.a);
    assert_same(&square, n.expected);
    numbers_clear(&n);
}

static void quotients_are_within_five_units_in_the_last_place(void **unused) {
    (void)unused;
    uint64_t state = seed + 3;
    numbers n;
    numbers_init(&n);
    mpq_t exact, got, allowed;
    mpq_inits(exact, got, allowed, NULL);
    for (long i = 0; i < scaled(300000); i++) {
        enf_wide a = random_wide(&state, 8), b = random_wide(&state, 8);
        if (b.sign == 0) continue;
        double quotient = enf_wide_quotient(&a, &b);
        if (a.sign == 0) {
            assert_true(quotient == 0);
            continue;
        }
        to_gmp(mpq_numref(exact), &a);
        to_gmp(mpq_denref(exact), &b);
        mpq_canonicalize(exact);
        int exponent;
        frexp(quotient, &exponent);
        mpq_set_d(allowed, ldexp(5, exponent - 53));
        mpq_set_d(got, quotient);
        mpq_sub(got, got, exact);
        mpq_abs(got, got);
        assert_true(mpq_cmp(got, allowed) <= 0);
    }
    mpq_clears(exact, got, allowed, NULL);
    numbers_clear(&n);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(setting_keeps_every_128_bit_number),
        cmocka_unit_test(parts_that_overlap_add_up),
        cmocka_unit_test(sums_and_differences_are_exact_also_in_place),
        cmocka_unit_test(products_are_exact_up_to_512_bits),
        cmocka_unit_test(quotients_are_within_five_units_in_the_last_place),
    };
    printf("seed %llu\n", (unsigned long long)seed);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
