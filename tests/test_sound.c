// SPDX-License-Identifier: GPL-3.0-or-later
// Ways of sound against all ways, listed by brute force: the best ones are found, with what portals and doors
// leave of the sound, and each comes from where its line says.
#include "run_worlds.h"

#include "enfilade/sound.h"
#include "run/instance.h"
#include "run/portal_shape.h"
#include "run/vector.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

enum { WAYS = 12, WAYS_MOST = 200000, PORTALS_MOST = 4096 };

typedef struct bench {
    run_world opened;
    const enf_file_view *view;
    enf_instance *instance;
    enf_paths *paths;
    enf_path_finder *finder;
    double *factors; ///< per pair
    double size, precision;

    // All ways.
    const enf_sound_query *query;
    int32_t listener_cell;
    bool *is_passed; ///< per cell
    double *costs;
    int count;
} bench;

static uint64_t begin(uint64_t seed) {
    print_message("seed %llu\n", (unsigned long long)seed);
    return seed;
}

static int32_t random_below(uint64_t *seed, int32_t count) {
    return (int32_t)(run_random(seed) % (uint64_t)count);
}

static void make_bench(bench *b, run_world opened, uint64_t *seed) {
    *b = (bench){.opened = opened, .view = enf_world_file(opened.world)};
    enf_path_finder_options options = {sizeof options, 1 << 18};
    enf_paths_info info;
    assert_int_equal(enf_instance_create(&b->instance, opened.world, NULL, NULL), ENF_OK);
    assert_int_equal(enf_paths_create(&b->paths, opened.world, NULL, NULL), ENF_OK);
    assert_int_equal(enf_path_finder_create(&b->finder, b->paths, &options, NULL), ENF_OK);
    enf_paths_get_info(b->paths, &info);
    b->size = enf_distance(opened.box_min, opened.box_max);
    b->precision = info.precision * 2 * (b->view->portal_count + 2) + 1e-9 * b->size;
    b->factors = calloc((size_t)b->view->portal_count + 1, sizeof *b->factors);
    b->is_passed = calloc((size_t)b->view->cell_count, sizeof *b->is_passed);
    b->costs = malloc(WAYS_MOST * sizeof *b->costs);
    for (int32_t i = 0; i < b->view->portal_count / 2; i++)
        b->factors[i] = run_random(seed) % 8 ? 0.3 + 0.9 * run_random_share(seed) : 0;
}

static void free_bench(bench *b) {
    enf_path_finder_free(b->finder);
    enf_paths_free(b->paths);
    enf_instance_free(b->instance);
    free(b->factors);
    free(b->is_passed);
    free(b->costs);
    run_world_free(&b->opened);
}

static double factor_of(const bench *b, int32_t portal) {
    double factor = b->query->factors ? fmin(1, b->query->factors[portal / 2]) : 1;
    bool shut = enf_instance_get_door(b->instance, portal).state == ENF_DOOR_CLOSED;
    return shut ? factor * b->query->door_factor : factor;
}

/// Where a portal leads, door or not; *place is where one comes out.
static int32_t pass(const bench *b, int32_t portal, double place[3]) {
    bool is_shut;
    enf_passage lead = enf_instance_lead(b->instance, b->view, portal, &is_shut);
    double middle[3];
    enf_portal_middle(b->view, portal, 1, middle);
    for (int a = 0; a < 3; a++)
        place[a] = lead.matrix ? enf_dot(lead.matrix + 4 * a, middle) + lead.matrix[4 * a + 3] : middle[a];
    return lead.to;
}

/// Lists the costs of all ways that go on from a place in a cell.
static void list_ways(bench *b, int32_t cell, const double place[3], double cost) {
    const enf_file_cell *c = &b->view->cells[cell];
    if (cost > b->query->range || b->count == WAYS_MOST) return;
    if (cell == b->listener_cell) {
        cost += enf_distance(place, b->query->listener);
        if (cost <= b->query->range) b->costs[b->count++] = cost;
        return;
    }
    b->is_passed[cell] = true;
    for (int32_t i = 0; i < c->portal_count; i++) {
        int32_t portal = b->view->cell_portals[c->portal_first + i];
        double factor = factor_of(b, portal), middle[3], out[3];
        int32_t to = pass(b, portal, out);
        if (!(factor > 0) || b->is_passed[to]) continue;
        enf_portal_middle(b->view, portal, 1, middle);
        list_ways(b, to, out, cost + enf_distance(place, middle) - b->query->fade_length * log(factor));
    }
    b->is_passed[cell] = false;
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/// What a way cost before it was pulled; checks that its portals lead from the source to the listener.
static double cost_of(const bench *b, const enf_sound_path *path, const int32_t *portals) {
    double cost = 0, at[3], middle[3], factor = 1;
    int32_t cell = b->query->source_cell;
    memcpy(at, b->query->source, sizeof at);
    for (int32_t i = 0; i < path->portal_count; i++) {
        assert_int_equal(b->view->portals[portals[i]].from, cell);
        enf_portal_middle(b->view, portals[i], 1, middle);
        cost += enf_distance(at, middle) - b->query->fade_length * log(factor_of(b, portals[i]));
        factor *= factor_of(b, portals[i]);
        cell = pass(b, portals[i], at);
    }
    assert_int_equal(cell, b->listener_cell);
    assert_true(fabs(factor - path->factor) <= 1e-12);
    assert_int_equal(path->portal, path->portal_count > 0 ? portals[path->portal_count - 1] : -1);
    return cost + enf_distance(at, b->query->listener);
}

static void check_direction(const bench *b, const enf_sound_path *path) {
    double distance = enf_distance(path->point, b->query->listener);
    assert_true(distance <= path->length + b->precision);
    for (int a = 0; a < 3; a++)
        assert_true(fabs(b->query->listener[a] + distance * path->direction[a] - path->point[a]) <=
                    b->precision);
    if (path->portal < 0) {
        assert_memory_equal(path->point, b->query->source, sizeof path->point);
    } else {
        double nearest[3];
        bool is_shut;
        if (enf_instance_lead(b->instance, b->view, path->portal, &is_shut).matrix) return;
        assert_true(enf_portal_nearest(b->view, path->portal, path->point, nearest));
        assert_true(enf_distance(nearest, path->point) <= 1e-9 * b->size);
    }
}

/// The costs before pulling are the least of all; those after pulling are less, and in order.
static int check_sound(bench *b, const enf_sound_query *query) {
    enf_sound_path ways[WAYS];
    enf_sound sound;
    double costs[WAYS];
    b->query = query;
    b->listener_cell = query->listener_cell;
    b->count = 0;
    list_ways(b, query->source_cell, query->source, 0);
    if (b->count == WAYS_MOST) return 0;
    qsort(b->costs, (size_t)b->count, sizeof *b->costs, compare_doubles);
    assert_int_equal(enf_sound_find(b->finder, b->instance, query, ways, WAYS, &sound, NULL), ENF_OK);
    assert_true(sound.is_complete);
    if (sound.count != (b->count < WAYS ? b->count : WAYS)) fail_msg("%d ways of %d", sound.count, b->count);
    for (int i = 0; i < sound.count; i++) {
        const enf_sound_path *way = &ways[i];
        assert_true(way->portal_first >= 0);
        costs[i] = cost_of(b, way, query->portals + way->portal_first);
        assert_true(way->cost <= costs[i] + b->precision);
        assert_true(fabs(way->cost - (way->length - query->fade_length * log(way->factor))) <= b->precision);
        if (i > 0) assert_true(ways[i - 1].cost <= way->cost);
        check_direction(b, way);
    }
    qsort(costs, (size_t)sound.count, sizeof *costs, compare_doubles);
    for (int i = 0; i < sound.count; i++) assert_true(fabs(costs[i] - b->costs[i]) <= b->precision);
    return sound.count;
}

static void change_instance(bench *b, bool transforms, uint64_t *seed) {
    for (int32_t i = 0; i < b->view->portal_count; i += 2) {
        enf_door door = {.state = run_random(seed) % 4 ? ENF_DOOR_OPEN : ENF_DOOR_CLOSED};
        enf_instance_set_door(b->instance, i, &door, NULL);
    }
    for (int k = 0; k < 6 && transforms; k++) {
        double matrix[12] = {0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0};
        for (int a = 0; a < 3; a++) matrix[4 * a + 3] = (run_random_share(seed) - 0.5) * b->size / 4;
        enf_instance_set_transform(b->instance, random_below(seed, b->view->portal_count),
                                   random_below(seed, b->view->cell_count), matrix, NULL);
    }
}

static void random_query(bench *b, enf_sound_query *query, int32_t *portals, uint64_t *seed) {
    *query = (enf_sound_query){.size = sizeof *query,
                               .source_cell = random_below(seed, b->view->cell_count),
                               .listener_cell = random_below(seed, b->view->cell_count),
                               .range = b->size * (0.4 + 1.2 * run_random_share(seed)),
                               .fade_length = run_random(seed) % 2 ? b->size * run_random_share(seed) : 0,
                               .factors = run_random(seed) % 3 ? b->factors : NULL,
                               .door_factor = run_random(seed) % 2 ? 0.4 : 0,
                               .portals = portals,
                               .portal_capacity = PORTALS_MOST};
    for (int a = 0; a < 3; a++) {
        double span = b->opened.box_max[a] - b->opened.box_min[a];
        query->source[a] = b->opened.box_min[a] + run_random_share(seed) * span;
        query->listener[a] = b->opened.box_min[a] + run_random_share(seed) * span;
    }
}

static void the_best_ways_are_found(void **state) {
    (void)state;
    uint64_t seed = begin(11);
    int32_t *portals = malloc(PORTALS_MOST * sizeof *portals);
    int found = 0;
    for (int n = 0; n < 40; n++) {
        bench b;
        make_bench(&b, run_world_grid(n % 3 ? 4 : 2, n % 2, run_random(&seed)), &seed);
        for (int k = 0; k < 24 && b.view->portal_count > 0; k++) {
            enf_sound_query query;
            if (k % 8 == 2) change_instance(&b, k > 8, &seed);
            random_query(&b, &query, portals, &seed);
            found += check_sound(&b, &query);
        }
        free_bench(&b);
    }
    print_message("%d ways\n", found);
    assert_true(found > 1000);
    free(portals);
}

static double ask(void *user, int32_t portal) {
    const double *factors = user;
    return factors[portal / 2];
}

static void a_callback_is_as_good_as_an_array(void **state) {
    (void)state;
    uint64_t seed = begin(12);
    bench b;
    make_bench(&b, run_world_grid(4, true, 5), &seed);
    for (int k = 0; k < 40; k++) {
        enf_sound_query query;
        enf_sound_path ways[2][WAYS];
        enf_sound sound[2];
        random_query(&b, &query, NULL, &seed);
        query.factors = b.factors;
        assert_int_equal(enf_sound_find(b.finder, NULL, &query, ways[0], WAYS, &sound[0], NULL), ENF_OK);
        query.factors = NULL;
        query.factor = ask;
        query.user = b.factors;
        assert_int_equal(enf_sound_find(b.finder, NULL, &query, ways[1], WAYS, &sound[1], NULL), ENF_OK);
        assert_int_equal(sound[0].count, sound[1].count);
        for (int i = 0; i < sound[0].count; i++) {
            assert_true(ways[0][i].cost == ways[1][i].cost && ways[0][i].portal == ways[1][i].portal);
            assert_int_equal(ways[0][i].portal_first, -1);
        }
    }
    free_bench(&b);
}

/// With few steps the answer is a part of the whole one, and says so.
static void few_steps_are_reported(void **state) {
    (void)state;
    uint64_t seed = begin(13);
    bench b;
    make_bench(&b, run_world_grid(6, false, 3), &seed);
    enf_path_finder *finder;
    enf_path_finder_options options = {sizeof options, 5};
    assert_int_equal(enf_path_finder_create(&finder, b.paths, &options, NULL), ENF_OK);
    int incomplete = 0;
    for (int k = 0; k < 100; k++) {
        enf_sound_query query;
        enf_sound_path ways[WAYS];
        enf_sound sound;
        random_query(&b, &query, NULL, &seed);
        query.range = INFINITY;
        assert_int_equal(enf_sound_find(finder, NULL, &query, ways, WAYS, &sound, NULL), ENF_OK);
        incomplete += !sound.is_complete;
    }
    assert_true(incomplete > 10);
    enf_path_finder_free(finder);
    free_bench(&b);
}

static void nonsense_ends(void **state) {
    (void)state;
    uint64_t seed = begin(14);
    for (int n = 0; n < 60; n++) {
        run_world opened = run_world_grid(4, n % 2, run_random(&seed));
        run_world_scramble(&opened, &seed);
        bench b;
        make_bench(&b, opened, &seed);
        for (int32_t i = 0; i < b.view->portal_count / 2; i++)
            b.factors[i] = run_random(&seed) % 4 ? run_nasty(&seed) : NAN;
        for (int k = 0; k < 24; k++) {
            enf_sound_query query;
            enf_sound_path ways[WAYS];
            enf_sound sound;
            random_query(&b, &query, NULL, &seed);
            for (int a = 0; a < 3; a++) query.source[a] = run_nasty(&seed);
            query.range = k % 2 ? fabs(run_nasty(&seed)) : INFINITY;
            query.fade_length = fabs(run_nasty(&seed));
            query.factors = b.factors;
            query.door_factor = run_nasty(&seed);
            assert_int_equal(enf_sound_find(b.finder, b.instance, &query, ways, WAYS, &sound, NULL), ENF_OK);
        }
        free_bench(&b);
    }
}

static void wrong_calls_are_refused(void **state) {
    (void)state;
    uint64_t seed = 15;
    bench b;
    make_bench(&b, run_world_grid(2, false, 7), &seed);
    enf_sound_query query = {.size = sizeof query, .range = 1}, bad = query;
    enf_sound_path way;
    enf_sound sound;
    assert_int_equal(enf_sound_find(b.finder, NULL, &query, &way, 1, &sound, NULL), ENF_OK);
    bad.range = NAN;
    assert_int_equal(enf_sound_find(b.finder, NULL, &bad, &way, 1, &sound, NULL), ENF_BAD_USAGE);
    bad = query;
    bad.fade_length = -1;
    assert_int_equal(enf_sound_find(b.finder, NULL, &bad, &way, 1, &sound, NULL), ENF_BAD_USAGE);
    bad = query;
    bad.listener[1] = INFINITY;
    assert_int_equal(enf_sound_find(b.finder, NULL, &bad, &way, 1, &sound, NULL), ENF_BAD_USAGE);
    bad = query;
    bad.source_cell = b.view->cell_count;
    assert_int_equal(enf_sound_find(b.finder, NULL, &bad, &way, 1, &sound, NULL), ENF_BAD_USAGE);
    bad = query;
    bad.source_cell = -1;
    bad.source[0] = 1e6;
    assert_int_equal(enf_sound_find(b.finder, NULL, &bad, &way, 1, &sound, NULL), ENF_OK);
    assert_int_equal(sound.count, 0);
    free_bench(&b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_best_ways_are_found), cmocka_unit_test(a_callback_is_as_good_as_an_array),
        cmocka_unit_test(few_steps_are_reported),  cmocka_unit_test(nonsense_ends),
        cmocka_unit_test(wrong_calls_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
