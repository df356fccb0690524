// SPDX-License-Identifier: GPL-3.0-or-later
// Whole numbers of fixed widths against GMP, with long runs of ones and zeros, and sums that cancel.
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
#include <string.h>

#include "base/limbs.h"

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

enum { LIMBS_MAX = 10 };

/// Limbs of all zeros and all ones more often than chance would have it; sometimes a small number.
static void random_limbs(uint64_t *state, uint64_t *limb, int size) {
    for (int i = 0; i < size; i++) {
        uint64_t kind = next_random(state) % 8;
        limb[i] = kind == 0   ? 0
                  : kind == 1 ? UINT64_MAX
                  : kind == 2 ? UINT64_C(1) << next_random(state) % 64
                              : next_random(state);
    }
    int kept = (int)(next_random(state) % (uint64_t)(2 * size));
    for (int i = kept; i < size; i++) limb[i] = next_random(state) % 2 && i > kept ? limb[i - 1] : 0;
    for (int i = kept > 0 ? kept : 1; i < size; i++) limb[i] = -(limb[i - 1] >> 63); // its sign goes on
}

static void to_gmp(mpz_t out, const uint64_t *limb, int size) {
    mpz_import(out, (size_t)size, -1, sizeof *limb, 0, 0, limb);
    if (limb[size - 1] >> 63) {
        mpz_t above;
        mpz_init_set_ui(above, 1);
        mpz_mul_2exp(above, above, 64 * (mp_bitcnt_t)size);
        mpz_sub(out, out, above);
        mpz_clear(above);
    }
}

/// Equal as far as the limbs go.
static void assert_same(const uint64_t *limb, int size, const mpz_t expected) {
    mpz_t value;
    mpz_init(value);
    to_gmp(value, limb, size);
    mpz_sub(value, value, expected);
    assert_true(mpz_divisible_2exp_p(value, 64 * (mp_bitcnt_t)size));
    mpz_clear(value);
}

typedef struct numbers {
    mpz_t a, b, expected;
} numbers;

static void numbers_init(numbers *n) {
    mpz_inits(n->a, n->b, n->expected, NULL);
}

static void numbers_clear(numbers *n) {
    mpz_clears(n->a, n->b, n->expected, NULL);
}

static enf_int128 random_int128(uint64_t *state) {
    uint64_t limb[2];
    random_limbs(state, limb, 2);
    return (enf_int128)((enf_uint128)limb[1] << 64 | limb[0]);
}

static void parts_that_overlap_add_up(void **unused) {
    (void)unused;
    uint64_t state = seed + 7;
    numbers n;
    numbers_init(&n);
    for (long i = 0; i < scaled(100000); i++) {
        enf_int128 part[2] = {random_int128(&state) >> 2, random_int128(&state)};
        if (i % 4 == 0) part[1] = -((part[0] >> 63) * ((enf_int128)1 << 64)); // they nearly cancel
        uint64_t limb[2], sum[3];
        enf_limbs_set(limb, part[0]);
        to_gmp(n.expected, limb, 2);
        mpz_mul_2exp(n.expected, n.expected, 64);
        enf_limbs_set(limb, part[1]);
        to_gmp(n.b, limb, 2);
        mpz_add(n.expected, n.expected, n.b);
        enf_limbs_set_parts(sum, part[0], part[1]);
        assert_same(sum, 3, n.expected);
        assert_int_equal(enf_limbs_sign(sum, 3), mpz_sgn(n.expected));
    }
    numbers_clear(&n);
}

static void sums_differences_and_signs_are_exact(void **unused) {
    (void)unused;
    uint64_t state = seed + 1;
    numbers n;
    numbers_init(&n);
    for (long i = 0; i < scaled(1000000); i++) {
        int size = 1 + (int)(next_random(&state) % 8);
        uint64_t a[LIMBS_MAX], b[LIMBS_MAX], result[LIMBS_MAX];
        random_limbs(&state, a, size);
        random_limbs(&state, b, size);
        if (i % 5 == 0) memcpy(b, a, sizeof b); // cancels: long borrows
        if (i % 10 == 0) b[0] ^= 1;
        to_gmp(n.a, a, size);
        to_gmp(n.b, b, size);
        assert_int_equal(enf_limbs_sign(a, size), mpz_sgn(n.a));
        assert_int_equal(enf_limbs_is_zero(a, size), mpz_sgn(n.a) == 0);
        memcpy(result, a, sizeof result);
        enf_limbs_add(result, b, size);
        mpz_add(n.expected, n.a, n.b);
        assert_same(result, size, n.expected);
        memcpy(result, a, sizeof result);
        enf_limbs_subtract(result, b, size);
        mpz_sub(n.expected, n.a, n.b);
        assert_same(result, size, n.expected);
    }
    numbers_clear(&n);
}

static void products_are_exact(void **unused) {
    (void)unused;
    uint64_t state = seed + 2;
    numbers n;
    numbers_init(&n);
    for (long i = 0; i < scaled(1000000); i++) {
        int a_size = 1 + (int)(next_random(&state) % 5), b_size = 1 + (int)(next_random(&state) % 5);
        uint64_t a[LIMBS_MAX], b[LIMBS_MAX], product[LIMBS_MAX];
        random_limbs(&state, a, a_size);
        random_limbs(&state, b, b_size);
        to_gmp(n.a, a, a_size);
        to_gmp(n.b, b, b_size);
        mpz_mul(n.expected, n.a, n.b);
        enf_limbs_multiply(product, a, a_size, b, b_size);
        assert_same(product, a_size + b_size, n.expected);
    }
    numbers_clear(&n);
}

static void quotients_are_within_five_units_in_the_last_place(void **unused) {
    (void)unused;
    uint64_t state = seed + 3;
    mpq_t exact, got, allowed;
    mpq_inits(exact, got, allowed, NULL);
    for (long i = 0; i < scaled(300000); i++) {
        int a_size = 1 + (int)(next_random(&state) % 8), b_size = 1 + (int)(next_random(&state) % 8);
        uint64_t a[LIMBS_MAX], b[LIMBS_MAX];
        random_limbs(&state, a, a_size);
        random_limbs(&state, b, b_size);
        if (enf_limbs_is_zero(b, b_size)) continue;
        double quotient = enf_limbs_quotient(a, a_size, b, b_size);
        if (enf_limbs_is_zero(a, a_size)) {
            assert_true(quotient == 0);
            continue;
        }
        to_gmp(mpq_numref(exact), a, a_size);
        to_gmp(mpq_denref(exact), b, b_size);
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
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parts_that_overlap_add_up),
        cmocka_unit_test(sums_differences_and_signs_are_exact),
        cmocka_unit_test(products_are_exact),
        cmocka_unit_test(quotients_are_within_five_units_in_the_last_place),
    };
    printf("seed %llu\n", (unsigned long long)seed);
    return cmocka_run_group_tests(tests, NULL, NULL);
}
