// SPDX-License-Identifier: GPL-3.0-or-later
// Moving objects against a plain model of the lists, after long sequences of random changes: the cells of an
// object are those that a query finds, lists hold who came when, and nothing gets lost when links run out.
#include "run_worlds.h"

#include "enfilade/objects.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "shared_data.h"

enum { OBJECTS = 40, LIST_MAX = OBJECTS };

/// What a list ought to hold.
typedef struct model_list {
    enf_object object[LIST_MAX];
    int count;
} model_list;

typedef struct model {
    const run_world *w;
    const enf_file_view *view;
    enf_objects *objects;
    enf_query *query;
    enf_object handle[OBJECTS]; ///< all zero: not there
    enf_shape shape[OBJECTS];
    model_list *lists; ///< cells, then nowhere
    enf_reached *reached;
    int32_t *cells;
    bool *in;
    uint64_t seed;
    int changes, several;
} model;

static bool same(enf_object a, enf_object b) {
    return a.slot == b.slot && a.generation == b.generation;
}

static int find_in(const model_list *list, enf_object object) {
    for (int i = 0; i < list->count; i++)
        if (same(list->object[i], object)) return i;
    return -1;
}

static void start_model(model *m, const run_world *w, int32_t links_max, uint64_t seed) {
    memset(m, 0, sizeof *m);
    m->w = w;
    m->view = enf_world_file(w->world);
    m->seed = seed;
    size_t count = (size_t)m->view->cell_count + 1;
    m->lists = calloc(count, sizeof *m->lists);
    m->reached = calloc(count, sizeof *m->reached);
    m->cells = calloc(4 * count, sizeof *m->cells);
    m->in = calloc(count, sizeof *m->in);
    assert_true(m->lists && m->reached && m->cells && m->in);
    enf_objects_options options = {.size = sizeof options, .objects_max = OBJECTS, .links_max = links_max};
    assert_int_equal(enf_objects_create(&m->objects, w->world, &options, NULL), ENF_OK);
    assert_int_equal(enf_query_create(&m->query, w->world, NULL, NULL), ENF_OK);
}

static void end_model(model *m) {
    enf_objects_free(m->objects);
    enf_query_free(m->query);
    free(m->lists);
    free(m->reached);
    free(m->cells);
    free(m->in);
}

/// Marks the lists that a shape belongs to.
static int find_lists(model *m, const enf_shape *shape) {
    int32_t nowhere = m->view->cell_count;
    enf_reach reach;
    memset(m->in, 0, (size_t)nowhere + 1);
    assert_int_equal(enf_query_cells(m->query, NULL, -1, shape, m->reached, nowhere, &reach, NULL), ENF_OK);
    for (int32_t i = 0; i < reach.count; i++) m->in[m->reached[i].cell] = true;
    if (reach.count == 0) m->in[nowhere] = true;
    return reach.count;
}

/// The plain way: an object leaves the lists that it does not belong to, and comes last where it is new.
static void set_model(model *m, enf_object object, bool exists) {
    for (int32_t i = 0; i <= m->view->cell_count; i++) {
        model_list *list = &m->lists[i];
        int at = find_in(list, object);
        bool wanted = exists && m->in[i];
        if (at >= 0 && !wanted) {
            memmove(&list->object[at], &list->object[at + 1],
                    (size_t)(--list->count - at) * sizeof *list->object);
        } else if (at < 0 && wanted) {
            list->object[list->count++] = object;
        }
    }
}

static double size_of(const run_world *w) {
    return fmax(w->box_max[0] - w->box_min[0],
                fmax(w->box_max[1] - w->box_min[1], w->box_max[2] - w->box_min[2]));
}

static void random_place(model *m, enf_shape *shape) {
    double size = size_of(m->w) * 0.3 * pow(run_random_share(&m->seed), 2);
    *shape = (enf_shape){.kind = run_random(&m->seed) % 2 ? ENF_SHAPE_BOX : ENF_SHAPE_SPHERE};
    for (int a = 0; a < 3; a++) {
        double wide = 1.1 * (m->w->box_max[a] - m->w->box_min[a]);
        shape->centre[a] = m->w->box_min[a] + (run_random_share(&m->seed) - 0.05) * wide;
        if (shape->kind == ENF_SHAPE_BOX) shape->half[a] = size * run_random_share(&m->seed);
    }
    if (shape->kind == ENF_SHAPE_SPHERE) shape->radius = size;
}

static void change_one(model *m) {
    int i = (int)(run_random(&m->seed) % OBJECTS), what = (int)(run_random(&m->seed) % 16);
    if (m->handle[i].slot == 0) {
        random_place(m, &m->shape[i]);
        const enf_object *near = what % 2 ? &m->handle[(i + 1) % OBJECTS] : NULL;
        assert_int_equal(enf_objects_add(m->objects, &m->shape[i], (uint64_t)i, near, &m->handle[i], NULL),
                         ENF_OK);
        m->several += find_lists(m, &m->shape[i]) > 1;
        set_model(m, m->handle[i], true);
    } else if (what == 0) {
        enf_object gone = m->handle[i];
        assert_int_equal(enf_objects_remove(m->objects, gone, NULL), ENF_OK);
        set_model(m, gone, false);
        assert_int_equal(enf_objects_remove(m->objects, gone, NULL), ENF_BAD_USAGE);
        m->handle[i] = (enf_object){0, 0};
    } else {
        double step = size_of(m->w) * 0.02;
        if (what == 1) random_place(m, &m->shape[i]);
        for (int a = 0; a < 3; a++) m->shape[i].centre[a] += step * (run_random_share(&m->seed) - 0.5);
        assert_int_equal(enf_objects_move(m->objects, m->handle[i], &m->shape[i], NULL), ENF_OK);
        m->several += find_lists(m, &m->shape[i]) > 1;
        set_model(m, m->handle[i], true);
    }
    m->changes++;
}

static void check_lists(model *m) {
    enf_object listed[LIST_MAX];
    for (int32_t i = 0; i <= m->view->cell_count; i++) {
        int32_t cell = i < m->view->cell_count ? i : ENF_LIST_NOWHERE;
        int32_t count = enf_objects_of_cell(m->objects, cell, listed, LIST_MAX);
        assert_int_equal(count, m->lists[i].count);
        for (int k = 0; k < count; k++) assert_true(same(listed[k], m->lists[i].object[k]));
    }
    assert_int_equal(enf_objects_of_cell(m->objects, m->view->cell_count, listed, LIST_MAX), 0);
    assert_int_equal(enf_objects_of_cell(m->objects, -3, listed, LIST_MAX), 0);
}

/// The cells of all objects are those that they would get in an empty set.
static void check_fresh(model *m) {
    int32_t cells[2][64];
    enf_objects *fresh;
    enf_objects_options options = {.size = sizeof options, .objects_max = OBJECTS, .links_max = 10000};
    assert_int_equal(enf_objects_create(&fresh, m->w->world, &options, NULL), ENF_OK);
    for (int i = 0; i < OBJECTS; i++) {
        if (m->handle[i].slot == 0) continue;
        enf_object handle;
        enf_object_info info[2];
        assert_int_equal(enf_objects_add(fresh, &m->shape[i], 0, NULL, &handle, NULL), ENF_OK);
        int32_t count = enf_objects_cells(fresh, handle, cells[0], 64);
        assert_int_equal(enf_objects_cells(m->objects, m->handle[i], cells[1], 64), count);
        for (int32_t k = 0; k < count && k < 64; k++) {
            int found = 0;
            for (int32_t n = 0; n < count && n < 64; n++) found += cells[1][n] == cells[0][k];
            if (count <= 64) assert_int_equal(found, 1);
        }
        assert_true(enf_objects_get(fresh, handle, &info[0]) &&
                    enf_objects_get(m->objects, m->handle[i], &info[1]));
        assert_int_equal(info[1].user, i);
        assert_int_equal(info[0].cell, info[1].cell);
        assert_int_equal(info[1].cell_count, count);
        assert_memory_equal(info[1].shape.centre, m->shape[i].centre, sizeof info[1].shape.centre);
    }
    enf_objects_free(fresh);
}

/// Objects of random cells, listed once, in the order of the cells.
static void check_many_cells(model *m) {
    enf_object expected[OBJECTS], got[OBJECTS];
    int count = 0, cell_count = (int)(run_random(&m->seed) % (uint64_t)(3 * m->view->cell_count));
    for (int k = 0; k < cell_count; k++) {
        int32_t cell = (int32_t)(run_random(&m->seed) % (uint64_t)(m->view->cell_count + 4)) - 3;
        m->cells[k] = cell;
        if (cell < -1 || cell >= m->view->cell_count) continue;
        const model_list *list = &m->lists[cell < 0 ? m->view->cell_count : cell];
        for (int i = 0; i < list->count; i++) {
            bool known = false;
            for (int n = 0; n < count; n++) known = known || same(expected[n], list->object[i]);
            if (!known) expected[count++] = list->object[i];
        }
    }
    assert_int_equal(enf_objects_in_cells(m->objects, m->query, m->cells, cell_count, got, OBJECTS), count);
    for (int i = 0; i < count; i++) assert_true(same(got[i], expected[i]));
    assert_int_equal(enf_objects_in_cells(m->objects, m->query, m->cells, cell_count, NULL, 0), count);
}

/// Returns how often an object came into more cells than one.
static int run_changes(const run_world *w, uint64_t seed, int rounds) {
    model m;
    start_model(&m, w, 10000, seed);
    for (int round = 0; round < rounds; round++) {
        for (int i = 0; i < 100; i++) change_one(&m);
        check_lists(&m);
        check_many_cells(&m);
        if (round % 4 == 0) check_fresh(&m);
    }
    for (int i = 0; i < OBJECTS; i++)
        if (m.handle[i].slot) assert_int_equal(enf_objects_remove(m.objects, m.handle[i], NULL), ENF_OK);
    enf_objects_use use = enf_objects_get_use(m.objects);
    assert_true(use.objects == 0 && use.links == 0 && use.nowhere == 0 && use.everywhere == 0);
    end_model(&m);
    return m.several;
}

static void random_changes(void **state) {
    (void)state;
    uint64_t seed = 2718;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int i = 0; i < 4; i++) {
        run_world w = run_world_grid(4 + i % 2 * 2, i >= 2, run_random(&seed));
        assert_true(run_changes(&w, run_random(&seed), 40) > 400);
        run_world_free(&w);
    }
}

/// The lists stay what they should be when the portals are nonsense.
static void hostile_portals_keep_the_lists_whole(void **state) {
    (void)state;
    uint64_t seed = 13;
    print_message("seed %llu\n", (unsigned long long)seed);
    for (int i = 0; i < 10; i++) {
        run_world w = run_world_grid(4, i % 2, run_random(&seed));
        run_world_scramble(&w, &seed);
        run_changes(&w, run_random(&seed), 4);
        run_world_free(&w);
    }
}

/// With few links, an object is in all its cells or everywhere; and comes back when there is room.
static void nothing_is_lost_without_links(void **state) {
    (void)state;
    uint64_t seed = 31;
    print_message("seed %llu\n", (unsigned long long)seed);
    run_world w = run_world_grid(6, false, 31);
    model m;
    start_model(&m, &w, 12, seed);
    int crowded = 0;
    for (int round = 0; round < 2000; round++) {
        int i = (int)(run_random(&m.seed) % OBJECTS);
        random_place(&m, &m.shape[i]);
        if (m.handle[i].slot)
            assert_int_equal(enf_objects_move(m.objects, m.handle[i], &m.shape[i], NULL), ENF_OK);
        else
            assert_int_equal(enf_objects_add(m.objects, &m.shape[i], 0, NULL, &m.handle[i], NULL), ENF_OK);
        enf_object_info info;
        assert_true(enf_objects_get(m.objects, m.handle[i], &info));
        int count = find_lists(&m, &m.shape[i]);
        crowded += info.everywhere;
        assert_int_equal(info.cell_count, info.everywhere ? 0 : count);
        enf_objects_use use = enf_objects_get_use(m.objects);
        assert_true(use.links <= 12);
        if (info.everywhere) assert_true(use.links + count - 1 > 12);
        enf_object all[OBJECTS];
        int32_t cell = m.view->cell_count - 1;
        int32_t found = enf_objects_in_cells(m.objects, m.query, &cell, 1, all, OBJECTS);
        int32_t own = enf_objects_of_cell(m.objects, cell, NULL, 0);
        assert_int_equal(found, own + use.everywhere);
        assert_int_equal(enf_objects_of_cell(m.objects, ENF_LIST_EVERYWHERE, NULL, 0), use.everywhere);
        assert_int_equal(enf_objects_of_cell(m.objects, ENF_LIST_NOWHERE, NULL, 0), use.nowhere);
    }
    assert_true(crowded > 100);
    for (int i = 1; i < OBJECTS; i++)
        if (m.handle[i].slot) assert_int_equal(enf_objects_remove(m.objects, m.handle[i], NULL), ENF_OK);
    enf_objects_use use = enf_objects_get_use(m.objects);
    assert_true(use.everywhere <= 1 && use.objects == 1);
    m.shape[0].radius = m.shape[0].half[0] = m.shape[0].half[1] = m.shape[0].half[2] = 0;
    assert_int_equal(enf_objects_move(m.objects, m.handle[0], &m.shape[0], NULL), ENF_OK);
    use = enf_objects_get_use(m.objects);
    assert_int_equal(use.everywhere, 0);
    end_model(&m);
    run_world_free(&w);
}

static void old_handles_are_refused(void **state) {
    (void)state;
    run_world w = run_world_grid(4, false, 8);
    enf_objects *objects;
    enf_objects_options options = {.size = sizeof options, .objects_max = 2, .links_max = 5};
    assert_int_equal(enf_objects_create(&objects, w.world, &options, NULL), ENF_OK);
    enf_shape shape = {.centre = {1, 1, 1}, .radius = 0.1};
    enf_object first, second, third;
    enf_object_info info;
    enf_error error;
    assert_int_equal(enf_objects_add(objects, &shape, 1, NULL, &first, NULL), ENF_OK);
    assert_int_equal(enf_objects_add(objects, &shape, 2, &first, &second, NULL), ENF_OK);
    assert_int_equal(enf_objects_add(objects, &shape, 3, NULL, &third, &error), ENF_NO_RESOURCES);
    assert_int_equal(third.slot, 0);
    assert_int_equal(enf_objects_remove(objects, first, NULL), ENF_OK);
    assert_int_equal(enf_objects_add(objects, &shape, 3, &first, &third, NULL), ENF_OK);
    assert_int_equal(third.slot, first.slot);
    const enf_object bad[] = {first, {0, 0}, {3, 0}, {UINT32_MAX, 0}, {second.slot, 9}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        assert_int_equal(enf_objects_move(objects, bad[i], &shape, &error), ENF_BAD_USAGE);
        assert_int_equal(enf_objects_remove(objects, bad[i], &error), ENF_BAD_USAGE);
        assert_false(enf_objects_get(objects, bad[i], &info));
        assert_int_equal(enf_objects_cells(objects, bad[i], NULL, 0), 0);
        assert_false(enf_objects_meets(objects, bad[i], NULL, 0));
    }
    shape.radius = NAN;
    assert_int_equal(enf_objects_move(objects, third, &shape, &error), ENF_BAD_USAGE);
    assert_int_equal(enf_objects_add(objects, &shape, 3, NULL, &first, &error), ENF_BAD_USAGE);
    assert_true(enf_objects_get(objects, third, &info) && info.user == 3 && info.shape.radius == 0.1);
    options.objects_max = -1;
    enf_objects *none;
    assert_int_equal(enf_objects_create(&none, w.world, &options, NULL), ENF_BAD_USAGE);
    assert_null(none);
    enf_objects_free(objects);
    enf_objects_free(NULL);
    run_world_free(&w);
}

/// A point of an object that lies in a region is never missed, and objects wholly behind one plane are.
static void regions_meet_what_reaches_into_them(void **state) {
    (void)state;
    uint64_t seed = 5;
    print_message("seed %llu\n", (unsigned long long)seed);
    run_world w = run_world_grid(4, false, 8);
    model m;
    start_model(&m, &w, 10000, seed);
    int met = 0, missed = 0;
    for (int i = 0; i < OBJECTS; i++) {
        random_place(&m, &m.shape[i]);
        assert_int_equal(enf_objects_add(m.objects, &m.shape[i], 0, NULL, &m.handle[i], NULL), ENF_OK);
    }
    for (int n = 0; n < 4000; n++) {
        double planes[3][4];
        const enf_shape *shape = &m.shape[n % OBJECTS];
        for (int k = 0; k < 12; k++)
            planes[k / 4][k % 4] = (run_random_share(&m.seed) - 0.5) * (k % 4 == 3 ? 8 : 4);
        bool meets = enf_objects_meets(m.objects, m.handle[n % OBJECTS], (const double(*)[4])planes, 3);
        bool inside = false, behind = false;
        for (int p = 0; p < 3; p++) {
            double reach = 0, height = planes[p][3], square = 0;
            for (int a = 0; a < 3; a++) {
                height += planes[p][a] * shape->centre[a];
                reach += fabs(planes[p][a]) * shape->half[a];
                square += planes[p][a] * planes[p][a];
            }
            behind = behind || height + fmax(reach, sqrt(square) * shape->radius) < -1e-9;
        }
        for (int s = 0; s < 50 && !inside; s++) {
            double at[3], away = 0;
            for (int a = 0; a < 3; a++) {
                at[a] = 2 * run_random_share(&m.seed) - 1;
                away += at[a] * at[a];
            }
            if (shape->kind == ENF_SHAPE_SPHERE && away > 1) continue;
            inside = true;
            for (int p = 0; p < 3; p++) {
                double height = planes[p][3];
                for (int a = 0; a < 3; a++)
                    height += planes[p][a] * (shape->centre[a] + at[a] * (shape->radius + shape->half[a]));
                inside = inside && height >= 0;
            }
        }
        if (inside) assert_true(meets);
        if (behind) assert_false(meets);
        met += inside;
        missed += behind;
    }
    assert_true(met > 500 && missed > 500);
    end_model(&m);
    run_world_free(&w);
}

#ifdef ENFILADE_CLI
static void compiled_worlds(void **state) {
    (void)state;
    run_world w = run_world_compile(ENFILADE_MODELS_DIR "/office.obj");
    assert_true(run_changes(&w, 3, 20) > 200);
    run_world_free(&w);
}

static void a_level(void **state) {
    (void)state;
    char path[512];
    snprintf(path, sizeof path, "%s/quake/obj/end.obj.gz", shared_data());
    run_world w = run_world_compile(path);
    assert_true(run_changes(&w, 4, 20) > 200);
    run_world_free(&w);
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(random_changes),
        cmocka_unit_test(hostile_portals_keep_the_lists_whole),
        cmocka_unit_test(nothing_is_lost_without_links),
        cmocka_unit_test(old_handles_are_refused),
        cmocka_unit_test(regions_meet_what_reaches_into_them),
#ifdef ENFILADE_CLI
        cmocka_unit_test(compiled_worlds),
        cmocka_unit_test(a_level),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
