// SPDX-License-Identifier: GPL-3.0-or-later
// Costs that are powers of the sizes have that exponent; what is off by as much up as down has it still.
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cli/exponent.h"

#include <math.h>

static void powers_have_their_exponent(void **state) {
    (void)state;
    static const double sizes[] = {12096, 29772, 101920, 308172, 1013900};
    for (double power = 0; power < 3; power += 0.25) {
        double costs[5];
        for (int i = 0; i < 5; i++) costs[i] = 3e-6 * pow(sizes[i], power);
        assert_true(fabs(cli_exponent_fit(sizes, costs, 5) - power) < 1e-9);
        assert_true(fabs(cli_exponent_fit(sizes, costs, 2) - power) < 1e-9);
    }
}

static void errors_on_both_sides_even_out(void **state) {
    (void)state;
    static const double sizes[] = {1, 10, 100, 1000}, costs[] = {2, 5, 50, 2000};
    assert_true(fabs(cli_exponent_fit(sizes, costs, 4) - 1) < 1e-9);
    static const double slower[] = {1, 10, 100, 2000}; // the largest twice as slow: 0.3 log(2) / log(10) more
    assert_true(fabs(cli_exponent_fit(sizes, slower, 4) - 1 - 0.3 * log10(2)) < 1e-9);
}

static void one_size_has_none(void **state) {
    (void)state;
    static const double size[] = {100}, cost[] = {7};
    assert_true(isnan(cli_exponent_fit(size, cost, 1)));
    assert_true(isnan(cli_exponent_fit(size, cost, 0)));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(powers_have_their_exponent),
        cmocka_unit_test(errors_on_both_sides_even_out),
        cmocka_unit_test(one_size_has_none),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
