// SPDX-License-Identifier: GPL-3.0-or-later
// Opening lazily: what is loaded shows exactly what a whole opening shows, what is not loaded shows nothing
// and is never touched. And option structs of other sizes.
#include "run_worlds.h"

#include "base/hash.h"
#include "base/options.h"
#include "enfilade/path.h"
#include "enfilade/prefetch.h"
#include "enfilade/query.h"
#include "enfilade/sight.h"
#include "enfilade/view.h"
#include "format/sections.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <pthread.h>

static const enf_open_options lazily = {.size = sizeof lazily, .mode = ENF_OPEN_LAZY};

typedef struct stage {
    run_world w;
    double inside[3]; ///< a point of a cell
} stage;

/// One world with a visible set, and one with lines of sight and the exact complex.
enum { WITH_SET, WITH_SIGHT, STAGES };

static int set_up(void **state) {
    static stage stages[STAGES];
    uint64_t seed = 1;
    stages[WITH_SET].w = run_world_grid(4, false, 7);
    stages[WITH_SIGHT].w = run_world_whole(2);
    for (stage *s = stages; s < stages + STAGES; s++) {
        do {
            for (int a = 0; a < 3; a++)
                s->inside[a] =
                    s->w.box_min[a] + run_random_share(&seed) * (s->w.box_max[a] - s->w.box_min[a]);
        } while (enf_world_locate(s->w.world, s->inside, -1).cell < 0);
    }
    assert_non_null(enf_world_file(stages[WITH_SET].w.world)->pvs);
    assert_non_null(enf_world_file(stages[WITH_SIGHT].w.world)->sight);
    assert_true(enf_world_file(stages[WITH_SIGHT].w.world)->has_exact);
    *state = stages;
    return 0;
}

static int tear_down(void **state) {
    stage *stages = *state;
    for (int i = 0; i < STAGES; i++) run_world_free(&stages[i].w);
    return 0;
}

static enf_world *open_lazily(const unsigned char *bytes, size_t size) {
    enf_world *world;
    enf_error error = {0};
    if (enf_world_open_memory(&world, bytes, size, &lazily, &error)) fail_msg("%s", error.text);
    return world;
}

/// What a part needs, told once more: everything has to do with cells.
static uint32_t with_needs(uint32_t loads) {
    if (loads & ENF_LOAD_EXACT) loads |= ENF_LOAD_DRAW | ENF_LOAD_LOCATION;
    if (loads & ENF_LOAD_SIGHT) loads |= ENF_LOAD_LOCATION;
    if (loads) loads |= ENF_LOAD_CELLS;
    return loads;
}

/// Sections that are loaded are those of the whole file, with their counts; the others are not there.
static void expect_parts(const enf_file_view *view, const enf_file_view *whole, uint32_t loads) {
    for (int i = 0; i < enf_section_spec_count; i++) {
        const enf_section_spec *spec = &enf_section_specs[i];
        enf_loaded load = enf_section_load(spec);
        bool shown = load == ENF_LOADED_ALWAYS || loads >> (load - 1) & 1;
        const void *array = enf_view_array(view, spec);
        if (array != (shown ? enf_view_array(whole, spec) : NULL))
            fail_msg("%s with parts %#x", spec->tag, (unsigned)loads);
        if (shown && array)
            assert_int_equal(enf_view_count(view, spec->dimension), enf_view_count(whole, spec->dimension));
    }
    assert_int_equal(view->cell_count, loads & ENF_LOAD_CELLS ? whole->cell_count : 0);
    assert_int_equal(view->tetrahedron_count, loads & ENF_LOAD_LOCATION ? whole->tetrahedron_count : 0);
    assert_int_equal(view->triangle_count, loads & ENF_LOAD_DRAW ? whole->triangle_count : 0);
    assert_int_equal(view->barrier_count, loads & ENF_LOAD_SIGHT ? whole->barrier_count : 0);
    assert_true(view->has_geometry == (whole->has_geometry && loads & ENF_LOAD_DRAW));
    assert_true(view->has_exact == (whole->has_exact && loads & ENF_LOAD_EXACT));
}

static void every_set_of_parts_shows_these_parts_only(void **state) {
    stage *s = *state;
    for (uint32_t both = 0; both <= 2 * ENF_LOAD_ALL + 1; both++) {
        uint32_t loads = both & ENF_LOAD_ALL;
        s = (stage *)*state + (both > ENF_LOAD_ALL);
        enf_world *world = open_lazily(s->w.bytes, s->w.size);
        assert_int_equal(enf_world_load(world, loads, NULL), ENF_OK);
        assert_int_equal(enf_world_loaded(world), with_needs(loads));
        expect_parts(enf_world_file(world), enf_world_file(s->w.world), with_needs(loads));
        enf_world_close(world);
    }
    enf_world *world = open_lazily(s->w.bytes, s->w.size);
    assert_int_equal(enf_world_load(world, ENF_LOAD_ALL + 1, NULL), ENF_BAD_USAGE);
    enf_world_close(world);
}

static void older_views_stay_as_they_were(void **state) {
    stage *s = *state;
    enf_world *world = open_lazily(s->w.bytes, s->w.size);
    const enf_file_view *none = enf_world_file(world);
    assert_int_equal(enf_world_load(world, ENF_LOAD_CELLS, NULL), ENF_OK);
    const enf_file_view *cells = enf_world_file(world);
    assert_int_equal(enf_world_load(world, ENF_LOAD_CELLS, NULL), ENF_OK);
    assert_ptr_equal(enf_world_file(world), cells); // nothing to do
    assert_int_equal(enf_world_load(world, ENF_LOAD_ALL, NULL), ENF_OK);
    expect_parts(none, enf_world_file(s->w.world), 0);
    expect_parts(cells, enf_world_file(s->w.world), ENF_LOAD_CELLS);
    expect_parts(enf_world_file(world), enf_world_file(s->w.world), ENF_LOAD_ALL);
    enf_world_close(world);
}

static void what_is_not_loaded_is_not_there(void **state) {
    stage *s = (stage *)*state + WITH_SIGHT;
    enf_world *world = open_lazily(s->w.bytes, s->w.size);
    assert_int_equal(enf_world_locate(world, s->inside, -1).cell, -1);
    enf_sight_query query = {.size = sizeof query};
    enf_sight sight;
    enf_error error = {0};
    memcpy(query.from, s->inside, sizeof query.from);
    memcpy(query.to, s->inside, sizeof query.to);
    assert_int_equal(enf_sight_between(world, NULL, &query, &sight, &error), ENF_BAD_USAGE);
    assert_non_null(strstr(error.text, "ENF_LOAD_SIGHT"));
    enf_world_info info;
    enf_world_get_info(world, &info);
    assert_int_equal(info.cells, 0);
    assert_int_equal(info.regions, enf_world_file(s->w.world)->region_count); // what is small is there
    assert_int_equal(enf_world_load(world, ENF_LOAD_SIGHT, NULL), ENF_OK);
    assert_int_equal(enf_world_locate(world, s->inside, -1).cell,
                     enf_world_locate(s->w.world, s->inside, -1).cell);
    assert_int_equal(enf_sight_between(world, NULL, &query, &sight, &error), ENF_OK);
    assert_true(sight.is_free);
    enf_world_close(world);
}

static void what_is_made_from_a_world_loads_what_it_needs(void **state) {
    stage *s = *state;
    enf_instance *instance;
    enf_view *view;
    enf_query *query;
    enf_paths *paths;
    enf_prefetch *prefetch;
    enf_query_options no_triangles = {.size = sizeof no_triangles, .skip_triangles = true};
    for (int made = 0; made < 6; made++) {
        enf_world *world = open_lazily(s->w.bytes, s->w.size);
        uint32_t expected = ENF_LOAD_CELLS;
        switch (made) {
        case 0:
            assert_int_equal(enf_instance_create(&instance, world, NULL, NULL), ENF_OK);
            enf_instance_free(instance);
            break;
        case 1:
            assert_int_equal(enf_view_create(&view, world, NULL, NULL), ENF_OK);
            enf_view_free(view);
            expected |= ENF_LOAD_LOCATION | ENF_LOAD_SEEN;
            break;
        case 2:
            assert_int_equal(enf_query_create(&query, world, NULL, NULL), ENF_OK);
            enf_query_free(query);
            expected |= ENF_LOAD_LOCATION | ENF_LOAD_DRAW;
            break;
        case 3:
            assert_int_equal(enf_query_create(&query, world, &no_triangles, NULL), ENF_OK);
            enf_query_free(query);
            expected |= ENF_LOAD_LOCATION;
            break;
        case 4:
            assert_int_equal(enf_paths_create(&paths, world, NULL, NULL), ENF_OK);
            enf_paths_free(paths);
            expected |= ENF_LOAD_LOCATION;
            break;
        default:
            assert_int_equal(enf_prefetch_create(&prefetch, world, NULL), ENF_OK);
            enf_prefetch_free(prefetch);
            expected |= ENF_LOAD_SEEN;
        }
        assert_int_equal(enf_world_loaded(world), expected);
        enf_world_close(world);
    }
}

static enf_file_section *section_of(unsigned char *file, const char *tag) {
    const enf_file_header *header = (const void *)file;
    enf_file_section *sections = (void *)(file + header->table_offset);
    for (uint32_t i = 0; i < header->section_count; i++)
        if (strncmp(sections[i].tag, tag, 8) == 0) return &sections[i];
    return NULL;
}

/// Every section in turn becomes rubbish. All parts load but its own, and those that need it.
static void find_damage(const stage *s) {
    unsigned char *copy = malloc(s->w.size);
    assert_non_null(copy);
    memcpy(copy, s->w.bytes, s->w.size);
    int found = 0;
    for (int i = 0; i < enf_section_spec_count; i++) {
        const enf_section_spec *spec = &enf_section_specs[i];
        const enf_file_section *section = section_of(copy, spec->tag);
        if (!section || section->size == 0) continue;
        memset(copy + section->offset, 0xa5, section->size);
        enf_loaded load = enf_section_load(spec);
        enf_world *world;
        enf_error error = {0};
        enf_status status = enf_world_open_memory(&world, copy, s->w.size, &lazily, &error);
        assert_int_equal(status, load == ENF_LOADED_ALWAYS ? ENF_BAD_INPUT : ENF_OK);
        for (int part = 1; !status && part < ENF_LOADS; part++) {
            uint32_t bit = 1u << (part - 1), before = enf_world_loaded(world);
            bool damaged = with_needs(bit) >> (load - 1) & 1;
            assert_int_equal(enf_world_load(world, bit, &error), damaged ? ENF_BAD_INPUT : ENF_OK);
            if (damaged) assert_non_null(strstr(error.text, spec->tag));
            assert_int_equal(enf_world_loaded(world), damaged ? before : before | with_needs(bit));
            found += damaged;
        }
        enf_world_close(world);
        memcpy(copy + section->offset, s->w.bytes + section->offset, section->size);
    }
    assert_true(found > 10);
    free(copy);
}

static void damage_is_found_when_a_part_is_loaded(void **state) {
    stage *stages = *state;
    for (int i = 0; i < STAGES; i++) find_damage(&stages[i]);
}

enum { THREADS = 8 };

typedef struct loader {
    enf_world *world;
    uint64_t seed;
    int wrong;
    pthread_t thread;
} loader;

static void *load_all(void *user) {
    loader *l = user;
    double somewhere[3] = {0.1, 0.2, 0.3};
    for (int i = 0; i < 12; i++) {
        uint32_t loads = 1u << run_random(&l->seed) % 6;
        l->wrong += enf_world_load(l->world, loads, NULL) != ENF_OK;
        l->wrong += (enf_world_loaded(l->world) & loads) != loads;
        const enf_file_view *view = enf_world_file(l->world);
        l->wrong += (view->cells == NULL) != (view->cell_count == 0);
        enf_place place = enf_world_locate(l->world, somewhere, -1);
        l->wrong += place.cell >= enf_world_file(l->world)->cell_count;
    }
    l->wrong += enf_world_load(l->world, ENF_LOAD_ALL, NULL) != ENF_OK;
    return NULL;
}

static void threads_may_load_at_the_same_time(void **state) {
    stage *s = *state;
    uint64_t seed = 5;
    for (int round = 0; round < 20; round++) {
        enf_world *world = open_lazily(s->w.bytes, s->w.size);
        loader loaders[THREADS];
        for (int i = 0; i < THREADS; i++) {
            loaders[i] = (loader){.world = world, .seed = run_random(&seed)};
            assert_int_equal(pthread_create(&loaders[i].thread, NULL, load_all, &loaders[i]), 0);
        }
        for (int i = 0; i < THREADS; i++) {
            pthread_join(loaders[i].thread, NULL);
            assert_int_equal(loaders[i].wrong, 0);
        }
        expect_parts(enf_world_file(world), enf_world_file(s->w.world), ENF_LOAD_ALL);
        enf_world_close(world);
    }
}

// --- Option structs

typedef struct small_options {
    size_t size;
    int32_t first, second;
} small_options;

typedef struct large_options {
    size_t size;
    int32_t first, second;
    double third;
} large_options;

static void options_may_be_shorter_or_longer(void **state) {
    (void)state;
    small_options small = {sizeof small, 1, 2}, taken_small;
    large_options large = {sizeof large, 3, 4, 0}, taken;
    enf_error error = {0};
    assert_int_equal(enf_options_take(&taken, sizeof taken, NULL, "o", &error), ENF_OK);
    assert_true(taken.size == sizeof taken && taken.first == 0 && taken.second == 0 && taken.third == 0);
    memset(&taken, 0xff, sizeof taken);
    assert_int_equal(enf_options_take(&taken, sizeof taken, &small, "o", &error), ENF_OK);
    assert_true(taken.size == sizeof taken && taken.first == 1 && taken.second == 2 && taken.third == 0);
    assert_int_equal(enf_options_take(&taken_small, sizeof taken_small, &large, "o", &error), ENF_OK);
    assert_true(taken_small.size == sizeof small && taken_small.first == 3 && taken_small.second == 4);
    large.third = 0.5; // what an older library cannot do
    assert_int_equal(enf_options_take(&taken_small, sizeof taken_small, &large, "o", &error), ENF_BAD_USAGE);
    assert_int_equal(enf_options_take(&taken, sizeof taken, &large, "o", &error), ENF_OK);
    assert_true(taken.third == 0.5);
    large.size = 0;
    assert_int_equal(enf_options_take(&taken, sizeof taken, &large, "o_name", &error), ENF_BAD_USAGE);
    assert_non_null(strstr(error.text, "o_name"));
    large.size = SIZE_MAX;
    assert_int_equal(enf_options_take(&taken, sizeof taken, &large, "o", &error), ENF_BAD_USAGE);
}

static void opening_and_instances_take_options_of_any_version(void **state) {
    stage *s = *state;
    struct {
        enf_open_options known;
        uint64_t unknown;
    } newer = {{.size = sizeof newer}, 0};
    enf_world *world;
    assert_int_equal(enf_world_open_memory(&world, s->w.bytes, s->w.size, &newer.known, NULL), ENF_OK);
    enf_world_close(world);
    newer.unknown = 1;
    assert_int_equal(enf_world_open_memory(&world, s->w.bytes, s->w.size, &newer.known, NULL), ENF_BAD_USAGE);
    assert_null(world);
    newer.known = (enf_open_options){.size = sizeof newer.known, .mode = (enf_open_mode)2};
    assert_int_equal(enf_world_open_memory(&world, s->w.bytes, s->w.size, &newer.known, NULL), ENF_BAD_USAGE);
    enf_instance *instance;
    size_t wide[3] = {sizeof wide, 0, 0};
    const enf_instance_options *options = (const void *)wide;
    assert_int_equal(enf_instance_create(&instance, s->w.world, options, NULL), ENF_OK);
    enf_instance_free(instance);
    wide[2] = 1;
    assert_int_equal(enf_instance_create(&instance, s->w.world, options, NULL), ENF_BAD_USAGE);
    wide[0] = 0;
    assert_int_equal(enf_instance_create(&instance, s->w.world, options, NULL), ENF_BAD_USAGE);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_set_of_parts_shows_these_parts_only),
        cmocka_unit_test(older_views_stay_as_they_were),
        cmocka_unit_test(what_is_not_loaded_is_not_there),
        cmocka_unit_test(what_is_made_from_a_world_loads_what_it_needs),
        cmocka_unit_test(damage_is_found_when_a_part_is_loaded),
        cmocka_unit_test(threads_may_load_at_the_same_time),
        cmocka_unit_test(options_may_be_shorter_or_longer),
        cmocka_unit_test(opening_and_instances_take_options_of_any_version),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
