// SPDX-License-Identifier: GPL-3.0-or-later
// What is fetched ahead, against a slow search; and which pages loading and dropping cells leaves in memory.
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

// --- loading and dropping
// ---------------------------------------------------------------------------------------------------

typedef struct streamed {
    enf_world *world;
    const enf_file_view *view;
    enf_stream *stream;
    bool *loaded; ///< per cell
    size_t page, page_count;
    unsigned sum;             ///< of what was read
    uint8_t *inner;           ///< per page: has geometry only
    uint8_t *wanted, *before; ///< per page: used by a loaded cell; and that before the latest change
} streamed;

/// Reads an element, too.
static void want(streamed *s, const void *start, size_t size) {
    const volatile uint8_t *bytes = start;
    size_t offset = (size_t)((const uint8_t *)start - s->view->bytes);
    s->wanted[offset / s->page] = s->wanted[(offset + size - 1) / s->page] = 1;
    s->sum += bytes[0] + bytes[size - 1];
}

/// The pages of the loaded cells, the plain way; and reads all that is on them.
static void use_loaded(streamed *s) {
    const enf_file_view *view = s->view;
    memcpy(s->before, s->wanted, s->page_count);
    memset(s->wanted, 0, s->page_count);
    for (int32_t cell = 0; cell < view->cell_count; cell++) {
        if (!s->loaded[cell]) continue;
        const enf_file_cell *about = &view->cells[cell];
        for (int32_t i = 0; i < about->triangle_count; i++) {
            const int32_t *at = &view->cell_triangles[about->triangle_first + i];
            const enf_file_triangle *triangle = &view->triangles[*at];
            want(s, at, sizeof *at);
            want(s, triangle, sizeof *triangle);
            for (int k = 0; k < 3; k++) {
                want(s, view->render_points[triangle->point[k]], sizeof *view->render_points);
                if (triangle->normal[k] >= 0)
                    want(s, view->render_normals[triangle->normal[k]], sizeof *view->render_normals);
                if (triangle->texcoord[k] >= 0)
                    want(s, view->render_texcoords[triangle->texcoord[k]], sizeof *view->render_texcoords);
            }
        }
    }
}

/// Is a page of the file in this process's memory? -1 if the system doesn't tell.
static int has_page(const streamed *s, size_t page) {
    FILE *map = fopen("/proc/self/pagemap", "rb");
    uint64_t entry = 0, number = (uint64_t)((uintptr_t)s->view->bytes / s->page + page);
    bool known = map && fseek(map, (long)(8 * number), SEEK_SET) == 0 && fread(&entry, 8, 1, map) == 1;
    if (map) fclose(map);
    return known ? (int)(entry >> 63) : -1;
}

static void find_inner(streamed *s, const void *start, int64_t count, size_t size) {
    size_t first = (size_t)((const uint8_t *)start - s->view->bytes), end = first + (size_t)count * size;
    for (size_t i = 0; i < s->page_count; i++)
        if (i * s->page >= first && (i + 1) * s->page <= end) s->inner[i] = 1;
}

/// Is nothing left of the geometry in this process's memory?
static void expect_none(const streamed *s) {
    for (size_t i = 0; i < s->page_count; i++)
        if (s->inner[i]) assert_true(has_page(s, i) <= 0);
}

static streamed open_stream(const char *path) {
    streamed s = {.page = (size_t)sysconf(_SC_PAGESIZE)};
    enf_open_options options = {.size = sizeof options, .mode = ENF_OPEN_LAZY};
    assert_int_equal(enf_world_open_path(&s.world, path, &options, NULL), ENF_OK);
    assert_int_equal(enf_stream_create(&s.stream, s.world, NULL), ENF_OK);
    s.view = enf_world_file(s.world);
    assert_true(s.view->has_geometry);
    s.page_count = s.view->size / s.page + 1;
    s.loaded = calloc((size_t)s.view->cell_count + 1, sizeof *s.loaded);
    s.inner = calloc(s.page_count, 1);
    s.wanted = calloc(s.page_count, 1);
    s.before = calloc(s.page_count, 1);
    assert_true(s.loaded && s.inner && s.wanted && s.before);
    const enf_file_view *view = s.view;
    find_inner(&s, view->render_points, view->render_point_count, sizeof *view->render_points);
    find_inner(&s, view->render_normals, view->render_normal_count, sizeof *view->render_normals);
    find_inner(&s, view->render_texcoords, view->render_texcoord_count, sizeof *view->render_texcoords);
    find_inner(&s, view->triangles, view->triangle_count, sizeof *view->triangles);
    find_inner(&s, view->cell_triangles, view->cell_triangle_count, sizeof *view->cell_triangles);
    expect_none(&s); // the check has read everything
    return s;
}

static void close_stream(streamed *s) {
    enf_stream_free(s->stream);
    enf_world_close(s->world);
    free(s->loaded);
    free(s->inner);
    free(s->wanted);
    free(s->before);
}

/// Loads and drops random cells. Returns how many pages of the process were given back.
static int64_t load_and_drop(streamed *s, int changes, uint64_t *seed) {
    int64_t gone = 0;
    for (int n = 0; n < changes; n++) {
        int32_t cell = (int32_t)(run_random(seed) % (uint64_t)s->view->cell_count);
        bool is_load = run_random_share(seed) < 0.05;
        bool changes_it = s->loaded[cell] != is_load;
        s->loaded[cell] = is_load;
        if (is_load) {
            assert_true(enf_stream_load(s->stream, cell) == changes_it);
            assert_false(enf_stream_load(s->stream, cell));
            use_loaded(s);
            continue;
        }
        use_loaded(s); // all that is about to go has been read
        assert_true(enf_stream_drop(s->stream, cell) == changes_it);
        assert_false(enf_stream_drop(s->stream, cell));
        for (size_t i = 0; i < s->page_count; i++) {
            int has = s->before[i] && s->inner[i] ? has_page(s, i) : -1;
            if (has < 0) continue;
            assert_int_equal(has, s->wanted[i]);
            gone += !has;
        }
    }
    return gone;
}

/// At least so many pages are to be given back on the way.
static void check_streaming(const run_world *w, int least, uint64_t *seed) {
    uint64_t hash = enf_hash64(w->bytes, w->size, 0);
    char path[] = "stream-XXXXXX";
    int file = mkstemp(path);
    assert_true(file >= 0 && write(file, w->bytes, w->size) == (ssize_t)w->size);
    close(file);
    streamed s = open_stream(path);
    remove(path); // it stays mapped, and nothing is left if the test fails
    bool tells = has_page(&s, 0) >= 0;
    int64_t gone = load_and_drop(&s, 2000, seed);
    if (tells) assert_true(gone > least);
    if (!tells) print_message("this system does not tell which pages a process has\n");
    for (int32_t i = 0; i < s.view->cell_count; i++) assert_true(enf_stream_drop(s.stream, i) == s.loaded[i]);
    expect_none(&s);
    assert_false(enf_stream_load(s.stream, -1) || enf_stream_load(s.stream, s.view->cell_count));
    assert_false(enf_stream_drop(s.stream, -1) || enf_stream_drop(s.stream, s.view->cell_count));
    assert_true(enf_hash64(s.view->bytes, s.view->size, 0) == hash);
    close_stream(&s);
}

static void dropped_pages_are_gone_and_no_others(void **state) {
    (void)state;
    uint64_t seed = 9;
    print_message("seed %llu\n", (unsigned long long)seed);
    run_world w = run_world_grid(12, true, 9);
    check_streaming(&w, 5, &seed);
    run_world_free(&w);
}

/// In memory that dropped pages would not come back to.
static void worlds_in_memory_stay(void **state) {
    (void)state;
    run_world w = run_world_grid(6, true, 9);
    uint64_t hash = enf_hash64(w.bytes, w.size, 0);
    enf_stream *stream;
    assert_int_equal(enf_stream_create(&stream, w.world, NULL), ENF_OK);
    int32_t count = enf_world_file(w.world)->cell_count;
    for (int32_t i = 0; i < count; i++) assert_true(enf_stream_load(stream, i));
    for (int32_t i = 0; i < count; i++) assert_true(enf_stream_drop(stream, i));
    assert_false(enf_stream_drop(stream, 0));
    assert_true(enf_hash64(w.bytes, w.size, 0) == hash);
    enf_stream_free(stream);
    enf_stream_free(NULL);
    run_world_free(&w);
}

#ifdef ENFILADE_CLI
static void a_compiled_world_streams(void **state) {
    (void)state;
    uint64_t seed = 10;
    print_message("seed %llu\n", (unsigned long long)seed);
    run_world w = run_world_compile(ENFILADE_MODELS_DIR "/office.obj");
    check_streaming(&w, 100, &seed);
    run_world_free(&w);
}
#endif

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(lists_are_what_a_slow_search_finds),
        cmocka_unit_test(nonsense_has_no_list),
        cmocka_unit_test(dropped_pages_are_gone_and_no_others),
        cmocka_unit_test(worlds_in_memory_stay),
#ifdef ENFILADE_CLI
        cmocka_unit_test(a_compiled_world_streams),
#endif
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
