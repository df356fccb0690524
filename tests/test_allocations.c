// SPDX-License-Identifier: GPL-3.0-or-later
// No query takes memory: each is asked with an allocator that ends the program. A new query gets a line in
// the list at the end. Whatever is made (instances, views and so on) may take memory when it is made.
#include "run_worlds.h"

#include "enfilade/objects.h"
#include "enfilade/prefetch.h"
#include "enfilade/query.h"
#include "enfilade/sight.h"
#include "enfilade/sound.h"
#include "enfilade/view.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <sys/mman.h>
#include <unistd.h>

static atomic_bool forbidden;
static atomic_long taken; ///< allocations altogether, to see that this is the allocator that is used

static void note_allocation(void) {
    atomic_fetch_add(&taken, 1);
    if (!atomic_load(&forbidden)) return;
    static const char words[] = "a query took memory\n";
    atomic_store(&forbidden, false);
    if (write(2, words, sizeof words - 1) < 0) _exit(3);
    abort();
}

#if defined(__has_feature)
#define HAS_FEATURE(name) __has_feature(name)
#else
#define HAS_FEATURE(name) 0
#endif

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || HAS_FEATURE(address_sanitizer) || \
    HAS_FEATURE(thread_sanitizer)

// A sanitizer has an allocator of its own, which tells.
int __sanitizer_install_malloc_and_free_hooks(void (*taken)(const volatile void *, size_t),
                                              void (*freed)(const volatile void *));

static void on_malloc(const volatile void *memory, size_t size) {
    (void)memory;
    (void)size;
    note_allocation();
}

static void on_free(const volatile void *memory) {
    (void)memory;
}

static void watch_allocations(void) {
    assert_true(__sanitizer_install_malloc_and_free_hooks(on_malloc, on_free) > 0);
}

#else

// These take the place of the system's functions, for the C library's own calls as well. Memory comes from
// one stretch of addresses and never goes back.
enum { HEAD = 16 };
static const size_t arena_size = (size_t)1 << 29;
static atomic_size_t used;
static _Atomic(char *) arena;

static char *get_arena(void) {
    char *old = atomic_load(&arena);
    if (old) return old;
    void *mapped =
        mmap(NULL, arena_size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
    if (mapped == MAP_FAILED) _exit(3);
    if (atomic_compare_exchange_strong(&arena, &old, mapped)) return mapped;
    munmap(mapped, arena_size);
    return old;
}

static void *take_aligned(size_t alignment, size_t size) {
    note_allocation();
    if (alignment < HEAD) alignment = HEAD;
    if (size > arena_size / 2 || alignment > 4096) return NULL;
    size_t room = (size + alignment + 2 * HEAD - 1) / HEAD * HEAD;
    size_t at = atomic_fetch_add(&used, room);
    if (at + room > arena_size) return NULL;
    uintptr_t start = (uintptr_t)get_arena() + at + HEAD;
    char *memory = (char *)((start + alignment - 1) / alignment * alignment);
    memcpy(memory - HEAD, &size, sizeof size);
    return memory;
}

void *malloc(size_t size) {
    return take_aligned(HEAD, size);
}

void free(void *memory) {
    (void)memory;
}

void *calloc(size_t count, size_t size) { // fresh pages are zero
    return size && count > SIZE_MAX / size ? NULL : take_aligned(HEAD, count * size);
}

void *realloc(void *memory, size_t size) {
    void *fresh = take_aligned(HEAD, size);
    if (memory && fresh) {
        size_t old;
        memcpy(&old, (char *)memory - HEAD, sizeof old);
        memcpy(fresh, memory, old < size ? old : size);
    }
    return fresh;
}

void *aligned_alloc(size_t alignment, size_t size) {
    return take_aligned(alignment, size);
}

int posix_memalign(void **memory, size_t alignment, size_t size) {
    *memory = take_aligned(alignment, size);
    return *memory ? 0 : 12; // ENOMEM
}

static void watch_allocations(void) {}

#endif

// --- The stage: a world, everything that is made from one, and random places

enum { ROUNDS = 200, OBJECTS = 32, ROOM = 64 };

typedef struct stage {
    run_world w;
    const enf_file_view *view;
    enf_instance *instance;
    enf_view *look, *regions;
    enf_query *query;
    enf_objects *objects;
    enf_object handles[OBJECTS];
    enf_paths *paths, *plain;
    enf_path_finder *table_finder, *finder;
    enf_prefetch *prefetch;
    enf_stream *stream;
    uint64_t seed;
    double from[3], to[3];
    enf_place place; ///< of `from`
    int answers;     ///< that were not empty
} stage;

static void choose(stage *s) {
    for (int a = 0; a < 3; a++) {
        double size = s->w.box_max[a] - s->w.box_min[a];
        s->from[a] = s->w.box_min[a] + run_random_share(&s->seed) * size;
        s->to[a] = s->w.box_min[a] + run_random_share(&s->seed) * size;
    }
    s->place = enf_world_locate(s->w.world, s->from, -1);
}

static void make(enf_status status, const enf_error *error) {
    if (status) fail_msg("%s", error->text);
}

static enf_shape random_shape(stage *s) {
    enf_shape shape = {.kind = run_random(&s->seed) % 2 ? ENF_SHAPE_BOX : ENF_SHAPE_SPHERE};
    for (int a = 0; a < 3; a++) {
        shape.centre[a] = s->w.box_min[a] + run_random_share(&s->seed) * (s->w.box_max[a] - s->w.box_min[a]);
        shape.half[a] = run_random_share(&s->seed);
    }
    shape.radius = run_random_share(&s->seed);
    return shape;
}

/// In turn a world of many cells, and one with lines of sight.
static void set_stage(stage *s, uint64_t seed) {
    enf_error error = {0};
    *s = (stage){.w = seed % 2 ? run_world_grid(6, true, seed) : run_world_whole(4), .seed = seed};
    s->view = enf_world_file(s->w.world);
    const enf_world *world = s->w.world;
    const double round[12] = {1, 0, 0, 0.25, 0, 1, 0, 0, 0, 0, 1, 0};
    make(enf_instance_create(&s->instance, world, NULL, &error), &error);
    for (int32_t i = 0; i < 4 && i < s->view->portal_count; i++)
        make(enf_instance_set_transform(s->instance, i, 0, round, &error), &error);
    const enf_view_options every = {.size = sizeof every, .every_region = true, .edges_max = 4};
    make(enf_view_create(&s->look, world, NULL, &error), &error);
    make(enf_view_create(&s->regions, world, &every, &error), &error);
    make(enf_query_create(&s->query, world, NULL, &error), &error);
    make(enf_objects_create(&s->objects, world, NULL, &error), &error);
    const enf_paths_options plain = {.size = sizeof plain, .skip_table = true};
    make(enf_paths_create(&s->paths, world, NULL, &error), &error);
    make(enf_paths_create(&s->plain, world, &plain, &error), &error);
    make(enf_path_finder_create(&s->table_finder, s->paths, NULL, &error), &error);
    make(enf_path_finder_create(&s->finder, s->plain, NULL, &error), &error);
    make(enf_prefetch_create(&s->prefetch, world, &error), &error);
    make(enf_stream_create(&s->stream, world, &error), &error);
}

static void clear_stage(stage *s) {
    enf_prefetch_free(s->prefetch);
    enf_stream_free(s->stream);
    enf_path_finder_free(s->finder);
    enf_path_finder_free(s->table_finder);
    enf_paths_free(s->plain);
    enf_paths_free(s->paths);
    enf_objects_free(s->objects);
    enf_query_free(s->query);
    enf_view_free(s->regions);
    enf_view_free(s->look);
    enf_instance_free(s->instance);
    run_world_free(&s->w);
}

// --- The queries

static void ask_locate(stage *s) {
    s->answers += enf_world_locate(s->w.world, s->from, -1).cell >= 0;
    s->answers += enf_world_locate(s->w.world, s->to, s->place.tetrahedron).cell >= 0;
}

static void ask_info(stage *s) {
    enf_world_info info;
    enf_world_get_info(s->w.world, &info);
    s->answers += enf_world_string(s->w.world, 0) != NULL && enf_world_loaded(s->w.world) == ENF_LOAD_ALL;
}

static void ask_load(stage *s) { // of what is loaded
    s->answers += enf_world_load(s->w.world, ENF_LOAD_ALL, NULL) == ENF_OK;
}

static void ask_door(stage *s) {
    enf_door door = {(enf_door_state)(run_random(&s->seed) % 3), {1, 0, 0, -s->from[0]}};
    int32_t portal = (int32_t)(run_random(&s->seed) % (uint64_t)s->view->portal_count);
    s->answers += enf_instance_set_door(s->instance, portal, &door, NULL) == ENF_OK;
    s->answers += enf_instance_get_door(s->instance, portal).state == door.state;
}

static void ask_transform(stage *s) { // of a portal that has had one
    const double matrix[12] = {0, 1, 0, s->from[0], 1, 0, 0, s->from[1], 0, 0, 1, 0};
    int32_t portal = (int32_t)(run_random(&s->seed) % 4);
    s->answers += enf_instance_set_transform(s->instance, portal, 0, run_random(&s->seed) % 2 ? matrix : NULL,
                                             NULL) == ENF_OK;
}

static void ask_view(stage *s) {
    double forward[3], up[3] = {0, 0, 1};
    for (int a = 0; a < 3; a++) forward[a] = s->to[a] - s->from[a];
    enf_camera camera = enf_camera_look(s->from, forward, up, 1.2, 1.6);
    s->answers += enf_view_run(s->look, s->instance, &camera)->entry_count > 0;
    s->answers += enf_view_run(s->regions, NULL, &camera)->entry_count > 0;
}

static void ask_sight(stage *s) {
    int32_t portals[ROOM];
    enf_sight_query query = {.size = sizeof query, .portals = portals, .portal_capacity = ROOM};
    enf_sight sight;
    memcpy(query.from, s->from, sizeof query.from);
    memcpy(query.to, s->to, sizeof query.to);
    enf_sight_between(s->w.world, s->instance, &query, &sight, NULL);
    s->answers += sight.from.cell >= 0;
}

static void ask_ray(stage *s) {
    int32_t portals[ROOM];
    enf_ray ray = {.size = sizeof ray, .portals = portals, .portal_capacity = ROOM};
    enf_ray_hit hit;
    memcpy(ray.origin, s->from, sizeof ray.origin);
    for (int a = 0; a < 3; a++) ray.direction[a] = s->to[a] - s->from[a];
    enf_ray_cast(s->w.world, s->instance, &ray, &hit, NULL);
    s->answers += hit.end != ENF_RAY_NOWHERE;
}

static void ask_follow(stage *s) {
    int32_t portals[ROOM];
    enf_step step = {.size = sizeof step, .place = s->place, .portals = portals, .portal_capacity = ROOM};
    enf_stepped stepped;
    memcpy(step.from, s->from, sizeof step.from);
    memcpy(step.to, s->to, sizeof step.to);
    enf_world_follow(s->w.world, s->instance, &step, &stepped, NULL);
    s->answers += stepped.place.cell >= 0;
}

static void ask_query(stage *s) {
    enf_shape shape = random_shape(s);
    enf_reached reached[ROOM];
    enf_touched touched[ROOM];
    enf_reach reach;
    enf_query_cells(s->query, s->instance, -1, &shape, reached, ROOM, &reach, NULL);
    s->answers += reach.count > 0;
    enf_query_triangles(s->query, touched, ROOM);
    s->answers += enf_query_image(s->query, 0).matrix[0] != 0;
}

static void ask_objects(stage *s) {
    enf_object *handle = &s->handles[run_random(&s->seed) % OBJECTS], found[ROOM];
    enf_shape shape = random_shape(s);
    const double planes[1][4] = {{1, 0, 0, 0}};
    enf_object_info info;
    int32_t cells[ROOM], cell = s->place.cell >= 0 ? s->place.cell : 0;
    if (!enf_objects_get(s->objects, *handle, &info))
        enf_objects_add(s->objects, &shape, 1, NULL, handle, NULL);
    else if (run_random(&s->seed) % 4)
        enf_objects_move(s->objects, *handle, &shape, NULL);
    else
        enf_objects_remove(s->objects, *handle, NULL);
    s->answers += enf_objects_cells(s->objects, *handle, cells, ROOM) > 0;
    s->answers += enf_objects_of_cell(s->objects, cell, found, ROOM) > 0;
    s->answers += enf_objects_in_cells(s->objects, s->query, &cell, 1, found, ROOM) > 0;
    enf_object_seen seen[ROOM];
    enf_camera camera = enf_camera_look(s->from, planes[0], s->to, 1.2, 1.6);
    const enf_visible *visible = enf_view_run(s->look, s->instance, &camera);
    s->answers += enf_objects_in_view(s->objects, s->query, s->instance, visible, seen, ROOM) > 0;
    enf_objects_meets(s->objects, *handle, planes, 1);
    s->answers += enf_objects_get_use(s->objects).objects > 0;
}

static void ask_path(stage *s) {
    int32_t portals[ROOM];
    double points[ROOM][3];
    enf_path_query query = {.size = sizeof query,
                            .from_cell = -1,
                            .to_cell = -1,
                            .from = s->from,
                            .to = s->to,
                            .portals = portals,
                            .portal_capacity = ROOM,
                            .points = points,
                            .point_capacity = ROOM};
    enf_path path;
    enf_path_find(s->table_finder, NULL, &query, &path, NULL);
    s->answers += path.is_found;
    enf_path_find(s->finder, s->instance, &query, &path, NULL);
    s->answers += path.is_found;
    enf_paths_info info;
    enf_paths_get_info(s->paths, &info);
}

static void ask_near(stage *s) {
    enf_near_cell near[ROOM];
    int32_t count = 0;
    enf_path_near(s->finder, s->instance, -1, s->from, INFINITY, near, ROOM, &count, NULL);
    s->answers += count > 0;
}

static void ask_sound(stage *s) {
    int32_t portals[ROOM];
    enf_sound_query query = {.size = sizeof query,
                             .source_cell = -1,
                             .listener_cell = -1,
                             .range = 10,
                             .fade_length = 1,
                             .door_factor = 0.5,
                             .portals = portals,
                             .portal_capacity = ROOM};
    enf_sound_path ways[4];
    enf_sound sound = {0};
    memcpy(query.source, s->from, sizeof query.source);
    memcpy(query.listener, s->to, sizeof query.listener);
    enf_sound_find(s->finder, s->instance, &query, ways, 4, &sound, NULL);
    s->answers += sound.count > 0;
}

static void ask_prefetch(stage *s) {
    enf_wanted wanted[ROOM];
    int32_t cell = s->place.cell >= 0 ? s->place.cell : 0;
    s->answers += enf_prefetch_list(s->prefetch, cell, s->from, s->to, 1, wanted, ROOM) > 0;
    s->answers += enf_stream_load(s->stream, cell);
    s->answers += enf_stream_drop(s->stream, cell);
}

/// What fails takes no memory for its words either.
static void ask_nonsense(stage *s) {
    enf_error error;
    enf_door door = {.state = ENF_DOOR_CLOSED};
    enf_ray ray = {.size = sizeof ray};
    enf_ray_hit hit;
    s->answers += enf_instance_set_door(s->instance, s->view->portal_count, &door, &error) != ENF_OK;
    s->answers += enf_ray_cast(s->w.world, NULL, &ray, &hit, &error) != ENF_OK;
}

static const struct {
    const char *name;
    void (*ask)(stage *);
} queries[] = {
    {"locate", ask_locate},       {"info", ask_info},
    {"load", ask_load},           {"door", ask_door},
    {"transform", ask_transform}, {"view", ask_view},
    {"sight", ask_sight},         {"ray", ask_ray},
    {"follow", ask_follow},       {"query", ask_query},
    {"objects", ask_objects},     {"path", ask_path},
    {"near", ask_near},           {"sound", ask_sound},
    {"prefetch", ask_prefetch},   {"nonsense", ask_nonsense},
};

enum { QUERIES = sizeof queries / sizeof *queries };

static void no_query_takes_memory(void **state) {
    (void)state;
    int answers[QUERIES] = {0};
    for (uint64_t seed = 1; seed <= 4; seed++) {
        stage s;
        set_stage(&s, seed);
        for (size_t i = 0; i < QUERIES; i++) {
            s.answers = 0;
            for (int round = 0; round < ROUNDS; round++) {
                choose(&s);
                atomic_store(&forbidden, true);
                queries[i].ask(&s);
                atomic_store(&forbidden, false);
            }
            answers[i] += s.answers;
        }
        clear_stage(&s);
    }
    for (size_t i = 0; i < QUERIES; i++)
        if (answers[i] < ROUNDS / 10) fail_msg("%s: hardly any answer", queries[i].name);
}

static void allocations_are_seen(void **state) {
    (void)state;
    long before = atomic_load(&taken);
    run_world w = run_world_grid(2, false, 1);
    assert_true(atomic_load(&taken) > before + 10);
    run_world_free(&w);
}

int main(void) {
    watch_allocations();
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(allocations_are_seen),
        cmocka_unit_test(no_query_takes_memory),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
