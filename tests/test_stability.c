// SPDX-License-Identifier: GPL-3.0-or-later
// Soups as bad as they come: the families of `enfilade bench stability`, a few seeds each. Every invariant is
// checked exactly, and the oracles are asked. ENFILADE_TEST_SCALE multiplies the number of seeds.
#include "build/stress_family.h"
#include "build/stress_run.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static int seeds_per_family(void) {
    const char *scale = getenv("ENFILADE_TEST_SCALE");
    double seeds = 12 * (scale ? atof(scale) : 1);
    return seeds >= 1 ? (int)seeds : 1;
}

static void every_soup_passes_check_and_oracles(void **state) {
    (void)state;
    const enf_stress_options harness = {.points = 200};
    int wrong = 0;
    for (int family = 0; enf_stress_family(family, NULL); family++) {
        int64_t points = 0, segments = 0, cells = 0;
        for (int i = 0; i < seeds_per_family(); i++) {
            enf_stress_result result;
            enf_stress_run(family, (uint64_t)i, &harness, &result);
            points += result.verdict.points;
            segments += result.verdict.segments;
            cells += result.fine_cells;
            if (result.outcome == ENF_STRESS_FINE) continue;
            print_message("%s, seed %d: %s\n", enf_stress_family(family, NULL), i, result.reason);
            wrong++;
        }
        print_message("%s, seeds 0 to %d: %lld fine cells; %lld points, %lld segments asked\n",
                      enf_stress_family(family, NULL), seeds_per_family() - 1, (long long)cells,
                      (long long)points, (long long)segments);
        assert_true(segments > 0);
    }
    assert_int_equal(wrong, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_soup_passes_check_and_oracles)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
