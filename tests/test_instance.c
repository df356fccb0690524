// SPDX-License-Identifier: GPL-3.0-or-later
// Doors and transforms of an instance: what is set is what passages say, nonsense is refused, and readers
// that run while a door moves never see half of a change.
#include "world_fixture.h"

#include "enfilade/instance.h"
#include "run/instance.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <pthread.h>

enum { READERS = 3, CHANGES = 20000 };

typedef struct opened {
    fixture_saved *saved;
    enf_world *world;
    enf_instance *instance;
} opened;

static int set_up(void **state) {
    opened *o = calloc(1, sizeof *o);
    void *saved = NULL;
    fixture_set_up(&saved);
    o->saved = saved;
    *state = o;
    if (enf_world_open_memory(&o->world, o->saved->bytes, o->saved->size, NULL, NULL)) return -1;
    return enf_instance_create(&o->instance, o->world, NULL, NULL) ? -1 : 0;
}

static int tear_down(void **state) {
    opened *o = *state;
    enf_instance_free(o->instance);
    enf_world_close(o->world);
    void *saved = o->saved;
    fixture_tear_down(&saved);
    free(o);
    return 0;
}

static void a_door_shuts_both_ways(void **state) {
    opened *o = *state;
    const enf_file_view *view = enf_world_file(o->world);
    assert_true(view->portal_count >= 2);
    enf_door shut = {.state = ENF_DOOR_CLOSED};
    for (int portal = 0; portal < 2; portal++) {
        assert_int_equal(enf_instance_passage(NULL, view, portal).to, view->portals[portal].to);
        assert_int_equal(enf_instance_passage(o->instance, view, portal).to, view->portals[portal].to);
    }
    assert_int_equal(enf_instance_set_door(o->instance, 1, &shut, NULL), ENF_OK);
    for (int portal = 0; portal < 2; portal++) {
        assert_int_equal(enf_instance_passage(o->instance, view, portal).to, -1);
        assert_int_equal(enf_instance_get_door(o->instance, portal).state, ENF_DOOR_CLOSED);
    }
    enf_door ajar = {.state = ENF_DOOR_PARTLY, .plane = {0, 0, 2, -1}};
    assert_int_equal(enf_instance_set_door(o->instance, 0, &ajar, NULL), ENF_OK);
    enf_passage passage = enf_instance_passage(o->instance, view, 1);
    assert_true(passage.cut && passage.to == view->portals[1].to);
    assert_memory_equal(passage.plane, ajar.plane, sizeof ajar.plane);
    assert_int_equal(enf_instance_set_door(o->instance, 0, &(enf_door){0}, NULL), ENF_OK);
    assert_false(enf_instance_passage(o->instance, view, 1).cut);
}

static void a_transform_leads_elsewhere(void **state) {
    opened *o = *state;
    const enf_file_view *view = enf_world_file(o->world);
    const double mirror[12] = {-1, 0, 0, 5, 0, 1, 0, 0, 0, 0, 1, 0};
    int32_t from = view->portals[0].from;
    assert_int_equal(enf_instance_set_transform(o->instance, 0, from, mirror, NULL), ENF_OK);
    enf_passage passage = enf_instance_passage(o->instance, view, 0);
    assert_int_equal(passage.to, from);
    assert_memory_equal(passage.matrix, mirror, sizeof mirror);
    assert_null(enf_instance_passage(o->instance, view, 1).matrix);
    assert_int_equal(enf_instance_set_transform(o->instance, 0, 0, NULL, NULL), ENF_OK);
    passage = enf_instance_passage(o->instance, view, 0);
    assert_true(!passage.matrix && passage.to == view->portals[0].to);
}

static void nonsense_is_refused(void **state) {
    opened *o = *state;
    const enf_file_view *view = enf_world_file(o->world);
    enf_door door = {.state = ENF_DOOR_PARTLY};
    enf_error error;
    assert_int_equal(enf_instance_set_door(o->instance, 0, &door, &error), ENF_BAD_USAGE);
    door.plane[0] = NAN;
    assert_int_equal(enf_instance_set_door(o->instance, 0, &door, &error), ENF_BAD_USAGE);
    door.state = (enf_door_state)7;
    assert_int_equal(enf_instance_set_door(o->instance, 0, &door, &error), ENF_BAD_USAGE);
    door.state = ENF_DOOR_CLOSED;
    assert_int_equal(enf_instance_set_door(o->instance, -1, &door, &error), ENF_BAD_USAGE);
    assert_int_equal(enf_instance_set_door(o->instance, view->portal_count, &door, &error), ENF_BAD_USAGE);
    assert_non_null(strstr(error.text, "portal"));
    double matrix[12] = {1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0}; // flat
    assert_int_equal(enf_instance_set_transform(o->instance, 0, 0, matrix, &error), ENF_BAD_USAGE);
    matrix[10] = INFINITY;
    assert_int_equal(enf_instance_set_transform(o->instance, 0, 0, matrix, &error), ENF_BAD_USAGE);
    matrix[10] = 1;
    assert_int_equal(enf_instance_set_transform(o->instance, 0, view->cell_count, matrix, &error),
                     ENF_BAD_USAGE);
    assert_int_equal(enf_instance_passage(o->instance, view, 0).to, view->portals[0].to);
}

typedef struct reading {
    const enf_instance *instance;
    const enf_file_view *view;
    atomic_bool *done;
    int64_t torn;
    pthread_t thread;
} reading;

static void *read_doors(void *user) {
    reading *reading = user;
    while (!atomic_load(reading->done)) {
        enf_passage passage = enf_instance_passage(reading->instance, reading->view, 0);
        for (int i = 1; passage.cut && i < 4; i++) reading->torn += passage.plane[i] != passage.plane[0];
    }
    return NULL;
}

static void readers_see_whole_changes(void **state) {
    opened *o = *state;
    atomic_bool done = false;
    reading readings[READERS];
    for (int i = 0; i < READERS; i++) {
        readings[i] = (reading){.instance = o->instance, .view = enf_world_file(o->world), .done = &done};
        assert_int_equal(pthread_create(&readings[i].thread, NULL, read_doors, &readings[i]), 0);
    }
    for (int i = 1; i <= CHANGES; i++) {
        enf_door door = {.state = ENF_DOOR_PARTLY, .plane = {i, i, i, i}};
        assert_int_equal(enf_instance_set_door(o->instance, i % 2, &door, NULL), ENF_OK);
    }
    atomic_store(&done, true);
    for (int i = 0; i < READERS; i++) {
        pthread_join(readings[i].thread, NULL);
        assert_true(readings[i].torn == 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(a_door_shuts_both_ways, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_transform_leads_elsewhere, set_up, tear_down),
        cmocka_unit_test_setup_teardown(nonsense_is_refused, set_up, tear_down),
        cmocka_unit_test_setup_teardown(readers_see_whole_changes, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
