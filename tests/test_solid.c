// SPDX-License-Identifier: GPL-3.0-or-later
// Rock or air, against the truth: the shared Quake levels name their brushes ("# brush N"), each convex and
// closed, so a point is solid exactly if it is behind all planes of one of them. Points are located in the
// finished world.
#include "clean_fixture.h"
#include "pipeline_fixture.h"

#include "base/array.h"
#include "build/write.h"
#include "format/locate.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

#include <cmocka.h>

/// Planes (outward normal and offset) of all solid brushes, with boxes; liquids are left out.
typedef struct brushes {
    double (*planes)[4];
    size_t plane_count, plane_capacity;
    struct brush {
        size_t first;
        double low[3], high[3];
    } * list;
    size_t count, capacity;
    double (*points)[3];
    size_t point_count, point_capacity;
} brushes;

static void add_face(brushes *all, const int32_t *corners, int count) {
    double normal[3] = {0, 0, 0};
    const double *origin = all->points[corners[0]];
    for (int i = 1; i + 1 < count; i++) {
        for (int k = 0; k < 3; k++) {
            int a = (k + 1) % 3, b = (k + 2) % 3;
            const double *p = all->points[corners[i]], *q = all->points[corners[i + 1]];
            normal[k] += (p[a] - origin[a]) * (q[b] - origin[b]) - (p[b] - origin[b]) * (q[a] - origin[a]);
        }
    }
    double length = sqrt(normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2]);
    assert_true(enf_array_reserve(all->planes, all->plane_capacity, all->plane_count + 1));
    double *plane = all->planes[all->plane_count++];
    plane[3] = 0;
    for (int k = 0; k < 3; k++) {
        plane[k] = normal[k] / length;
        plane[3] -= plane[k] * origin[k];
    }
    struct brush *brush = &all->list[all->count - 1];
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) {
            brush->low[k] = fmin(brush->low[k], all->points[corners[i]][k]);
            brush->high[k] = fmax(brush->high[k], all->points[corners[i]][k]);
        }
    }
}

static void read_brushes(brushes *all, const char *path) {
    gzFile file = gzopen(path, "rb");
    assert_non_null(file);
    char line[4096];
    bool liquid = false;
    while (gzgets(file, line, sizeof line)) {
        if (line[0] == 'g') {
            liquid = strstr(line, "liquid") != NULL;
        } else if (strncmp(line, "v ", 2) == 0) {
            assert_true(enf_array_reserve(all->points, all->point_capacity, all->point_count + 1));
            double *p = all->points[all->point_count++];
            assert_int_equal(sscanf(line, "v %lf %lf %lf", &p[0], &p[1], &p[2]), 3);
        } else if (strncmp(line, "# brush", 7) == 0 && !liquid) {
            assert_true(enf_array_reserve(all->list, all->capacity, all->count + 1));
            all->list[all->count++] = (struct brush){.first = all->plane_count,
                                                     .low = {HUGE_VAL, HUGE_VAL, HUGE_VAL},
                                                     .high = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}};
        } else if (line[0] == 'f' && !liquid) {
            int32_t corners[64];
            int count = 0;
            for (char *at = line + 1; count < 64;) {
                char *end;
                long index = strtol(at, &end, 10);
                if (end == at) break;
                corners[count++] = (int32_t)index - 1;
                at = end + strcspn(end, " \n");
            }
            add_face(all, corners, count);
        }
    }
    gzclose(file);
}

/// +1 inside a brush, -1 outside all; 0 nearer than `margin` to a face.
static int solid_at(const brushes *all, const double at[3], double margin) {
    int answer = -1;
    for (size_t b = 0; b < all->count; b++) {
        const struct brush *brush = &all->list[b];
        bool beyond = false;
        for (int k = 0; k < 3; k++)
            beyond |= at[k] < brush->low[k] - margin || at[k] > brush->high[k] + margin;
        if (beyond) continue;
        size_t end = b + 1 < all->count ? all->list[b + 1].first : all->plane_count;
        double highest = -HUGE_VAL;
        for (size_t p = brush->first; p < end; p++) {
            const double *plane = all->planes[p];
            highest = fmax(highest, plane[0] * at[0] + plane[1] * at[1] + plane[2] * at[2] + plane[3]);
        }
        if (fabs(highest) < margin) return 0;
        if (highest < 0) answer = 1;
    }
    return answer;
}

static int points_per_level(void) {
    const char *scale = getenv("ENFILADE_TEST_SCALE");
    return (int)fmax(200, 4000 * (scale ? atof(scale) : 1));
}

static void check_kinds(const char *path, const char *name, const brushes *all, bool with_spawns) {
    static const char *const exclude[] = {"*liquid*"};
    enf_build build = {0};
    enf_error error = {0};
    enf_image image;
    if (enf_soup_read(&build.soup, path, &error) != ENF_OK) fail_msg("%s", error.text);
    if (!with_spawns) build.soup.spawn_count = 0;
    enf_build_options options = pipeline_options();
    options.clean.exclude = exclude;
    options.clean.exclude_count = 1;
    options.keep = ENF_KEEP_ALL;
    options.stop = (enf_stop){.rule = ENF_STOP_WEIGHT, .weight = 1};
    pipeline_build(&build, &options);
    if (enf_image_make(&image, &build, NULL, &error) != ENF_OK) fail_msg("%s", error.text);
    double low[3], high[3];
    for (int k = 0; k < 3; k++) low[k] = HUGE_VAL, high[k] = -HUGE_VAL;
    for (size_t i = 0; i < 3 * all->point_count; i++) {
        low[i % 3] = fmin(low[i % 3], all->points[i / 3][i % 3]);
        high[i % 3] = fmax(high[i % 3], all->points[i / 3][i % 3]);
    }
    uint64_t seed = 11;
    int wrong = 0, asked = 0, solid = 0;
    for (int i = 0; i < points_per_level(); i++) {
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = low[k] + (high[k] - low[k]) * (double)(fixture_random(&seed) >> 11) * 0x1p-53;
        int truth = solid_at(all, at, 1e-3);
        if (truth == 0) continue;
        asked++;
        solid += truth > 0;
        wrong += (enf_view_locate(&image.view, at, -1).kind == ENF_WORLD_ROCK) != (truth > 0);
    }
    for (size_t s = 0; s < build.soup.spawn_count; s++) {
        if (solid_at(all, build.soup.spawns + 3 * s, 1e-3) == 0) continue;
        wrong += enf_view_locate(&image.view, build.soup.spawns + 3 * s, -1).kind == ENF_WORLD_ROCK;
    }
    print_message("%s %s spawns: %d points, %d solid, %d wrong\n", name, with_spawns ? "with" : "without",
                  asked, solid, wrong);
    assert_int_equal(wrong, 0);
    assert_true(solid > 0);
    enf_image_free(&image);
    enf_build_free(&build);
}

static void check_level(const char *path, const char *name) {
    brushes all = {0};
    read_brushes(&all, path);
    check_kinds(path, name, &all, true);
    check_kinds(path, name, &all, false);
    free(all.planes);
    free(all.list);
    free(all.points);
}

static void rock_is_what_brushes_hold(void **state) {
    (void)state;
    pipeline_visit_levels(check_level);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(rock_is_what_brushes_hold)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
