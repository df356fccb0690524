// SPDX-License-Identifier: GPL-3.0-or-later
// What is fetched ahead, against a slow search; and that no advice about pages changes what is read.
#include "run_worlds.h"

#include "base/hash.h"
#include "enfilade/prefetch.h"
#include "format/pvs_row.h"

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

typedef struct scene {
    run_world w;
    const enf_file_view *view;
    enf_prefetch *prefetch;
    enf_wanted *list;
    double *entered, *seen; ///< per cell: seconds
    uint8_t *row;
} scene;

static scene make_scene(int side, bool turned, uint64_t seed) {
    scene s = {.w = run_world_grid(side, turned, seed)};
    s.view = enf_world_file(s.w.world);
    size_t cells = (size_t)s.view->cell_count;
    s.list = calloc(cells, sizeof *s.list);
    s.entered = calloc(cells, sizeof *s.entered);
    s.seen = calloc(cells, sizeof *s.seen);
    s.row = calloc(enf_pvs_row_bytes(s.view->cell_count), 1);
    assert_true(s.list && s.entered && s.seen && s.row);
    assert_int_equal(enf_prefetch_create(&s.prefetch, s.w.world, NULL), ENF_OK);
    return s;
}

static void free_scene(scene *s) {
    enf_prefetch_free(s->prefetch);
    run_world_free(&s->w);
    free(s->list);
    free(s->entered);
    free(s->seen);
    free(s->row);
}

static double length(const double v[3]) {
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/// As the header says it, by the angle.
static double seconds_to(const enf_file_portal *portal, const double point[3], const double velocity[3]) {
    double off[3], along = 0;
    for (int a = 0; a < 3; a++) {
        off[a] = portal->centre[a] - point[a];
        along += off[a] * velocity[a];
    }
    if (length(off) <= portal->radius) return 0;
    if (length(velocity) == 0) return INFINITY;
    double ahead = along / length(off) / length(velocity);
    return (length(off) - portal->radius) / length(velocity) * (ahead > 0 ? 2 - ahead : 2 - 2 * ahead);
}

static double box_distance(const enf_file_cell *cell, const double point[3]) {
    double off[3];
    for (int a = 0; a < 3; a++) {
        double inside = point[a] < cell->box_min[a] ? cell->box_min[a] : point[a];
        off[a] = point[a] - (inside > cell->box_max[a] ? cell->box_max[a] : inside);
    }
    return length(off);
}

/// Relaxes until nothing changes.
static void search(scene *s, int32_t cell, const double point[3], const double velocity[3], double seconds) {
    const enf_file_view *view = s->view;
    for (int32_t i = 0; i < view->cell_count; i++) s->entered[i] = s->seen[i] = INFINITY;
    s->entered[cell] = 0;
    for (bool changed = true; changed;) {
        changed = false;
        for (int32_t i = 0; i < view->portal_count; i++) {
            const enf_file_portal *portal = &view->portals[i];
            double when = fmax(s->entered[portal->from], seconds_to(portal, point, velocity));
            if (when > seconds || when >= s->entered[portal->to]) continue;
            s->entered[portal->to] = when;
            changed = true;
        }
    }
    for (int32_t i = 0; i < view->cell_count; i++) {
        if (s->entered[i] > seconds) continue;
        const uint8_t *coded = view->pvs_rows + view->pvs_offset[i];
        assert_true(enf_pvs_row_decode(coded, (size_t)(view->pvs_offset[i + 1] - view->pvs_offset[i]), s->row,
                                       view->cell_count));
        for (int32_t k = 0; k < view->cell_count; k++)
            if (s->row[k / 8] >> k % 8 & 1) s->seen[k] = fmin(s->seen[k], s->entered[i]);
    }
}

static int check_list(scene *s, int32_t cell, const double point[3], const double velocity[3],
                      double seconds) {
    search(s, cell, point, velocity, seconds);
    int32_t expected = 0;
    for (int32_t i = 0; i < s->view->cell_count; i++) expected += s->seen[i] < INFINITY;
    int32_t count =
        enf_prefetch_list(s->prefetch, cell, point, velocity, seconds, s->list, s->view->cell_count);
    assert_int_equal(count, expected);
    assert_int_equal(enf_prefetch_list(s->prefetch, cell, point, velocity, seconds, NULL, 0), expected);
    for (int32_t i = 0; i < count; i++) {
        const enf_wanted *wanted = &s->list[i], *before = &s->list[i > 0 ? i - 1 : 0];
        assert_true(fabs(s->seen[wanted->cell] - wanted->seconds) <= 1e-9 * seconds);
        s->seen[wanted->cell] = INFINITY; // a second time would be an error
        assert_true(before->seconds <= wanted->seconds);
        if (i == 0 || before->seconds < wanted->seconds) continue;
        double nearer = box_distance(&s->view->cells[before->cell], point);
        double farther = box_distance(&s->view->cells[wanted->cell], point);
        assert_true(nearer <= farther + 1e-12);
        if (nearer == farther) assert_true(before->cell < wanted->cell);
    }
    return count;
}

static void lists_are_what_a_slow_search_finds(void **state) {
    (void)state;
    uint64_t seed = 606;
    print_message("seed %llu\n", (unsigned long long)seed);
    int64_t now = 0, later = 0;
    for (int i = 0; i < 4; i++) {
        scene s = make_scene(4 + i % 2 * 2, i >= 2, run_random(&seed));
        for (int n = 0; n < 200; n++) {
            double point[3], velocity[3];
            for (int a = 0; a < 3; a++) {
                point[a] = s.w.box_min[a] + run_random_share(&seed) * (s.w.box_max[a] - s.w.box_min[a]);
                velocity[a] = n % 10 ? run_random_share(&seed) - 0.5 : 0;
            }
            int32_t cell = enf_world_locate(s.w.world, point, -1).cell;
            if (cell < 0) continue;
            now += check_list(&s, cell, point, velocity, 0);
            later += check_list(&s, cell, point, velocity, 6 * run_random_share(&seed));
        }
        free_scene(&s);
    }
    assert_true(later > now * 5 / 4);
}

static void nonsense_has_no_list(void **state) {
    (void)state;
    scene s = make_scene(4, false, 2);
    const double good[3] = {1, 1, 1}, bad[3] = {1, NAN, 1}, fast[3] = {DBL_MAX, -DBL_MAX, 1e300};
    assert_int_equal(enf_prefetch_list(s.prefetch, -1, good, good, 1, s.list, 1), 0);
    assert_int_equal(enf_prefetch_list(s.prefetch, s.view->cell_count, good, good, 1, s.list, 1), 0);
    assert_int_equal(enf_prefetch_list(s.prefetch, 0, bad, good, 1, s.list, 1), 0);
    assert_int_equal(enf_prefetch_list(s.prefetch, 0, good, bad, 1, s.list, 1), 0);
    assert_int_equal(enf_prefetch_list(s.prefetch, 0, good, good, -1, s.list, 1), 0);
    assert_int_equal(enf_prefetch_list(s.prefetch, 0, good, good, INFINITY, s.list, 1), 0);
    assert_true(enf_prefetch_list(s.prefetch, 0, fast, fast, DBL_MAX, s.list, 1) > 0);
    free_scene(&s);
}

static uint64_t advise_all(const enf_world *world) {
    const enf_file_view *view = enf_world_file(world);
    for (int32_t i = -1; i <= view->cell_count; i++) enf_world_advise_cell(world, i, true);
    for (int32_t i = -1; i <= view->cell_count; i++) enf_world_advise_cell(world, i, false);
    return enf_hash64(view->bytes, view->size, 0);
}

static void advice_changes_no_byte(void **state) {
    (void)state;
    run_world w = run_world_grid(6, true, 9);
    uint64_t hash = enf_hash64(w.bytes, w.size, 0);
    assert_true(advise_all(w.world) == hash); // in memory that dropped pages would not come back to
    char path[] = "advise-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0 && write(file, w.bytes, w.size) == (ssize_t)w.size);
    close(file);
    enf_world *mapped;
    assert_int_equal(enf_world_open_path(&mapped, path, NULL, NULL), ENF_OK);
    assert_true(advise_all(mapped) == hash);
    enf_world_close(mapped);
    remove(path);
    run_world_free(&w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_are_what_a_slow_search_finds),
        cmocka_unit_test(nonsense_has_no_list),
        cmocka_unit_test(advice_changes_no_byte),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
