// SPDX-License-Identifier: GPL-3.0-or-later
// The rule of threads, for a thread sanitizer: eight readers that locate, ask what shapes reach, look through
// portals and read the lists of objects; one writer that moves doors whenever it likes, and objects under a
// lock for readers and writers. What readers see must hold together.
#include "run_worlds.h"

#include "enfilade/objects.h"
#include "run/instance.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <pthread.h>

enum { READERS = 8, OBJECTS = 64, CHANGES = 1500, ROUNDS = 100, CELLS_MAX = 512 };

typedef struct stage {
    run_world w;
    const enf_file_view *view;
    enf_instance *instance;
    enf_objects *objects;
    pthread_rwlock_t lock;
    pthread_mutex_t gate; ///< whoever wants the lock waits here, so that readers cannot keep the writer out
    atomic_bool done;
} stage;

typedef struct reader {
    stage *stage;
    enf_query *query;
    uint64_t seed;
    int64_t wrong;
    atomic_int rounds;
    pthread_t thread;
} reader;

static enf_shape random_shape(const run_world *w, uint64_t *seed) {
    enf_shape shape = {.kind = run_random(seed) % 2 ? ENF_SHAPE_BOX : ENF_SHAPE_SPHERE};
    for (int a = 0; a < 3; a++) {
        shape.centre[a] = w->box_min[a] + run_random_share(seed) * (w->box_max[a] - w->box_min[a]);
        shape.half[a] = run_random_share(seed);
    }
    shape.radius = run_random_share(seed);
    return shape;
}

/// The objects of some cells are there, and in one of these cells.
static void read_objects(reader *r, const int32_t *cells, int32_t count) {
    stage *s = r->stage;
    enf_object found[OBJECTS];
    pthread_mutex_lock(&s->gate);
    pthread_rwlock_rdlock(&s->lock);
    pthread_mutex_unlock(&s->gate);
    int32_t objects = enf_objects_in_cells(s->objects, r->query, cells, count, found, OBJECTS);
    for (int32_t i = 0; i < objects; i++) {
        enf_object_info info;
        int32_t own[CELLS_MAX];
        bool shared = false, known = enf_objects_get(s->objects, found[i], &info);
        int32_t own_count = enf_objects_cells(s->objects, found[i], own, CELLS_MAX);
        for (int32_t k = 0; k < own_count; k++)
            for (int32_t n = 0; n < count; n++) shared = shared || own[k] == cells[n];
        r->wrong += !known || !(shared || info.everywhere) || own_count != info.cell_count;
    }
    r->wrong += enf_objects_of_cell(s->objects, cells[0], found, OBJECTS) > OBJECTS;
    pthread_rwlock_unlock(&s->lock);
}

static void *read_all(void *user) {
    reader *r = user;
    stage *s = r->stage;
    enf_place place = {.tetrahedron = -1};
    while (!atomic_load(&s->done)) {
        enf_shape shape = random_shape(&s->w, &r->seed);
        enf_reached reached[CELLS_MAX];
        enf_reach reach;
        int32_t cells[CELLS_MAX];
        place = enf_world_locate(s->w.world, shape.centre, place.tetrahedron);
        if (place.cell < 0) continue;
        r->wrong +=
            enf_query_cells(r->query, s->instance, place.cell, &shape, reached, CELLS_MAX, &reach, NULL) != 0;
        r->wrong += reach.count < 1 || reached[0].cell != place.cell;
        r->wrong += enf_query_triangles(r->query, NULL, 0) > s->view->triangle_count;
        for (int32_t i = 0; i < reach.count; i++) cells[i] = reached[i].cell;
        int32_t portal = (int32_t)(run_random(&r->seed) % (uint64_t)s->view->portal_count);
        enf_passage passage = enf_instance_passage(s->instance, s->view, portal);
        r->wrong += passage.to >= 0 && passage.to != s->view->portals[portal].to;
        r->wrong += passage.cut && passage.plane[0] != passage.plane[3];
        read_objects(r, cells, reach.count);
        atomic_fetch_add(&r->rounds, 1);
    }
    return NULL;
}

static void change_objects(stage *s, enf_object *handles, uint64_t *seed) {
    pthread_mutex_lock(&s->gate);
    pthread_rwlock_wrlock(&s->lock);
    pthread_mutex_unlock(&s->gate);
    for (int k = 0; k < 4; k++) {
        enf_object *handle = &handles[run_random(seed) % OBJECTS];
        enf_shape shape = random_shape(&s->w, seed);
        if (handle->slot == 0) {
            assert_int_equal(enf_objects_add(s->objects, &shape, 0, NULL, handle, NULL), ENF_OK);
        } else if (run_random(seed) % 4) {
            assert_int_equal(enf_objects_move(s->objects, *handle, &shape, NULL), ENF_OK);
        } else {
            assert_int_equal(enf_objects_remove(s->objects, *handle, NULL), ENF_OK);
            *handle = (enf_object){0, 0};
        }
    }
    pthread_rwlock_unlock(&s->lock);
}

static void change_door(stage *s, uint64_t *seed) {
    double number = 1 + run_random_share(seed);
    enf_door door = {(enf_door_state)(run_random(seed) % 3), {number, number, number, number}};
    int32_t portal = (int32_t)(run_random(seed) % (uint64_t)s->view->portal_count);
    assert_int_equal(enf_instance_set_door(s->instance, portal, &door, NULL), ENF_OK);
}

static bool all_have_read(reader *readers) {
    for (int i = 0; i < READERS; i++)
        if (atomic_load(&readers[i].rounds) < ROUNDS) return false;
    return true;
}

static void readers_and_one_writer(void **state) {
    (void)state;
    static stage s;
    reader readers[READERS];
    enf_object handles[OBJECTS] = {{0, 0}};
    uint64_t seed = 64;
    print_message("seed %llu\n", (unsigned long long)seed);
    s.w = run_world_grid(6, true, 64);
    s.view = enf_world_file(s.w.world);
    assert_true(s.view->cell_count <= CELLS_MAX);
    enf_objects_options options = {.size = sizeof options, .objects_max = OBJECTS, .links_max = 400};
    assert_int_equal(enf_instance_create(&s.instance, s.w.world, NULL, NULL), ENF_OK);
    assert_int_equal(enf_objects_create(&s.objects, s.w.world, &options, NULL), ENF_OK);
    assert_int_equal(pthread_rwlock_init(&s.lock, NULL), 0);
    assert_int_equal(pthread_mutex_init(&s.gate, NULL), 0);
    for (int i = 0; i < READERS; i++) {
        readers[i].stage = &s;
        readers[i].seed = (uint64_t)i;
        readers[i].wrong = 0;
        atomic_init(&readers[i].rounds, 0);
        assert_int_equal(enf_query_create(&readers[i].query, s.w.world, NULL, NULL), ENF_OK);
        assert_int_equal(pthread_create(&readers[i].thread, NULL, read_all, &readers[i]), 0);
    }
    for (int i = 0; i < CHANGES || !all_have_read(readers); i++) {
        for (int k = 0; k < 8; k++) change_door(&s, &seed);
        change_objects(&s, handles, &seed);
    }
    atomic_store(&s.done, true);
    for (int i = 0; i < READERS; i++) {
        pthread_join(readers[i].thread, NULL);
        assert_true(readers[i].wrong == 0);
        enf_query_free(readers[i].query);
    }
    pthread_rwlock_destroy(&s.lock);
    pthread_mutex_destroy(&s.gate);
    enf_objects_free(s.objects);
    enf_instance_free(s.instance);
    run_world_free(&s.w);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(readers_and_one_writer),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
